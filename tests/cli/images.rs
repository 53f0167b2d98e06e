//! `compare` and `convert`.

use twinlight::film::Image;
use twinlight::output::{Metadata, Window, read_image, srgb_decode, write_image};

use super::{Folder, difference, exr_header};

/// A smooth picture of positive values up to a little above `peak`.
fn picture(width: u32, height: u32, peak: f32) -> Image {
    let mut image = Image::new(width, height);
    for (i, pixel) in image.rgb.iter_mut().enumerate() {
        let (x, y) = (i as u32 % width, i as u32 / width);
        let (x, y) = (x as f32 / width as f32, y as f32 / height as f32);
        *pixel = [x, y, 0.5 * (x + y)].map(|v| (v + 0.01) * peak);
    }
    image
}

fn put(folder: &Folder, name: &str, image: &Image) {
    write_image(&folder.path(name), image, &Metadata::default(), 0.0).unwrap();
}

#[test]
fn compare_measures_as_defined() {
    let folder = Folder::new("compare");
    let reference = picture(8, 6, 2.0);
    let mut image = reference.clone();
    for pixel in &mut image.rgb {
        *pixel = pixel.map(|v| v + 0.125);
    }
    image.rgb[8 * 4 + 3] = reference.rgb[8 * 4 + 3].map(|v| v - 0.5);
    put(&folder, "a.exr", &image);
    put(&folder, "r.exr", &reference);
    let outcome = folder.ok(&["compare", "a.exr", "r.exr", "--json"]);
    assert_eq!(outcome.stderr, "");
    let json: serde_json::Value = serde_json::from_str(&outcome.stdout).unwrap();
    let keys: Vec<&str> = json.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "max",
        "max_at",
        "mean",
        "mean_ratio",
        "mean_reference",
        "mse",
        "non_finite",
        "non_finite_reference",
        "notes",
        "rel_mse",
        "rel_mse_trimmed",
    ];
    assert_eq!(keys, expected);

    // By hand: mean (a − r)² and mean (a − r)²/(r² + 0.01).
    let (mut mse, mut relative) = (0.0, 0.0);
    for (a, r) in image.rgb.iter().flatten().zip(reference.rgb.iter().flatten()) {
        let (d, r) = (f64::from(a - r), f64::from(*r));
        mse += d * d / 144.0;
        relative += d * d / (r * r + 0.01) / 144.0;
    }
    let number = |key: &str| json[key].as_f64().unwrap();
    assert!((number("mse") / mse - 1.0).abs() < 1e-5, "{mse}: {json:#}");
    assert!((number("rel_mse") / relative - 1.0).abs() < 1e-5, "{relative}: {json:#}");
    assert!((number("max") - 0.5).abs() < 1e-6, "{json:#}");
    assert_eq!(json["max_at"], serde_json::json!([3, 4]));
    for c in 0..3 {
        let (a, r) = (image.mean()[c], reference.mean()[c]);
        assert!((json["mean"][c].as_f64().unwrap() - a).abs() < 1e-9, "{json:#}");
        assert!((json["mean_reference"][c].as_f64().unwrap() - r).abs() < 1e-9, "{json:#}");
        assert!((json["mean_ratio"][c].as_f64().unwrap() - a / r).abs() < 1e-9, "{json:#}");
    }
    assert_eq!((&json["non_finite"], &json["non_finite_reference"]), (&0.into(), &0.into()));
    assert_eq!(json["notes"], serde_json::json!([]));

    // The text says the same.
    let text = folder.ok(&["compare", "a.exr", "r.exr"]).stdout;
    let line = |key: &str| text.lines().find_map(|l| l.strip_prefix(key)).unwrap_or_else(|| panic!("{key}: {text}"));
    // Plain numbers where they are neither tiny nor huge, to four figures, the means to six.
    for (key, value) in [("relMSE", relative), ("MSE", mse)] {
        let said = line(key).trim();
        assert!(said.starts_with("0.") && said.len() <= 7, "{key}: {text}");
        assert!((said.parse::<f64>().unwrap() / value - 1.0).abs() < 5e-4, "{key}: {text}");
    }
    assert_eq!(line("max").trim(), "0.5000 at 3,4");
    for (key, mean) in [("mean", image.mean()), ("reference", reference.mean())] {
        let said: Vec<f64> = line(key).split_whitespace().map(|n| n.parse().unwrap()).collect();
        assert!(said.len() == 3 && said.iter().zip(mean).all(|(s, m)| (s / m - 1.0).abs() < 5e-6), "{key}: {text}");
    }
    let mut faint = reference.clone();
    faint.rgb[0][1] += 1e-3;
    put(&folder, "f.exr", &faint);
    let text = folder.ok(&["compare", "f.exr", "r.exr"]).stdout;
    assert!(text.contains("\nMSE         6.944e-9\n"), "{text}");
    assert_eq!(line("non-finite").trim(), "0 (reference 0)");
    let means: Vec<f64> = line("mean").split_whitespace().map(|n| n.parse().unwrap()).collect();
    assert!(means.iter().zip(image.mean()).all(|(a, b)| (a - b).abs() < 1e-6), "{text}");
    // Of itself an image does not differ, whatever it holds.
    image.rgb[5] = [f32::NAN, 1.0, f32::INFINITY];
    put(&folder, "a.exr", &image);
    let same = folder.ok(&["compare", "a.exr", "a.exr", "--json"]).stdout;
    let same: serde_json::Value = serde_json::from_str(&same).unwrap();
    assert_eq!((same["mse"].as_f64(), same["non_finite"].as_u64()), (Some(0.0), Some(1)));
    assert_eq!(same["mean_ratio"], serde_json::json!([1.0, 1.0, 1.0]));
}

