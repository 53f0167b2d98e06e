//! `twinlight bench`: the arguments, what they ask for, and where the reports go.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{ArgGroup, Args};

use super::args::{AccelArg, IntegratorArg, Size, whole};
use super::available::{Limit, size};
use super::render::load;
use super::{Failure, memory, print, same_file, settings, status, tell};
use crate::bench::report::{HEADING, Report, table};
use crate::bench::{Backend, Configuration, Effort, Given, Plan, ReferenceJob, SceneJob, bench_scene};
use crate::film::BYTES_PER_PIXEL;
use crate::integrator::Settings;
use crate::output::{self, Format};
use crate::scene::desc::{IntegratorKind, SceneDesc};
use crate::scene::{Memory, prepare};

#[derive(Debug, Args)]
#[command(group = ArgGroup::new("given").args(["reference", "references"]))]
pub struct BenchArgs {
    /// Scene files (JSON)
    #[arg(required = true, value_name = "SCENE")]
    pub scenes: Vec<PathBuf>,
    /// Integrators to compare; the first configuration is what others are compared with
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "path,bdpt")]
    pub integrators: Vec<IntegratorArg>,
    /// What answers rays
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = AccelArg::DEFAULT)]
    pub accels: Vec<AccelArg>,
    /// Samples per pixel
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_negative_numbers = true,
        default_value = "4,16,64",
        value_parser = whole(1, u32::MAX),
        conflicts_with = "seconds"
    )]
    pub spp: Vec<u32>,
    /// Budgets of processor seconds, instead of --spp: a pilot finds how many samples they are, once, before the runs
    #[arg(long, value_name = "LIST", value_delimiter = ',', allow_negative_numbers = true, value_parser = budget)]
    pub seconds: Vec<f64>,
    /// Independent runs of each configuration
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value = "5", value_parser = whole(1, 1000))]
    pub seeds: u32,
    /// Seed of the first run; the others' follow
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        default_value = "1001",
        value_parser = whole(0, u32::MAX)
    )]
    pub first_seed: u32,
    /// The scene's reference, of the runs' size [default: rendered by bdpt]
    #[arg(long, value_name = "FILE.exr")]
    pub reference: Option<PathBuf>,
    /// Folder with a reference for each scene, named like it: NAME.exr
    #[arg(long, value_name = "DIR")]
    pub references: Option<PathBuf>,
    /// relMSE of the references that are given, which is subtracted from those of the runs
    #[arg(long, value_name = "X", requires = "given", allow_negative_numbers = true, value_parser = noise)]
    pub reference_noise: Option<f64>,
    /// Samples per pixel of each of the two halves that a reference is rendered in [default: 16 times the most of a run]
    #[arg(
        long,
        value_name = "N",
        conflicts_with = "given",
        allow_negative_numbers = true,
        value_parser = whole(1, u32::MAX)
    )]
    pub reference_spp: Option<u32>,
    /// Image size in pixels [default: the scene's]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Largest number of scattering events on a path [default: the scene's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(0, 1_000_000))]
    pub max_bounces: Option<u32>,
    /// Threads of each run; references are rendered by all there are
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value = "1", value_parser = whole(1, 4096))]
    pub threads: u32,
    /// Report to write, .json, .csv or .html; or a folder for all three, bench.json, bench.csv and bench.html. May be given
    /// several times
    #[arg(short, long = "output", value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// Say nothing but the table and errors
    #[arg(short, long)]
    pub quiet: bool,
}

/// A budget of processor time.
fn budget(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (1e-3..=1e6).contains(&seconds) => Ok(seconds),
        _ => Err("write it as a number of seconds from 0.001 to 1000000, for example 1.5".into()),
    }
}

/// A relMSE.
fn noise(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(noise) if (0.0..=1e6).contains(&noise) => Ok(noise),
        _ => Err("write it as a relMSE, 0 or more (at most 1000000), for example 1e-5".into()),
    }
}

