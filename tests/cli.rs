//! The built program as its user runs it: what it writes, what it says and with which status it ends.
//!
//! Every test has a folder of its own, which is the program's current folder. `docs/ERRORS.md` is made from the
//! tables of `cli/mistakes.rs`, `cli/mistakes_in_parts.rs`, `cli/assets.rs`, `cli/arguments.rs` and `cli/notes.rs`: `UPDATE_DOCS=1 cargo test --test cli` writes it, otherwise a
//! stale page fails.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use twinlight::film::Image;
use twinlight::output::read_image;

#[path = "cli/arguments.rs"]
mod arguments;
#[path = "cli/assets.rs"]
mod assets;
#[path = "cli/assets_images.rs"]
mod assets_images;
#[path = "cli/bench.rs"]
mod bench;
#[path = "cli/errors_page.rs"]
mod errors_page;
#[path = "cli/failures.rs"]
mod failures;
#[path = "cli/images.rs"]
mod images;
#[path = "cli/info.rs"]
mod info;
#[path = "cli/layers.rs"]
mod layers;
#[path = "cli/memory.rs"]
mod memory;
#[path = "cli/mistakes.rs"]
mod mistakes;
#[path = "cli/mistakes_in_parts.rs"]
mod mistakes_in_parts;
#[path = "cli/notes.rs"]
mod notes;
#[path = "cli/options.rs"]
mod options;
#[path = "cli/precision.rs"]
mod precision;
#[path = "cli/render.rs"]
mod render;
#[path = "cli/stress.rs"]
mod stress;
#[path = "cli/techniques.rs"]
mod techniques;
#[path = "cli/trace.rs"]
mod trace;

/// A room with a lamp in view and a mirror ball: every technique has something to find. 16 × 12 pixels, 4 samples.
const ROOM: &str = r#"{
  "camera": {"transform": {"from": [0, 0, 3.4], "at": [0, 0, 0]}, "vfov": 40, "resolution": [16, 12]},
  "integrator": {"type": "bdpt", "max_bounces": 5},
  "sampler": {"type": "sobol", "samples": 4, "seed": 11},
  "materials": [
    {"name": "white", "type": "lambertian", "albedo": [0.75, 0.7, 0.6], "two_sided": true},
    {"name": "lamp", "type": "diffuse light", "emit": [6, 5, 4]}
  ],
  "surfaces": [
    {"type": "quad", "size": 2, "material": "white", "transform": {"translate": [0, 0, -1]}},
    {"type": "quad", "size": 2, "material": "white",
     "transform": [{"rotate": [-90, 1, 0, 0]}, {"translate": [0, -1, 0]}]},
    {"type": "quad", "size": 2, "material": "white",
     "transform": [{"rotate": [90, 1, 0, 0]}, {"translate": [0, 1, 0]}]},
    {"type": "quad", "size": 0.6, "material": "lamp", "transform": {"translate": [0, 0.4, -0.9]}},
    {"type": "sphere", "radius": 0.4, "material": {"type": "mirror"}, "transform": {"translate": [0.4, -0.6, 0]}}
  ]
}
"#;

/// A folder of one test's own, empty at first, removed when the test has passed.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cli").join(name);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// With `ROOM` in it as `room.json`.
    fn with_room(name: &str) -> Self {
        let folder = Self::new(name);
        folder.write("room.json", ROOM);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn image(&self, name: &str) -> Image {
        read_image(&self.path(name)).unwrap_or_else(|e| panic!("{e}"))
    }

    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&self.bytes(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    /// Every file's content by its path, and every folder.
    fn snapshot(&self) -> BTreeMap<PathBuf, Option<Vec<u8>>> {
        fn walk(folder: &Path, out: &mut BTreeMap<PathBuf, Option<Vec<u8>>>) {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    walk(&path, out);
                    out.insert(path, None);
                } else {
                    let content = fs::read(&path).unwrap();
                    out.insert(path, Some(content));
                }
            }
        }
        let mut out = BTreeMap::new();
        walk(&self.0, &mut out);
        out
    }

    /// Names of the files and folders directly in it.
    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(&self.0).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_twinlight"));
        command.current_dir(&self.0).args(args).stdin(Stdio::null());
        command
    }

    /// Runs the program to its end.
    fn run(&self, args: &[&str]) -> Outcome {
        let Output { status, stdout, stderr } = self.command(args).output().unwrap();
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let outcome =
            Outcome { status: status.code(), stdout: text(stdout), stderr: text(stderr), args: args.join(" ") };
        assert!(!outcome.stderr.contains("panicked"), "{outcome:?}");
        outcome
    }

    /// Runs the program, which must succeed.
    fn ok(&self, args: &[&str]) -> Outcome {
        let outcome = self.run(args);
        assert_eq!(outcome.status, Some(0), "{outcome:?}");
        outcome
    }

    /// Renders `room.json` quietly with these options into `name`, and reads the image.
    fn rendered(&self, name: &str, options: &[&str]) -> Image {
        self.ok(&[&["render", "room.json", "--quiet", "-o", name], options].concat());
        self.image(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let _ = fs::remove_dir_all(&self.0);
        }
    }
}

/// How a run ended.
#[derive(Debug)]
#[allow(dead_code)] // `args` is for messages.
struct Outcome {
    args: String,
    status: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Largest difference of two images of one size, relative to the second's mean.
fn difference(a: &Image, b: &Image) -> f64 {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let mean = b.mean().iter().sum::<f64>() / 3.0;
    let pairs = a.rgb.iter().flatten().zip(b.rgb.iter().flatten());
    pairs.map(|(x, y)| f64::from((x - y).abs())).fold(0.0, f64::max) / mean
}

/// Ratio of the means over all channels.
fn mean_ratio(a: &Image, b: &Image) -> f64 {
    a.mean().iter().sum::<f64>() / b.mean().iter().sum::<f64>()
}

/// An EXR's string attributes, and its data window as x0, y0, width, height.
fn exr_header(path: &Path) -> (BTreeMap<String, String>, [i64; 4], [usize; 2]) {
    let meta = exr::meta::MetaData::read_from_file(path, false).unwrap();
    let header = &meta.headers[0];
    let texts = header.own_attributes.other.iter().chain(&header.shared_attributes.other).filter_map(
        |(name, value)| match value {
            exr::meta::attribute::AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            _ => None,
        },
    );
    let (at, size) = (header.own_attributes.layer_position, header.layer_size);
    let window = [i64::from(at.x()), i64::from(at.y()), size.x() as i64, size.y() as i64];
    let display = header.shared_attributes.display_window.size;
    (texts.collect(), window, [display.x(), display.y()])
}
