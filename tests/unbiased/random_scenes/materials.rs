//! Every material of the format, each as often as any other, with parameters at random.

use serde_json::{Value, json};

use super::deck::Deck;
use super::textures::Textures;
use crate::common::Random;

/// What things in the room are made of.
pub const MATERIALS: &[&str] = &[
    "lambertian",
    "lambertian, two-sided",
    "oren-nayar",
    "phong",
    "blinnphong",
    "mirror",
    "metal, smooth",
    "metal, rough",
    "conductor, index",
    "conductor, schlick, separable",
    "conductor, fresnel none",
    "conductor, anisotropic",
    "conductor, anisotropic, separable",
    "conductor, smooth",
    "beckmann",
    "beckmann, separable",
    "beckmann, anisotropic",
    "dielectric, smooth",
    "dielectric, rough",
    "dielectric, rough, anisotropic",
    "thin dielectric",
    "plastic, smooth",
    "plastic, smooth, nonlinear",
    "plastic, rough",
    "plastic, rough, nonlinear",
    "blend with a mirror",
    "blend of blends",
    "blend with a window",
    "window",
    "cut-out",
];

/// What walls are made of: all of it can be connected to, so that every integrator finds its way about the room.
pub const WALLS: &[&str] = &[
    "lambertian",
    "lambertian",
    "lambertian, two-sided",
    "oren-nayar",
    "phong",
    "blinnphong",
    "conductor, schlick, separable",
    "beckmann",
    "plastic, smooth",
    "plastic, rough",
    "plastic, smooth, nonlinear",
    "blend with a mirror",
];

/// What area lights are made of besides what they emit: those that reflect nothing, diffuse, coated and mirroring ones.
pub const EMITTERS: &[&str] = &[
    "diffuse light",
    "lambertian",
    "diffuse light",
    "lambertian, two-sided",
    "plastic, smooth",
    "conductor, anisotropic",
    "mirror",
    "phong",
    "dielectric, smooth",
];

/// Makes materials.
pub struct Materials<'a> {
    pub random: &'a mut Random,
    pub textures: &'a Textures,
    /// Deals the textures of colours and numbers.
    pub deck: &'a mut Deck,
}

