//! The `twinlight` command: parse, run, exit code.

use std::process::ExitCode;

fn main() -> ExitCode {
    twinlight::cli::run()
}
