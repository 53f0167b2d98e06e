//! `twinlight render --trace`: one sample again, with every vertex, density and weight it was made of.

use std::fmt::{Display, Write};

use super::args::RenderArgs;
use super::settings::{departures, name};
use super::{Failure, figures, print, significant, status, words};
use crate::accel::{Accel, AccelOptions};
use crate::film::Accumulator;
use crate::geometry::{GeometryKind, QuadricKind};
use crate::integrator::trace::{Arrived, End, Made, Step};
use crate::integrator::{Crop, PixelSample, Reason, Recorder, SampleLoop, Settings};
use crate::light::{Light, LightPoint};
use crate::math::{DVec3, Rgb, Vec3};
use crate::render::made_by;
use crate::scene::desc::{Place, SceneDesc, ShapeDesc};
use crate::scene::{Prepared, Scene};

/// The sample that is replayed, from the command line; `None` without `--trace`.
///
/// # Errors
/// A pixel outside the image, a sample that the render would not take.
pub fn wanted(args: &RenderArgs, desc: &SceneDesc) -> Result<Option<PixelSample>, Failure> {
    let (true, Some(pixel)) = (args.trace, args.pixel) else { return Ok(None) };
    let [x, y] = pixel.0;
    let [width, height] = desc.camera.resolution;
    if x >= width || y >= height {
        return Err(Failure::usage(format!(
            "--pixel {x},{y} is outside the image: it is {width} × {height} pixels, counted from 0,0 at the top left"
        )));
    }
    let index = args.sample.unwrap_or(0);
    if index >= desc.samples {
        return Err(Failure::usage(format!(
            "--sample {index}: the render takes {} per pixel, counted from 0; give a smaller number or --spp {}",
            desc.samples,
            u64::from(index) + 1
        )));
    }
    Ok(Some(PixelSample { pixel: [x, y], index }))
}

/// What messages call the surfaces and materials of a scene, kept where the description is given up.
#[derive(Debug)]
pub struct Names {
    /// By prepared surface: where in the file, and its material's name.
    surfaces: Vec<(Place, Option<String>)>,
}

impl Names {
    /// Of a scene's surfaces; delta points are not among those that are prepared.
    pub fn of(desc: &SceneDesc) -> Self {
        let solid = desc.surfaces.iter().filter(|s| !matches!(s.shape, ShapeDesc::DeltaPoint));
        let named = |s: &crate::scene::desc::SurfaceDesc| (s.at.clone(), desc.materials[s.material].name.clone());
        Self { surfaces: solid.map(named).collect() }
    }

    fn surface(&self, index: u32) -> String {
        match self.surfaces.get(index as usize) {
            Some((at, Some(material))) => format!("surface {index} ({at}) of {material:?}"),
            Some((at, None)) => format!("surface {index} ({at})"),
            None => format!("surface {index}"),
        }
    }
}

/// Replays a sample and prints its steps.
///
/// # Errors
/// When the accelerator cannot be built; status 70 when a contribution is not finite.
pub fn run<A: Accel>(
    prepared: Prepared,
    settings: Settings,
    sample: PixelSample,
    names: &Names,
    scene_name: &str,
) -> Result<(), Failure> {
    let (center, scale) = (prepared.center, prepared.scale);
    let scene: Scene<A> = Scene::build(prepared, AccelOptions::default()).map_err(Failure::other)?;
    let largest = Accumulator::largest(scene.brightness);
    let mut recorder = Recorder::traced(Crop::full(scene.camera.resolution())).within(largest);
    let (made_by, thresholds) = made_by(&scene, &settings, sample.index).map_err(Failure::other)?;
    SampleLoop::thrifty(&scene, made_by, thresholds).sample(sample, &mut recorder);
    let page = Page { scene: &scene, names, center, scale };
    let mut out = page.heading(scene_name, settings, sample);
    let (mut camera, mut subpaths) = (true, 0);
    for step in recorder.steps() {
        match step {
            Step::Camera { .. } => camera = true,
            Step::Light { .. } => (camera, subpaths) = (false, subpaths + 1),
            _ => {}
        }
        page.step(&mut out, step, camera, subpaths);
    }
    page.sums(&mut out, &recorder, sample);
    print(&out);
    let (bad, large) = (recorder.rejected().0, recorder.overflows());
    if bad + large == 0 {
        return Ok(());
    }
    let mut parts = Vec::new();
    for (count, what) in [(bad, "not finite"), (large, "too large for the film")] {
        match count {
            0 => {}
            1 => parts.push(format!("1 contribution of this sample is {what}")),
            n => parts.push(format!("{n} contributions of this sample are {what}")),
        }
    }
    Err(Failure::new(status::NON_FINITE, parts.join(", ")))
}

