//! A scene as it is written: plain data, in the file's units and order, checked value by value but not yet prepared.

mod escaped;
mod texture;

use std::fmt;

use crate::math::{DAffine3, DMat3, DVec3};

pub use escaped::Escaped;
pub use texture::{Filter, FinishDesc, Param, Texels, TextureDesc, Wrap};

/// A linear RGB triple as written.
pub type Color = [f64; 3];

/// A scene file's content. References between its parts are indices, already resolved and in range.
#[derive(Clone, Debug)]
pub struct SceneDesc {
    /// The camera.
    pub camera: CameraDesc,
    /// The integrator and its limits.
    pub integrator: IntegratorDesc,
    /// The sampler.
    pub sampler: SamplerDesc,
    /// Samples per pixel.
    pub samples: u32,
    /// Materials, named and inline alike; a blend stands after its parts.
    pub materials: Vec<MaterialDesc>,
    /// Textures, named and inline alike; each stands after those it is made of.
    pub textures: Vec<TextureDesc>,
    /// Surfaces, with the `lights[]` sugar already turned into delta points.
    pub surfaces: Vec<SurfaceDesc>,
    /// Lights at infinity, the background included.
    pub infinite_lights: Vec<InfiniteLightDesc>,
    /// What the reader should know but need not mend, for example a sampler read as another.
    pub notes: Vec<String>,
    /// Changes with the file's text and the content of its meshes and images, and with nothing else.
    pub fingerprint: u128,
}

/// The camera: looks down its local −z, y up.
#[derive(Clone, Debug)]
pub struct CameraDesc {
    /// Camera to world.
    pub transform: DAffine3,
    /// Width and height in pixels.
    pub resolution: [u32; 2],
    /// How it projects the scene.
    pub projection: Projection,
    /// What a pixel is the mean of.
    pub filter: FilterDesc,
    /// Where in the file, for errors that only preparation can find.
    pub at: Place,
}

/// How a camera projects the scene. Lengths are in the camera's own units, before its transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Through a pinhole or a thin lens.
    Perspective {
        /// Full vertical angle of view in degrees, in (0, 180).
        vfov: f64,
        /// Distance of the plane in focus, above 0; without effect for a pinhole.
        fdist: f64,
        /// Radius of the lens; 0 for a pinhole.
        aperture: f64,
    },
    /// By parallel rays.
    Orthographic {
        /// Of the image, above 0.
        height: f64,
    },
}

/// A pixel filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterDesc {
    /// Its shape.
    pub kind: FilterKind,
    /// How far it reaches along each axis, in pixels from the pixel's centre.
    pub radius: f64,
}

/// The shapes of pixel filters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilterKind {
    /// The same everywhere.
    Box,
    /// Falls linearly to nothing at the radius.
    Tent,
    /// A Gaussian of standard deviation radius/3.
    Gaussian,
}

impl Default for FilterDesc {
    fn default() -> Self {
        Self { kind: FilterKind::Box, radius: 0.5 }
    }
}

/// What computes the image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum IntegratorKind {
    /// Chooses by itself; means `Bdpt` for now.
    Auto,
    /// Bidirectional path tracing.
    Bdpt,
    /// Path tracing with next-event estimation.
    Path,
    /// Light tracing.
    Light,
}

/// How techniques that can make the same path share it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heuristic {
    /// Power heuristic, β = 2.
    Power,
    /// Balance heuristic, β = 1.
    Balance,
    /// Arithmetic mean over the feasible techniques, β = 0.
    Uniform,
}

/// The integrator as the file asks for it.
#[derive(Clone, Copy, Debug)]
pub struct IntegratorDesc {
    /// Which.
    pub kind: IntegratorKind,
    /// Largest number of scattering events; 0 is emitted light only.
    pub max_bounces: u32,
    /// Whether long paths are ended at random (without bias).
    pub russian_roulette: bool,
    /// The MIS heuristic.
    pub heuristic: Heuristic,
}

impl Default for IntegratorDesc {
    fn default() -> Self {
        Self { kind: IntegratorKind::Auto, max_bounces: 64, russian_roulette: true, heuristic: Heuristic::Power }
    }
}

pub use crate::sampling::SamplerKind;

/// The sampler as the file asks for it.
#[derive(Clone, Copy, Debug)]
pub struct SamplerDesc {
    /// Which.
    pub kind: SamplerKind,
    /// Seed of everything random.
    pub seed: u64,
}

impl Default for SamplerDesc {
    fn default() -> Self {
        Self { kind: SamplerKind::Sobol, seed: 0 }
    }
}

