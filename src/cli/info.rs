//! `twinlight info`: what is in a scene, what it needs, what will be skipped.

use std::fmt::Write;

use serde_json::json;

use super::args::InfoArgs;
use super::render::load;
use super::{Failure, print, status};
use crate::light::{Emitter, Light};
use crate::scene::{Prepared, prepare};

pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let desc = load(&args.scene)?;
    let prepared = prepare(&desc).map_err(|e| Failure::new(status::DATA, e))?;
    let [width, height] = desc.camera.resolution;
    let g = &prepared.geometry;
    let lights: Vec<String> = prepared.lights.iter().map(|l| describe(l, &prepared)).collect();
    let skipped = prepared.needs.skipped();
    let notes: Vec<String> =
        desc.notes.iter().cloned().chain(prepared.warnings.iter().map(ToString::to_string)).collect();
    if args.json {
        let value = json!({
            "scene": args.scene.display().to_string(),
            "resolution": [width, height],
            "samples": desc.samples,
            "integrator": format!("{:?}", desc.integrator.kind).to_lowercase(),
            "max_bounces": desc.integrator.max_bounces,
            "surfaces": prepared.surfaces.len(),
            "triangles": g.triangles.len(),
            "vertices": g.positions.len(),
            "quadrics": g.quadrics.len(),
            "delta_points": g.delta_points.len(),
            "lights": lights,
            "center": prepared.center.to_array(),
            "scale": prepared.scale,
            "skipped": skipped,
            "notes": notes,
        });
        print(&format!("{value:#}\n"));
        return Ok(());
    }
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{}", args.scene.display());
    let _ = writeln!(
        out,
        "  image        {width} × {height}, {} spp, {} with at most {} bounces",
        desc.samples,
        format!("{:?}", desc.integrator.kind).to_lowercase(),
        desc.integrator.max_bounces
    );
    let _ = writeln!(
        out,
        "  geometry     {} surfaces: {} triangles on {} vertices, {} spheres and disks, {} delta points",
        prepared.surfaces.len(),
        g.triangles.len(),
        g.positions.len(),
        g.quadrics.len(),
        g.delta_points.len()
    );
    let _ = writeln!(
        out,
        "  render space recentred on ({}, {}, {}), scaled by 2^{}",
        prepared.center.x,
        prepared.center.y,
        prepared.center.z,
        prepared.scale.log2()
    );
    let _ = writeln!(out, "  lights       {}", prepared.lights.len());
    for line in lights.iter().take(20) {
        let _ = writeln!(out, "    {line}");
    }
    if lights.len() > 20 {
        let _ = writeln!(out, "    … and {} more", lights.len() - 20);
    }
    let _ = writeln!(out, "  skipped");
    for line in skipped {
        let _ = writeln!(out, "    {line}");
    }
    for line in notes {
        let _ = writeln!(out, "  note: {line}");
    }
    print(&out);
    Ok(())
}

fn describe(light: &Light, prepared: &Prepared) -> String {
    // Powers and areas are told in the file's units; render space is scaled.
    let per_area = 1.0 / (prepared.scale * prepared.scale);
    let power = light.power().as_dvec3() * per_area;
    let kind = match light {
        Light::Area(l) => {
            let shape = match &l.emitter {
                Emitter::Parallelogram { .. } => "parallelogram".to_string(),
                Emitter::Triangles { triangles, .. } => format!("{} triangles", triangles.len()),
                Emitter::Quadric { .. } => "sphere or disk".to_string(),
            };
            format!("area ({shape}, {:.6} square units)", l.area * per_area)
        }
        Light::Point(_) => "point".to_string(),
        Light::Spot(_) => "spot".to_string(),
    };
    format!("{kind}, power {:.6} {:.6} {:.6} W", power.x, power.y, power.z)
}