#[test]
fn what_a_png_has_lost_is_said() {
    let folder = Folder::new("compare_png");
    // Four pixels of 5 × 8 exceed 1: 10 %.
    let mut image = picture(5, 8, 0.5);
    image.rgb[3..7].fill([0.5, 1.01, 0.5]);
    for name in ["a.exr", "a.png", "b.png"] {
        put(&folder, name, &image);
    }
    // The content decides, not the name.
    folder.write("c.exr", folder.bytes("a.png"));
    for (a, b, png, exr) in [
        ("a.png", "a.exr", "a.png", "a.exr"),
        ("a.exr", "a.png", "a.png", "a.exr"),
        ("a.exr", "c.exr", "c.exr", "a.exr"),
    ] {
        let note = format!(
            "{png} is a PNG: clipped to 0…1 (10 % of the pixels of {exr} are not within), rounded to its bits, and scaled \
             if it was written with an exposure; the figures hold these differences, too: compare two EXR files"
        );
        let text = folder.ok(&["compare", a, b]);
        assert_eq!(text.stderr, format!("note: {note}\n"));
        assert!(text.stdout.starts_with("mean ") && !text.stdout.contains("note"), "{text:?}");
        let json = folder.ok(&["compare", a, b, "--json"]);
        let value: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
        assert_eq!((value["notes"].clone(), json.stderr.as_str()), (serde_json::json!([note]), ""));
    }
    for (a, b) in [("a.exr", "a.exr"), ("a.png", "b.png"), ("a.png", "c.exr")] {
        assert_eq!(folder.ok(&["compare", a, b]).stderr, "", "{a}, {b}");
    }
}

