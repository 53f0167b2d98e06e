//! `twinlight render`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::args::{AccelArg, AovArg, RenderArgs};
use super::available::Limit;
use super::progress::{Reporter, duration};
use super::settings::{
    black_technique, departures, idle_options, missing, name, override_desc, pyramid_edges, settings,
};
use super::{Failure, explain, memory, print, pyramid, same_file, stats, status, tell, trace};
use crate::accel::bvh::BvhAccel;
#[cfg(feature = "embree")]
use crate::accel::embree::EmbreeAccel;
use crate::accel::{Accel, AccelOptions};
use crate::film::Accumulator;
use crate::import::{self, ImportError};
use crate::integrator::auto::Plan;
use crate::integrator::{Crop, Integrator, Reason, Settings};
use crate::output::{self, Format, Metadata, Window};
use crate::render::{Aov, AovJob, Extras, RenderJob, Rendered, render_with};
use crate::scene::desc::{IntegratorKind, SceneDesc};
use crate::scene::{Memory, Prepared, Scene, prepare, surface_materials};

/// Reads a scene file whose meshes fit into a limit of memory.
pub fn load(path: &Path, limit: Limit) -> Result<SceneDesc, Failure> {
    refuse_image(path)?;
    import::load_scene_within(path, limit.bytes).map_err(|e| match e {
        ImportError::Scene(e) => Failure::new(status::DATA, e),
        e @ ImportError::Io { .. } => Failure::other(e),
    })
}

/// An image is often given for a scene: both have the scene's name.
fn refuse_image(path: &Path) -> Result<(), Failure> {
    let Some(format) = output::format_of_content(path) else { return Ok(()) };
    let path = path.display();
    let message = format!(
        "{path}: this is an image ({format}), not a scene; did you mean `twinlight compare` or `twinlight convert`?"
    );
    Err(Failure::new(status::DATA, message))
}

pub fn run(args: &RenderArgs) -> Result<(), Failure> {
    let mut phases = stats::Phases::default();
    // Before the outputs, whose default name may be the image's own, or the folder's.
    refuse_image(&args.scene)?;
    let limit = Limit::of(args);
    if args.scene.is_dir() {
        load(&args.scene, limit)?;
    }
    // A replay writes nothing, whatever the command wrote that it is added to.
    let outputs = if args.trace { Vec::new() } else { outputs(args)? };

    let start = Instant::now();
    let mut desc = load(&args.scene, limit)?;
    override_desc(&mut desc, args);
    phases.parse = start.elapsed();
    let crop = crop(args, desc.camera.resolution)?;
    let settings = settings(&desc, args)?;
    let replay = trace::wanted(args, &desc)?;
    memory::check(args, &Memory::of(&desc), crop, kept_edges(args), AOV_EDGES, limit)?;

    let start = Instant::now();
    let prepared = prepare(&desc).map_err(|e| Failure::new(status::DATA, e))?;
    // A scene that turns out to be bad is told about its errors alone.
    for note in desc.notes.iter().chain(&idle_options(&settings, args)).chain(&black_technique(&settings, &prepared)) {
        say(args, &format!("note: {note}"));
    }
    for warning in &prepared.warnings {
        say(args, &format!("warning: {warning}"));
    }
    // A technique rendered alone is known to be a part.
    if settings.only.is_none() {
        for note in missing(settings.integrator, settings.light_paths, &prepared) {
            say(args, &format!("note: {note}"));
        }
    }
    if desc.samples == 1 && AovArg::wanted(&args.aovs).contains(&Aov::Variance) {
        say(args, "note: the variance of one sample per pixel cannot be told and is written as 0; use --spp 2 or more");
    }
    if let Some(sample) = replay {
        let (names, scene) = (trace::Names::of(&desc), args.scene.display().to_string());
        return match args.accel {
            #[cfg(feature = "embree")]
            AccelArg::Embree => trace::run::<EmbreeAccel>(prepared, settings, sample, &names, &scene),
            AccelArg::Bvh => trace::run::<BvhAccel>(prepared, settings, sample, &names, &scene),
        };
    }
    let materials = surface_materials(&desc);
    // The meshes have been taken over into render space: not twice in memory for the whole render.
    desc.surfaces = Vec::new();
    let run = Run { args, desc: &desc, crop, settings, outputs, materials };
    match args.accel {
        #[cfg(feature = "embree")]
        AccelArg::Embree => run.with::<EmbreeAccel>(prepared, phases, start),
        AccelArg::Bvh => run.with::<BvhAccel>(prepared, phases, start),
    }
}

