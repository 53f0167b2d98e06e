//! What the models promise, by claim: sampling and densities, symmetry, energy, and the ends of every range.

mod energy;
mod extremes;
mod formulas;
mod sampling;
mod symmetry;

use super::{Bsdf, Distribution, Empirical, Masking, Plastic, Reflectance, Shape};
use crate::geometry::{SurfacePoint, SurfaceTag};
use crate::math::{PointWithError, Rgb, Vec3};
use crate::sampling::{Sampler, SamplerKind, Stream};

/// The largest number that `u` can be.
const LAST: f32 = 1.0 - f32::EPSILON / 2.0;

/// A point with the given normals; `flat` when they are the same.
fn point(ng: Vec3, ns: Vec3) -> SurfacePoint {
    let point = PointWithError { p: Vec3::ZERO, error: Vec3::ZERO };
    SurfacePoint { point, ng, ns, tag: SurfaceTag::new(0, 0, [0.0; 2]) }
}

/// A flat point that faces z.
fn flat() -> SurfacePoint {
    point(Vec3::Z, Vec3::Z)
}

/// A direction by its angle to z in degrees and its azimuth in radians.
fn direction(degrees: f32, phi: f32) -> Vec3 {
    let (s, c) = f64::from(degrees).to_radians().sin_cos();
    let (sp, cp) = f64::from(phi).sin_cos();
    Vec3::new((s * cp) as f32, (s * sp) as f32, c as f32)
}

fn numbers(seed: u64, index: u32) -> Sampler {
    Sampler::new(SamplerKind::Independent, seed, 0, Stream::Camera, index)
}

fn conductor(alpha: [f32; 2], distribution: Distribution, masking: Masking, two_sided: bool) -> Bsdf {
    Bsdf::conductor(Reflectance::Constant([1.0; 3]), alpha, distribution, masking, two_sided)
}

/// An anisotropic conductor whose tangent is turned by `angle`.
fn turned(alpha: [f32; 2], angle: f32) -> Bsdf {
    let Bsdf::Conductor(mut c) = conductor(alpha, Distribution::Ggx, Masking::HeightCorrelated, true) else {
        unreachable!("rough")
    };
    c.roughness.tangent = [angle.cos(), angle.sin()];
    Bsdf::Conductor(c)
}

fn plastic(albedo: Rgb, alpha: f32, nonlinear: bool) -> Bsdf {
    Bsdf::Plastic(Plastic::new(albedo, 1.5, alpha, nonlinear, true))
}

fn empirical(shape: Shape) -> Bsdf {
    Bsdf::Empirical(Empirical { albedo: [1.0; 3], shape, two_sided: true })
}

/// Every model that is not all delta, wide enough to be integrated over a grid.
fn models() -> Vec<(&'static str, Bsdf)> {
    use Distribution::{Beckmann, Ggx};
    use Masking::{HeightCorrelated, Separable};
    let metal = Reflectance::Index { eta: [0.2, 0.9, 1.4], k: [3.9, 2.4, 1.6] };
    vec![
        ("lambertian", Bsdf::Lambertian { albedo: Rgb::splat(0.7), two_sided: true }),
        ("ggx .1", conductor([0.1; 2], Ggx, HeightCorrelated, true)),
        ("ggx .4 separable", conductor([0.4; 2], Ggx, Separable, true)),
        ("ggx 1", conductor([1.0; 2], Ggx, HeightCorrelated, true)),
        ("ggx .15/.6 turned", turned([0.15, 0.6], 0.7)),
        ("metal ggx .3/.2", Bsdf::conductor(metal, [0.3, 0.2], Ggx, Separable, true)),
        ("beckmann .15", conductor([0.15; 2], Beckmann, HeightCorrelated, true)),
        ("beckmann .6/.25", conductor([0.6, 0.25], Beckmann, Separable, true)),
        (
            "schlick beckmann .5",
            Bsdf::conductor(Reflectance::Schlick([0.04, 0.3, 0.9]), [0.5; 2], Beckmann, Separable, false),
        ),
        ("rough glass .15", Bsdf::dielectric(1.5, Rgb::ONE, [0.15; 2])),
        ("rough glass .6", Bsdf::dielectric(1.5, Rgb::new(1.0, 0.9, 0.5), [0.6; 2])),
        ("rough glass .2/.5 ior 2.4", Bsdf::dielectric(2.4, Rgb::ONE, [0.2, 0.5])),
        ("rough bubble .3", Bsdf::dielectric(0.7, Rgb::ONE, [0.3; 2])),
        ("smooth plastic", plastic(Rgb::new(0.9, 0.4, 0.1), 0.0, false)),
        ("smooth nonlinear plastic", plastic(Rgb::new(0.9, 0.4, 0.1), 0.0, true)),
        ("rough plastic .2", plastic(Rgb::new(0.9, 0.4, 0.1), 0.2, false)),
        ("rough nonlinear plastic .7", plastic(Rgb::splat(0.8), 0.7, true)),
        ("black rough plastic", plastic(Rgb::ZERO, 0.3, false)),
        ("oren-nayar", empirical(Shape::oren_nayar(0.5))),
        ("phong 0", empirical(Shape::Phong { exponent: 0.0 })),
        ("phong 40", empirical(Shape::Phong { exponent: 40.0 })),
        ("blinn-phong 0", empirical(Shape::BlinnPhong { exponent: 0.0 })),
        ("blinn-phong 60", empirical(Shape::BlinnPhong { exponent: 60.0 })),
    ]
}