/// What turns numbers into words.
struct Page<'a, A> {
    scene: &'a Scene<A>,
    names: &'a Names,
    center: DVec3,
    scale: f64,
}

/// A line; writing to a String cannot fail.
fn line(out: &mut String, indent: usize, text: impl Display) {
    let _ = writeln!(out, "{:indent$}{text}", "");
}

/// Nine digits tell two f32 apart.
pub(super) fn number(x: impl Into<f64>) -> String {
    significant(x.into(), 9, -4..7)
}

pub(super) fn color(c: Rgb) -> String {
    let [r, g, b] = c.to_array().map(number);
    if r == g && g == b { r } else { format!("({r} {g} {b})") }
}

/// Of points and directions, what an f32 knows.
fn vector(v: [f64; 3]) -> String {
    let [x, y, z] = v.map(|x| significant(x, 7, -4..7));
    format!("({x} {y} {z})")
}

fn direction(v: Vec3) -> String {
    vector(v.as_dvec3().to_array())
}

impl<A: Accel> Page<'_, A> {
    fn heading(&self, scene_name: &str, settings: Settings, sample: PixelSample) -> String {
        let [x, y] = sample.pixel;
        let integrator = name(settings.integrator);
        let mut parts = vec![
            format!("pixel {x},{y}"),
            format!("sample {}", sample.index),
            format!("seed {}", settings.seed),
            integrator.to_owned(),
        ];
        parts.extend(departures(&settings));
        parts.push(A::NAME.to_owned());
        let unit = 1.0 / self.scale;
        let mut out = format!("{scene_name}: {}\n", parts.join(", "));
        line(
            &mut out,
            0,
            "Points are in the scene's coordinates. Lengths, densities and throughputs are in render space,",
        );
        line(
            &mut out,
            0,
            format!("whose unit is {} of the scene's; (s,t) has s light and t camera vertices.", figures(unit)),
        );
        out
    }

    /// A point in the scene's coordinates.
    fn place(&self, p: Vec3) -> String {
        vector((p.as_dvec3() / self.scale + self.center).to_array())
    }

    fn light_point(&self, point: &LightPoint) -> String {
        match point {
            LightPoint::Surface(at) => format!("at {}", self.place(at.p())),
            LightPoint::Delta(place) => format!("at {}", self.place(place.p)),
            LightPoint::Infinite(toward) => format!("toward {}", direction(*toward)),
        }
    }

    fn light(&self, id: u32) -> String {
        let kind = match &self.scene.lights[id as usize] {
            Light::Area(_) => "area",
            Light::Point(_) => "point",
            Light::Spot(_) => "spot",
            Light::Directional(_) => "directional",
            Light::Environment(_) => "environment",
        };
        let surface = self.scene.surfaces.iter().position(|s| s.light == Some(id));
        let on = surface.map_or_else(String::new, |i| format!(", {}", self.names.surface(i as u32)));
        format!("light {id} ({kind}{on})")
    }

    fn step(&self, out: &mut String, step: &Step, camera: bool, subpath: usize) {
        match step {
            Step::Camera { from, toward, pdf, .. } => {
                line(out, 0, "");
                line(out, 0, "camera subpath");
                line(out, 2, format!("z1 camera at {} toward {}", self.place(*from), direction(*toward)));
                line(out, 5, format!("density {} of the direction, by one sample of each pixel", number(*pdf)));
            }
            Step::Light { light, pmf, point, toward, pdf_position, pdf_direction, le } => {
                line(out, 0, "");
                line(out, 0, format!("light subpath {subpath}"));
                line(out, 2, format!("y1 {} {}", self.light(*light), self.light_point(point)));
                line(
                    out,
                    5,
                    format!(
                        "chosen with probability {}, with which the point has density {}",
                        number(*pmf),
                        number(*pdf_position)
                    ),
                );
                line(out, 5, format!("toward {} with density {}", direction(*toward), number(*pdf_direction)));
                line(out, 5, format!("emits {}", color(*le)));
            }
            Step::Arrived(arrived) => self.arrived(out, arrived, camera),
            Step::Left { toward, .. } => line(out, 2, format!("leaves the scene toward {}", direction(*toward))),
            Step::Scattered { toward, pdf_fwd, pdf_rev, weight, delta } => {
                let lobe = if *delta { " by a delta lobe" } else { "" };
                line(out, 5, format!("scatters{lobe} toward {}, throughput × {}", direction(*toward), color(*weight)));
                line(out, 5, format!("density {} forth, {} back", number(*pdf_fwd), number(*pdf_rev)));
            }
            Step::Survived(q) if *q == 1.0 => {}
            Step::Survived(q) => line(out, 5, format!("roulette: goes on with probability {}", number(*q))),
            Step::Ended(end) => line(out, 2, ending(*end)),
            Step::LightSampled { light, point, pdf } => {
                let (light, point) = (self.light(*light), self.light_point(point));
                line(out, 5, format!("next event: {light} {point}, density {}", number(*pdf)));
            }
            Step::Made(made) => self.made(out, made),
            Step::Blocked { surface } => line(out, 7, format!("by {}", self.names.surface(*surface))),
        }
    }

    fn arrived(&self, out: &mut String, a: &Arrived, camera: bool) {
        let side = if camera { 'z' } else { 'y' };
        let surface = self.names.surface(a.at.surface());
        let window = if a.through_window { ", through a window" } else { "" };
        line(out, 2, format!("{side}{} {surface} at {}{window}", a.number, self.place(a.at.p())));
        line(out, 5, format!("{}: {}", self.primitive(a), words::bsdf(&a.bsdf)));
        let shading = if a.at.is_flat() { String::new() } else { format!(", shading normal {}", direction(a.at.ns)) };
        let cos = number(a.wo.dot(a.at.ng).abs());
        line(out, 5, format!("normal {}{shading}, cosine {cos}, distance² {}", direction(a.at.ng), number(a.d2)));
        line(out, 5, format!("throughput {}", color(a.beta)));
        if let Some(partial) = a.partial {
            let (direct, earlier) = (number(partial.direct), number(partial.earlier));
            line(out, 5, format!("sums of the weights: direct {direct}, earlier {earlier}"));
        }
        if let Some(id) = a.light {
            line(out, 5, format!("is light {id}"));
        }
    }

    /// What kind of primitive, which, and where on it.
    fn primitive(&self, a: &Arrived) -> String {
        let (index, geometry) = (a.at.primitive(), &self.scene.geometry);
        let kind = match a.geometry {
            GeometryKind::Triangle => "triangle",
            GeometryKind::Quadric => match geometry.quadrics[index as usize].kind {
                QuadricKind::Sphere => "sphere",
                QuadricKind::Disk => "disk",
            },
        };
        let [u, v] = a.at.uv();
        let uv = if geometry.wants_uv { format!(", uv ({} {})", number(u), number(v)) } else { String::new() };
        format!("{kind} {index}{uv}")
    }

    fn made(&self, out: &mut String, m: &Made) {
        let technique = format!("({},{})", m.technique.s, m.technique.t);
        let pixel = m.seen.map_or_else(String::new, |([x, y], _)| format!(" to pixel {x},{y}"));
        let light = if m.technique.s == 0 {
            m.light.map_or_else(String::new, |id| format!(" from light {id}"))
        } else {
            String::new()
        };
        let Some([plain, weighted]) = m.values else {
            return line(out, 5, format!("{technique}{pixel}: nothing goes along the connection"));
        };
        let weight = number(m.weight());
        let seen = match m.visible {
            1.0 => String::new(),
            0.0 => ", blocked".to_owned(),
            x => format!(", of which {} pass", number(x)),
        };
        line(
            out,
            5,
            format!("{technique}{pixel}{light}: {} × weight {weight} = {}{seen}", color(plain), color(weighted)),
        );
    }

    fn sums(&self, out: &mut String, recorder: &Recorder<true>, sample: PixelSample) {
        let [x, y] = sample.pixel;
        line(out, 0, "");
        line(out, 0, format!("to pixel {x},{y}: {}", color(recorder.radiance())));
        let width = self.scene.camera.resolution()[0];
        for splat in recorder.splats() {
            let (x, y, t) = (splat.pixel % width, splat.pixel / width, splat.technique);
            line(out, 0, format!("to pixel {x},{y} by ({},{}): {}", t.s, t.t, color(splat.value)));
        }
        for r in recorder.rejected().1 {
            let why = match r.reason {
                Reason::NotFinite => "not finite".to_owned(),
                Reason::TooLarge => {
                    format!("overflow, not below {}", number(Accumulator::largest(self.scene.brightness)))
                }
            };
            line(out, 0, format!("{why}, kept from the image: technique ({},{})", r.technique.s, r.technique.t));
        }
    }
}

fn ending(end: End) -> &'static str {
    match end {
        End::Length => "ends: no more bounces are allowed",
        End::Black => "ends: the surface scatters nothing",
        End::Grazing => "ends: it runs along the surface",
        End::Absorbed => "ends: absorbed",
        End::Roulette => "ends: roulette",
        End::Class => "ends: the rest is not asked for",
    }
}
