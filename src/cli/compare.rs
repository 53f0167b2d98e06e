//! `twinlight compare`.

use serde_json::json;

use super::args::CompareArgs;
use super::{Failure, print, same_file, status};
use crate::compare::{Metrics, metrics};
use crate::film::Image;
use crate::output::{self, Metadata};

pub fn run(args: &CompareArgs) -> Result<(), Failure> {
    if let Some(path) = &args.difference {
        output::check_writable(path).map_err(Failure::usage)?;
        if same_file(path, &args.image) || same_file(path, &args.reference) {
            return Err(Failure::usage(format!(
                "{}: this is an image to compare; choose another name",
                path.display()
            )));
        }
    }
    let read = |path| output::read_image(path).map_err(|e| Failure::new(status::DATA, e));
    let (image, reference) = (read(&args.image)?, read(&args.reference)?);
    let m = metrics(&image, &reference).map_err(|e| Failure::new(status::DATA, e))?;
    print(&if args.json { format!("{:#}\n", to_json(&m)) } else { to_text(&m) });
    if let Some(path) = &args.difference {
        let picture = difference(&image, &reference);
        output::write_image(path, &picture, &Metadata::default(), 0.0).map_err(Failure::other)?;
    }
    Ok(())
}

fn to_json(m: &Metrics) -> serde_json::Value {
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
