//! Textures: named ones, inline ones, references by name, and the images behind them.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use super::context::{Context, Keys, Object, Type, did_you_mean, list, nearest};
use super::json::{Kind, Node, excerpt, printable};
use super::place_in_file;
use super::value::{ANY, EMISSION, POSITIVE, Range};
use crate::decode::{self, ColorSpace, FileKind};
use crate::scene::desc::{Color, Filter, Param, Texels, TextureDesc, Wrap};

/// The types that are built.
const SUPPORTED: &[&str] = &["constant", "checker", "marble", "image"];

/// Most textures within each other: what looks into them visits each way to a part.
const MAX_DEPTH: usize = 10;

/// Names listed in a message.
const MAX_NAMES: usize = 20;

/// Keys of every kind of texture.
const OWN_KEYS: &[&str] =
    &["color", "scale", "even", "odd", "veins", "base", "filename", "wrap", "filter", "colorspace"];

/// What a value is used for, which decides what an 8-bit image without a `colorspace` is taken for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Use {
    Color,
    /// Numbers and normals: no colours, and nothing that sRGB is meant for.
    Data,
}

/// An image that was read, and the format it was in.
type Loaded = (Arc<Texels>, FileKind);

/// The textures read so far.
#[derive(Default)]
pub(super) struct Textures<'a> {
    list: Vec<TextureDesc>,
    /// By texture the two values that it goes between, or twice the one it has: where messages about its range point to.
    values: Vec<[Node<'a>; 2]>,
    /// How many textures stand within each other in each of them.
    depths: Vec<usize>,
    /// Which of them, or of what they are made of, is an integer image that was taken for sRGB because nothing was said.
    taken_for_srgb: Vec<bool>,
    /// `None` stands for one whose errors are already reported.
    by_name: HashMap<String, Option<usize>>,
    /// Names in file order, for messages.
    names: Vec<String>,
    /// Images by file and colour space; `None` for one that was reported.
    images: HashMap<(PathBuf, ColorSpace), Option<Loaded>>,
}

impl Textures<'_> {
    /// All textures in the order of their indices.
    pub fn into_list(self) -> Vec<TextureDesc> {
        self.list
    }
}

impl<'a> Context<'a> {
    /// Reads the scene's named textures.
    pub fn named_textures(&mut self, scene: &Object<'a>) {
        let nodes = scene.get("textures").and_then(|node| self.array(node, "an array of textures"));
        let nodes = nodes.unwrap_or_default();
        self.declare("texture", &nodes);
        for node in nodes {
            let Some(object) = self.object(&node, "an object") else { continue };
            let name = object.get("name").and_then(|n| self.string(n));
            let texture = self.texture(&object, Use::Color);
            self.required(&object, "name");
            let Some(name) = name else { continue };
            if self.textures.by_name.contains_key(&name) {
                let at = object.get("name").unwrap_or(&object.node);
                self.error(at, format!("duplicate texture name {:?}; names must differ", excerpt(&name)));
            } else {
                self.textures.names.push(name.clone());
                self.textures.by_name.insert(name, texture);
            }
        }
    }

    /// A colour or a texture whose values lie in a range.
    pub fn color_or_texture(&mut self, node: &Node<'a>, range: Range) -> Option<Param<Color>> {
        match self.texture_at(node, Use::Color, range) {
            Some(texture) => texture.map(Param::Texture),
            None => self.vector(node, range).map(Param::Value),
        }
    }

    /// A number or a texture whose values lie in a range.
    pub fn scalar_or_texture(&mut self, node: &Node<'a>, range: Range) -> Option<Param<f64>> {
        match self.texture_at(node, Use::Data, range) {
            Some(texture) => texture.map(Param::Texture),
            None => self.number(node, range).map(Param::Value),
        }
    }

