//! `twinlight precision`: a scene's samples against f64.

use super::args::{AccelArg, PrecisionArgs, Size};
use super::available::Limit;
use super::render::load;
use super::{Failure, print, status};
use crate::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use crate::accel::embree::EmbreeAccel;
use crate::accel::{Accel, AccelOptions};
use crate::integrator::Settings;
use crate::scene::{Prepared, Scene, prepare};
use crate::stress::precision;

/// Most samples: some ten paths each, of 48 bytes.
const MOST: u64 = 1 << 22;

pub fn run(args: &PrecisionArgs) -> Result<(), Failure> {
    let mut desc = load(&args.scene, Limit::sensible())?;
    if let Some(Size(size)) = args.size {
        desc.camera.resolution = size;
    }
    let [width, height] = desc.camera.resolution;
    let samples = u64::from(width) * u64::from(height) * u64::from(args.spp);
    if samples > MOST {
        return Err(Failure::usage(format!(
            "{width} × {height} pixels with {} spp are {samples} samples, of which each path is kept; at most {MOST} fit: use a \
             smaller --size or --spp",
            args.spp
        )));
    }
    let settings = Settings {
        max_bounces: args.max_bounces.unwrap_or(desc.integrator.max_bounces),
        roulette: desc.integrator.russian_roulette,
        heuristic: desc.integrator.heuristic,
        sampler: desc.sampler.kind,
        seed: desc.sampler.seed,
        ..Settings::default()
    };
    let prepared = prepare(&desc).map_err(|e| Failure::new(status::DATA, e))?;
    match args.accel {
        #[cfg(feature = "embree")]
        AccelArg::Embree => with::<EmbreeAccel>(args, prepared, settings),
        AccelArg::Bvh => with::<BvhAccel>(args, prepared, settings),
    }
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
