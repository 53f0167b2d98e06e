//! Whether a render fits into memory, asked before anything is allocated for it.

use super::Failure;
use super::args::{AccelArg, AovArg, RenderArgs};
use super::available::{Limit, size};
use crate::accel::Footprint;
use crate::film::{BYTES_PER_PIXEL, VARIANCE_BYTES_PER_PIXEL};
use crate::integrator::Crop;
use crate::render::{Aov, FIRST_SURFACE_BYTES};
use crate::scene::Memory;

/// The program itself, with the library that answers rays.
pub const PROGRAM: u64 = 10 << 20;

/// Below this share of the whole a part is not worth naming.
const WORTH_NAMING: u64 = 50;

/// What one pixel takes.
struct PerPixel {
    /// Techniques with films of their own.
    techniques: u64,
    /// Channels of auxiliary images.
    channels: u64,
    bytes: u64,
}

impl PerPixel {
    /// With techniques kept apart for paths of up to `edges` edges; of them auxiliary images show `aov_edges`.
    fn new(edges: u64, wanted: &[Aov], aov_edges: u32) -> Self {
        // Paths of n edges are made by n + 1 techniques (t = 0 is not built).
        let techniques = edges * (edges + 3) / 2;
        let channels = wanted.iter().map(|aov| aov.channels(aov_edges)).sum();
        let mut bytes = (techniques + 1) * BYTES_PER_PIXEL + channels * size_of::<f32>() as u64;
        if wanted.contains(&Aov::Variance) {
            bytes += VARIANCE_BYTES_PER_PIXEL;
        }
        if wanted.iter().any(|aov| aov.is_of_first_surface()) {
            bytes += FIRST_SURFACE_BYTES;
        }
        Self { techniques, channels, bytes }
    }
}

/// Checks the scene, the film, those of the techniques kept apart for paths of up to `edges` edges, and the auxiliary images.
///
/// # Errors
/// What they take in all, when it is too much, and which options would make it less.
pub fn check(
    args: &RenderArgs,
    scene: &Memory,
    crop: Crop,
    edges: Option<u32>,
    aov_edges: u32,
    limit: Limit,
) -> Result<(), Failure> {
    let per_pixel = PerPixel::new(edges.unwrap_or(0).into(), &AovArg::wanted(&args.aovs), aov_edges);
    let film = per_pixel.bytes.saturating_mul(crop.pixels());
    let (parts, peak) = scene.peak(args.accel.footprint(), film);
    let peak = peak.saturating_add(PROGRAM);
    if peak <= limit.bytes {
        return Ok(());
    }
    let mut what = vec![format!("the film of {} × {} pixels", crop.width(), crop.height())];
    let mut mend = vec!["a smaller --size", "a --crop"];
    if per_pixel.techniques > 0 {
        what.push(format!("those of {} techniques", per_pixel.techniques));
    }
    if args.pyramid.is_some() {
        mend.push("fewer --pyramid-edges");
    }
    if per_pixel.channels > 0 {
        what.push(super::count(per_pixel.channels as usize, "auxiliary channel", "auxiliary channels"));
        mend.push("fewer --aovs");
    }
    let words = limit.words();
    if film > limit.bytes {
        return Err(Failure::usage(format!(
            "{} {} {}, more than {words}; use {} or a larger --max-memory",
            what.join(if what.len() == 2 { " and " } else { ", " }),
            if what.len() > 1 { "take" } else { "takes" },
            size(film),
            mend.join(" or ")
        )));
    }
    // What cannot help is no advice.
    if !parts.iter().any(|(part, bytes)| *part == "film" && bytes.saturating_mul(WORTH_NAMING) > peak) {
        mend.clear();
    }
    if let Some(smaller) = smaller(args.accel, scene, film, limit) {
        mend.insert(0, smaller);
    }
    mend.extend(["a simpler scene", "a larger --max-memory"]);
    let parts = parts.into_iter().chain([("the program itself", PROGRAM)]);
    let parts = parts.filter(|(_, bytes)| bytes.saturating_mul(WORTH_NAMING) > peak);
    let parts: Vec<String> = parts.map(|(part, bytes)| format!("{part} {}", size(bytes))).collect();
    Err(Failure::usage(format!(
        "the render takes about {} at once ({}), more than {words}; use {}",
        size(peak),
        parts.join(", "),
        mend.join(" or ")
    )))
}

/// Another accelerator that would do.
fn smaller(accel: AccelArg, scene: &Memory, film: u64, limit: Limit) -> Option<&'static str> {
    #[cfg(feature = "embree")]
    if accel != AccelArg::Embree
        && scene.peak(AccelArg::Embree.footprint(), film).1.saturating_add(PROGRAM) <= limit.bytes
    {
        return Some("--accel embree");
    }
    let _ = (accel, scene, film, limit);
    None
}

impl AccelArg {
    /// What it takes.
    pub fn footprint(self) -> Footprint {
        use crate::accel::Accel;
        match self {
            #[cfg(feature = "embree")]
            Self::Embree => crate::accel::embree::EmbreeAccel::FOOTPRINT,
            Self::Bvh => crate::accel::bvh::BvhAccel::FOOTPRINT,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_is_kept_counts() {
        let bytes = |edges, wanted: &[Aov]| PerPixel::new(edges, wanted, 6).bytes;
        let film = BYTES_PER_PIXEL;
        assert_eq!(bytes(0, &[]), film);
        // (0,2), (1,1), then (0,3), (1,2), (2,1).
        assert_eq!(bytes(2, &[]), film * 6);
        assert_eq!(bytes(0, &[Aov::Variance]), film + VARIANCE_BYTES_PER_PIXEL + 12);
        assert_eq!(bytes(2, &[Aov::Direct]), film * 6 + 9 * 4);
        assert_eq!(bytes(6, &[Aov::PerDepth]), film * 28 + 18 * 4);
        assert_eq!(bytes(0, &[Aov::SampleCount, Aov::Lights]), film + 12);
        assert_eq!(bytes(0, &[Aov::Depth]), film + FIRST_SURFACE_BYTES + 4);
    }
}