/// A material: how a surface reflects, and what it emits.
#[derive(Clone, Debug)]
pub struct MaterialDesc {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// How it scatters or, on a delta point, emits.
    pub kind: MaterialKind,
    /// Emitted radiance on the normal's side, W·m⁻²·sr⁻¹; all zero when it does not shine.
    pub emit: Param<Color>,
    /// Whether the other side shines as well.
    pub emit_two_sided: bool,
    /// Where in the file.
    pub at: Place,
}

/// The material models of the format.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialKind {
    /// Diffuse reflection, albedo in [0,1]; on the normal's side only unless `two_sided`.
    Lambertian {
        /// Fraction of light reflected, per channel.
        albedo: Param<Color>,
        /// Whether the back reflects as well.
        two_sided: bool,
    },
    /// Ideal mirror on both sides.
    Mirror {
        /// Fraction of light reflected at every angle, in [0,1].
        albedo: Param<Color>,
    },
    /// Smooth or rough dielectric interface; `ior` is the index on the side the normal points away from, over the other side's.
    Dielectric {
        /// Relative index of refraction, above 0.
        ior: f64,
        /// Scales what is transmitted, in [0,1].
        transmittance: Param<Color>,
        /// GGX α along and across the tangent, in [0,1].
        roughness: [Param<f64>; 2],
    },
    /// Rough or smooth conductor.
    Conductor {
        /// What its facets reflect.
        fresnel: FresnelDesc,
        /// α along and across the tangent, in [0,1].
        roughness: [Param<f64>; 2],
        /// How their normals are distributed.
        facets: Facets,
        /// Whether masking and shadowing are independent, or correlated by height.
        separable_masking: bool,
        /// Whether the back reflects as well.
        two_sided: bool,
    },
    /// Diffuse base under a smooth or rough dielectric coat.
    Plastic {
        /// Of the base, in [0,1].
        albedo: Param<Color>,
        /// Index of refraction of the coat, at least 1.
        ior: f64,
        /// GGX α of the coat, in [0,1].
        roughness: Param<f64>,
        /// Whether light that goes back and forth under the coat takes on the base's colour each time.
        nonlinear: bool,
        /// Whether the back reflects as well.
        two_sided: bool,
    },
    /// A pane: reflection and straight transmission.
    ThinDielectric {
        /// Relative index of refraction, above 0.
        ior: f64,
    },
    /// A phenomenological model.
    Empirical {
        /// Factor of the whole, in [0,1].
        albedo: Param<Color>,
        /// Which.
        model: EmpiricalModel,
        /// Whether the back reflects as well.
        two_sided: bool,
    },
    /// Reflects nothing (a `diffuse light`; its emission is in `MaterialDesc::emit`).
    Black,
    /// Index-matched window: passes light unchanged and blocks connections.
    Null,
    /// A mixture: `b` with the weight `amount`, `a` with what is left. Both are indices into `SceneDesc::materials`.
    Blend {
        /// The material at amount 0.
        a: usize,
        /// The material at amount 1.
        b: usize,
        /// In [0, 1].
        amount: Param<f64>,
    },
    /// Point light of radiant intensity `intensity`, W·sr⁻¹; only on a delta point.
    PointLight {
        /// Radiant intensity, W·sr⁻¹.
        intensity: Color,
    },
    /// Spot light; only on a delta point. Angles are half-angles in degrees, `inner ≤ outer ≤ 180`.
    SpotLight {
        /// Radiant intensity within the inner cone, W·sr⁻¹.
        intensity: Color,
        /// Half-angle of the cone of full intensity, degrees.
        inner_angle: f64,
        /// Half-angle of the cone outside which it is dark, degrees.
        outer_angle: f64,
        /// The attenuation between the two.
        profile: SpotProfile,
    },
}

/// How a spot's intensity falls between its cones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpotProfile {
    /// A power of the cosine's share.
    Cosine {
        /// The exponent, 0 or above.
        falloff: f64,
    },
    /// Linear in the angle.
    Angle,
}

/// A light at infinity.
#[derive(Clone, Debug)]
pub struct InfiniteLightDesc {
    /// What it is.
    pub kind: InfiniteLightKind,
    /// Where in the file.
    pub at: Place,
}

/// The lights at infinity of the format.
#[derive(Clone, Debug)]
pub enum InfiniteLightKind {
    /// Parallel light.
    Directional {
        /// The direction in which the light travels, unit length.
        direction: DVec3,
        /// Irradiance of a surface that faces it, W·m⁻².
        irradiance: Color,
    },
    /// The same radiance from everywhere.
    Constant {
        /// W·m⁻²·sr⁻¹.
        radiance: Color,
    },
    /// Radiance from an equirectangular image.
    Image {
        /// Width and height in texels.
        size: [usize; 2],
        /// Linear radiance by row from the top, already scaled, W·m⁻²·sr⁻¹; finite, not negative.
        texels: Vec<[f32; 3]>,
        /// The image's frame (top +y, middle −z) to the world: a rotation.
        transform: DMat3,
    },
}

