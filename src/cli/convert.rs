//! `twinlight convert`.

use super::args::ConvertArgs;
use super::{Failure, same_file};
use crate::output::{self, Format, Metadata};

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
    let image = output::read_image(&args.input).map_err(Failure::image)?;
    let exposure = args.exposure.unwrap_or(0.0);
    output::write_image(&args.output, &image, &Metadata::default(), exposure).map_err(Failure::other)
}
