//! The pyramid: one weighted image per technique, which together are the image.

use std::collections::BTreeMap;
use std::path::Path;

use super::Failure;
use crate::film::Image;
use crate::integrator::Technique;
use crate::output::{self, Metadata};

/// Checks, before the work starts, that the folder can be made and written to. Leaves nothing behind: the scene may
/// yet turn out to be bad.
pub fn check(folder: &Path) -> Result<(), Failure> {
    let there = folder.ancestors().find(|f| f.exists()).unwrap_or(Path::new("."));
    output::check_place(&there.join("s0_t2.exr")).map_err(|e| Failure::usage(format!("--pyramid: {e}")))
}

/// Makes the folder and writes `s{s}_t{t}.exr` and `.png` per technique, and `pyramid.png`: a row per path length from
/// short to long, s growing to the right, each image scaled alike.
pub fn write(
    folder: &Path,
    techniques: &BTreeMap<Technique, Image>,
    metadata: &Metadata,
    exposure: f32,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::other(format!("{}: cannot make the pyramid's folder: {e}", folder.display())))?;
    for (t, image) in techniques {
        for extension in ["exr", "png"] {
            let path = folder.join(format!("s{}_t{}.{extension}", t.s, t.t));
            output::write_image(&path, image, metadata, exposure).map_err(Failure::other)?;
        }
    }
    let Some(sheet) = sheet(techniques) else { return Ok(()) };
    output::write_image(&folder.join("pyramid.png"), &sheet, &Metadata::default(), exposure).map_err(Failure::other)
}

/// Largest side of one image on the sheet.
const CELL: u32 = 160;

fn sheet(techniques: &BTreeMap<Technique, Image>) -> Option<Image> {
    let any = techniques.values().next()?;
    let step = any.width.max(any.height).div_ceil(CELL).max(1);
    let (w, h) = ((any.width / step).max(1), (any.height / step).max(1));
    let longest = techniques.keys().map(|t| t.s + t.t).max()?;
    let columns = techniques.keys().map(|t| t.s).max()? + 1;
    let rows = longest - 1;
    let (pitch_x, pitch_y) = (w + 4, h + 4);
    let mut sheet = Image::new(columns * pitch_x, rows * pitch_y);
    for (t, image) in techniques {
        let (x0, y0) = (t.s * pitch_x, (t.s + t.t - 2) * pitch_y);
        for y in 0..h {
            for x in 0..w {
                let to = (y0 + y) as usize * sheet.width as usize + (x0 + x) as usize;
                sheet.rgb[to] = mean(image, x * step, y * step, step);
            }
        }
    }
    Some(sheet)
}

/// Mean over a square of pixels.
fn mean(image: &Image, x0: u32, y0: u32, side: u32) -> [f32; 3] {
    let (x1, y1) = ((x0 + side).min(image.width), (y0 + side).min(image.height));
    let mut sum = [0.0f32; 3];
    for y in y0..y1 {
        for x in x0..x1 {
            for (s, v) in sum.iter_mut().zip(image.get(x, y)) {
                *s += v;
            }
        }
    }
    let n = ((x1 - x0) * (y1 - y0)).max(1) as f32;
    sum.map(|s| s / n)
}
