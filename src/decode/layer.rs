//! The layers of an EXR beside its picture: channels whose names share what stands before their last dot, or parts of a
//! file of several.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use exr::block::reader::Reader;
use exr::math::Vec2;
use exr::meta::attribute::Text;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _};

use super::{Decoded, FileKind, Pixels, check_exr_header, told_by};

/// A layer that may be asked for by name.
struct Layer {
    name: String,
    /// Its header's index.
    part: usize,
    /// Channels in the file's order: what stands before the last dot, and the whole names.
    prefix: String,
    channels: Vec<String>,
}

/// The names of an EXR's layers beside the picture that [`super::read`] takes; none of files of other formats, or of no EXR
/// that can be read.
pub fn layers(path: &Path) -> Vec<String> {
    let Some(FileKind::Exr) = super::kind_of_content(path) else { return Vec::new() };
    let all = super::guard::guarded(|| {
        let file = File::open(path).map_err(|e| e.to_string())?;
        let reader = Reader::read_from_buffered(BufReader::new(file), false).map_err(|e| e.to_string())?;
        Ok(found(reader.headers()))
    });
    let Ok(all) = all else { return Vec::new() };
    let picture = all.iter().position(|l| l.prefix.is_empty() && rgb(&l.channels).is_some());
    all.into_iter().enumerate().filter(|(i, _)| Some(*i) != picture).map(|(_, layer)| layer.name).collect()
}

/// Reads a layer of an EXR as an image: its channels R, G, B or X, Y, Z, two channels as red and green, one as grey.
///
/// # Errors
/// In words, when the file cannot be read, has no such layer, or one of other channels.
pub fn read_layer(path: &Path, name: &str) -> Result<Decoded, String> {
    super::guard::guarded(|| read_layer_of_exr(path, name))
}

fn read_layer_of_exr(path: &Path, name: &str) -> Result<Decoded, String> {
    let file = File::open(path).map_err(|e| format!("{e}; check the name and the permissions"))?;
    let length = file.metadata().map_err(|e| e.to_string())?.len();
    let damaged = |e: exr::error::Error| format!("{e}; the file is damaged or uses an unsupported feature");
    let reader = Reader::read_from_buffered(BufReader::new(file), false).map_err(damaged)?;
    for header in reader.headers() {
        check_exr_header(header, length)?;
    }
    let layers = found(reader.headers());
    let is_named = |layer: &&Layer| layer.name == name && !name.is_empty();
    // A layer of one channel goes by that channel's name as well: `depth.Z` is all of `depth`.
    let is_its_channel = |layer: &&Layer| match layer.channels.as_slice() {
        [only] => {
            let last = only.rsplit('.').next().unwrap_or_default();
            if layer.name.is_empty() { last == name } else { format!("{}.{last}", layer.name) == name }
        }
        _ => false,
    };
    let Some(layer) = layers.iter().find(is_named).or_else(|| layers.iter().find(is_its_channel)) else {
        let names: Vec<&str> = layers.iter().map(|l| l.name.as_str()).filter(|n| !n.is_empty()).collect();
        let there =
            if names.is_empty() { "it has none".to_owned() } else { format!("there are: {}", names.join(", ")) };
        return Err(format!("no layer is named {name:?}; {there}"));
    };
    let about = told_by(&reader.headers()[layer.part]);
    // The decoder takes the first part that has these channels.
    let has_all = |header: &Header| layer.channels.iter().all(|name| names(header).any(|n| n == *name));
    if reader.headers()[..layer.part].iter().any(has_all) {
        let channels = layer.channels.join(", ");
        return Err(format!(
            "an earlier part of the file has the channels {channels} as well, and only that can be read"
        ));
    }
    let read = exr::prelude::read().no_deep_data().largest_resolution_level().specific_channels();
    macro_rules! pixels {
        ($read:expr, $pattern:pat, $type:ty => $value:expr) => {
            $read
                .collect_pixels(
                    |size, _| start(size),
                    move |all: &mut Pixels, at, $pattern: $type| put(all, at, $value),
                )
                .first_valid_layer()
                .all_attributes()
                .non_parallel()
                .from_chunks(reader)
                .map_err(damaged)?
                .layer_data
                .channel_data
                .pixels
        };
    }
    let channels = rgb(&layer.channels).unwrap_or_else(|| layer.channels.clone());
    let (width, height, rgb) = match channels.as_slice() {
        [grey] => pixels!(read.required(text(grey)?), (v,), (f32,) => [v; 3]),
        [r, g] => pixels!(read.required(text(r)?).required(text(g)?), (r, g), (f32, f32) => [r, g, 0.0]),
        [r, g, b] => {
            let read = read.required(text(r)?).required(text(g)?).required(text(b)?);
            pixels!(read, (r, g, b), (f32, f32, f32) => [r, g, b])
        }
        other => return Err(format!("the layer {name:?} has the channels {}, which are no picture", other.join(", "))),
    };
    Ok(Decoded { width, height, rgb, kind: FileKind::Exr, about })
}

fn text(name: &str) -> Result<Text, String> {
    Text::new_or_none(name).ok_or_else(|| format!("the channel {name:?} has a name that cannot be read"))
}

/// A black image.
fn start(Vec2(width, height): Vec2<usize>) -> Pixels {
    (width as u32, height as u32, vec![[0.0; 3]; width * height])
}

fn put((width, _, pixels): &mut Pixels, Vec2(x, y): Vec2<usize>, value: [f32; 3]) {
    pixels[y * *width as usize + x] = value;
}

/// A header's channels by name.
fn names(header: &Header) -> impl Iterator<Item = String> {
    header.channels.list.iter().map(|c| String::from_utf8_lossy(c.name.as_slice()).into_owned())
}

/// The layers in the file's order; the name of a picture in a part without a name is empty.
fn found(headers: &[Header]) -> Vec<Layer> {
    let mut all: Vec<Layer> = Vec::new();
    for (part, header) in headers.iter().enumerate().filter(|(_, header)| !header.deep) {
        let own = header.own_attributes.layer_name.as_ref();
        let own = own.map_or_else(String::new, |name| String::from_utf8_lossy(name.as_slice()).into_owned());
        for channel in names(header) {
            let prefix = channel.rsplit_once('.').map_or("", |(prefix, _)| prefix).to_owned();
            if let Some(layer) = all.iter_mut().find(|l| l.part == part && l.prefix == prefix) {
                layer.channels.push(channel);
                continue;
            }
            let name =
                if own.is_empty() || prefix.is_empty() { format!("{own}{prefix}") } else { format!("{own}.{prefix}") };
            all.push(Layer { name, part, prefix, channels: vec![channel] });
        }
    }
    all
}

/// Those channels that are red, green and blue, or x, y and z, in this order.
fn rgb(channels: &[String]) -> Option<Vec<String>> {
    let last = |channel: &String| channel.rsplit('.').next().unwrap_or_default().to_owned();
    [["R", "G", "B"], ["X", "Y", "Z"]].iter().find_map(|wanted| {
        wanted.iter().map(|w| channels.iter().find(|c| last(c) == *w).cloned()).collect::<Option<Vec<String>>>()
    })
}