pub fn run(args: &BenchArgs) -> Result<(), Failure> {
    refuse_twice("--integrators", &args.integrators, |x| format!("{x:?}").to_lowercase())?;
    refuse_twice("--accels", &args.accels, |x| format!("{x:?}").to_lowercase())?;
    refuse_twice("--spp", &args.spp, u32::to_string)?;
    refuse_twice("--seconds", &args.seconds, f64::to_string)?;
    if let (Some(file), 2..) = (&args.reference, args.scenes.len()) {
        return Err(Failure::usage(format!(
            "--reference {}: it can be that of one scene, and there are {}; put one for each into a folder and give \
             --references",
            file.display(),
            args.scenes.len()
        )));
    }
    let names = names(&args.scenes)?;
    let outputs = outputs(args, &names)?;
    // Every scene and reference is tried before the time for the first is spent, and read again when its turn comes: what
    // the others take would count as its memory.
    for (path, name) in args.scenes.iter().zip(&names) {
        Asked::read(args, path, name)?;
    }
    let mut report = Report::new(args.threads as usize, args.seeds);
    print(&format!("{}\n{HEADING}\n", report.intervals()));
    for (path, name) in args.scenes.iter().zip(&names) {
        let Asked { desc, plan, reference, notes } = Asked::read(args, path, name)?;
        let job = SceneJob {
            name: name.clone(),
            file: path.display().to_string(),
            desc: &desc,
            plan: &plan,
            reference,
            notes,
        };
        let mut say = |text: &str| {
            if !args.quiet {
                tell(&format!("{name}: {text}\n"));
            }
        };
        let scene = bench_scene(&job, &mut say).map_err(Failure::other)?;
        print(&table(&scene));
        report.scenes.push(scene);
        // After each: what is done is not lost with what comes after.
        outputs.write(&report)?;
    }
    match report.left_out() {
        [0, 0] => Ok(()),
        [non_finite, overflows] => Err(Failure::new(
            status::NON_FINITE,
            format!(
                "{non_finite} non-finite and {overflows} overflowing contributions were left out of the runs; the reports count \
                 them for each, and `twinlight render` with a run's settings and seed names them"
            ),
        )),
    }
}

/// A list is a set: what stands in it twice would be two rows that say one thing.
fn refuse_twice<T: PartialEq>(option: &str, list: &[T], text: impl Fn(&T) -> String) -> Result<(), Failure> {
    match list.iter().enumerate().find(|(i, x)| list[..*i].contains(x)) {
        None => Ok(()),
        Some((_, x)) => {
            let x = text(x);
            Err(Failure::usage(format!("{option}: {x} is given twice; give it once, and --seeds for more runs of it")))
        }
    }
}

/// The scenes' names: those of their files, or of their folders where the file is plainly called `scene`.
fn names(scenes: &[PathBuf]) -> Result<Vec<String>, Failure> {
    let name = |path: &PathBuf| {
        let stem = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
        let folder =
            path.canonicalize().ok().and_then(|p| Some(p.parent()?.file_name()?.to_string_lossy().into_owned()));
        if stem == "scene" { folder.unwrap_or(stem) } else { stem }
    };
    let names: Vec<String> = scenes.iter().map(name).collect();
    match names.iter().enumerate().find_map(|(i, name)| Some((i, names[..i].iter().position(|n| n == name)?))) {
        None => Ok(names),
        Some((i, j)) => Err(Failure::usage(format!(
            "{} and {} would both be named `{}` in the reports; give each scene once, or rename one",
            scenes[j].display(),
            scenes[i].display(),
            names[i]
        ))),
    }
}

/// Where the reports go.
#[derive(Debug, Default)]
struct Outputs {
    /// A folder that is made when there is something to put into it.
    folders: Vec<PathBuf>,
    files: Vec<(PathBuf, Kind)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Json,
    Csv,
    Html,
}

impl Kind {
    const ALL: [(Self, &'static str); 3] =
        [(Self::Json, "bench.json"), (Self::Csv, "bench.csv"), (Self::Html, "bench.html")];

    fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "json" => Some(Self::Json),
            "csv" => Some(Self::Csv),
            "html" => Some(Self::Html),
            _ => None,
        }
    }
}

/// Checks all outputs before the work starts. Leaves nothing behind.
fn outputs(args: &BenchArgs, names: &[String]) -> Result<Outputs, Failure> {
    let mut out = Outputs::default();
    for path in &args.output {
        let shown = path.display();
        match Kind::of(path) {
            Some(kind) if !path.is_dir() => {
                output::check_place(path).map_err(Failure::usage)?;
                out.files.push((path.clone(), kind));
            }
            // A folder by being there, or by its name.
            _ if path.is_dir() || path.extension().is_none() => {
                let place = if path.is_dir() { path.join(Kind::ALL[0].1) } else { path.clone() };
                output::check_place(&place).map_err(Failure::usage)?;
                out.folders.push(path.clone());
                out.files.extend(Kind::ALL.map(|(kind, name)| (path.join(name), kind)));
            }
            _ => {
                return Err(Failure::usage(format!(
                    "{shown}: a report is a .json, .csv or .html file, or a folder for all three; give it such a name"
                )));
            }
        }
    }
    for (i, (path, _)) in out.files.iter().enumerate() {
        let refuse = |what: &str| Err(Failure::usage(format!("{}: {what}; choose another name", path.display())));
        if args.scenes.iter().any(|scene| same_file(path, scene)) {
            return refuse("this is a scene itself");
        }
        if out.files[..i].iter().any(|(other, _)| path == other || same_file(path, other)) {
            return refuse("two reports would be written to this file");
        }
        let references = names.iter().zip(&args.scenes).filter_map(|(name, _)| reference_file(args, name));
        if references.into_iter().any(|reference| same_file(path, &reference)) {
            return refuse("this is a reference");
        }
    }
    Ok(out)
}