/// What the facets of a conductor reflect, per channel.
#[derive(Clone, Debug, PartialEq)]
pub enum FresnelDesc {
    /// Fresnel's formulas with the index η − ik.
    Index {
        /// η, above 0.
        eta: Param<Color>,
        /// k, 0 or above.
        k: Param<Color>,
    },
    /// Schlick's approximation.
    Schlick {
        /// Reflectance at normal incidence, in [0,1].
        albedo: Param<Color>,
    },
    /// The same at every angle.
    Constant {
        /// Reflectance, in [0,1].
        albedo: Param<Color>,
    },
}

/// Distributions of facet normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Facets {
    /// GGX (Trowbridge–Reitz).
    Ggx,
    /// Beckmann.
    Beckmann,
}

/// Phenomenological models, each with its parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum EmpiricalModel {
    /// Rough diffuse surface.
    OrenNayar {
        /// Standard deviation of the facets' slope angle, radians.
        sigma: Param<f64>,
    },
    /// Lobe around the mirror direction.
    Phong {
        /// Of the cosine, 0 or above.
        exponent: Param<f64>,
    },
    /// Lobe of the half vector around the normal.
    BlinnPhong {
        /// Of the cosine, 0 or above.
        exponent: Param<f64>,
    },
}

/// A surface: a shape, where it stands and what it is made of.
#[derive(Clone, Debug)]
pub struct SurfaceDesc {
    /// The shape, in its own space.
    pub shape: ShapeDesc,
    /// Its space to the world.
    pub transform: DAffine3,
    /// Index into `SceneDesc::materials`.
    pub material: usize,
    /// Turns the emitting and shading side.
    pub flip_normals: bool,
    /// Opacity and maps of the normal.
    pub finish: FinishDesc,
    /// Where in the file.
    pub at: Place,
}

/// The shapes of the format.
#[derive(Clone, Debug)]
pub enum ShapeDesc {
    /// Rectangle of full extents `size` in z = 0, normal +z.
    Quad {
        /// Along x and y, above 0.
        size: [f64; 2],
    },
    /// Sphere around the origin, normal outward.
    Sphere {
        /// Above 0.
        radius: f64,
    },
    /// Disk around the origin in z = 0, normal +z.
    Disk {
        /// Above 0.
        radius: f64,
    },
    /// Triangles.
    Mesh(MeshDesc),
    /// A point of zero size at the origin; light comes from its material, a spot's axis is local −z.
    DeltaPoint,
}

/// Triangles with shared vertices. Indices are in range; a normal wound counter-clockwise is the front.
#[derive(Clone, Debug, Default)]
pub struct MeshDesc {
    /// Vertex positions, mesh space.
    pub positions: Vec<[f32; 3]>,
    /// Vertex normals (not normalised), one per position, or empty; zero where a vertex has none while others do.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates, one per position, or empty.
    pub uvs: Vec<[f32; 2]>,
    /// Triangles.
    pub triangles: Vec<[u32; 3]>,
}

/// A place in a scene file.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The file as the user named it.
    pub file: String,
    /// Line, from 1; 0 when the error is not at one place.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// JSON pointer (RFC 6901) of the value, for example `/surfaces/3/material`; empty for files without one.
    pub pointer: String,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", Escaped(&self.file))?;
        if self.line > 0 {
            write!(f, ":{}:{}", self.line, self.column)?;
        }
        if !self.pointer.is_empty() {
            write!(f, ": {}", Escaped(&self.pointer))?;
        }
        Ok(())
    }
}

/// One thing wrong with a scene or an asset: where, what was found, what is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Where.
    pub at: Place,
    /// What is wrong, with the offending value, and what is allowed instead.
    pub message: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.at, Escaped(&self.message))
    }
}

/// Everything found wrong with a scene, in file order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SceneError {
    /// At least one.
    pub diagnostics: Vec<Diagnostic>,
}

impl SceneError {
    /// An error of one diagnostic.
    pub fn one(at: Place, message: impl Into<String>) -> Self {
        Self { diagnostics: vec![Diagnostic { at, message: message.into() }] }
    }
}

impl fmt::Display for SceneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, d) in self.diagnostics.iter().enumerate() {
            if i > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{d}")?;
        }
        Ok(())
    }
}

impl std::error::Error for SceneError {}

/// Whether all three channels are zero.
pub fn is_black(c: Color) -> bool {
    c == [0.0; 3]
}