    /// A texture whose values lie in a range, where nothing else will do.
    pub fn data_texture(&mut self, node: &Node<'a>, range: Range) -> Option<usize> {
        let texture = self.texture_at(node, Use::Data, range);
        if texture.is_none() {
            self.wrong_type(node, "the name of a texture or a texture object");
        }
        texture.flatten()
    }

    /// The texture that a value names or holds: `None` when the value is neither name nor object, `Some(None)` when it is
    /// in error.
    fn texture_at(&mut self, node: &Node<'a>, usage: Use, range: Range) -> Option<Option<usize>> {
        let texture = match node.kind() {
            Kind::String => self.texture_named(node, usage),
            Kind::Object => self.object(node, "a texture object").and_then(|object| self.texture(&object, usage)),
            _ => return None,
        };
        Some(texture.filter(|&index| self.check_range(node, index, range)))
    }

    fn texture_named(&mut self, node: &Node<'a>, usage: Use) -> Option<usize> {
        let name = self.string(node)?;
        let Some(&found) = self.textures.by_name.get(&name) else {
            if let Some(message) = self.defined_below("texture", &name, node) {
                self.error(node, message);
                return None;
            }
            let names = &self.textures.names;
            let known = if names.is_empty() {
                "there are no named textures here".to_owned()
            } else {
                let shown: Vec<_> = names.iter().take(MAX_NAMES).map(|n| printable(n)).collect();
                let more = if names.len() > MAX_NAMES { ", …" } else { "" };
                format!("known: {}{more}", list(&shown))
            };
            let hint = did_you_mean(nearest(&name, names));
            self.error(node, format!("no texture is named {:?};{hint} {known}", excerpt(&name)));
            return None;
        };
        if usage == Use::Data && found.is_some_and(|i| self.textures.taken_for_srgb[i]) {
            let message = format!(
                "the texture {:?} is an image of integers, taken for sRGB colours; where numbers or normals are asked \
                 for, it has to say its \"colorspace\": \"linear\" or \"srgb\"",
                excerpt(&name)
            );
            self.error(node, message);
            return None;
        }
        found
    }

    fn texture(&mut self, object: &Object<'a>, usage: Use) -> Option<usize> {
        let kind = self.type_of(object, "texture type", SUPPORTED, &[]);
        let own = match kind {
            Type::Known("constant") => &["color"][..],
            Type::Known("checker") => &["scale", "even", "odd"],
            Type::Known("marble") => &["scale", "veins", "base"],
            Type::Known(_) => &["filename", "scale", "wrap", "filter", "colorspace"],
            Type::Unknown | Type::Later => OWN_KEYS,
        };
        self.check_keys(object, &Keys::only(&[&["type", "name"], own].concat()));
        self.required(object, "type");
        let Type::Known(kind) = kind else { return None };
        let (texture, taken_for_srgb) = match kind {
            "constant" => {
                let color = self.required(object, "color").and_then(|n| self.vector(n, ANY));
                (TextureDesc::Constant(color?), false)
            }
            "checker" => {
                let scale = object.get("scale").map_or(Some([1.0; 3]), |n| self.vector(n, ANY));
                let even = self.part(object, "even", usage);
                let odd = self.part(object, "odd", usage);
                let ((even, a), (odd, b)) = (even?, odd?);
                (TextureDesc::Checker { scale: scale?, even, odd }, a || b)
            }
            "marble" => {
                let scale = object.get("scale").map_or(Some(1.0), |n| self.number(n, ANY));
                let veins = self.part(object, "veins", usage);
                let base = self.part(object, "base", usage);
                let ((veins, a), (base, b)) = (veins?, base?);
                (TextureDesc::Marble { scale: scale?, base, veins }, a || b)
            }
            _ => self.image(object, usage)?,
        };
        let part = |param: &Param<Color>| match *param {
            Param::Texture(index) => self.textures.depths[index],
            Param::Value(_) => 0,
        };
        let depth = match &texture {
            TextureDesc::Checker { even, odd, .. } => 1 + part(even).max(part(odd)),
            TextureDesc::Marble { base, veins, .. } => 1 + part(base).max(part(veins)),
            TextureDesc::Constant(_) | TextureDesc::Image { .. } => 0,
        };
        if depth > MAX_DEPTH {
            self.error(&object.node, format!("textures of textures {depth} deep; allowed: at most {MAX_DEPTH}"));
            return None;
        }
        let value = |key: &str| object.get(key).unwrap_or(&object.node).clone();
        self.textures.values.push(match kind {
            "constant" => [value("color"), value("color")],
            "checker" => [value("even"), value("odd")],
            "marble" => [value("base"), value("veins")],
            _ => [value("filename"), value("filename")],
        });
        self.textures.depths.push(depth);
        self.textures.list.push(texture);
        self.textures.taken_for_srgb.push(taken_for_srgb);
        Some(self.textures.list.len() - 1)
    }