impl Outputs {
    fn write(&self, report: &Report) -> Result<(), Failure> {
        for folder in self.folders.iter().filter(|folder| !folder.is_dir()) {
            fs::create_dir(folder)
                .map_err(|e| Failure::other(format!("{}: cannot make the reports' folder: {e}", folder.display())))?;
        }
        for (path, kind) in &self.files {
            let text = match kind {
                Kind::Json => format!("{:#}\n", report.json()),
                Kind::Csv => report.csv(),
                Kind::Html => report.html(),
            };
            output::write_atomically(path, text.as_bytes()).map_err(Failure::other)?;
        }
        Ok(())
    }
}

/// A scene's reference, if one is given.
fn reference_file(args: &BenchArgs, name: &str) -> Option<PathBuf> {
    args.reference.clone().or_else(|| Some(args.references.as_ref()?.join(format!("{name}.exr"))))
}

/// A scene with all that is asked for of it.
struct Asked {
    desc: SceneDesc,
    plan: Plan,
    reference: ReferenceJob,
    notes: Vec<String>,
}

impl Asked {
    fn read(args: &BenchArgs, path: &Path, name: &str) -> Result<Self, Failure> {
        let limit = Limit::sensible();
        let mut desc = load(path, limit)?;
        if let Some(Size(size)) = args.size {
            desc.camera.resolution = size;
        }
        if let Some(bounces) = args.max_bounces {
            desc.integrator.max_bounces = bounces;
        }
        let plan = plan(args, &desc);
        check_memory(args, path, &desc, plan.configurations.len(), limit)?;
        let mut notes = desc.notes.clone();
        let reference = match reference_file(args, name) {
            Some(file) => {
                let (given, said) = given(args, &file, path, &desc)?;
                notes.extend(said);
                ReferenceJob::Given(given)
            }
            None => ReferenceJob::Made(settings_of(&desc, IntegratorKind::Bdpt), args.reference_spp),
        };
        let prepared = prepare(&desc).map_err(|e| Failure::new(status::DATA, e))?;
        notes.extend(prepared.warnings.iter().map(ToString::to_string));
        if let ReferenceJob::Made(made, _) = &reference {
            let missing = settings::missing(made.integrator, made.light_paths, &prepared);
            notes.extend(missing.iter().map(|what| format!("the reference, by bdpt: {what}")));
        }
        for &integrator in &args.integrators {
            let by = settings_of(&desc, integrator.into());
            for what in settings::missing(by.integrator, by.light_paths, &prepared) {
                notes.push(format!(
                    "{}: {what}; what is missing counts as error, and the energy tells how much it is",
                    word(integrator)
                ));
            }
        }
        Ok(Self { desc, plan, reference, notes })
    }
}

/// An integrator as it is asked for.
fn word(integrator: IntegratorArg) -> &'static str {
    match integrator {
        IntegratorArg::Auto => "auto",
        IntegratorArg::Bdpt => "bdpt",
        IntegratorArg::Path => "path",
        IntegratorArg::Light => "light",
    }
}

/// What a scene is rendered by, with this integrator.
fn settings_of(desc: &SceneDesc, kind: IntegratorKind) -> Settings {
    let integrator = settings::integrator_of(kind);
    let (light_paths, connections) = settings::usual_subpaths(integrator);
    Settings {
        integrator,
        max_bounces: desc.integrator.max_bounces,
        roulette: desc.integrator.russian_roulette,
        heuristic: desc.integrator.heuristic,
        light_paths,
        connections,
        sampler: desc.sampler.kind,
        ..Settings::default()
    }
}

