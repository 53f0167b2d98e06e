//! `twinlight precision`: a scene's samples against f64.

use super::args::{AccelArg, PrecisionArgs, Size};
use super::available::{Limit, size};
use super::memory::PROGRAM;
use super::render::load;
use super::{Failure, print, status};
use crate::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use crate::accel::embree::EmbreeAccel;
use crate::accel::{Accel, AccelOptions};
use crate::integrator::Settings;
use crate::scene::{Memory, Prepared, Scene, prepare};
use crate::stress::{bytes_of_steps, precision};

pub fn run(args: &PrecisionArgs) -> Result<(), Failure> {
    let limit = Limit::sensible();
    let mut desc = load(&args.scene, limit)?;
    if let Some(Size(pixels)) = args.size {
        desc.camera.resolution = pixels;
    }
    let settings = Settings {
        max_bounces: args.max_bounces.unwrap_or(desc.integrator.max_bounces),
        roulette: desc.integrator.russian_roulette,
        heuristic: desc.integrator.heuristic,
        sampler: desc.sampler.kind,
        seed: desc.sampler.seed,
        ..Settings::default()
    };
    check(args, &Memory::of(&desc), settings.max_bounces, limit)?;
    let prepared = prepare(&desc).map_err(|e| Failure::new(status::DATA, e))?;
    match args.accel {
        #[cfg(feature = "embree")]
        AccelArg::Embree => with::<EmbreeAccel>(args, prepared, settings),
        AccelArg::Bvh => with::<BvhAccel>(args, prepared, settings),
    }
}

/// Checks the scene and the steps of one sample for each thread: what is found of their paths takes no more with their number.
fn check(args: &PrecisionArgs, scene: &Memory, max_bounces: u32, limit: Limit) -> Result<(), Failure> {
    let steps = bytes_of_steps(max_bounces);
    let (_, peak) = scene.peak(args.accel.footprint(), steps);
    let peak = peak.saturating_add(PROGRAM);
    if peak <= limit.bytes {
        return Ok(());
    }
    let mend = if steps > limit.bytes / 2 { "fewer --max-bounces" } else { "a simpler scene" };
    Err(Failure::usage(format!(
        "the paths of up to {max_bounces} bounces and the scene take up to {} at once, more than {}; use {mend}",
        size(peak),
        limit.words()
    )))
}

fn with<A: Accel>(args: &PrecisionArgs, prepared: Prepared, settings: Settings) -> Result<(), Failure> {
    let scene: Scene<A> = Scene::build(prepared, AccelOptions::default()).map_err(Failure::other)?;
    let found = precision(&scene, settings, args.spp);
    print(&if args.json {
        format!("{:#}\n", found.json())
    } else {
        format!("{}: bdpt, {} spp, {}\n{}", args.scene.display(), args.spp, A::NAME, found.text())
    });
    Ok(())
}