    /// A part of a texture: a colour or another texture; and whether that was taken for sRGB. Its range is checked where
    /// the whole is used.
    fn part(&mut self, object: &Object<'a>, key: &str, usage: Use) -> Option<(Param<Color>, bool)> {
        let node = self.required(object, key)?;
        Some(match self.texture_at(node, usage, ANY) {
            Some(texture) => (Param::Texture(texture?), self.textures.taken_for_srgb[texture?]),
            None => (Param::Value(self.vector(node, ANY)?), false),
        })
    }

    fn image(&mut self, object: &Object<'a>, usage: Use) -> Option<(TextureDesc, bool)> {
        let scale = object.get("scale").map_or(Some(1.0), |n| self.number(n, POSITIVE));
        let wrap = object.get("wrap").map_or(Some(Wrap::Repeat), |n| {
            let clamp = self.choice(n, "wrap", &["repeat", "clamp"], &[])? == "clamp";
            Some(if clamp { Wrap::Clamp } else { Wrap::Repeat })
        });
        let filter = object.get("filter").map_or(Some(Filter::Bilinear), |n| {
            let nearest = self.choice(n, "filter", &["nearest", "bilinear"], &[])? == "nearest";
            Some(if nearest { Filter::Nearest } else { Filter::Bilinear })
        });
        let said = object.get("colorspace").map(|n| {
            let srgb = self.choice(n, "colorspace", &["srgb", "linear"], &[])? == "srgb";
            Some(if srgb { ColorSpace::Srgb } else { ColorSpace::Linear })
        });
        let node = self.required(object, "filename");
        let name = node.and_then(|n| self.string(n));
        let space = match (said, usage) {
            (Some(said), _) => said?,
            (None, Use::Color) => ColorSpace::OfFile,
            (None, Use::Data) => ColorSpace::Linear,
        };
        let (texels, kind) = self.texels(node?, &name?, space)?;
        let taken_for_srgb = space == ColorSpace::OfFile && kind == FileKind::Png;
        Some((TextureDesc::Image { texels, scale: scale?, wrap: wrap?, filter: filter? }, taken_for_srgb))
    }

    /// The texels of an image of radiance, which times a scale still are some.
    pub fn radiance_image(&mut self, node: &Node<'a>, name: &str, scale: f64) -> Option<Arc<Texels>> {
        let (texels, _) = self.texels(node, name, ColorSpace::OfFile)?;
        self.check_texels(node, None, &texels, scale, EMISSION).then_some(texels)
    }

    /// The texels of a file; each is read once.
    fn texels(&mut self, node: &Node<'a>, name: &str, space: ColorSpace) -> Option<Loaded> {
        let path = self.base_dir.join(name);
        let key = (path, space);
        if let Some(known) = self.textures.images.get(&key) {
            return known.clone();
        }
        let read = self.read_texels(node, &key);
        self.textures.images.insert(key, read.clone());
        read
    }