fn plan(args: &BenchArgs, desc: &SceneDesc) -> Plan {
    let efforts: Vec<Effort> = if args.seconds.is_empty() {
        args.spp.iter().map(|n| Effort::Samples(*n)).collect()
    } else {
        args.seconds.iter().map(|s| Effort::Seconds(*s)).collect()
    };
    let mut configurations = Vec::new();
    for &integrator in &args.integrators {
        for &accel in &args.accels {
            let backend = match accel {
                #[cfg(feature = "embree")]
                AccelArg::Embree => Backend::Embree,
                AccelArg::Bvh => Backend::Bvh,
            };
            let (settings, integrator) = (settings_of(desc, integrator.into()), word(integrator));
            configurations.extend(efforts.iter().map(|&effort| Configuration {
                integrator,
                settings,
                backend,
                effort,
            }));
        }
    }
    Plan { configurations, repetitions: args.seeds, first_seed: args.first_seed, threads: args.threads as usize }
}

/// Bytes of a pixel of an image: three floats.
const IMAGE: u64 = 12;

/// Refuses what would not fit into memory: the scene on the greediest of the accelerators, with the images that are kept.
fn check_memory(args: &BenchArgs, path: &Path, desc: &SceneDesc, kept: usize, limit: Limit) -> Result<(), Failure> {
    let [width, height] = desc.camera.resolution.map(u64::from);
    // Beside the film: an image of the run, the reference, its noise and its halves, and one of each configuration.
    let images = BYTES_PER_PIXEL + IMAGE * (5 + kept as u64);
    let scene = Memory::of(desc);
    let peak = args.accels.iter().map(|accel| scene.peak(accel.footprint(), width * height * images).1).max();
    // The description stays: it is built from again and again.
    let peak = peak.unwrap_or(0).saturating_add(scene.read).saturating_add(memory::PROGRAM);
    if peak > limit.bytes {
        return Err(Failure::usage(format!(
            "{}: its runs take about {} at once, more than {}; use a smaller --size, fewer configurations or a simpler scene",
            path.display(),
            size(peak),
            limit.words()
        )));
    }
    Ok(())
}

/// Reads a reference and sees whether it can be one of the scene's; with what to note about it.
fn given(args: &BenchArgs, file: &Path, scene: &Path, desc: &SceneDesc) -> Result<(Given, Vec<String>), Failure> {
    let (shown, mut notes) = (file.display(), Vec::new());
    let (image, metadata) = output::read_image_and_metadata(file).map_err(Failure::image)?;
    if output::format_of_content(file) != Some(Format::Exr) {
        return Err(Failure::new(
            status::DATA,
            format!("{shown}: a reference has to be linear and unclipped, an EXR; render it to one"),
        ));
    }
    let [width, height] = desc.camera.resolution;
    if metadata.window.is_some_and(|w| w.full != [image.width, image.height]) {
        return Err(Failure::new(
            status::DATA,
            format!("{shown}: this is a crop, and runs render whole images; give a reference that is whole"),
        ));
    }
    if [image.width, image.height] != [width, height] {
        let (w, h) = (image.width, image.height);
        return Err(Failure::new(
            status::DATA,
            format!(
                "{shown}: the reference has {w} × {h} pixels, the image of {} {width} × {height}; give --size {w}x{h}, or a \
                 reference of that size",
                scene.display()
            ),
        ));
    }
    let said = |name: &str| Some(&metadata.attributes.iter().find(|(n, _)| n == &format!("twinlight:{name}"))?.1);
    let seed = said("seed").and_then(|seed| seed.parse::<u64>().ok());
    let first = u64::from(args.first_seed);
    if let Some(seed) = seed.filter(|seed| (first..first + u64::from(args.seeds)).contains(seed)) {
        return Err(Failure::usage(format!(
            "{shown}: it was rendered with seed {seed}, which is a run's, too: common samples would look like no error; give \
             another --first-seed"
        )));
    }
    if said("scene").is_some_and(|scene| *scene != format!("{:032x}", desc.fingerprint)) {
        notes.push(format!("{shown} was rendered of another scene file, or of another version of it"));
    }
    let bounces = desc.integrator.max_bounces;
    if let Some(other) = said("max_bounces").filter(|n| **n != bounces.to_string()) {
        notes.push(format!("{shown} was rendered with max_bounces {other}, the runs have {bounces}"));
    }
    let bad = image.rgb.iter().filter(|pixel| pixel.iter().any(|c| !c.is_finite())).count();
    if bad > 0 {
        let pixels = super::count(bad, "pixel", "pixels");
        notes.push(format!("{shown} has {pixels} that are not finite and are left out of all errors"));
    }
    Ok((Given { image, file: shown.to_string(), noise: args.reference_noise }, notes))
}
