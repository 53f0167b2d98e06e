//! Textures of every type, for colours, numbers and normals.

use std::path::Path;

use serde_json::{Value, json};
use twinlight::film::Image;
use twinlight::output::{Metadata, write_image};

use super::deck::Deck;

/// What a colour may be: mostly plain, as in a scene file.
const COLORS: &[&str] = &[
    "plain",
    "plain",
    "plain",
    "plain",
    "plain",
    "plain",
    "plain",
    "plain",
    "constant",
    "checker",
    "marble",
    "bilinear image",
    "nearest image",
    "nested",
];

/// What a number may be.
const NUMBERS: &[&str] = &["plain", "plain", "plain", "plain", "plain", "checker", "marble", "image"];

/// What may turn the normal.
const MAPS: &[&str] = &[
    "none",
    "none",
    "none",
    "none",
    "none",
    "none",
    "normal map, checker",
    "normal map, image",
    "bump map, marble",
    "bump map, image",
];

/// Makes textures for a scene that was enlarged by `scale`.
pub struct Textures {
    pub scale: f64,
}

/// Side of the images in texels.
const SIDE: u32 = 4;

/// An EXR of these texels, as a scene names it.
fn file(name: &str, texel: impl Fn(u32) -> [f32; 3]) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("random_scenes");
    std::fs::create_dir_all(&folder).expect("a folder for textures");
    let path = folder.join(name);
    let image = Image { width: SIDE, height: SIDE, rgb: (0..SIDE * SIDE).map(texel).collect() };
    // Renamed into place: tests that run at the same time write and read the same file.
    let unfinished = folder.join(format!("{:?}.{name}", std::thread::current().id()));
    write_image(&unfinished, &image, &Metadata::default(), 0.0).expect("a texture is written");
    std::fs::rename(&unfinished, &path).expect("a texture is put into its place");
    path.to_str().expect("a path in UTF-8").to_owned()
}

/// Reflectances from 0.1 to 1, without a pattern.
fn colored() -> String {
    file("colors.exr", |i| [1, 5, 9].map(|k| 0.1 + 0.9 * ((i * 7 + k * (i / 3)) % 11) as f32 / 10.0))
}

/// Numbers from 0 to 1.
fn numbers() -> String {
    file("numbers.exr", |i| [((i * 5 + i / SIDE) % 8) as f32 / 7.0; 3])
}

/// Numbers from 0.7 to 1.
fn large_numbers() -> String {
    file("large_numbers.exr", |i| [1.0 - 0.3 * ((i * 5 + i / SIDE) % 8) as f32 / 7.0; 3])
}

/// Normals up to 35° off.
fn normals() -> String {
    file("normals.exr", |i| {
        [0.5 + 0.25 * (((i * 3) % 5) as f32 / 2.0 - 1.0), 0.5 + 0.25 * (((i * 7) % 5) as f32 / 2.0 - 1.0), 0.95]
    })
}

/// Radiance all around, up to 2, some of it black.
pub fn sky() -> String {
    file("sky.exr", |i| if i % 5 == 0 { [0.0; 3] } else { [0.3, 0.5, 1.0].map(|x| x * (1 + i * 7 % 4) as f32 / 2.0) })
}

impl Textures {
    /// A colour, or a texture about it.
    pub fn color(&self, deck: &mut Deck, color: [f64; 3]) -> Value {
        let darker = color.map(|c| 0.5 * c);
        match deck.deal("colour", COLORS) {
            "plain" => json!(color),
            "constant" => json!({ "type": "constant", "color": color }),
            "checker" => json!({ "type": "checker", "scale": 9.0 / self.scale, "even": color, "odd": darker }),
            "marble" => json!({ "type": "marble", "scale": 5.0 / self.scale, "base": color, "veins": darker }),
            "nested" => {
                let odd = json!({ "type": "image", "filename": colored(), "scale": 0.5 });
                json!({ "type": "checker", "scale": 6.0 / self.scale, "even": color, "odd": odd })
            }
            kind => {
                // Brightest where a texel is 1: the largest channel of the colour.
                let (filter, scale) = (kind.trim_end_matches(" image"), color.into_iter().fold(0.0, f64::max));
                json!({ "type": "image", "filename": colored(), "filter": filter, "scale": scale })
            }
        }
    }

    /// The first of two numbers, or a texture that is not much below both.
    pub fn number(&self, deck: &mut Deck, [a, b]: [f64; 2]) -> Value {
        match deck.deal("number", NUMBERS) {
            "plain" => json!(a),
            "checker" => json!({ "type": "checker", "scale": 8.0 / self.scale, "even": a, "odd": b }),
            "marble" => json!({ "type": "marble", "scale": 6.0 / self.scale, "base": a, "veins": b }),
            _ => json!({ "type": "image", "filename": large_numbers(), "colorspace": "linear", "scale": a.max(b) }),
        }
    }

    /// The fraction of a surface that is there.
    pub fn opacity(&self) -> Value {
        json!({ "type": "image", "filename": numbers(), "filter": "nearest", "colorspace": "linear" })
    }

    /// Gives a surface a map that turns its normal, or none.
    pub fn map(&self, deck: &mut Deck, surface: &mut Value) {
        match deck.deal("map", MAPS) {
            "none" => {}
            "normal map, checker" => {
                surface["normal_map"] = json!({ "type": "checker", "scale": 8.0 / self.scale,
                                               "even": [0.7, 0.45, 0.95], "odd": [0.35, 0.6, 0.95] });
            }
            "normal map, image" => {
                surface["normal_map"] = json!({ "type": "image", "filename": normals(), "colorspace": "linear" });
            }
            "bump map, marble" => {
                let veins = 0.02 * self.scale;
                surface["bump_map"] = json!({ "type": "marble", "scale": 9.0 / self.scale, "base": 0, "veins": veins });
            }
            _ => {
                surface["bump_map"] = json!({ "type": "image", "filename": numbers(), "colorspace": "linear",
                                             "scale": 0.04 * self.scale });
            }
        }
    }
}