    fn read_texels(&mut self, node: &Node<'a>, (path, space): &(PathBuf, ColorSpace)) -> Option<Loaded> {
        let file = path.display().to_string();
        let image = match decode::read(path, *space) {
            Ok(image) => image,
            Err(e) if e.bad_content => {
                self.error_in_image(node, None, &file, &e.why);
                return None;
            }
            Err(e) => {
                self.error(node, format!("cannot read {file}: {}", e.why));
                return None;
            }
        };
        if let Some(i) = image.rgb.iter().position(|t| !t.iter().all(|x| x.is_finite())) {
            let message = format!("{} is not finite; allowed: finite numbers", texel(&image.rgb, i, image.width));
            self.error_in_image(node, None, &file, &message);
            return None;
        }
        let decode::Decoded { width, height, rgb, kind, .. } = image;
        Some((Arc::new(Texels { file, width, height, rgb: Arc::new(rgb) }), kind))
    }

    fn error_in_image(&mut self, node: &Node<'a>, user: Option<&Node<'a>>, file: &str, message: &str) {
        let used = user.map_or_else(String::new, |user| format!(", {}", self.used_by(user)));
        let by = self.place(node);
        self.error_in_asset(node, place_in_file(file, 0, 0), format!("{message} (named by {by}{used})"));
    }

    /// Whether all values that a texture can take lie in the range of what uses it, `user`; one that does not is reported
    /// at the texture, which is what has to change.
    fn check_range(&mut self, user: &Node<'a>, index: usize, range: Range) -> bool {
        let parts: [Param<Color>; 2] = match &self.textures.list[index] {
            TextureDesc::Constant(c) => [Param::Value(*c); 2],
            TextureDesc::Checker { even, odd, .. } => [*even, *odd],
            TextureDesc::Marble { base, veins, .. } => [*base, *veins],
            TextureDesc::Image { texels, scale, .. } => {
                let (texels, scale) = (Arc::clone(texels), *scale);
                let [name, _] = self.textures.values[index].clone();
                return self.check_texels(&name, Some(user), &texels, scale, range);
            }
        };
        for (i, part) in parts.into_iter().enumerate() {
            match part {
                Param::Texture(part) => {
                    if !self.check_range(user, part, range) {
                        return false;
                    }
                }
                Param::Value(c) if i == 0 || parts[0] != part => {
                    if let Some(channel) = c.iter().position(|x| !(range.holds)(*x)) {
                        let value = &self.textures.values[index][i];
                        let node = value.elements().into_iter().nth(channel).unwrap_or_else(|| value.clone());
                        let (x, used) = (excerpt(node.text), self.used_by(user));
                        self.error(&node, format!("{x} is out of range; allowed: {} ({used})", range.text));
                        return false;
                    }
                }
                Param::Value(_) => {}
            }
        }
        true
    }

    /// Whether all texels of a file lie in a range: of what uses it, where that is not the image itself.
    fn check_texels(
        &mut self,
        name: &Node<'a>,
        user: Option<&Node<'a>>,
        texels: &Texels,
        scale: f64,
        range: Range,
    ) -> bool {
        // As rendering multiplies them.
        let scaled = |x: f32| x * scale as f32;
        let bad = texels.rgb.iter().position(|t| !t.iter().all(|x| (range.holds)(f64::from(scaled(*x)))));
        let Some(i) = bad else { return true };
        let times = if scale == 1.0 { String::new() } else { format!(" times the scale {scale}") };
        let shown = texel(&texels.rgb, i, texels.width);
        let message = format!("{shown}{times} is out of range; allowed: {}", range.text);
        self.error_in_image(name, user, &texels.file, &message);
        false
    }

    /// The parameter whose range a texture is held to, in words.
    fn used_by(&self, user: &Node<'a>) -> String {
        format!("used by {}", self.place(user))
    }
}

/// A texel in words.
fn texel(rgb: &[[f32; 3]], index: usize, width: u32) -> String {
    let [r, g, b] = rgb[index];
    let (x, y) = (index % width as usize, index / width as usize);
    format!("the texel in column {x}, row {y} (from the top left), [{r}, {g}, {b}],")
}
