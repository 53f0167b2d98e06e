//! Materials and textures from bytes: all of the format's but images.

use arbitrary::Result;
use serde_json::{Value, json};

use super::generator::Source;

/// Makes materials and what varies over them.
pub trait Materials {
    /// A material, with blends of it `depth` deep at the most.
    fn material(&mut self, depth: u32) -> Result<Value>;
    /// A number in a range, or a texture of such.
    fn number(&mut self, low: f64, high: f64) -> Result<Value>;
    /// Radiance, or a texture of it.
    fn color_texture_of_emission(&mut self) -> Result<Value>;
    /// A map of normals.
    fn normals(&mut self) -> Result<Value>;
    /// A map of displacements.
    fn bumps(&mut self) -> Result<Value>;
}

/// A texture that has these two values, or the first of them.
fn texture(source: &mut Source<'_, '_>, a: Value, b: Value, depth: u32) -> Result<Value> {
    let scale = source.one(&[1.0, 0.0, 9.0, -3.0, 1e-6, 1e6])?;
    Ok(match source.bytes.arbitrary::<u8>()? {
        0..20 => {
            let even = if depth > 0 { texture(source, a, b.clone(), depth - 1)? } else { a };
            json!({ "type": "checker", "scale": scale, "even": even, "odd": b })
        }
        20..40 => json!({ "type": "marble", "scale": scale, "base": a, "veins": b }),
        40..48 => json!({ "type": "constant", "color": a }),
        _ => a,
    })
}

fn reflectance(source: &mut Source<'_, '_>) -> Result<Value> {
    let color = |source: &mut Source<'_, '_>| -> Result<Value> {
        Ok(if source.chance(5)? {
            json!([source.unit()?, source.unit()?, source.unit()?])
        } else {
            json!(source.unit()?)
        })
    };
    let (a, b) = (color(source)?, color(source)?);
    texture(source, a, b, 2)
}

impl Source<'_, '_> {
    /// A part of a blend: parts do not shine by themselves, and those with windows never.
    fn part(&mut self, depth: u32) -> Result<Value> {
        let part = self.material(depth - 1)?;
        Ok(match part["type"].as_str() {
            Some("diffuse light") => json!({ "type": "mirror" }),
            Some("null") => json!({ "type": "dielectric", "ior": 1 }),
            _ => part,
        })
    }
}

fn roughness(source: &mut Source<'_, '_>, both: bool) -> Result<Value> {
    let list = [0.0_f64, 1e-5, 1e-4, 1.01e-4, 1e-3, 0.01, 0.1, 0.3, 0.7, 1.0];
    let (a, b) = (source.one(&list)?, source.one(&list)?);
    source.peaked |= a.min(b) < 0.05;
    if both && source.chance(4)? {
        return Ok(json!([a, b]));
    }
    texture(source, json!(a), json!(b), 1)
}

impl Materials for Source<'_, '_> {
    fn material(&mut self, depth: u32) -> Result<Value> {
        let indices = [1.5, 1.0, 1.0 + 1e-6, 1.0 - 1e-6, 1.33, 2.4, 0.7, 1e-3, 1e3];
        let index = self.one(&indices)?;
        self.peaked |= !(0.1..10.0).contains(&index);
        let mut material = match self.bytes.arbitrary::<u8>()? % 20 {
            0..4 => json!({ "type": "lambertian", "albedo": reflectance(self)? }),
            4 => json!({ "type": "mirror", "albedo": reflectance(self)? }),
            5 => json!({ "type": "metal", "albedo": reflectance(self)?, "roughness": roughness(self, true)? }),
            6..9 => {
                let transmittance = if self.chance(4)? { reflectance(self)? } else { json!(1) };
                json!({ "type": "dielectric", "ior": index, "transmittance": transmittance,
                        "roughness": if self.chance(8)? { json!(0) } else { roughness(self, true)? } })
            }
            9 => json!({ "type": "thin dielectric", "ior": index }),
            10 => {
                let (a, b) = (self.one(&[1.0, 1e-3, 0.2, 3.0, 1e3])?, self.one(&[0.0, 3.0, 1e3])?);
                json!({ "type": "conductor", "eta": a, "k": b, "roughness": roughness(self, true)? })
            }
            11 | 12 => {
                let kind = self.one(&["conductor", "beckmann"])?;
                let fresnel = self.one(&["schlick", "none"])?;
                let masking = self.one(&["height_correlated", "separable"])?;
                json!({ "type": kind, "albedo": reflectance(self)?, "fresnel": fresnel, "masking": masking,
                        "roughness": roughness(self, true)? })
            }
            13 | 14 => {
                let ior = self.one(&[1.5, 1.0, 1.0 + 1e-6, 2.4, 1e3])?;
                json!({ "type": "plastic", "albedo": reflectance(self)?, "ior": ior, "nonlinear": self.chance(8)?,
                        "roughness": if self.chance(8)? { json!(0) } else { roughness(self, false)? } })
            }
            15 => json!({ "type": "oren-nayar", "albedo": reflectance(self)?, "sigma": self.number(0.0, 1.5)? }),
            16 => {
                let kind = self.one(&["phong", "blinnphong"])?;
                let exponent = self.one(&[0.0, 1e-3, 1.0, 30.0, 1e4, 1e6])?;
                self.peaked |= exponent > 1e3;
                json!({ "type": kind, "albedo": reflectance(self)?, "exponent": exponent })
            }
            17 => {
                return Ok(json!({ "type": "diffuse light", "emit": self.emission()?, "two_sided": self.chance(4)? }));
            }
            18 => return Ok(json!({ "type": "null" })),
            _ if depth == 0 => json!({ "type": "lambertian", "albedo": reflectance(self)? }),
            _ => {
                let (a, b) = (self.part(depth)?, self.part(depth)?);
                json!({ "type": "blend", "a": a, "b": b, "amount": self.number(0.0, 1.0)? })
            }
        };
        let sided = ["lambertian", "conductor", "beckmann", "plastic", "oren-nayar", "phong", "blinnphong"];
        if material["type"].as_str().is_some_and(|t| sided.contains(&t)) && self.chance(6)? {
            material["two_sided"] = json!(true);
        }
        Ok(material)
    }

    fn number(&mut self, low: f64, high: f64) -> Result<Value> {
        let (a, b) = (low + (high - low) * self.unit()?, low + (high - low) * self.unit()?);
        texture(self, json!(a), json!(b), 1)
    }

    fn color_texture_of_emission(&mut self) -> Result<Value> {
        let (a, b) = (self.emission()?, self.emission()?);
        texture(self, a, b, 1)
    }

    fn normals(&mut self) -> Result<Value> {
        let mut normal =
            || -> Result<Value> { Ok(json!([self.unit()?, self.unit()?, self.one(&[1.0, 0.9, 0.5, 0.0])?])) };
        let (a, b) = (normal()?, normal()?);
        let map = texture(self, a, b, 1)?;
        Ok(if map.is_object() { map } else { json!({ "type": "constant", "color": map }) })
    }

    fn bumps(&mut self) -> Result<Value> {
        let (a, b) = (self.one(&[0.0, 1.0, -0.1, 1e-6, 1e6])?, self.one(&[0.0, 0.05, 10.0])?);
        let scale = self.one(&[1.0, 9.0, 1e3])?;
        Ok(json!({ "type": "marble", "scale": scale, "base": a, "veins": b }))
    }
}