fn say(args: &RenderArgs, text: &str) {
    if !args.quiet {
        tell(&format!("{text}\n"));
    }
}

/// Where images go; every place is tried before the work starts.
fn outputs(args: &RenderArgs) -> Result<Vec<PathBuf>, Failure> {
    let mut outputs = args.output.clone();
    if outputs.is_empty() {
        // Appended: `with_extension` would make `room.exr` of `room.v2.json`.
        let mut name = args.scene.file_stem().unwrap_or(args.scene.as_os_str()).to_owned();
        name.push(".exr");
        outputs.push(name.into());
    }
    let stats = stats_file(args);
    let all: Vec<&PathBuf> = outputs.iter().chain(stats).collect();
    for (i, path) in all.iter().enumerate() {
        let path_is = |what: &str| Err(Failure::usage(format!("{}: {what}; choose another name", path.display())));
        if same_file(path, &args.scene) {
            return path_is("this is the scene itself");
        }
        if all[..i].iter().any(|other| same_file(path, other)) {
            return path_is("two outputs would be written to this file");
        }
    }
    for path in &outputs {
        output::check_writable(path).map_err(Failure::usage)?;
    }
    if let Some(path) = stats {
        output::check_place(path).map_err(Failure::usage)?;
    }
    if let Some(folder) = &args.pyramid {
        pyramid::check(folder)?;
        if let Some(path) = all.iter().find(|path| pyramid::would_write(folder, path)) {
            return Err(Failure::usage(format!(
                "{}: the pyramid writes a file of this name there; choose another name or folder",
                path.display()
            )));
        }
    }
    if !args.aovs.is_empty() && !outputs.iter().any(|path| Format::of(path).is_ok_and(|f| f == Format::Exr)) {
        let why = "--aovs writes its images into an EXR, and none is written: add -o NAME.exr";
        return Err(Failure::usage(why.to_owned()));
    }
    let any_png = args.pyramid.is_some() || outputs.iter().any(|path| Format::of(path).is_ok_and(|f| f == Format::Png));
    if let Some(stops) = args.exposure.filter(|_| !any_png) {
        return Err(Failure::usage(format!(
            "--exposure {stops} brightens PNG files, and none is written: an EXR stays linear; add -o NAME.png"
        )));
    }
    Ok(outputs)
}

/// The file that statistics go to; `None` for standard output and where there are none to write.
fn stats_file(args: &RenderArgs) -> Option<&PathBuf> {
    args.stats.as_ref().filter(|path| *path != Path::new("-"))
}

fn crop(args: &RenderArgs, [width, height]: [u32; 2]) -> Result<Crop, Failure> {
    let Some(crop) = args.crop else { return Ok(Crop::full([width, height])) };
    let [x0, y0, x1, y1] = crop.0;
    if x1 > width || y1 > height {
        return Err(Failure::usage(format!(
            "--crop {x0},{y0},{x1},{y1} reaches outside the image: it is {width} × {height} pixels, the ends of a \
             crop are exclusive"
        )));
    }
    Ok(Crop { x0, y0, x1, y1 })
}

/// Longest paths that auxiliary images tell apart, in edges.
const AOV_EDGES: u32 = 6;

/// Longest paths whose techniques are kept apart, for the pyramid or for auxiliary images.
fn kept_edges(args: &RenderArgs) -> Option<u32> {
    let wanted = AovArg::wanted(&args.aovs);
    let depths = match (wanted.contains(&Aov::PerDepth), wanted.contains(&Aov::Direct)) {
        (true, _) => Some(AOV_EDGES),
        (_, true) => Some(2),
        _ => None,
    };
    pyramid_edges(args).max(depths)
}

/// Threads where the command line names no number. Asked once, so that what is told is what runs.
fn logical_processors() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get)
}

