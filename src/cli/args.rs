//! The arguments.

use std::path::PathBuf;
use std::str::FromStr;

use clap::{Args, Parser, Subcommand, ValueEnum};

use super::bench::BenchArgs;
use crate::integrator::Technique;
use crate::render::Aov;
use crate::sampling::SamplerKind;
use crate::scene::desc::{Heuristic, IntegratorKind};

/// Bidirectional path tracing with multiple importance sampling, on the CPU.
#[derive(Debug, Parser)]
#[command(
    version,
    max_term_width = 110,
    after_help = "Exit status: 0 done, 2 usage, 65 bad scene or asset, \
    70 non-finite contributions seen (image written), 1 anything else."
)]
pub struct Cli {
    #[command(subcommand)]
    pub command: Command,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene to EXR and PNG files
    Render(RenderArgs),
    /// Say what is in a scene, what it needs and what will be skipped
    Info(InfoArgs),
    /// Measure how far an image is from a reference
    Compare(CompareArgs),
    /// Convert an image between EXR and PNG
    Convert(ConvertArgs),
    /// Render scenes at the edge of what numbers can hold, and judge them
    #[command(after_help = crate::stress::LEGEND)]
    Stress(StressArgs),
    /// Say how far rounding takes a scene's contributions and weights
    Precision(PrecisionArgs),
    /// Measure error against time: scenes by integrators, accelerators and numbers of samples, with intervals
    Bench(BenchArgs),
}

#[derive(Debug, Args)]
pub struct RenderArgs {
    /// Scene file (JSON)
    pub scene: PathBuf,
    /// Image to write, .exr (linear) or .png (sRGB); may be given several times [default: the scene's name with
    /// .exr in the current folder]
    #[arg(short, long = "output", value_name = "OUT")]
    pub output: Vec<PathBuf>,
    /// Samples per pixel [default: the scene's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1, u32::MAX))]
    pub spp: Option<u32>,
    /// Integrator [default: the scene's]
    #[arg(long, value_name = "X")]
    pub integrator: Option<IntegratorArg>,
    /// What answers rays
    #[arg(long, value_name = "X", default_value = AccelArg::DEFAULT)]
    pub accel: AccelArg,
    /// Threads to build and to render with [default: one per logical processor]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1, 4096))]
    pub threads: Option<u32>,
    /// Seed of everything random [default: the scene's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = seed)]
    pub seed: Option<u64>,
    /// Largest number of scattering events on a path; 0 is emitted light only, 1 direct light [default: the scene's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(0, 1_000_000))]
    pub max_bounces: Option<u32>,
    /// Image size in pixels [default: the scene's]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Render these pixels only; the ends are exclusive
    #[arg(long, value_name = "x0,y0,x1,y1")]
    pub crop: Option<CropArg>,
    /// Refuse what would take more memory than this, for example 8G or 512M [default: 80 % of what is available]
    #[arg(long, value_name = "SIZE")]
    pub max_memory: Option<MemoryArg>,
    /// Write times, ray counts and settings as JSON; - is standard output
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Say nothing but errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Stops by which PNG images are brightened [default: 0]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = stops)]
    pub exposure: Option<f32>,
    /// How techniques share a path [default: the scene's]
    #[arg(long, value_name = "X", conflicts_with = "unweighted")]
    pub heuristic: Option<HeuristicArg>,
    /// Point set [default: the scene's]
    #[arg(long, value_name = "X")]
    pub sampler: Option<SamplerArg>,
    /// Never end paths at random before --max-bounces
    #[arg(long)]
    pub no_roulette: bool,
    /// Let the first N scatterings of a subpath be free of roulette [default: 3 for path, 2 for bdpt and light]
    #[arg(
        long,
        value_name = "N",
        allow_negative_numbers = true,
        value_parser = whole(0, u32::MAX),
        conflicts_with = "no_roulette"
    )]
    pub roulette_after: Option<u32>,
    /// Light subpaths per camera sample (bdpt, light); 0 turns bdpt into path tracing [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(0, 1024))]
    pub light_paths: Option<u32>,
    /// How many of them each camera vertex connects to (bdpt) [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(0, 1024))]
    pub connections: Option<u32>,
    /// Render one technique alone: s light vertices, t camera vertices (the camera's own included)
    #[arg(long, value_name = "s,t")]
    pub technique: Option<TechniqueArg>,
    /// Leave out the MIS weights (with --technique)
    #[arg(long, requires = "technique")]
    pub unweighted: bool,
    /// Write an image per technique, weighted, and a sheet of them all into this folder; those of an earlier run that
    /// are not written again are removed
    #[arg(long, value_name = "DIR")]
    pub pyramid: Option<PathBuf>,
    /// Write auxiliary images into the EXR, as layers beside the picture
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub aovs: Vec<AovArg>,
    /// Longest paths of the pyramid, in edges [default: 6]
    #[arg(
        long,
        value_name = "N",
        requires = "pyramid",
        allow_negative_numbers = true,
        value_parser = whole(1, 64)
    )]
    pub pyramid_edges: Option<u32>,
    /// Say what is skipped and, of auto, which techniques it has chosen and why
    #[arg(long, conflicts_with = "trace")]
    pub explain: bool,
    /// Replay one sample and print every vertex, density and weight of it, for this pixel; no file is written
    #[arg(long, requires = "pixel")]
    pub trace: bool,
    /// The pixel to replay, counted from 0,0 at the top left (with --trace)
    #[arg(long, value_name = "x,y", requires = "trace", allow_hyphen_values = true)]
    pub pixel: Option<PixelArg>,
    /// The sample to replay, counted from 0 [default: 0] (with --trace)
    #[arg(long, value_name = "N", requires = "trace", allow_negative_numbers = true, value_parser = whole(0, u32::MAX))]
    pub sample: Option<u32>,
}