impl Materials<'_> {
    fn color(&mut self, low: f64, high: f64) -> Value {
        let color = [0; 3].map(|_| self.random.between(low, high));
        self.textures.color(self.deck, color)
    }

    /// A number between two bounds, or a texture that stays between them.
    fn number(&mut self, low: f64, high: f64) -> Value {
        let (a, b) = (self.random.between(low, high), self.random.between(low, high));
        self.textures.number(self.deck, [a, b])
    }

    /// α of facets: what is smoother makes peaks whose tails a run of some thousand samples does not know.
    fn alpha(&mut self) -> Value {
        self.number(0.2, 0.7)
    }

    fn alphas(&mut self) -> Value {
        // Apart, so that the surface is anisotropic indeed.
        let (fine, coarse) = (self.random.between(0.15, 0.3), self.random.between(0.45, 0.8));
        if self.random.uniform() < 0.5 { json!([fine, coarse]) } else { json!([coarse, fine]) }
    }

    fn facets(&mut self, kind: &str, reflects: Value, roughness: Value, separable: bool) -> Value {
        let mut material = reflects;
        material["type"] = json!(kind);
        material["roughness"] = roughness;
        if separable {
            material["masking"] = json!("separable");
        }
        material["two_sided"] = json!(self.random.uniform() < 0.5);
        material
    }

    fn index(&mut self) -> Value {
        json!({ "eta": self.color(0.2, 2.0), "k": self.color(2.0, 4.0) })
    }

    fn schlick(&mut self, fresnel: &str) -> Value {
        json!({ "albedo": self.color(0.4, 0.95), "fresnel": fresnel })
    }

    fn lobe(&mut self, kind: &str, key: &str, number: Value) -> Value {
        let two_sided = self.random.uniform() < 0.5;
        json!({ "type": kind, "albedo": self.color(0.3, 0.9), key: number, "two_sided": two_sided })
    }

    fn dielectric(&mut self, roughness: Value) -> Value {
        let (ior, transmittance) = (self.random.between(1.2, 1.7), self.color(0.6, 1.0));
        json!({ "type": "dielectric", "ior": ior, "transmittance": transmittance, "roughness": roughness })
    }

    fn plastic(&mut self, roughness: Value, nonlinear: bool) -> Value {
        let (ior, two_sided) = (self.random.between(1.3, 1.8), self.random.uniform() < 0.5);
        json!({ "type": "plastic", "albedo": self.color(0.3, 0.8), "ior": ior, "roughness": roughness,
                "nonlinear": nonlinear, "two_sided": two_sided })
    }

    fn blend(&mut self, a: &str, b: &str, amount: [f64; 2]) -> Value {
        let (a, b) = (self.make(a), self.make(b));
        json!({ "type": "blend", "a": a, "b": b, "amount": self.textures.number(self.deck, amount) })
    }

    /// A material of a name above.
    pub fn make(&mut self, name: &str) -> Value {
        match name {
            "diffuse light" => json!({ "type": "diffuse light" }),
            "lambertian" | "cut-out" => json!({ "type": "lambertian", "albedo": self.color(0.2, 0.8) }),
            "lambertian, two-sided" => {
                json!({ "type": "lambertian", "albedo": self.color(0.2, 0.8), "two_sided": true })
            }
            "oren-nayar" => {
                let sigma = self.number(0.1, 1.0);
                self.lobe("oren-nayar", "sigma", sigma)
            }
            "phong" => {
                let exponent = self.number(1.0, 20.0);
                self.lobe("phong", "exponent", exponent)
            }
            "blinnphong" => {
                let exponent = self.number(2.0, 40.0);
                self.lobe("blinnphong", "exponent", exponent)
            }
            "mirror" => json!({ "type": "mirror", "albedo": self.color(0.5, 0.9) }),
            "metal, smooth" => json!({ "type": "metal", "albedo": self.color(0.5, 0.9), "roughness": 0 }),
            "metal, rough" => json!({ "type": "metal", "albedo": self.color(0.5, 0.9), "roughness": self.alpha() }),
            "conductor, index" => {
                let (index, alpha) = (self.index(), self.alpha());
                self.facets("conductor", index, alpha, false)
            }
            "conductor, schlick, separable" => {
                let (schlick, alpha) = (self.schlick("schlick"), self.alpha());
                self.facets("conductor", schlick, alpha, true)
            }
            "conductor, fresnel none" => {
                let (constant, alpha) = (self.schlick("none"), self.alpha());
                self.facets("conductor", constant, alpha, false)
            }
            "conductor, anisotropic" | "conductor, anisotropic, separable" => {
                let (index, alphas) = (self.index(), self.alphas());
                self.facets("conductor", index, alphas, name.ends_with("separable"))
            }
            "conductor, smooth" => {
                let index = self.index();
                self.facets("conductor", index, json!(0), false)
            }
            "beckmann" | "beckmann, separable" => {
                let (schlick, alpha) = (self.schlick("schlick"), self.alpha());
                self.facets("beckmann", schlick, alpha, name.ends_with("separable"))
            }
            "beckmann, anisotropic" => {
                let (index, alphas) = (self.index(), self.alphas());
                self.facets("beckmann", index, alphas, false)
            }
            "dielectric, smooth" => self.dielectric(json!(0)),
            "dielectric, rough" => {
                let alpha = self.alpha();
                self.dielectric(alpha)
            }
            "dielectric, rough, anisotropic" => {
                let alphas = self.alphas();
                self.dielectric(alphas)
            }
            "thin dielectric" => json!({ "type": "thin dielectric", "ior": self.random.between(1.2, 2.0) }),
            "plastic, smooth" | "plastic, smooth, nonlinear" => self.plastic(json!(0), name.ends_with("nonlinear")),
            "plastic, rough" | "plastic, rough, nonlinear" => {
                let alpha = self.alpha();
                self.plastic(alpha, name.ends_with("nonlinear"))
            }
            "blend with a mirror" => self.blend("lambertian", "mirror", [0.2, 0.5]),
            "blend of blends" => {
                let inner = self.blend("plastic, smooth", "dielectric, rough", [0.3, 0.7]);
                let other = self.make("conductor, anisotropic");
                json!({ "type": "blend", "a": inner, "b": other, "amount": 0.4 })
            }
            "blend with a window" => self.blend("oren-nayar", "window", [0.3, 0.7]),
            "window" => json!({ "type": "null" }),
            _ => panic!("no material is named {name:?}"),
        }
    }
}