/// A render whose questions are all answered but for the backend.
struct Run<'a> {
    args: &'a RenderArgs,
    desc: &'a SceneDesc,
    crop: Crop,
    settings: Settings,
    outputs: Vec<PathBuf>,
    /// By surface, for the auxiliary images.
    materials: Vec<u32>,
}

impl Run<'_> {
    fn with<A: Accel>(&self, prepared: Prepared, mut phases: stats::Phases, start: Instant) -> Result<(), Failure> {
        let args = self.args;
        let wanted = AovArg::wanted(&args.aovs);
        let scale = prepared.scale;
        let delta_points = wanted.contains(&Aov::Lights);
        let options = AccelOptions { threads: args.threads.unwrap_or(0), delta_points };
        let scene: Scene<A> = Scene::build(prepared, options).map_err(Failure::other)?;
        phases.build = start.elapsed();

        let start = Instant::now();
        let job = RenderJob {
            settings: self.settings,
            samples: self.desc.samples,
            crop: self.crop,
            threads: args.threads.map_or_else(logical_processors, |n| n as usize),
            pyramid: kept_edges(args),
        };
        self.announce(&job, &scene.accel.describe());
        let reporter = Reporter::new(args.quiet, job.samples);
        let extras = Extras { variance: wanted.contains(&Aov::Variance) };
        let mut rendered = render_with(&scene, &job, extras, &|p| {
            reporter.update(p);
            true
        })
        .map_err(Failure::other)?;
        let aovs = AovJob {
            settings: self.settings,
            samples: job.samples,
            crop: self.crop,
            threads: job.threads,
            wanted: &wanted,
            scale,
            materials: &self.materials,
        };
        let mut layers = aovs.of_scene(&scene).map_err(Failure::other)?;
        layers.extend(aovs.of_picture(&rendered, AOV_EDGES));
        // Longer paths may have been kept for the one than were asked for by the other.
        let edges = pyramid_edges(args).unwrap_or(0);
        rendered.techniques.retain(|t, _| t.s + t.t <= edges + 1);
        reporter.finish();
        phases.render = start.elapsed();

        let start = Instant::now();
        let metadata = self.metadata(&scene.accel.describe(), rendered.plan.as_ref());
        let exposure = args.exposure.unwrap_or(0.0);
        for path in &self.outputs {
            output::write_with_layers(path, &rendered.image, &layers, &metadata, exposure).map_err(Failure::other)?;
        }
        let pyramid = match &args.pyramid {
            Some(folder) => Some(pyramid::write(folder, &rendered.techniques, &metadata, exposure)?),
            None => None,
        };
        phases.write = start.elapsed();
        if args.stats.is_some() {
            let json = stats::json(&job, self.desc, &scene.accel.describe(), &rendered, &phases);
            let text = format!("{json:#}\n");
            match stats_file(args) {
                Some(path) => output::write_atomically(path, text.as_bytes()).map_err(Failure::other)?,
                None => print(&text),
            }
        }
        if args.explain {
            print(&explain::page(&self.settings, rendered.plan.as_ref(), &scene.needs));
        }
        self.summary(&rendered, &phases);
        if let Some(line) = pyramid {
            say(args, &line);
        }
        verdict(&rendered, self.settings.seed, Accumulator::largest(scene.brightness))
    }

    /// One line of what is about to be done, and by what.
    fn announce(&self, job: &RenderJob, accel: &str) {
        let [width, height] = self.desc.camera.resolution;
        let integrator = name(self.settings.integrator);
        let mut parts = vec![format!("{width} × {height} pixels")];
        if self.crop != Crop::full([width, height]) {
            let Crop { x0, y0, x1, y1 } = self.crop;
            parts.push(format!("of these {x0},{y0} to {x1},{y1}"));
        }
        parts.push(format!("{} spp", self.desc.samples));
        parts.push(match self.desc.integrator.kind {
            IntegratorKind::Auto if self.settings.integrator != Integrator::Auto => format!("auto = {integrator}"),
            _ => integrator.to_owned(),
        });
        parts.extend(departures(&self.settings));
        parts.push(super::count(job.threads, "thread", "threads"));
        // Last: its words may hold commas.
        parts.push(accel.to_owned());
        say(self.args, &format!("{}: {}", self.args.scene.display(), parts.join(", ")));
    }

    /// What made the image, and only what the same command makes again: nothing that varies from run to run.
    fn metadata(&self, accel: &str, plan: Option<&Plan>) -> Metadata {
        let s = &self.settings;
        let resolution = self.desc.camera.resolution;
        let lower = |x: &dyn std::fmt::Debug| format!("{x:?}").to_lowercase();
        let mut attributes = vec![
            ("twinlight:version", env!("CARGO_PKG_VERSION").into()),
            ("twinlight:git", env!("TWINLIGHT_GIT_HASH").into()),
            ("twinlight:scene", format!("{:032x}", self.desc.fingerprint)),
            ("twinlight:spp", self.desc.samples.to_string()),
            ("twinlight:seed", s.seed.to_string()),
            ("twinlight:sampler", lower(&s.sampler)),
            ("twinlight:integrator", lower(&s.integrator)),
            ("twinlight:heuristic", lower(&s.heuristic)),
            ("twinlight:max_bounces", s.max_bounces.to_string()),
            ("twinlight:roulette", s.roulette.to_string()),
            ("twinlight:accel", accel.into()),
        ];
        if s.integrator != Integrator::Auto {
            attributes.push(("twinlight:light_paths", s.light_paths.to_string()));
            attributes.push(("twinlight:connections", s.connections.to_string()));
        }
        if let Some(plan) = plan {
            attributes.push(("twinlight:plan", explain::json(plan).to_string()));
        }
        if let Some(n) = s.roulette_after {
            attributes.push(("twinlight:roulette_after", n.to_string()));
        }
        if let Some(t) = s.only {
            attributes.push((pyramid::TECHNIQUE, pyramid::technique_text(t, s.weighted)));
        }
        let window = (self.crop != Crop::full(resolution))
            .then_some(Window { full: resolution, origin: [self.crop.x0, self.crop.y0] });
        let attributes = attributes.into_iter().map(|(k, v)| (k.to_string(), v)).collect();
        Metadata { attributes, window, ..Metadata::default() }
    }

    fn summary(&self, rendered: &Rendered, phases: &stats::Phases) {
        let seconds = phases.render.as_secs_f64();
        let names: Vec<String> = self.outputs.iter().map(|p| p.display().to_string()).collect();
        say(
            self.args,
            &format!(
                "{}: {} spp in {} ({:.2} Mrays/s)",
                names.join(", "),
                self.desc.samples,
                duration(seconds),
                rendered.rays.total() as f64 / seconds.max(1e-9) * 1e-6
            ),
        );
    }
}

