//! `twinlight info`: what is in a scene, what it needs, what will be skipped.

use std::fmt::Write;
use std::sync::Arc;

use clap::ValueEnum;
use serde_json::{Value, json};

use super::args::{AccelArg, InfoArgs};
use super::available::{Limit, size};
use super::memory::PROGRAM;
use super::render::load;
use super::settings::{integrator, missing, usual_subpaths};
use super::{Failure, count, figures, print, status};
use crate::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use crate::accel::embree::EmbreeAccel;
use crate::accel::{Accel, AccelOptions};
use crate::film::BYTES_PER_PIXEL;
use crate::geometry::Geometry;
use crate::light::{Cone, Emitter, Light, Profile};
use crate::scene::desc::SceneDesc;
use crate::scene::{Memory, Prepared, prepare};

pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let desc = load(&args.scene, Limit::sensible())?;
    let memory = Memory::of(&desc);
    let prepared = prepare(&desc).map_err(|e| Failure::new(status::DATA, e))?;
    let scene = args.scene.display().to_string();
    let integrator = integrator(&desc);
    let facts = Facts {
        accelerators: accelerators(),
        lights: prepared.lights.iter().map(|l| Lamp::of(l, &prepared)).collect(),
        skipped: prepared.needs.skipped(),
        notes: (desc.notes.iter().cloned())
            .chain(prepared.warnings.iter().map(ToString::to_string))
            .chain(missing(integrator, usual_subpaths(integrator).0, &prepared).into_iter().map(str::to_owned))
            .collect(),
        desc: &desc,
        memory,
        prepared: &prepared,
    };
    print(&if args.json { format!("{:#}\n", facts.json(&scene)) } else { facts.text(&scene) });
    Ok(())
}

/// What can be told about a scene.
struct Facts<'a> {
    desc: &'a SceneDesc,
    memory: Memory,
    prepared: &'a Prepared,
    accelerators: Vec<String>,
    lights: Vec<Lamp>,
    skipped: Vec<&'static str>,
    notes: Vec<String>,
}

impl Facts<'_> {
    fn integrator(&self) -> String {
        format!("{:?}", self.desc.integrator.kind).to_lowercase()
    }

    fn film(&self) -> u64 {
        self.desc.camera.resolution.iter().map(|side| u64::from(*side)).product::<u64>() * BYTES_PER_PIXEL
    }

    /// What a plain render takes at once, by accelerator.
    fn peaks(&self) -> Vec<(String, u64)> {
        let peak = |accel: &AccelArg| self.memory.peak(accel.footprint(), self.film()).1 + PROGRAM;
        let name = |accel: &AccelArg| format!("{accel:?}").to_lowercase();
        AccelArg::value_variants().iter().map(|accel| (name(accel), peak(accel))).collect()
    }

    fn memory(&self) -> String {
        let peaks: Vec<String> =
            self.peaks().into_iter().map(|(accel, bytes)| format!("{} with {accel}", size(bytes))).collect();
        let Memory { geometry, textures, .. } = self.memory;
        let (geometry, textures, film) = (size(geometry), size(textures), size(self.film()));
        format!("about {} (geometry {geometry}, textures {textures}, film {film})", peaks.join(" or "))
    }

    fn json(&self, scene: &str) -> Value {
        let g = &self.prepared.geometry;
        json!({
            "scene": scene,
            "resolution": self.desc.camera.resolution,
            "samples": self.desc.samples,
            "integrator": self.integrator(),
            "max_bounces": self.desc.integrator.max_bounces,
            "accelerators": self.accelerators,
            "surfaces": self.prepared.surfaces.len(),
            "triangles": g.triangles.len(),
            "vertices": g.positions.len(),
            "quadrics": g.quadrics.len(),
            "delta_points": g.delta_points.len(),
            "memory": {
                "geometry": self.memory.geometry,
                "textures": self.memory.textures,
                "film": self.film(),
                "peak": self.peaks().into_iter().collect::<std::collections::BTreeMap<_, _>>(),
            },
            "lights": self.lights.iter().map(Lamp::json).collect::<Vec<Value>>(),
            "center": self.prepared.center.to_array(),
            "scale": self.prepared.scale,
            "skipped": self.skipped,
            "notes": self.notes,
        })
    }

    fn text(&self, scene: &str) -> String {
        let [width, height] = self.desc.camera.resolution;
        let mut out = format!("{scene}\n");
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "  image        {width} × {height}, {} spp, {} with at most {}",
            self.desc.samples,
            self.integrator(),
            count(self.desc.integrator.max_bounces as usize, "bounce", "bounces")
        );
        let _ = writeln!(out, "  geometry     {}", self.geometry());
        let center = self.prepared.center.to_array().map(figures).join(", ");
        let scale = self.prepared.scale.log2();
        let _ = writeln!(out, "  render space recentred on ({center}), scaled by 2^{scale}");
        let _ = writeln!(out, "  accelerators {}; the first is the default", self.accelerators.join("; "));
        let _ = writeln!(out, "  memory       {}", self.memory());
        let _ = writeln!(out, "  lights       {}", self.lights.len());
        for lamp in self.lights.iter().take(20) {
            let _ = writeln!(out, "    {}", lamp.text());
        }
        if self.lights.len() > 20 {
            let _ = writeln!(out, "    … and {} more", self.lights.len() - 20);
        }
        let _ = writeln!(out, "  skipped");
        for line in &self.skipped {
            let _ = writeln!(out, "    {line}");
        }
        for line in &self.notes {
            let _ = writeln!(out, "  note: {line}");
        }
        out
    }

    fn geometry(&self) -> String {
        let g = &self.prepared.geometry;
        let mut parts = Vec::new();
        if !g.triangles.is_empty() {
            let vertices = count(g.positions.len(), "vertex", "vertices");
            parts.push(format!("{} on {vertices}", count(g.triangles.len(), "triangle", "triangles")));
        }
        if !g.quadrics.is_empty() {
            parts.push(count(g.quadrics.len(), "sphere or disk", "spheres or disks"));
        }
        if !g.delta_points.is_empty() {
            parts.push(count(g.delta_points.len(), "delta point", "delta points"));
        }
        let surfaces = count(self.prepared.surfaces.len(), "surface", "surfaces");
        if parts.is_empty() { surfaces } else { format!("{surfaces}: {}", parts.join(", ")) }
    }
}

