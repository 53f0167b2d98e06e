//! `docs/ERRORS.md`, made from the tables of mistakes.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::arguments::ARGUMENTS;
use super::mistakes::SCENES;

const INTRODUCTION: &str = "\
# Errors

What `twinlight` says about mistakes. Each message names the file, the line and column, the JSON pointer of the value,
the value and what is allowed instead. Mistakes are told all at once, in the file's order. The exit status is 2 for the
command line, 65 for a scene, an asset or an image, 1 for a scene or an image that is not there or cannot be read. No
output file is touched.

This page is made from the tables that `tests/cli.rs` runs the program on:
`UPDATE_DOCS=1 cargo test --test cli the_page` writes it, and the test fails where it is stale.
";

/// Text as Markdown's block of code.
fn indented(out: &mut String, text: &str) {
    for line in text.lines() {
        let _ = writeln!(out, "    {line}");
    }
    out.push('\n');
}

fn page() -> String {
    let mut out = INTRODUCTION.to_owned();
    for (title, mistakes) in SCENES {
        let _ = writeln!(out, "\n## {title}\n");
        for mistake in mistakes {
            let text = mistake.text.replace('«', "").replace("[128×[]", "[[… 128 times …[").replace("[128×]]", "]… ]]");
            let _ = match (text.as_str(), text.contains('\n')) {
                ("", _) => writeln!(out, "**{}.**\n", mistake.what),
                (_, true) => writeln!(out, "**{}.**\n\n```json\n{text}\n```\n", mistake.what),
                (_, false) => writeln!(out, "**{}.** `{text}`\n", mistake.what),
            };
            indented(&mut out, &mistake.unmarked().1);
        }
        out.pop();
    }
    out.push_str(
        "\n## Command line\n\nThe scene's image has 8 × 8 pixels; `old.exr` is a file, `folder.exr` an empty folder, \
         `image.png` an image, `binary` a file of\nother bytes.\n\n",
    );
    for mistake in ARGUMENTS {
        let status = if mistake.status == 2 { String::new() } else { format!(" (status {})", mistake.status) };
        let _ = writeln!(out, "**{}{status}.** `twinlight render {}`\n", mistake.what, mistake.arguments);
        indented(&mut out, mistake.message);
    }
    out.pop();
    out
}

#[test]
fn the_page_of_errors_is_up_to_date() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/ERRORS.md");
    let page = page();
    if std::env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&path, &page).unwrap();
    }
    let there = fs::read_to_string(&path).unwrap_or_default();
    let stale = there.lines().zip(page.lines()).position(|(a, b)| a != b).map_or(1, |i| i + 1);
    assert!(
        there == page,
        "docs/ERRORS.md is stale from line {stale} on: UPDATE_DOCS=1 cargo test --test cli the_page"
    );
}
