//! `twinlight compare`.

use std::path::Path;

use serde_json::json;

use super::args::CompareArgs;
use super::{Failure, padded, print, same_file, status, tell};
use crate::compare::{BLOCK, FULL_COLOUR, Metrics, difference, metrics};
use crate::film::Image;
use crate::output::{self, Format, Metadata, Window};

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
    let mut image = Placed::read(&args.image)?;
    let mut reference = Placed::read(&args.reference)?;
    // The place is told of the image that is the smaller one.
    let cut = reference.cut_to(&image, &args.image).or_else(|| image.cut_to(&reference, &args.reference));
    // Where they lie says more than their sizes.
    let same_size = (image.image.width, image.image.height) == (reference.image.width, reference.image.height);
    if (image.is_crop() || reference.is_crop()) && !same_size {
        return Err(Failure::new(
            status::DATA,
            format!(
                "{} shows {}, {} {}: neither holds the other; render or crop them to one window",
                args.image.display(),
                image.place(),
                args.reference.display(),
                reference.place()
            ),
        ));
    }
    let (image, reference) = (image.image, reference.image);
    let m = metrics(&image, &reference).map_err(|e| Failure::new(status::DATA, e))?;
    let mut notes: Vec<String> = cut.into_iter().chain(notes(args, &image, &reference)).collect();
    if let Some(path) = &args.difference {
        let range = args.range.unwrap_or(FULL_COLOUR);
        let picture = difference(&image, &reference, range);
        output::write_image(path, &picture, &Metadata::default(), 0.0).map_err(Failure::other)?;
        notes.push(format!(
            "{} shows means over {BLOCK}×{BLOCK} pixels, relative to the reference: red where the image is brighter, \
             blue where it is darker, ±{range} % at full colour",
            path.display()
        ));
    }
    if args.json {
        print(&format!("{:#}\n", to_json(&m, &notes)));
    } else {
        print(&to_text(&m));
        notes.iter().for_each(|note| tell(&format!("note: {note}\n")));
    }
    Ok(())
}

/// An image and its place within the full one.
struct Placed {
    image: Image,
    window: Window,
}

impl Placed {
    fn read(path: &Path) -> Result<Self, Failure> {
        let (image, metadata) = output::read_image_and_metadata(path).map_err(Failure::image)?;
        let whole = Window { full: [image.width, image.height], origin: [0, 0] };
        Ok(Self { image, window: metadata.window.unwrap_or(whole) })
    }

    fn is_crop(&self) -> bool {
        self.window.full != [self.image.width, self.image.height]
    }

    /// What it shows, in words.
    fn place(&self) -> String {
        let [[x0, y0], [x1, y1]] = self.ends();
        let [width, height] = self.window.full;
        format!("{x0},{y0} to {x1},{y1} of {width} × {height}")
    }

    /// Column and row of the first pixel, and those after the last.
    fn ends(&self) -> [[u32; 2]; 2] {
        let ([x, y], image) = (self.window.origin, &self.image);
        [[x, y], [x + image.width, y + image.height]]
    }

    /// Keeps what the crop `other`, the file of that name, shows as well, if both are parts of images of one size and
    /// this one is the larger part. Returns what to tell of it.
    fn cut_to(&mut self, other: &Self, name: &Path) -> Option<String> {
        let ([start, end], [from, to]) = (self.ends(), other.ends());
        let covered = (0..2).all(|axis| start[axis] <= from[axis] && to[axis] <= end[axis]);
        if self.window.full != other.window.full || !covered || (start, end) == (from, to) {
            return None;
        }
        let mut part = Image::new(other.image.width, other.image.height);
        for (y, row) in part.rgb.chunks_exact_mut(part.width as usize).enumerate() {
            let first = (from[1] - start[1] + y as u32) as usize * self.image.width as usize;
            let first = first + (from[0] - start[0]) as usize;
            row.copy_from_slice(&self.image.rgb[first..first + row.len()]);
        }
        *self = Self { image: part, window: other.window };
        let [width, height] = other.window.full;
        Some(format!(
            "{} is a crop: compared over its pixels alone, {},{} to {},{} of {width} × {height} (ends exclusive); the \
             place of `max` is counted from the crop's first pixel",
            name.display(),
            from[0],
            from[1],
            to[0],
            to[1]
        ))
    }
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
    let number = |x: f64, digits| padded(x, digits, -4..7);
    // Means have to show differences of a hundredth of a percent.
    let triple = |x: [f64; 3]| x.map(|x| number(x, 6)).join(" ");
    format!(
        "mean        {}\nreference   {}\nratio       {}\nMSE         {}\nrelMSE      {}\n\
         trimmed     {}  (relMSE without the worst 0.1 % of pixels)\nmax         {} at {},{}\n\
         non-finite  {} (reference {})\n",
        triple(m.mean_a),
        triple(m.mean_ref),
        triple(m.mean_ratio),
        number(m.mse, 4),
        number(m.rel_mse, 4),
        number(m.rel_mse_trimmed, 4),
        number(m.max_abs, 4),
        m.max_at[0],
        m.max_at[1],
        m.non_finite_a,
        m.non_finite_ref
    )
}