#[test]
fn the_difference_is_red_where_brighter_and_blue_where_darker() {
    let folder = Folder::new("difference");
    let mut reference = Image::new(16, 8);
    reference.rgb.fill([1.0; 3]);
    let mut image = reference.clone();
    for (i, pixel) in image.rgb.iter_mut().enumerate() {
        *pixel = match i % 16 {
            0..4 => [1.5; 3],
            4..8 => [0.5; 3],
            _ => [1.0; 3],
        };
    }
    put(&folder, "a.exr", &image);
    put(&folder, "r.exr", &reference);
    let quiet = folder.ok(&["compare", "a.exr", "r.exr"]).stdout;
    assert_eq!(folder.names(), ["a.exr", "r.exr"]);
    let told = folder.ok(&["compare", "a.exr", "r.exr", "--difference", "d.png"]);
    assert_eq!(told.stdout, quiet);
    // What it shows is said, on the help page as well.
    let note = "d.png shows means over 4×4 pixels, relative to the reference: red where the image is brighter, blue where \
                it is darker, ±10 % at full colour";
    assert_eq!(told.stderr, format!("note: {note}\n"));
    let json = folder.ok(&["compare", "a.exr", "r.exr", "--difference", "d.png", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&json.stdout).unwrap();
    assert_eq!((value["notes"].clone(), json.stderr.as_str()), (serde_json::json!([note]), ""));
    let help = folder.ok(&["compare", "--help"]).stdout.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(help.contains("mean over 4×4 pixels, relative to the reference, ±10 % at full colour"), "{help}");
    // Fifty percent are full colour, then.
    let wide = folder.ok(&["compare", "a.exr", "r.exr", "--difference", "wide.png", "--range", "100"]).stderr;
    assert_eq!(wide, format!("note: {}\n", note.replace("d.png", "wide.png").replace("±10 %", "±100 %")));
    let red = folder.image("wide.png").get(1, 5)[0];
    assert!((red - 0.495).abs() < 0.01, "{red}");
    let d = folder.image("d.png");
    assert_eq!((d.width, d.height), (16, 8));
    let expected = |x| {
        if x < 4 {
            [1.0, 0.0, 0.0]
        } else if x < 8 {
            [0.0, 0.0, 1.0]
        } else {
            [0.0; 3]
        }
    };
    for x in 0..16 {
        assert_eq!(d.get(x, 5), expected(x), "column {x}");
    }
    // Ten percent are full colour, five are half of it; what cancels within a block does not show.
    image.clone_from(&reference);
    for (i, pixel) in image.rgb.iter_mut().enumerate() {
        *pixel = match i % 16 {
            0..4 => [1.102; 3],
            4..8 => [1.05; 3],
            8..12 if i % 2 == 0 => [2.0; 3],
            8..12 => [0.0; 3],
            _ => [0.95; 3],
        };
    }
    put(&folder, "a.exr", &image);
    folder.ok(&["compare", "a.exr", "r.exr", "--difference", "d.png"]);
    let d = folder.image("d.png");
    for (x, [red, _, blue]) in [(1, [1.0, 0.0, 0.0]), (5, [0.5, 0.0, 0.0]), (9, [0.0; 3]), (13, [0.0, 0.0, 0.5])] {
        let got = d.get(x, 5);
        assert!((got[0] - red).abs() < 0.01 && (got[2] - blue).abs() < 0.01, "column {x}: {got:?}");
    }
}

#[test]
fn a_crop_is_compared_with_its_part_of_the_full_image() {
    let folder = Folder::new("compare_crop");
    let full = picture(23, 9, 0.9);
    let part = |image: &Image, [x0, y0, x1, y1]: [u32; 4]| {
        let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| (x, y)));
        Image { width: x1 - x0, height: y1 - y0, rgb: pixels.map(|(x, y)| image.get(x, y)).collect() }
    };
    let put_part = |name: &str, image: &Image, origin| {
        let window = Some(Window { full: [23, 9], origin });
        write_image(&folder.path(name), image, &Metadata { window, ..Metadata::default() }, 0.0).unwrap();
    };
    put(&folder, "full.exr", &full);
    put(&folder, "full.png", &full);
    let mut small = part(&full, [7, 2, 20, 8]);
    small.rgb[13 * 4 + 5][1] += 0.25;
    put_part("crop.exr", &small, [7, 2]);
    put_part("larger.exr", &part(&full, [6, 2, 20, 9]), [6, 2]);
    put_part("beside.exr", &part(&full, [8, 2, 23, 9]), [8, 2]);
    put(&folder, "part.exr", &part(&full, [7, 2, 20, 8]));
    let note = "crop.exr is a crop: compared over its pixels alone, 7,2 to 20,8 of 23 × 9 (ends exclusive); the place of \
                `max` is counted from the crop's first pixel";
    let figures = folder.ok(&["compare", "crop.exr", "part.exr"]);
    assert!(figures.stdout.contains("max         0.2500 at 5,4\n") && figures.stderr.is_empty(), "{figures:?}");
    for reference in ["full.exr", "larger.exr"] {
        let told = folder.ok(&["compare", "crop.exr", reference, "--difference", "d.png"]);
        assert_eq!(told.stdout, figures.stdout, "{reference}");
        assert_eq!(told.stderr.lines().next(), Some(format!("note: {note}").as_str()));
        let picture = folder.image("d.png");
        assert_eq!((picture.width, picture.height), (13, 6));
        let json: serde_json::Value =
            serde_json::from_str(&folder.ok(&["compare", reference, "crop.exr", "--json"]).stdout).unwrap();
        assert_eq!(json["notes"], serde_json::json!([note]));
        assert_eq!(json["max_at"], serde_json::json!([5, 4]));
    }
    let png = folder.ok(&["compare", "crop.exr", "full.png"]).stderr;
    assert!(png.starts_with(&format!("note: {note}\nnote: full.png is a PNG: ")), "{png}");
    // Neither holds the other; the full image has another size; no crop at all.
    put(&folder, "other.exr", &picture(24, 9, 1.0));
    for (a, b, said) in [
        (
            "crop.exr",
            "beside.exr",
            "crop.exr shows 7,2 to 20,8 of 23 × 9, beside.exr 8,2 to 23,9 of 23 × 9: neither holds the other; \
          render or crop them to one window",
        ),
        (
            "crop.exr",
            "other.exr",
            "crop.exr shows 7,2 to 20,8 of 23 × 9, other.exr 0,0 to 24,9 of 24 × 9: neither holds the other; \
          render or crop them to one window",
        ),
        ("part.exr", "full.exr", "the image has 13 × 6 pixels, the reference 23 × 9: render or crop them to one size"),
    ] {
        let outcome = folder.run(&["compare", a, b]);
        assert_eq!((outcome.status, outcome.stderr), (Some(65), format!("twinlight: {said}\n")));
    }
}

