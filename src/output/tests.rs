use std::fs;
use std::path::{Path, PathBuf};

use super::*;
use crate::film::Image;

/// A folder of a test's own, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("twinlight-output-{}-{name}", std::process::id()));
        fs::create_dir_all(&path).expect("the system's temporary folder can be written");
        Self(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = (fs::read_dir(&self.0).expect("there"))
            .map(|e| e.expect("readable").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Noise over many magnitudes, with every kind of special value at its start.
fn noise(width: u32, height: u32) -> Image {
    let mut state = 1_u32;
    let mut next = || {
        state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    let mut image = Image::new(width, height);
    for pixel in &mut image.rgb {
        *pixel = [next(), next() * 1e-20, -next() * 1e20];
    }
    let special = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-45, f32::MAX];
    for (i, value) in special.into_iter().enumerate().take(image.rgb.len()) {
        image.rgb[i][i % 3] = value;
    }
    image
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.rgb.iter().map(|p| p.map(f32::to_bits)).collect()
}

fn described() -> Metadata {
    let attributes = (0..12).map(|i| (format!("twinlight:key{i}"), format!("value {i} π"))).collect();
    Metadata { attributes, ..Metadata::default() }
}

#[test]
fn exr_keeps_every_bit() {
    let folder = Folder::new("bits");
    for (w, h) in [(1, 1), (1, 40), (37, 1), (67, 35)] {
        let (image, path) = (noise(w, h), folder.file("a.exr"));
        write_exr(&path, &image, &described()).expect("writable");
        let back = read_image(&path).expect("readable");
        assert_eq!((back.width, back.height), (w, h));
        assert_eq!(bits(&back), bits(&image), "{w}×{h}");
    }
    assert_eq!(folder.names(), ["a.exr"]);
}

#[test]
fn exr_bytes_depend_on_the_image_and_metadata_alone() {
    let image = noise(50, 50);
    let first = exr::encode(&image, &described()).expect("encodes");
    // The encoder's hash table is seeded anew for each file: twelve attributes would come in another order.
    for _ in 0..5 {
        assert_eq!(exr::encode(&image, &described()).expect("encodes"), first);
    }
    let mut turned = described();
    turned.attributes.reverse();
    assert_eq!(exr::encode(&image, &turned).expect("encodes"), first);
    turned.attributes[0].1 = "other".to_owned();
    assert_ne!(exr::encode(&image, &turned).expect("encodes"), first);
}

#[test]
fn exr_says_where_the_crop_is_and_carries_the_metadata() {
    let folder = Folder::new("crop");
    let path = folder.file("crop.exr");
    let window = Window { full: [640, 480], origin: [100, 200] };
    let metadata = Metadata { window: Some(window), pixel_aspect: 2.0, ..described() };
    write_exr(&path, &noise(20, 10), &metadata).expect("writable");
    let read = ::exr::meta::MetaData::read_from_file(&path, true).expect("valid");
    let header = &read.headers[0];
    let display = header.shared_attributes.display_window;
    assert_eq!((display.position.0, display.position.1, display.size.0, display.size.1), (0, 0, 640, 480));
    let data = header.data_window();
    assert_eq!((data.position.0, data.position.1, data.size.0, data.size.1), (100, 200, 20, 10));
    assert_eq!(header.shared_attributes.pixel_aspect, 2.0);
    let texts: Vec<_> = (header.shared_attributes.other.values().chain(header.own_attributes.other.values()))
        .filter_map(|v| v.to_text().ok().map(|t| String::from_utf8_lossy(t.as_slice()).into_owned()))
        .collect();
    assert_eq!(texts.len(), 12);
    assert!(texts.contains(&"value 11 π".to_owned()), "{texts:?}");
    assert_eq!(read_image(&path).expect("readable").height, 10);
}

#[test]
fn metadata_come_back_and_what_is_not_ours_stays_behind() {
    let folder = Folder::new("metadata");
    let path = folder.file("a.exr");
    let attributes = |names: &[&str]| names.iter().map(|n| (n.to_string(), format!("of {n} π"))).collect();
    let back = |metadata: &Metadata| {
        write_exr(&path, &noise(20, 10), metadata).expect("writable");
        read_image_and_metadata(&path).expect("readable").1
    };
    let window = Some(Window { full: [640, 480], origin: [100, 200] });
    let ours = Metadata { attributes: attributes(&["twinlight:a", "twinlight:b"]), pixel_aspect: 2.0, window };
    assert_eq!(back(&ours), ours);
    let more = Metadata { attributes: attributes(&["twinlight:a", "twinlight", "comment", "twinlight:b"]), ..ours };
    assert_eq!(back(&more), Metadata { attributes: attributes(&["twinlight:a", "twinlight:b"]), ..more });
    // A crop that is all of the image is none.
    let whole = Metadata { window: Some(Window { full: [20, 10], origin: [0, 0] }), ..Metadata::default() };
    assert_eq!(back(&whole), Metadata::default());
    write_png(&path, &noise(2, 2), 0.0).expect("writable");
    assert_eq!(read_image_and_metadata(&path).expect("readable").1, Metadata::default());
}

#[test]
fn windows_are_counted_from_the_display_windows_corner() {
    use ::exr::prelude::*;
    let folder = Folder::new("windows");
    let path = folder.file("a.exr");
    // Position and size of the display window, position of a data window of 4 × 3, and the crop that is.
    for (corner, full, at, expected) in [
        ((-5, 7), (10, 8), (-3, 9), Some(Window { full: [10, 8], origin: [2, 2] })),
        ((-5, 7), (10, 8), (1, 12), Some(Window { full: [10, 8], origin: [6, 5] })),
        ((-5, 7), (10, 8), (2, 12), None),
        ((0, 0), (10, 8), (-1, 0), None),
        ((3, 3), (4, 3), (3, 3), None),
    ] {
        let pixels = SpecificChannels::rgb(|_| (1.0_f32, 1.0_f32, 1.0_f32));
        let place = LayerAttributes { layer_position: Vec2(at.0, at.1), ..LayerAttributes::default() };
        let layer = Layer::new((4, 3), place, Encoding::FAST_LOSSLESS, pixels);
        let display = IntegerBounds::new(corner, full);
        let image = ::exr::image::Image::new(ImageAttributes::new(display), layer);
        image.write().to_file(&path).expect("writable");
        let (image, metadata) = read_image_and_metadata(&path).expect("readable");
        assert_eq!((image.width, image.height, metadata.window), (4, 3, expected), "{corner:?} {full:?} {at:?}");
    }
}

#[test]
fn exr_refuses_what_it_cannot_say() {
    let image = noise(4, 4);
    let with = |name: &str| Metadata { attributes: vec![(name.to_owned(), String::new())], ..Metadata::default() };
    for name in ["", "channels", "owner", "a\0b", &"x".repeat(32)] {
        assert!(exr::encode(&image, &with(name)).is_err(), "{name:?}");
    }
    let twice =
        Metadata { attributes: vec![("a".into(), "1".into()), ("a".into(), "2".into())], ..Metadata::default() };
    assert!(exr::encode(&image, &twice).is_err());
    let outside = Metadata { window: Some(Window { full: [7, 8], origin: [4, 4] }), ..Metadata::default() };
    assert!(exr::encode(&image, &outside).is_err());
    assert!(exr::encode(&Image::new(0, 4), &Metadata::default()).is_err());
}

#[test]
fn exr_of_other_types_and_compressions_is_read() {
    use ::exr::prelude::*;
    let folder = Folder::new("kinds");
    let value = |x: usize, y: usize| ((x * 7 + y * 13) % 32) as f32;
    let compressions =
        [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::ZIP16, Compression::PIZ];
    for compression in compressions {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 16))] {
            let path = folder.file("a.exr");
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            // Mixed types, and an alpha channel to ignore.
            let channels = SpecificChannels::rgba(|Vec2(x, y)| {
                (f16::from_f32(value(x, y)), value(y, x), value(x, x) as u32, 0.25_f32)
            });
            let layer = Layer::new((40, 33), LayerAttributes::named("first"), encoding, channels);
            ::exr::image::Image::from_layer(layer).write().to_file(&path).expect("writable");
            let image = read_image(&path).expect("readable");
            assert_eq!((image.width, image.height), (40, 33));
            for (x, y) in [(0, 0), (39, 32), (17, 20)] {
                let want = [value(x, y), value(y, x), value(x, x)];
                assert_eq!(image.get(x as u32, y as u32), want, "{compression:?} {blocks:?}");
            }
        }
    }
}

