//! How surfaces scatter, in words: the scene format's names, as far as what was prepared has them.

use super::trace::{color, number};
use crate::bsdf::{Bsdf, Distribution, Reflectance, Shape};
use crate::math::Rgb;

/// A number per channel.
fn channels(c: [f32; 3]) -> String {
    color(Rgb::from_array(c))
}

fn roughness([a, b]: [f32; 2]) -> String {
    if a == b { format!("roughness {}", number(a)) } else { format!("roughness ({} {})", number(a), number(b)) }
}

fn reflectance(r: &Reflectance) -> String {
    match r {
        Reflectance::Index { eta, k } => format!("eta {}, k {}", channels(*eta), channels(*k)),
        Reflectance::Schlick(c) => format!("albedo {}, fresnel \"schlick\"", channels(*c)),
        Reflectance::Constant(c) => format!("albedo {}", channels(*c)),
    }
}

/// What a surface scatters by.
pub fn bsdf(b: &Bsdf) -> String {
    let (words, two_sided) = match b {
        Bsdf::Black => ("scatters nothing".to_owned(), false),
        Bsdf::Lambertian { albedo, two_sided } => (format!("lambertian, albedo {}", color(*albedo)), *two_sided),
        Bsdf::Mirror { albedo } => (format!("mirror, albedo {}", color(*albedo)), false),
        Bsdf::Dielectric { ior, transmittance } => {
            (format!("dielectric, ior {}, transmittance {}", number(*ior), color(*transmittance)), false)
        }
        Bsdf::Null => ("null".to_owned(), false),
        Bsdf::Conductor(c) => {
            let name = match c.distribution {
                Distribution::Ggx => "conductor",
                Distribution::Beckmann => "beckmann",
            };
            (format!("{name}, {}, {}", reflectance(&c.reflectance), roughness(c.roughness.alpha)), c.two_sided)
        }
        Bsdf::SmoothConductor { reflectance: r, two_sided } => {
            (format!("conductor, {}, roughness 0", reflectance(r)), *two_sided)
        }
        Bsdf::RoughDielectric(d) => {
            let (ior, transmittance) = (number(d.ior), channels(d.transmittance));
            (format!("dielectric, ior {ior}, transmittance {transmittance}, {}", roughness(d.roughness.alpha)), false)
        }
        Bsdf::ThinDielectric { ior } => (format!("thin dielectric, ior {}", number(*ior)), false),
        Bsdf::Plastic(p) => {
            let alpha = if p.is_smooth() { 0.0 } else { p.alpha() };
            (format!("plastic, ior {}, roughness {}", number(p.ior()), number(alpha)), p.two_sided())
        }
        Bsdf::Empirical(e) => {
            let albedo = channels(e.albedo);
            let words = match e.shape {
                Shape::OrenNayar { a, b } => {
                    format!("oren-nayar, albedo {albedo}, A {}, B {}", number(a), number(b))
                }
                Shape::Phong { exponent } => format!("phong, albedo {albedo}, exponent {}", number(exponent)),
                Shape::BlinnPhong { exponent } => format!("blinnphong, albedo {albedo}, exponent {}", number(exponent)),
            };
            (words, e.two_sided)
        }
    };
    if two_sided { words + ", two-sided" } else { words }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn models_are_told_by_the_formats_names() {
        let lambertian = Bsdf::Lambertian { albedo: Rgb::new(0.5, 0.25, 0.5), two_sided: true };
        assert_eq!(bsdf(&lambertian), "lambertian, albedo (0.5 0.25 0.5), two-sided");
        let glass = Bsdf::Dielectric { ior: 1.5, transmittance: Rgb::ONE };
        assert_eq!(bsdf(&glass), "dielectric, ior 1.5, transmittance 1");
    }
}
