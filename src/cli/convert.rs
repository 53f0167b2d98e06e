//! `twinlight convert`.

use super::args::ConvertArgs;
use super::{Failure, same_file, status};
use crate::output::{self, Metadata};

pub fn run(args: &ConvertArgs) -> Result<(), Failure> {
    output::check_writable(&args.output).map_err(Failure::usage)?;
    if same_file(&args.output, &args.input) {
        let path = args.output.display();
        return Err(Failure::usage(format!("{path}: this is the image to convert; choose another name")));
    }
    let image = output::read_image(&args.input).map_err(|e| Failure::new(status::DATA, e))?;
    output::write_image(&args.output, &image, &Metadata::default(), args.exposure).map_err(Failure::other)
}
