//! `twinlight stress`: scenes at the edge of what numbers can hold.

use std::path::Path;

use super::args::StressArgs;
use super::{Failure, count, print, status, tell};
use crate::output::{check_place, write_atomically};
use crate::stress::{self, HEADING};

/// Samples per pixel and seed of a quick run and of a full one.
const SAMPLES: [u32; 2] = [4, 16];

/// The command that makes such a report, but for where it goes: that is told of the page in `docs` alone.
fn command(args: &StressArgs) -> String {
    let mut words = vec!["twinlight stress".to_owned()];
    words.extend(args.full.then(|| "--full".to_owned()));
    words.extend(args.case.iter().map(|case| format!("--case {case:?}")));
    if args.output.as_deref().is_some_and(|path| path == Path::new("docs/STRESS.md")) {
        words.push("-o docs/STRESS.md".to_owned());
    }
    words.join(" ")
}

pub fn run(args: &StressArgs) -> Result<(), Failure> {
    let format = match &args.output {
        None => None,
        Some(path) => match path.extension().and_then(|e| e.to_str()) {
            Some(format @ ("html" | "json" | "md")) => {
                // Not after minutes.
                check_place(path).map_err(Failure::other)?;
                Some((path, format))
            }
            _ => {
                let path = path.display();
                return Err(Failure::usage(format!(
                    "{path}: a report is an .html, .json or .md file; give it such a name"
                )));
            }
        },
    };
    let cases: Vec<_> = (stress::cases(args.full).into_iter())
        .filter(|case| args.case.is_empty() || args.case.iter().any(|name| case.name.contains(name.as_str())))
        .collect();
    if cases.is_empty() {
        let names: Vec<String> = stress::cases(args.full).into_iter().map(|case| case.name).collect();
        let wanted = args.case.join(", ");
        return Err(Failure::usage(format!("no case is named like {wanted}; there are: {}", names.join("; "))));
    }
    print(&format!("{HEADING}\n"));
    let hook = std::panic::take_hook();
    // A panic within a case is a row's verdict.
    std::panic::set_hook(Box::new(move |info| {
        if !stress::is_guarded() {
            hook(info);
        }
    }));
    let report = stress::run(&cases, SAMPLES[usize::from(args.full)], &mut |row| print(&format!("{}\n", row.line())));
    if let Some((path, format)) = format {
        let text = match format {
            "html" => report.html(),
            "md" => report.markdown(&command(args)),
            _ => format!("{:#}\n", report.json()),
        };
        write_atomically(path, text.as_bytes()).map_err(Failure::other)?;
    }
    let failures = report.failures();
    let rows = count(report.rows.len(), "row", "rows");
    if failures > 0 {
        return Err(Failure::new(status::OTHER, format!("{failures} of {rows} are not as they must be")));
    }
    tell(&format!("twinlight: {rows}, all as they must be\n"));
    Ok(())
}
