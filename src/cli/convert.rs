//! `twinlight convert`.

use super::args::ConvertArgs;
use super::{Failure, same_file, tell};
use crate::output::{self, Format};

pub fn run(args: &ConvertArgs) -> Result<(), Failure> {
    let format = output::check_writable(&args.output).map_err(Failure::usage)?;
    if let Some(stops) = args.exposure.filter(|_| format == Format::Exr) {
        return Err(Failure::usage(format!(
            "--exposure {stops} brightens PNG files: an EXR stays linear; leave it out or write a PNG"
        )));
    }
    if same_file(&args.output, &args.input) {
        let path = args.output.display();
        return Err(Failure::usage(format!("{path}: this is the image to convert; choose another name")));
    }
    // A crop stays one, and what made the image stays known: what a PNG cannot hold, writing one leaves out.
    let read = match &args.layer {
        Some(layer) => output::read_layer_and_metadata(&args.input, layer),
        None => output::read_image_and_metadata(&args.input),
    };
    let (image, metadata) = read.map_err(Failure::image)?;
    output::write_image(&args.output, &image, &metadata, args.exposure.unwrap_or(0.0)).map_err(Failure::other)?;
    let left_out = if args.layer.is_none() { output::layers(&args.input) } else { Vec::new() };
    if !left_out.is_empty() {
        let input = args.input.display();
        tell(&format!("note: of {input} the layers {} are left out: --layer NAME takes one\n", left_out.join(", ")));
    }
    Ok(())
}
