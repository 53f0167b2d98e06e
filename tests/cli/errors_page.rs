//! `docs/ERRORS.md`, made from the tables of mistakes.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use super::arguments::{ARGUMENTS, Arguments, COMMANDS};
use super::assets::{Asset, Content, MESH_FILES};
use super::assets_images::IMAGES;
use super::mistakes::SCENES;
use super::notes::NOTES;

const INTRODUCTION: &str = "\
# Errors

What `twinlight` says about mistakes. Each message names the file, the line and column, the JSON pointer of the value,
the value and what is allowed instead. The mistakes of a scene are told all at once, the first hundred of them, in the
file's order; of each mesh file and image that it names, the first. The exit status is 2 for the command line, 65 for a
scene, an asset or an image, 1 for a scene or an image that is not there or cannot be read. No output file is touched.

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

/// A heading, then `text` in line or as a block.
fn example(out: &mut String, what: &str, language: &str, text: &str) {
    let _ = match (text, text.contains('\n')) {
        ("", _) => writeln!(out, "**{what}.**\n"),
        (_, true) => writeln!(out, "**{what}.**\n\n```{language}\n{}\n```\n", text.trim_end_matches('\n')),
        (_, false) => writeln!(out, "**{what}.** `{text}`\n"),
    };
}

fn scene_text(marked: &str) -> String {
    let text = marked.replace('«', "").replace('\u{feff}', "U+FEFF");
    text.replace("[128×[]", "[[… 128 times …[").replace("[128×]]", "]… ]]")
}

fn assets(out: &mut String, title: &str, introduction: &str, assets: &[Asset]) {
    let _ = writeln!(out, "\n## {title}\n\n{introduction}\n");
    for asset in assets {
        match asset.content {
            Content::Text(text) => example(out, asset.what, "text", text),
            Content::Bytes(words, _) => {
                let _ = writeln!(out, "**{}:** {words}.\n", asset.what);
            }
        }
        indented(out, &asset.scene().1);
    }
    out.pop();
}

fn arguments(out: &mut String, title: &str, introduction: &str, command: &str, table: &[Arguments]) {
    let _ = writeln!(out, "\n## {title}\n\n{introduction}\n");
    for mistake in table {
        let status = if mistake.status == 2 { String::new() } else { format!(" (status {})", mistake.status) };
        let _ = writeln!(out, "**{}{status}.** `twinlight {command}{}`\n", mistake.what, mistake.arguments);
        indented(out, mistake.message);
    }
    out.pop();
}

fn page() -> String {
    let mut out = INTRODUCTION.to_owned();
    for (title, mistakes) in SCENES {
        let _ = writeln!(out, "\n## {title}\n");
        for mistake in mistakes {
            example(&mut out, mistake.what, "json", &scene_text(mistake.text));
            indented(&mut out, &mistake.unmarked().1);
        }
        out.pop();
    }
    let scene = "The scene is a `mesh` of this file.";
    assets(&mut out, "Mesh files", scene, MESH_FILES);
    let scene =
        "The scene is a `mirror` with the image as its `albedo`; where the file is named `sky`, it is the background.";
    assets(&mut out, "Images", scene, IMAGES);
    let files = "The scene's image has 8 × 8 pixels; `old.exr` is a file, `folder.exr` an empty folder, `image.png` an image, \
                 `binary` a file of\nother bytes.";
    arguments(&mut out, "Command line", files, "render ", ARGUMENTS);
    let files = "`a.exr` and `a.png` are images of 2 × 2 pixels, `b.exr` of 3 × 2.";
    arguments(&mut out, "The other commands", files, "", COMMANDS);
    out.push_str(
        "\n## Notes and warnings\n\nThese stop nothing: the image is written, the status is 0. `--quiet` leaves them out; `info` \
         tells those that the scene\nalone causes.\n\n",
    );
    for note in NOTES {
        let options = if note.arguments.is_empty() { String::new() } else { format!(" (`{}`)", note.arguments) };
        example(&mut out, &format!("{}{options}", note.what), "json", &scene_text(note.text));
        indented(&mut out, &note.unmarked().1);
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
