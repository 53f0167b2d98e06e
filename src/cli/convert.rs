//! `twinlight convert`.

use super::args::ConvertArgs;
use super::{Failure, status};
use crate::output::{self, Encoding, Metadata, Window};

pub fn run(args: &ConvertArgs) -> Result<(), Failure> {
    output::check_writable(&args.output).map_err(Failure::usage)?;
    let image = output::read_image(&args.input).map_err(|e| Failure::new(status::DATA, e))?;
    let metadata = Metadata::default();
    let window = Window::full(image.width, image.height);
    output::write_image(&args.output, &image, &Encoding { metadata: &metadata, window, exposure: args.exposure })
        .map_err(Failure::other)
}
