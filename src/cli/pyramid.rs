//! The pyramid: one weighted image per technique, which together are the image, and a sheet that shows them.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::{fs, io};

use super::sheet::sheet;
use super::{Failure, same_file};
use crate::film::Image;
use crate::integrator::Technique;
use crate::output::{self, Metadata};

/// The sheet's file name.
const SHEET: &str = "pyramid.png";

/// What each technique's image is written as.
const EXTENSIONS: [&str; 2] = ["exr", "png"];

/// Checks, before the work starts, that the folder is there and can be written to, or can be made: its parent must be
/// there, as an output's folder must. Leaves nothing behind: the scene may yet turn out to be bad.
pub fn check(folder: &Path) -> Result<(), Failure> {
    let place = if folder.exists() || folder.is_symlink() { folder.join("s0_t2.exr") } else { folder.to_owned() };
    output::check_place(&place).map_err(|e| Failure::usage(format!("--pyramid: {e}")))
}

/// The name of a technique's image.
fn image_name(t: Technique, extension: &str) -> String {
    format!("s{}_t{}.{extension}", t.s, t.t)
}

/// Whether a pyramid may write files of that name: the sheet, or a technique's image.
fn is_ours(name: &str) -> bool {
    let technique = || {
        let (s, rest) = name.strip_prefix('s')?.split_once("_t")?;
        let (t, extension) = rest.split_once('.')?;
        let technique = Technique { s: s.parse().ok()?, t: t.parse().ok()? };
        // Only as it is written here: `+1` and `01` are numbers, too.
        Some(EXTENSIONS.contains(&extension) && name == image_name(technique, extension))
    };
    name == SHEET || technique() == Some(true)
}

/// Whether a path is that of a file which a pyramid in `folder` may write.
pub fn would_write(folder: &Path, path: &Path) -> bool {
    let Some(name) = path.file_name().and_then(|name| name.to_str()) else { return false };
    is_ours(name) && same_file(&folder.join(name), path)
}

/// Removes what an earlier pyramid wrote and this one, of the files `written`, did not: two runs' images do not add up to
/// one. Folders and links of such names are nobody's pyramid and stay. Returns how many files there were.
fn remove_others(folder: &Path, written: &HashSet<String>) -> io::Result<usize> {
    let mut removed = 0;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let old = name.to_str().is_some_and(|name| is_ours(name) && !written.contains(name));
        if old && entry.file_type()?.is_file() {
            fs::remove_file(entry.path())?;
            removed += 1;
        }
    }
    Ok(removed)
}

/// Makes the folder and writes `s{s}_t{t}.exr` and `.png` per technique, and the sheet; then removes those files of an
/// earlier pyramid that were not written again. Returns what to tell of it.
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
    let mut written = HashSet::new();
    for (t, image) in techniques {
        let mut metadata = metadata.clone();
        // `--technique` has named it already, weighted or not; all others are weighted.
        if metadata.attributes.iter().all(|(key, _)| key != TECHNIQUE) {
            metadata.attributes.push((TECHNIQUE.to_owned(), technique_text(*t, true)));
        }
        for extension in EXTENSIONS {
            let name = image_name(*t, extension);
            output::write_image(&folder.join(&name), image, &metadata, exposure).map_err(Failure::other)?;
            written.insert(name);
        }
    }
    let mut told = match sheet(techniques, exposure) {
        None => format!("{}: no technique found any light, so that no image was written", folder.display()),
        Some(sheet) => {
            let path = folder.join(SHEET);
            output::write_image(&path, &sheet.image, &Metadata::default(), 0.0).map_err(Failure::other)?;
            written.insert(SHEET.to_owned());
            let rows: Vec<String> = sheet.rows.iter().map(|(edges, factor)| format!("{edges} ×{factor}")).collect();
            format!(
                "{}: images of {} (sS_tT.exr and .png); the sheet {SHEET} has s growing to the right and a row for each \
                 number of edges, brightened: {}",
                folder.display(),
                super::count(techniques.len(), "technique", "techniques"),
                rows.join(", ")
            )
        }
    };
    let removed = remove_others(folder, &written).map_err(|e| {
        let folder = folder.display();
        Failure::other(format!("{folder}: cannot remove the files of an earlier pyramid ({e}); remove them yourself"))
    })?;
    if removed > 0 {
        told += &format!("; removed {} of an earlier pyramid", super::count(removed, "file", "files"));
    }
    Ok(told)
}

/// The attribute that names the technique an image shows, and its text.
pub const TECHNIQUE: &str = "twinlight:technique";

pub fn technique_text(t: Technique, weighted: bool) -> String {
    format!("{},{} {}", t.s, t.t, if weighted { "weighted" } else { "unweighted" })
}