/// Contributions that were kept from the film are told, and decide the exit status.
fn verdict(rendered: &Rendered, seed: u64, largest: f32) -> Result<(), Failure> {
    if rendered.rejected == 0 && rendered.overflows == 0 {
        return Ok(());
    }
    let mut message = format!(
        "{} non-finite and {} overflowing contributions were left out; the image was written without them",
        rendered.rejected, rendered.overflows
    );
    for r in &rendered.rejected_first {
        message += &format!(
            "\n  pixel {},{} sample {} technique ({},{}) seed {seed}{}",
            r.pixel[0],
            r.pixel[1],
            r.sample,
            r.technique.s,
            r.technique.t,
            match r.reason {
                Reason::NotFinite => "",
                Reason::TooLarge => ": overflow",
            }
        );
    }
    if rendered.overflows > 0 {
        message += &format!(
            "\nan overflow is a contribution of {largest:.1e} or more, too bright for a film that suits the scene's lights: \
             something shines, or is focused, that much more than they let expect; move surfaces off point and spot lights, or \
             make a light that is all but a point larger"
        );
    }
    if let Some(r) = rendered.rejected_first.first() {
        message += &format!(
            "\nto see how one comes about, add --trace --pixel {},{} --sample {} to the command",
            r.pixel[0], r.pixel[1], r.sample
        );
    }
    Err(Failure::new(status::NON_FINITE, message))
}