#[test]
fn compare_refuses_what_it_cannot_compare() {
    let folder = Folder::new("compare_refuses");
    put(&folder, "a.exr", &picture(8, 6, 1.0));
    put(&folder, "b.exr", &picture(6, 8, 1.0));
    put(&folder, "a.png", &picture(8, 6, 1.0));
    folder.write("text.exr", "no image at all");
    folder.write("d.png", "what was there before");
    let before = folder.snapshot();
    for (args, status, message) in [
        (
            ["a.exr", "b.exr", "d.png"],
            65,
            "twinlight: the image has 8 × 6 pixels, the reference 6 × 8: render or crop them to one size\n",
        ),
        (
            ["a.exr", "text.exr", "d.png"],
            65,
            "twinlight: cannot read `text.exr`: it is no EXR, PNG or Radiance HDR image; convert it to one of them\n",
        ),
        (
            ["none.exr", "a.exr", "d.png"],
            1,
            "twinlight: cannot read `none.exr`: No such file or directory (os error 2); check the name and the permissions\n",
        ),
        (["a.exr", ".", "d.png"], 1, "twinlight: cannot read `.`: it is a folder; give an image file inside it\n"),
        (["a.png", "b.exr", "a.png"], 2, "twinlight: a.png: this is an image to compare; choose another name\n"),
        (["a.exr", "a.png", "./a.png"], 2, "twinlight: ./a.png: this is an image to compare; choose another name\n"),
        (
            ["a.exr", "a.exr", "d.exr"],
            2,
            "twinlight: --difference d.exr: the difference is a picture in false colours, not data; give it a name that \
             ends in .png\n",
        ),
        (
            ["a.exr", "a.exr", "no/d.png"],
            2,
            "twinlight: cannot write `no/d.png`: the folder `no` cannot be entered (No such file or directory (os error \
             2)); create it first\n",
        ),
    ] {
        let outcome = folder.run(&["compare", args[0], args[1], "--json", "--difference", args[2]]);
        assert_eq!((outcome.status, outcome.stderr.as_str()), (Some(status), message), "{outcome:?}");
        assert_eq!(outcome.stdout, "", "{outcome:?}");
        assert!(folder.snapshot() == before, "{args:?}: a file was touched");
    }
    assert_eq!(folder.run(&["compare", "a.exr"]).status, Some(2));
}