#[test]
fn a_layer_without_rgb_is_passed_over_or_named() {
    use ::exr::prelude::*;
    let folder = Folder::new("layers");
    let path = folder.file("a.exr");
    let depth =
        |name: &str| AnyChannels::sort([AnyChannel::new(name, FlatSamples::F32(vec![1.0; 6]))].into_iter().collect());
    let only_depth = ::exr::image::Image::from_channels((3, 2), depth("Z"));
    only_depth.write().to_file(&path).expect("writable");
    let message = read_image(&path).expect_err("no colours").message;
    assert!(message.contains("R, G and B") && message.contains('Z'), "{message}");
}

#[test]
fn damaged_files_are_errors() {
    let folder = Folder::new("damage");
    let whole = exr::encode(&noise(64, 64), &described()).expect("encodes");
    let path = folder.file("a.exr");
    for length in [0, 3, 4, 20, 200, whole.len() / 2, whole.len() - 1] {
        fs::write(&path, &whole[..length]).expect("writable");
        assert!(read_image(&path).is_err(), "{length}");
    }
    fs::write(&path, b"neither of them").expect("writable");
    assert!(read_image(&path).expect_err("text").message.contains("no EXR, PNG or Radiance HDR image"));
    assert!(read_image(&folder.file("missing.exr")).is_err());
    assert!(read_image(&folder.0).is_err());
}

