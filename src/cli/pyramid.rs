//! The pyramid: one weighted image per technique, which together are the image, and a sheet that shows them.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::sheet::sheet;
use super::{Failure, same_file};
use crate::film::Image;
use crate::integrator::Technique;
use crate::output::{self, Metadata};

/// The sheet's file name.
const SHEET: &str = "pyramid.png";

/// Checks, before the work starts, that the folder is there and can be written to, or can be made: its parent must be
/// there, as an output's folder must. Leaves nothing behind: the scene may yet turn out to be bad.
pub fn check(folder: &Path) -> Result<(), Failure> {
    let place = if folder.exists() || folder.is_symlink() { folder.join("s0_t2.exr") } else { folder.to_owned() };
    output::check_place(&place).map_err(|e| Failure::usage(format!("--pyramid: {e}")))
}

/// Whether a path is that of a file which a pyramid in `folder` may write.
pub fn would_write(folder: &Path, path: &Path) -> bool {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return false };
    let technique = || {
        let (s, rest) = name.strip_prefix('s')?.split_once("_t")?;
        let (t, extension) = rest.split_once('.')?;
        let number = |n: &str| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit());
        Some(number(s) && number(t) && ["exr", "png"].contains(&extension))
    };
    (name == SHEET || technique() == Some(true)) && same_file(&folder.join(name), path)
}

/// Makes the folder and writes `s{s}_t{t}.exr` and `.png` per technique, and the sheet. Returns what to tell of it.
pub fn write(
    folder: &Path,
    techniques: &BTreeMap<Technique, Image>,
    metadata: &Metadata,
    exposure: f32,
) -> Result<String, Failure> {
    if !folder.is_dir() {
        fs::create_dir(folder)
            .map_err(|e| Failure::other(format!("{}: cannot make the pyramid's folder: {e}", folder.display())))?;
    }
    for (t, image) in techniques {
        for extension in ["exr", "png"] {
            let path = folder.join(format!("s{}_t{}.{extension}", t.s, t.t));
            output::write_image(&path, image, metadata, exposure).map_err(Failure::other)?;
        }
    }
    let Some(sheet) = sheet(techniques, exposure) else {
        return Ok(format!("{}: no technique found any light, so that no image was written", folder.display()));
    };
    output::write_image(&folder.join(SHEET), &sheet.image, &Metadata::default(), 0.0).map_err(Failure::other)?;
    let rows: Vec<String> = sheet.rows.iter().map(|(edges, factor)| format!("{edges} ×{factor}")).collect();
    Ok(format!(
        "{}: images of {} (sS_tT.exr and .png); the sheet {SHEET} has s growing to the right and a row for each number \
         of edges, brightened: {}",
        folder.display(),
        super::count(techniques.len(), "technique", "techniques"),
        rows.join(", ")
    ))
}
