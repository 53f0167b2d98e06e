//! The command line: one file per subcommand. Only this module knows arguments, terminals and exit codes.

mod args;
mod available;
mod bench;
mod compare;
mod convert;
mod explain;
mod info;
mod memory;
mod precision;
mod progress;
mod pyramid;
mod render;
mod settings;
mod sheet;
mod stats;
mod stress;
mod trace;
mod words;

use std::borrow::Cow;
use std::fmt::Display;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;

use crate::decode::in_decoder;
use crate::output::OutputError;

use args::{Cli, Command};

/// Exit statuses beyond 0 (done) and 2 (usage, which clap uses as well).
mod status {
    /// Anything that has no status of its own; files that are not there or cannot be read or written among it.
    pub const OTHER: u8 = 1;
    /// The command line asks for something impossible.
    pub const USAGE: u8 = 2;
    /// A scene or asset is bad (`EX_DATAERR`).
    pub const DATA: u8 = 65;
    /// Non-finite or overflowing contributions were seen and left out; the image was written (`EX_SOFTWARE`).
    pub const NON_FINITE: u8 = 70;
}

/// Why a command failed: the status to exit with and what to tell the user.
#[derive(Debug)]
struct Failure {
    status: u8,
    message: String,
}

impl Failure {
    fn new(status: u8, message: impl Display) -> Self {
        Self { status, message: message.to_string() }
    }

    fn other(message: impl Display) -> Self {
        Self::new(status::OTHER, message)
    }

    fn usage(message: impl Display) -> Self {
        Self::new(status::USAGE, message)
    }

    /// An image that could not be read: bad, or out of reach.
    fn image(error: OutputError) -> Self {
        Self::new(if error.bad_content { status::DATA } else { status::OTHER }, error)
    }
}

/// Parses the arguments, runs the command and returns its exit status.
pub fn run() -> ExitCode {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        if !in_decoder() {
            hook(info);
        }
    }));
    let result = match Cli::parse().command {
        Command::Render(args) => render::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Convert(args) => convert::run(&args),
        Command::Stress(args) => stress::run(&args),
        Command::Precision(args) => precision::run(&args),
        Command::Bench(args) => bench::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            for line in failure.message.lines() {
                tell(&format!("twinlight: {line}\n"));
            }
            ExitCode::from(failure.status)
        }
    }
}

/// Prints to standard output; a reader that has gone away (a closed pipe) is no error of ours.
fn print(text: &str) {
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(printable(text).as_bytes()).and_then(|()| out.flush());
}

/// Prints to standard error. `eprint!` would panic where nobody reads it, and lose the image with it.
fn tell(text: &str) {
    draw(&printable(text));
}

/// `tell` for what steers the terminal: of our own words alone.
fn draw(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// Text with control characters escaped, but for ends of lines and tabs: names out of files (layers of an EXR, say) may hold
/// sequences that a terminal obeys.
fn printable(text: &str) -> Cow<'_, str> {
    let steers = |c: char| c.is_control() && !matches!(c, '\n' | '\t');
    if !text.contains(steers) {
        return Cow::Borrowed(text);
    }
    let escaped = |c: char| if steers(c) { c.escape_default().to_string() } else { c.to_string() };
    Cow::Owned(text.chars().map(escaped).collect())
}

/// A number and what it counts.
fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// A number to four significant digits, without zeros that say nothing.
fn figures(x: f64) -> String {
    significant(x, 4, -4..5)
}

/// A number to so many significant digits, without zeros that say nothing; as a power of ten where its size is none of
/// `plain`.
fn significant(x: f64, digits: i32, plain: std::ops::Range<i32>) -> String {
    let text = padded(x, digits, plain);
    let stripped = text.contains('.') && !text.contains('e');
    if stripped { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// `significant` with all its zeros, so that numbers below each other are as exact as each other.
fn padded(x: f64, digits: i32, plain: std::ops::Range<i32>) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{}", x + 0.0); // −0 is 0.
    }
    let power = x.abs().log10().floor() as i32;
    if !plain.contains(&power) {
        return format!("{x:.*e}", digits as usize - 1);
    }
    format!("{x:.*}", (digits - 1 - power).max(0) as usize)
}

/// Whether two paths lead to one file, which need not be there yet.
fn same_file(a: &Path, b: &Path) -> bool {
    let place = |path: &Path| -> Option<PathBuf> {
        path.canonicalize().ok().or_else(|| {
            let folder = path.parent().filter(|p| *p != Path::new("")).unwrap_or(Path::new("."));
            Some(folder.canonicalize().ok()?.join(path.file_name()?))
        })
    };
    matches!((place(a), place(b)), (Some(a), Some(b)) if a == b)
}