#[test]
fn a_headers_size_is_checked_before_memory_is_taken() {
    let folder = Folder::new("size");
    let mut file = exr::encode(&noise(64, 64), &Metadata::default()).expect("encodes");
    // Both windows: name, 0, `box2i`, 0, 16 as i32, then xMin, yMin, xMax, yMax.
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = file.windows(name.len()).position(|w| w == name).expect("there") + name.len() + 4 + 8;
        file[at..at + 8].copy_from_slice(&[0xff, 0xff, 0xff, 0x0f, 0xff, 0xff, 0xff, 0x0f]);
    }
    let path = folder.file("a.exr");
    fs::write(&path, &file).expect("writable");
    let message = read_image(&path).expect_err("2⁵⁶ pixels").message;
    assert!(!message.is_empty());

    // A PNG's width and height follow its first chunk's tag; the chunk's checksum no longer holds, but is read later.
    let png = folder.file("a.png");
    write_png(&png, &noise(4, 4), 0.0).expect("writable");
    let mut bytes = fs::read(&png).expect("readable");
    bytes[16..24].copy_from_slice(&[0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff]);
    fs::write(&png, &bytes).expect("writable");
    assert!(read_image(&png).is_err());
}

#[test]
fn srgb_is_the_standards_curve() {
    // The ends, the join (from below), and 0.5, whose code value is 188 in 8 bits.
    assert_eq!(srgb_encode(0.0), 0.0);
    assert!((srgb_encode(1.0) - 1.0).abs() < 1e-12);
    assert!((srgb_encode(0.5) - 0.735_356_983_052_4).abs() < 1e-10, "{}", srgb_encode(0.5));
    for i in 0..=1000 {
        let v = f64::from(i) / 1000.0;
        assert!((srgb_encode(srgb_decode(v)) - v).abs() < 1e-6, "{v}");
    }
}

#[test]
fn png_clips_exposes_and_comes_back_linear() {
    let folder = Folder::new("png");
    let path = folder.file("a.png");
    let image = Image {
        width: 3,
        height: 2,
        rgb: vec![
            [0.5, 0.25, 0.125],
            [f32::NAN, f32::INFINITY, f32::NEG_INFINITY],
            [-1.0, 7.0, 0.0],
            [0.0, 1.0, 0.001],
            [1e-9, 0.2, 0.3],
            [0.4, 0.6, 0.9],
        ],
    };
    write_png(&path, &image, 1.0).expect("writable");
    let decoded = ::image::open(&path).expect("a PNG").into_rgb8();
    assert_eq!(decoded.get_pixel(0, 0).0, [255, 188, 137]);
    assert_eq!(decoded.get_pixel(1, 0).0, [0, 255, 0]);
    assert_eq!(decoded.get_pixel(2, 0).0, [0, 255, 0]);
    assert_eq!(decoded.get_pixel(0, 1).0, [0, 255, 7]);
    let back = read_image(&path).expect("readable");
    for (got, want) in back.rgb[4..].iter().flatten().zip(image.rgb[4..].iter().flatten()) {
        let want = (2.0 * want).min(1.0);
        // Half a code value of 255, through a slope of at most 2.28.
        assert!((got - want).abs() < 0.5 / 255.0 * 2.28, "{got} {want}");
    }
    // Every code value survives a round trip.
    let ramp =
        Image { width: 256, height: 1, rgb: (0..256).map(|i| [srgb_decode(f64::from(i) / 255.0) as f32; 3]).collect() };
    write_png(&path, &ramp, 0.0).expect("writable");
    let decoded = ::image::open(&path).expect("a PNG").into_rgb8();
    assert!(decoded.pixels().enumerate().all(|(i, p)| p.0 == [i as u8; 3]));
    assert_eq!(read_image(&path).expect("readable"), ramp);
}

