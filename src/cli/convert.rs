//! `twinlight convert`.

use super::args::ConvertArgs;
use super::{Failure, status};
use crate::output::{self, Metadata};

pub fn run(args: &ConvertArgs) -> Result<(), Failure> {
    output::check_writable(&args.output).map_err(Failure::usage)?;
    let image = output::read_image(&args.input).map_err(|e| Failure::new(status::DATA, e))?;
    output::write_image(&args.output, &image, &Metadata::default(), args.exposure).map_err(Failure::other)
}