#[derive(Debug, Args)]
pub struct InfoArgs {
    /// Scene file (JSON)
    pub scene: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct StressArgs {
    /// The cases that take seconds, with few samples; the default
    #[arg(long, conflicts_with = "full")]
    pub quick: bool,
    /// All cases, with more samples
    #[arg(long)]
    pub full: bool,
    /// Only cases with one of these texts in their names
    #[arg(long, value_name = "TEXT")]
    pub case: Vec<String>,
    /// Write a report, .html, .json or .md
    #[arg(short, long, value_name = "REPORT")]
    pub output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub struct PrecisionArgs {
    /// Scene file (JSON)
    pub scene: PathBuf,
    /// Samples per pixel
    #[arg(long, value_name = "N", allow_negative_numbers = true, default_value = "1", value_parser = whole(1, 1024))]
    pub spp: u32,
    /// Image size in pixels [default: the scene's]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Largest number of scattering events on a path [default: the scene's]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(0, 1_000_000))]
    pub max_bounces: Option<u32>,
    /// What answers rays
    #[arg(long, value_name = "X", default_value = AccelArg::DEFAULT)]
    pub accel: AccelArg,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct CompareArgs {
    /// Image to judge
    pub image: PathBuf,
    /// Image to judge it by
    pub reference: PathBuf,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
    /// Write a picture of the signed difference, red where the image is brighter, blue where it is darker: mean over
    /// 4×4 pixels, relative to the reference, ±10 % at full colour unless --range says otherwise
    #[arg(long, value_name = "FILE.png")]
    pub difference: Option<PathBuf>,
    /// Percent of the reference that have full colour in the picture of the difference [default: 10]
    #[arg(long, value_name = "PERCENT", requires = "difference", allow_negative_numbers = true, value_parser = percent)]
    pub range: Option<f32>,
}

#[derive(Debug, Args)]
pub struct ConvertArgs {
    /// Image to read (.exr, .png)
    pub input: PathBuf,
    /// Image to write (.exr, .png)
    pub output: PathBuf,
    /// The layer of an EXR to take, depth say, instead of the picture
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,
    /// Stops by which a PNG is brightened [default: 0]
    #[arg(long, value_name = "STOPS", allow_negative_numbers = true, value_parser = stops)]
    pub exposure: Option<f32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum IntegratorArg {
    Auto,
    Bdpt,
    Path,
    Light,
}

impl From<IntegratorArg> for IntegratorKind {
    fn from(arg: IntegratorArg) -> Self {
        match arg {
            IntegratorArg::Auto => Self::Auto,
            IntegratorArg::Bdpt => Self::Bdpt,
            IntegratorArg::Path => Self::Path,
            IntegratorArg::Light => Self::Light,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AovArg {
    /// All of these
    All,
    /// What share of light the first surface scatters to the camera: albedo.R,G,B
    Albedo,
    /// Its geometric normal, world axes: normal.X,Y,Z
    Normal,
    /// Its shading normal: shading_normal.X,Y,Z
    ShadingNormal,
    /// Its distance along the optical axis, scene units: depth.Z
    Depth,
    /// 1 + the index of the primitive at the pixel's centre: primitive.id
    Primitive,
    /// 1 + the index of the material there: material.id
    Material,
    /// Light that scattered not at all, once, more often: emission, direct, indirect
    Direct,
    /// Light by number of edges of its path, 1 to 6: depth1 to depth6
    PerDepth,
    /// Estimated variance of each pixel: variance.R,G,B
    Variance,
    /// Samples of each pixel: samples.count
    Samples,
    /// Where point and spot lights are seen: lights.id, lights.visible
    Lights,
}

impl AovArg {
    /// What these ask for, each once.
    pub fn wanted(args: &[Self]) -> Vec<Aov> {
        let each = |arg: &Self| match arg {
            Self::All => vec![],
            Self::Albedo => vec![Aov::Albedo],
            Self::Normal => vec![Aov::Normal],
            Self::ShadingNormal => vec![Aov::ShadingNormal],
            Self::Depth => vec![Aov::Depth],
            Self::Primitive => vec![Aov::Primitive],
            Self::Material => vec![Aov::Material],
            Self::Direct => vec![Aov::Direct],
            Self::PerDepth => vec![Aov::PerDepth],
            Self::Variance => vec![Aov::Variance],
            Self::Samples => vec![Aov::SampleCount],
            Self::Lights => vec![Aov::Lights],
        };
        let args = if args.contains(&Self::All) { Self::value_variants() } else { args };
        args.iter().flat_map(each).collect()
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HeuristicArg {
    Power,
    Balance,
    Uniform,
}

impl From<HeuristicArg> for Heuristic {
    fn from(arg: HeuristicArg) -> Self {
        match arg {
            HeuristicArg::Power => Self::Power,
            HeuristicArg::Balance => Self::Balance,
            HeuristicArg::Uniform => Self::Uniform,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerArg {
    Sobol,
    Independent,
}

impl From<SamplerArg> for SamplerKind {
    fn from(arg: SamplerArg) -> Self {
        match arg {
            SamplerArg::Sobol => Self::Sobol,
            SamplerArg::Independent => Self::Independent,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum AccelArg {
    /// Intel Embree 4
    #[cfg(feature = "embree")]
    Embree,
    /// The pure-Rust BVH
    Bvh,
}

impl AccelArg {
    pub(super) const DEFAULT: &'static str = if cfg!(feature = "embree") { "embree" } else { "bvh" };
}

/// A seed.
fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| not_whole(0, u64::MAX))
}

/// A whole number between bounds; the standard library's own messages would not say what is allowed.
pub(super) fn whole(least: u32, most: u32) -> impl Fn(&str) -> Result<u32, String> + Clone + Send + Sync + 'static {
    move |text| match text.parse() {
        Ok(n) if (least..=most).contains(&n) => Ok(n),
        _ => Err(not_whole(least, most.into())),
    }
}

fn not_whole(least: u32, most: u64) -> String {
    format!("write it as a whole number, {least} or more (at most {most})")
}

/// An exposure: a number of stops.
fn stops(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(stops) if (-100.0..=100.0).contains(&stops) => Ok(stops),
        _ => Err("write it as a number of stops from -100 to 100, for example 1.5".into()),
    }
}

/// The range of a picture of differences, in percent.
fn percent(text: &str) -> Result<f32, String> {
    match text.trim_end_matches('%').parse() {
        Ok(x) if (1e-3..=1e6).contains(&x) => Ok(x),
        _ => Err("write it as a number of percent from 0.001 to 1000000, for example 50".into()),
    }
}

/// `WxH`.
#[derive(Clone, Copy, Debug)]
pub struct Size(pub [u32; 2]);

impl FromStr for Size {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        let parsed = s.split_once(['x', 'X', '×']).and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
        match parsed {
            Some([w, h])
                if w > 0 && h > 0 && w <= 1 << 16 && h <= 1 << 16 && u64::from(w) * u64::from(h) <= 1 << 28 =>
            {
                Ok(Self([w, h]))
            }
            Some(_) => Err("each side must be 1 to 65536 pixels, the area at most 268435456".into()),
            None => Err("write it as 640x480".into()),
        }
    }
}

/// A size in memory, in bytes.
#[derive(Clone, Copy, Debug)]
pub struct MemoryArg(pub u64);

impl FromStr for MemoryArg {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        let digits = s.trim_end_matches(|c: char| c.is_ascii_alphabetic());
        let unit = s[digits.len()..].to_ascii_uppercase();
        let power = match unit.trim_end_matches('B').trim_end_matches('I') {
            "K" => 10,
            "M" => 20,
            "G" => 30,
            "T" => 40,
            _ => return Err("write it as a number and a unit, K, M, G or T, for example 8G or 512M".into()),
        };
        match digits.parse::<f64>() {
            Ok(n) if n > 0.0 && n <= 1e6 => Ok(Self((n * f64::from(power).exp2()) as u64)),
            _ => Err("the number must be above 0 and at most 1000000, for example 8G or 512M".into()),
        }
    }
}

/// `x0,y0,x1,y1`.
#[derive(Clone, Copy, Debug)]
pub struct CropArg(pub [u32; 4]);

impl FromStr for CropArg {
    type Err = String;
    fn from_str(s: &str) -> Result<Self, String> {
        let numbers: Option<Vec<u32>> = s.split(',').map(|x| x.trim().parse().ok()).collect();
        match numbers.as_deref() {
            Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Self([x0, y0, x1, y1])),
            Some(&[x0, y0, x1, y1]) => Err(format!(
                "no pixel lies in columns {x0}..{x1} and rows {y0}..{y1}: the ends are exclusive and must come after \
                 the starts"
            )),
            _ => Err("write it as x0,y0,x1,y1 in pixels, for example 0,0,64,64".into()),
        }
    }
}

/// `x,y`.
#[derive(Clone, Copy, Debug)]
pub struct PixelArg(pub [u32; 2]);

impl FromStr for PixelArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once(',').and_then(|(x, y)| Some([x.trim().parse().ok()?, y.trim().parse().ok()?]));
        parsed.map(Self).ok_or_else(|| "write it as x,y in pixels, for example 12,40".into())
    }
}

/// `s,t`.
#[derive(Clone, Copy, Debug)]
pub struct TechniqueArg(pub Technique);

impl FromStr for TechniqueArg {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = text.split_once(',').and_then(|(s, t)| Some((s.trim().parse().ok()?, t.trim().parse().ok()?)));
        match parsed {
            Some((_, 0)) => Err("t counts the camera's own vertex: it is at least 1".into()),
            Some((s, t)) if u64::from(s) + u64::from(t) >= 2 => Ok(Self(Technique { s, t })),
            Some(_) => Err("a path has at least two vertices: s + t must be at least 2".into()),
            None => Err("write it as s,t, for example 1,2".into()),
        }
    }
}