#[test]
fn a_failed_write_changes_nothing() {
    let folder = Folder::new("failure");
    let path = folder.file("a.exr");
    fs::write(&path, "before").expect("writable");
    write_exr(&path, &Image::new(0, 0), &Metadata::default()).expect_err("empty");
    // A folder in the file's place: the temporary file is written, the renaming fails.
    let blocked = folder.file("folder.exr");
    fs::create_dir(&blocked).expect("possible");
    fs::write(blocked.join("inside"), "x").expect("possible");
    write_exr(&blocked, &noise(2, 2), &Metadata::default()).expect_err("a folder is in the way");
    assert_eq!(fs::read_to_string(&path).expect("there"), "before");
    assert_eq!(folder.names(), ["a.exr", "folder.exr"]);
    write_exr(&path, &noise(2, 2), &Metadata::default()).expect("replaces");
    assert_eq!(read_image(&path).expect("readable").width, 2);
}

#[cfg(unix)]
#[test]
fn links_stay_links() {
    let folder = Folder::new("links");
    let (real, link) = (folder.file("real.exr"), folder.file("link.exr"));
    fs::write(&real, "before").expect("writable");
    std::os::unix::fs::symlink(&real, &link).expect("possible");
    write_exr(&link, &noise(2, 2), &Metadata::default()).expect("writable");
    assert!(fs::symlink_metadata(&link).expect("there").is_symlink());
    assert!(read_image(&real).is_ok());
}

#[test]
fn writability_is_known_beforehand() {
    let folder = Folder::new("writable");
    assert_eq!(check_writable(&folder.file("a.exr")).expect("fine"), Format::Exr);
    assert_eq!(check_writable(&folder.file("a.PNG")).expect("fine"), Format::Png);
    assert!(folder.names().is_empty(), "nothing is left behind");
    let says = |path: &Path, what: &str| {
        let message = check_writable(path).expect_err("cannot be written").message;
        assert!(message.contains(what) && message.contains(&*path.to_string_lossy()), "{message}");
    };
    says(&folder.file("a.jpg"), ".exr");
    says(&folder.file("a"), "no extension");
    says(&folder.file("missing/a.exr"), "create it");
    fs::write(folder.file("file"), "").expect("writable");
    says(&folder.file("file/a.exr"), "file");
    fs::create_dir(folder.file("d.exr")).expect("possible");
    says(&folder.file("d.exr"), "folder");
    let locked = folder.file("locked.png");
    fs::write(&locked, "").expect("writable");
    let mut permissions = fs::metadata(&locked).expect("there").permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&locked, permissions).expect("possible");
    says(&locked, "read-only");
}

/// Time and size of the lossless compressions on float noise: `cargo test --lib compressions -- --ignored --nocapture`.
#[test]
#[ignore = "measures speed"]
fn compressions() {
    use ::exr::prelude::*;
    let (w, h) = (960, 540);
    let mut image = noise(w, h);
    // A smooth gradient under ten per cent of noise, as a rendering at some hundred samples has.
    for (i, pixel) in image.rgb.iter_mut().enumerate() {
        let gradient = 0.2 + (i % w as usize) as f32 / w as f32;
        *pixel = [pixel[0], pixel[1] * 1e20, -pixel[2] * 1e-20].map(|n| gradient * (0.95 + 0.1 * n));
    }
    for compression in [Compression::Uncompressed, Compression::ZIP1, Compression::ZIP16, Compression::PIZ] {
        let encoding = Encoding { compression, blocks: Blocks::ScanLines, line_order: LineOrder::Increasing };
        let pixels = SpecificChannels::rgb(|Vec2(x, y): Vec2<usize>| {
            let [r, g, b] = image.rgb[y * w as usize + x];
            (r, g, b)
        });
        let layer = Layer::new((w as usize, h as usize), LayerAttributes::default(), encoding, pixels);
        let mut bytes = Vec::new();
        let clock = std::time::Instant::now();
        let file = ::exr::image::Image::from_layer(layer);
        file.write().non_parallel().to_buffered(std::io::Cursor::new(&mut bytes)).expect("encodes");
        println!(
            "{compression:?}: {:.1} % in {:?}",
            100.0 * bytes.len() as f64 / f64::from(w * h * 12),
            clock.elapsed()
        );
    }
}