/// What the build can intersect with, the default first, in the words of the images' metadata.
fn accelerators() -> Vec<String> {
    fn describe<A: Accel>() -> String {
        match A::build(Arc::new(Geometry::default()), AccelOptions::default()) {
            Ok(accel) => accel.describe(),
            Err(e) => format!("{} (cannot be used here: {e})", A::NAME),
        }
    }
    vec![
        #[cfg(feature = "embree")]
        describe::<EmbreeAccel>(),
        describe::<BvhAccel>(),
    ]
}

/// A light, in the file's units: render space is scaled.
struct Lamp {
    kind: &'static str,
    /// Shape and area in square units, of an area light.
    shape: Option<(String, f64)>,
    /// Of a spot.
    cone: Option<Cone>,
    /// Watts per channel.
    power: [f64; 3],
}

impl Lamp {
    fn of(light: &Light, prepared: &Prepared) -> Self {
        let per_area = 1.0 / (prepared.scale * prepared.scale);
        let power = (light.power().as_dvec3() * per_area).to_array();
        match light {
            Light::Area(l) => {
                let shape = match &l.emitter {
                    Emitter::Parallelogram { .. } => "parallelogram".to_string(),
                    Emitter::Triangles { triangles, .. } => count(triangles.len(), "triangle", "triangles"),
                    Emitter::Quadric { .. } => "sphere or disk".to_string(),
                };
                Self { kind: "area", shape: Some((shape, l.area * per_area)), cone: None, power }
            }
            Light::Point(_) => Self { kind: "point", shape: None, cone: None, power },
            Light::Spot(l) => Self { kind: "spot", shape: None, cone: Some(*l.cone()), power },
            Light::Directional(_) => Self { kind: "directional", shape: None, cone: None, power },
            Light::Environment(_) => Self { kind: "environment", shape: None, cone: None, power },
        }
    }

    fn json(&self) -> Value {
        let (shape, area) = self.shape.as_ref().map(|(shape, area)| (shape, area)).unzip();
        let mut json = json!({"kind": self.kind, "shape": shape, "area": area, "power": self.power});
        if let Some(Cone { inner, outer, profile }) = self.cone {
            json["inner_angle"] = inner.into();
            json["outer_angle"] = outer.into();
            json["profile"] = profile_name(profile).into();
            if let Profile::Cosine { falloff } = profile {
                json["falloff"] = falloff.into();
            }
        }
        json
    }

    fn text(&self) -> String {
        let shape = self.shape.as_ref().map_or_else(String::new, |(shape, area)| {
            format!(" ({shape}, {} square {})", figures(*area), if *area == 1.0 { "unit" } else { "units" })
        });
        let cone = self.cone.map_or_else(String::new, |Cone { inner, outer, profile }| {
            let falloff = match profile {
                Profile::Cosine { falloff } => format!(", falloff {}", figures(falloff)),
                Profile::Angle => String::new(),
            };
            let (inner, outer) = (figures(inner), figures(outer));
            format!(" ({} profile from {inner}° to {outer}°{falloff})", profile_name(profile))
        });
        format!("{}{shape}{cone}, power {} W", self.kind, self.power.map(figures).join(" "))
    }
}

/// A profile's name in the scene format.
fn profile_name(profile: Profile) -> &'static str {
    match profile {
        Profile::Cosine { .. } => "cosine",
        Profile::Angle => "angle",
    }
}