#[test]
fn convert_goes_there_and_back() {
    let folder = Folder::new("convert");
    let image = picture(9, 5, 0.9);
    put(&folder, "a.exr", &image);
    let convert = |from: &str, to: &str, more: &[&str]| {
        let outcome = folder.ok(&[&["convert", from, to], more].concat());
        assert_eq!((outcome.stdout.as_str(), outcome.stderr.as_str()), ("", ""));
        folder.image(to)
    };
    // EXR to EXR keeps every bit, a crop's place and what made it.
    assert!(convert("a.exr", "copy.exr", &[]) == image);
    let attributes = vec![("twinlight:spp".to_owned(), "7".to_owned()), ("comment".to_owned(), "not ours".to_owned())];
    let window = Some(Window { full: [30, 20], origin: [11, 12] });
    write_image(&folder.path("crop.exr"), &image, &Metadata { attributes, pixel_aspect: 1.0, window }, 0.0).unwrap();
    assert!(convert("crop.exr", "copy.exr", &[]) == image);
    let (attributes, data, display) = exr_header(&folder.path("copy.exr"));
    assert_eq!(attributes.into_iter().collect::<Vec<_>>(), [("twinlight:spp".to_owned(), "7".to_owned())]);
    assert_eq!((data, display), ([11, 12, 9, 5], [30, 20]));
    // To 8 bits a value moves by half a step at most, and back and forth by nothing more.
    let coded = convert("a.exr", "a.png", &[]);
    let step =
        |v: f32| srgb_decode((twinlight::output::srgb_encode(f64::from(v)) + 0.5001 / 255.0).min(1.0)) - f64::from(v);
    for (a, c) in image.rgb.iter().flatten().zip(coded.rgb.iter().flatten()) {
        assert!(f64::from((a - c).abs()) <= step(*a) + 1e-6, "{a} became {c}");
    }
    assert!(convert("a.png", "b.exr", &[]) == coded);
    assert!(convert("b.exr", "b.png", &[]) == coded);
    assert_eq!(folder.bytes("b.png"), folder.bytes("a.png"));
    // Stops brighten a PNG; 1.5 of them by 2^1.5. An EXR stays linear.
    let darker = convert("a.exr", "dark.png", &["--exposure", "-2"]);
    let quarter = Image { rgb: image.rgb.iter().map(|p| p.map(|v| 0.25 * v)).collect(), ..image.clone() };
    assert!(difference(&darker, &quarter) < 0.03, "{}", difference(&darker, &quarter));
}

#[test]
fn convert_refuses_and_touches_nothing() {
    let folder = Folder::new("convert_refuses");
    put(&folder, "a.exr", &picture(4, 4, 1.0));
    let whole = folder.bytes("a.exr");
    folder.write("cut.exr", &whole[..whole.len() / 2]);
    folder.write("old.png", "what was there before");
    let before = folder.snapshot();
    for (from, to, status, message) in [
        (
            "a.exr",
            "b.tiff",
            2,
            "cannot write `b.tiff`: the extension `.tiff` names no known format; use `.exr` (linear) or",
        ),
        ("a.exr", "b", 2, "cannot write `b`: the name has no extension to choose the format by"),
        ("a.exr", "no/b.png", 2, "cannot write `no/b.png`: the folder `no` cannot be entered"),
        ("a.exr", "a.exr", 2, "a.exr: this is the image to convert; choose another name"),
        ("none.exr", "old.png", 1, "cannot read `none.exr`: No such file"),
        ("cut.exr", "old.png", 65, "cannot read `cut.exr`: "),
        ("old.png", "new.png", 65, "cannot read `old.png`: it is no EXR, PNG or Radiance HDR image"),
    ] {
        let outcome = folder.run(&["convert", from, to]);
        assert_eq!(outcome.status, Some(status), "{outcome:?}");
        assert!(outcome.stderr.starts_with(&format!("twinlight: {message}")), "{outcome:?}");
        assert!(folder.snapshot() == before, "{from} to {to}: a file was touched");
    }
    assert!(read_image(&folder.path("a.exr")).is_ok());
    let outcome = folder.run(&["convert", "a.exr", "b.exr", "--exposure", "0"]);
    assert_eq!(outcome.status, Some(2));
    assert_eq!(
        outcome.stderr,
        "twinlight: --exposure 0 brightens PNG files: an EXR stays linear; leave it out or write a PNG\n"
    );
    assert!(folder.snapshot() == before);
}
