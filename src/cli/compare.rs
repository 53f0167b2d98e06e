//! `twinlight compare`.

use serde_json::json;

use super::args::CompareArgs;
use super::{Failure, print, same_file, status, tell};
use crate::compare::{Metrics, metrics};
use crate::film::Image;
use crate::output::{self, Format, Metadata};

pub fn run(args: &CompareArgs) -> Result<(), Failure> {
    if let Some(path) = &args.difference {
        let format = output::check_writable(path).map_err(Failure::usage)?;
        if format != Format::Png {
            return Err(Failure::usage(format!(
                "--difference {}: the difference is a picture in false colours, not data; give it a name that ends in \
                 .png",
                path.display()
            )));
        }
        if same_file(path, &args.image) || same_file(path, &args.reference) {
            return Err(Failure::usage(format!(
                "{}: this is an image to compare; choose another name",
                path.display()
            )));
        }
    }
    let read = |path| output::read_image(path).map_err(Failure::image);
    let (image, reference) = (read(&args.image)?, read(&args.reference)?);
    let m = metrics(&image, &reference).map_err(|e| Failure::new(status::DATA, e))?;
    let notes = notes(args, &image, &reference);
    if args.json {
        print(&format!("{:#}\n", to_json(&m, &notes)));
    } else {
        print(&to_text(&m));
        notes.iter().for_each(|note| tell(&format!("note: {note}\n")));
    }
    if let Some(path) = &args.difference {
        let picture = difference(&image, &reference);
        output::write_image(path, &picture, &Metadata::default(), 0.0).map_err(Failure::other)?;
    }
    Ok(())
}

/// What the figures do not show. A PNG beside an EXR has lost what does not fit into it.
fn notes(args: &CompareArgs, image: &Image, reference: &Image) -> Vec<String> {
    let formats = [&args.image, &args.reference].map(|path| output::format_of_content(path));
    let (png, exr, linear) = match formats {
        [Some(Format::Png), Some(Format::Exr)] => (&args.image, &args.reference, reference),
        [Some(Format::Exr), Some(Format::Png)] => (&args.reference, &args.image, image),
        _ => return Vec::new(),
    };
    let outside = |pixel: &&[f32; 3]| pixel.iter().any(|v| !(0.0..=1.0).contains(v));
    let clipped = linear.rgb.iter().filter(outside).count() as f64 / linear.rgb.len().max(1) as f64;
    vec![format!(
        "{} is a PNG: clipped to 0…1 ({} % of the pixels of {} are not within), rounded to its bits, and scaled if it \
         was written with an exposure; the figures hold these differences, too: compare two EXR files",
        png.display(),
        super::figures(100.0 * clipped),
        exr.display()
    )]
}

fn to_json(m: &Metrics, notes: &[String]) -> serde_json::Value {
    json!({
        "mean": m.mean_a,
        "mean_reference": m.mean_ref,
        "mean_ratio": m.mean_ratio,
        "mse": m.mse,
        "rel_mse": m.rel_mse,
        "rel_mse_trimmed": m.rel_mse_trimmed,
        "max": m.max_abs,
        "max_at": m.max_at,
        "non_finite": m.non_finite_a,
        "non_finite_reference": m.non_finite_ref,
        "notes": notes,
    })
}

fn to_text(m: &Metrics) -> String {
    let triple = |x: [f64; 3]| format!("{:.6} {:.6} {:.6}", x[0], x[1], x[2]);
    format!(
        "mean        {}\nreference   {}\nratio       {}\nMSE         {:.4e}\nrelMSE      {:.4e}\n\
         trimmed     {:.4e}  (relMSE without the worst 0.1 % of pixels)\nmax         {:.4e} at {},{}\n\
         non-finite  {} (reference {})\n",
        triple(m.mean_a),
        triple(m.mean_ref),
        triple(m.mean_ratio),
        m.mse,
        m.rel_mse,
        m.rel_mse_trimmed,
        m.max_abs,
        m.max_at[0],
        m.max_at[1],
        m.non_finite_a,
        m.non_finite_ref
    )
}

/// Side of the blocks that noise is averaged over, so that structure shows.
const BLOCK: u32 = 4;

/// Signed relative difference of block means, ±10 % at full colour: red brighter, blue darker than the reference.
fn difference(image: &Image, reference: &Image) -> Image {
    let mut out = Image::new(image.width, image.height);
    for y0 in (0..image.height).step_by(BLOCK as usize) {
        for x0 in (0..image.width).step_by(BLOCK as usize) {
            let (x1, y1) = ((x0 + BLOCK).min(image.width), (y0 + BLOCK).min(image.height));
            let (mut a, mut r) = (0.0f32, 0.0f32);
            for y in y0..y1 {
                for x in x0..x1 {
                    a += image.get(x, y).iter().sum::<f32>();
                    r += reference.get(x, y).iter().sum::<f32>();
                }
            }
            let d = 10.0 * (a - r) / (r + 0.01 * ((x1 - x0) * (y1 - y0)) as f32);
            let color = [d.clamp(0.0, 1.0), 0.0, (-d).clamp(0.0, 1.0)];
            for y in y0..y1 {
                for x in x0..x1 {
                    out.rgb[(y * image.width + x) as usize] = color;
                }
            }
        }
    }
    out
}
