//! `twinlight convert`.

use super::args::ConvertArgs;
use super::{Failure, same_file};
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
    let (image, metadata) = output::read_image_and_metadata(&args.input).map_err(Failure::image)?;
    let exposure = args.exposure.unwrap_or(0.0);
    output::write_image(&args.output, &image, &metadata, exposure).map_err(Failure::other)
}
