//! Valid scenes from any bytes, at the ends of what the format allows. The numbers come from short lists more often than
//! not: planes that coincide, lights on surfaces, the same primitive twice are what random numbers never make.

use arbitrary::{Result, Unstructured};
use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::sampling::SamplerKind;
use twinlight::scene::desc::Heuristic;

use super::materials::Materials;

/// Most surfaces and lights of a scene.
const SURFACES: u32 = 12;
const LIGHTS: u32 = 4;

/// A scene, and how `bdpt` renders it.
#[derive(Debug)]
pub struct Made {
    pub scene: Value,
    pub settings: Settings,
    /// Whether some light is so bright that f32 need not hold what it makes.
    pub blinding: bool,
    /// Whether some lobe is so peaked, or bends so much, that the rounding of directions shows.
    pub peaked: bool,
}

/// The bytes, and what has been decided.
pub struct Source<'a, 'b> {
    pub bytes: &'b mut Unstructured<'a>,
    /// What all radiance is in units of. Times a peaked lobe's value and 1/d² of a point of light next to a surface f32 still
    /// holds it.
    unit_of_light: f64,
    /// What all lengths are in units of.
    unit_of_length: f64,
    blinding: bool,
    /// See `Made`.
    pub peaked: bool,
}

impl Source<'_, '_> {
    /// One of a list.
    pub fn one<T: Clone>(&mut self, list: &[T]) -> Result<T> {
        self.bytes.choose(list).cloned()
    }

    /// Whether something happens that does so `times` in 16.
    pub fn chance(&mut self, times: u8) -> Result<bool> {
        Ok(self.bytes.arbitrary::<u8>()? % 16 < times)
    }

    /// In [−1, 1], in steps that f32 holds; sometimes next to one of those steps.
    fn coordinate(&mut self) -> Result<f64> {
        let x = f64::from(self.bytes.arbitrary::<i8>()?) / 64.0;
        Ok(match self.bytes.arbitrary::<u8>()? {
            0..12 => x + 1e-7,
            12..24 => x * 1e-6,
            24..64 => x + f64::from(self.bytes.arbitrary::<i16>()?) / 1e5,
            64..80 => 0.0,
            _ => x,
        })
    }

    fn place(&mut self) -> Result<[f64; 3]> {
        Ok([self.coordinate()?, self.coordinate()?, self.coordinate()?])
    }

    /// Above 0.
    pub fn length(&mut self) -> Result<f64> {
        Ok(match self.bytes.arbitrary::<u8>()? {
            0..8 => 1e-6,
            8..16 => (-20.0_f64).exp2(),
            16..24 => 1e3,
            24..32 => 1e-3,
            n => f64::from(n) / 128.0,
        })
    }

    /// In [0, 1], its ends often.
    pub fn unit(&mut self) -> Result<f64> {
        Ok(match self.bytes.arbitrary::<u8>()? {
            0..32 => 0.0,
            32..80 => 1.0,
            80..88 => 1e-6,
            88..96 => 1.0 - 1e-7,
            n => f64::from(n) / 255.0,
        })
    }

    /// A direction, of any length but zero.
    fn direction(&mut self) -> Result<[f64; 3]> {
        let d = self.place()?;
        Ok(if d.iter().any(|x| x.abs() > 1e-3) { d } else { [0.0, -1.0, 0.0] })
    }

    /// Radiant intensity: of the same effect in a scene of any size.
    fn intensity(&mut self) -> Result<Value> {
        let (radiance, length) = (self.unit_of_light, self.unit_of_length);
        self.unit_of_light *= length * length;
        let intensity = self.emission();
        self.unit_of_light = radiance;
        intensity
    }

    /// Radiance.
    pub fn emission(&mut self) -> Result<Value> {
        let strength = match self.bytes.arbitrary::<u8>()? {
            0..8 => 1e-3,
            8..16 => 1e3,
            16..20 => {
                self.blinding = true;
                3e38
            }
            n => f64::from(n) / 32.0,
        };
        let strength = if strength < 1e38 { strength * self.unit_of_light } else { strength };
        Ok(if self.chance(4)? { json!([0.0, strength, strength * 0.5]) } else { json!(strength) })
    }

    fn rotation(&mut self) -> Result<Value> {
        let angle = f64::from(self.bytes.arbitrary::<u8>()? % 24) * 15.0;
        let angle = if self.chance(2)? { angle + 1e-4 } else { angle };
        let axis = self.one(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0], [1.0, -2.0, 0.3]])?;
        Ok(json!({ "axis": axis, "angle": angle }))
    }

    /// Steps that put a thing into its place.
    fn transform(&mut self) -> Result<Vec<Value>> {
        let mut steps = Vec::new();
        if self.chance(4)? {
            // Nothing is a million times as large as what is about it: places would be known no better than that is large.
            let x = self.one(&[1.0, 0.5, 2.0, -1.0, 1e-3, 3.0])?;
            steps.push(json!({ "scale": [x, self.one(&[1.0, 0.25, -1.0, 1e-2])?, 1.0] }));
        }
        if self.chance(12)? {
            steps.push(self.rotation()?);
        }
        steps.push(json!({ "translate": self.place()? }));
        Ok(steps)
    }

    /// Corners of a triangle: good ones, needles, points.
    fn corners(&mut self) -> Result<[[f64; 3]; 3]> {
        let (a, b, c) = (self.place()?, self.place()?, self.place()?);
        Ok(match self.bytes.arbitrary::<u8>()? {
            0..6 => [a, a, a],
            6..12 => [a, b, b],
            12..20 => [a, b, [0, 1, 2].map(|i| 0.5 * (a[i] + b[i]))],
            20..36 => [a, b, [a[0] + 1e-7, a[1], a[2]]],
            _ => [a, b, c],
        })
    }

    fn mesh(&mut self) -> Result<Value> {
        let count = self.bytes.int_in_range(3..=8)?;
        let mut positions = Vec::new();
        for _ in 0..count {
            positions.push(self.place()?);
        }
        let mut triangles = Vec::new();
        for _ in 0..self.bytes.int_in_range(1..=6)? {
            triangles.push([0; 3].map(|_| self.bytes.arbitrary::<u8>().unwrap_or(0) % count));
        }
        let mut mesh = json!({ "type": "mesh", "positions": positions, "indices": triangles });
        if self.chance(6)? {
            let normals: Vec<_> = (0..count).map(|_| self.direction()).collect::<Result<_>>()?;
            mesh["normals"] = json!(normals);
        }
        if self.chance(6)? {
            let uvs: Vec<_> = (0..count).map(|_| Ok([self.coordinate()?, self.unit()?])).collect::<Result<_>>()?;
            mesh["uvs"] = json!(uvs);
        }
        Ok(mesh)
    }

    fn shape(&mut self) -> Result<Value> {
        Ok(match self.bytes.arbitrary::<u8>()? % 8 {
            0..3 => json!({ "type": "quad", "size": [self.length()?, self.length()?] }),
            3 => json!({ "type": "disk", "radius": self.length()? }),
            4 | 5 => json!({ "type": "sphere", "radius": self.length()? }),
            6 => {
                let mut triangle = json!({ "type": "triangle", "positions": self.corners()? });
                if self.chance(6)? {
                    triangle["normals"] = json!([self.direction()?, self.direction()?, self.direction()?]);
                }
                triangle
            }
            _ => self.mesh()?,
        })
    }

    fn surface(&mut self) -> Result<Value> {
        let mut surface = self.shape()?;
        surface["transform"] = json!(self.transform()?);
        let mut material = self.material(2)?;
        let shines = if material["type"] == "null" { false } else { self.chance(5)? };
        if shines {
            material["emit"] = self.color_texture_of_emission()?;
            if material["type"] != "diffuse light" && self.chance(3)? {
                material["emit_two_sided"] = json!(true);
            }
        }
        let shines = shines || material["type"] == "diffuse light";
        surface["material"] = material;
        if self.chance(4)? {
            surface["flip_normals"] = json!(true);
        }
        if !shines && self.chance(4)? {
            surface["opacity"] = self.number(0.0, 1.0)?;
        }
        match self.bytes.arbitrary::<u8>()? {
            0..12 => surface["normal_map"] = self.normals()?,
            12..24 => surface["bump_map"] = self.bumps()?,
            _ => {}
        }
        Ok(surface)
    }

    fn spot(&mut self, spot: &mut Value) -> Result<()> {
        let outer = self.one(&[0.0, 1e-4, 0.01, 20.0, 45.0, 90.0, 90.0 + 1e-6, 135.0, 180.0])?;
        spot["outer_angle"] = json!(outer);
        spot["inner_angle"] = json!(outer * self.unit()?);
        match self.bytes.arbitrary::<u8>()? % 8 {
            0..3 => spot["profile"] = json!("angle"),
            3..6 => spot["falloff"] = json!(self.one(&[0.0, 1e-6, 0.5, 1.0, 7.0, 1e4])?),
            _ => {}
        }
        Ok(())
    }

    /// A light that is no surface, or a delta point, which is one; `on` is where surfaces are.
    fn light(&mut self, on: &[[f64; 3]], surfaces: &mut Vec<Value>, lights: &mut Vec<Value>) -> Result<()> {
        let place = if on.is_empty() || self.chance(10)? { self.place()? } else { self.one(on)? };
        let kind = self.bytes.arbitrary::<u8>()? % 8;
        match kind {
            0 | 1 => lights.push(json!({ "type": "point", "position": place, "intensity": self.intensity()? })),
            2 | 3 => {
                let mut spot = json!({ "type": "spot", "position": place, "intensity": self.intensity()?,
                                       "direction": self.direction()? });
                self.spot(&mut spot)?;
                lights.push(spot);
            }
            4 => {
                let direction = self.direction()?;
                lights.push(json!({ "type": "directional", "direction": direction, "irradiance": self.emission()? }));
            }
            5 => lights.push(json!({ "type": "constant", "radiance": self.emission()? })),
            _ => {
                let mut material = json!({ "type": "point light", "emit": self.intensity()? });
                if kind == 6 {
                    material["type"] = json!("spot light");
                    self.spot(&mut material)?;
                }
                let transform = [self.rotation()?, json!({ "translate": place })];
                surfaces.push(json!({ "type": "delta point", "transform": transform, "material": material }));
            }
        }
        Ok(())
    }

    fn camera(&mut self) -> Result<Value> {
        let look = match self.bytes.arbitrary::<u8>()? {
            0..160 => json!({ "from": [0.0, 0.0, 3.0], "at": self.one(&[[0.0; 3], [0.25, -0.5, 0.0]])? }),
            160..192 => json!({ "from": [0.0, 0.0, 1e4], "at": [0, 0, 0] }),
            _ => {
                let (from, to) = (self.place()?, self.place()?);
                // Neither the same point nor straight up, both of which are errors.
                let at = [to[0] + 0.1 + from[0], to[1] + from[1], to[2] + 0.2 + from[2]];
                json!({ "from": from, "at": at, "up": [0.0, 1.0, 0.0] })
            }
        };
        let mut camera = json!({ "transform": [look], "resolution": [4, 4] });
        if self.chance(4)? {
            camera["type"] = json!("orthographic");
            camera["height"] = json!(2.0 * self.length()?);
        } else {
            camera["vfov"] = json!(self.one(&[40.0, 40.0, 90.0, 0.001, 1.0, 150.0, 179.9])?);
            if self.chance(4)? {
                camera["aperture"] = json!(self.length()?);
                camera["fdist"] = json!(self.one(&[3.0, 1e-3, 1.0, 1e6])?);
            }
        }
        if self.chance(6)? {
            let kind = self.one(&["box", "tent", "gaussian"])?;
            camera["filter"] = json!({ "type": kind, "radius": self.one(&[0.01, 0.5, 1.5, 8.0, 100.0])? });
        }
        Ok(camera)
    }

    fn settings(&mut self) -> Result<Settings> {
        let bounces = self.one(&[0, 1, 2, 3, 4, 6, 8, 16])?;
        Ok(Settings {
            integrator: Integrator::Bdpt,
            max_bounces: bounces,
            roulette: self.chance(12)?,
            roulette_after: self.one(&[None, None, Some(0), Some(3)])?,
            heuristic: self.one(&[Heuristic::Power, Heuristic::Power, Heuristic::Balance, Heuristic::Uniform])?,
            light_paths: self.one(&[1, 1, 0, 2])?,
            connections: self.one(&[1, 1, 0, 3])?,
            sampler: self.one(&[SamplerKind::Sobol, SamplerKind::Independent])?,
            seed: u64::from(self.bytes.arbitrary::<u8>()?),
            ..Settings::default()
        })
    }
}

/// Makes a scene; where the bytes end, the rest of it is as if they were zero.
pub fn make(bytes: &[u8]) -> Result<Made> {
    let mut unstructured = Unstructured::new(bytes);
    let mut source =
        Source { bytes: &mut unstructured, unit_of_light: 1.0, unit_of_length: 1.0, blinding: false, peaked: false };
    source.unit_of_light = source.one(&[1.0, 1.0, 1.0, 1e-12, 1e12])?;
    source.unit_of_length = source.one(&[1.0, 1.0, 1.0, 1e-6, 1e6, (-20.0_f64).exp2(), 20.0_f64.exp2(), 3.7])?;
    let settings = source.settings()?;
    let mut camera = source.camera()?;
    let (mut surfaces, mut lights) = (Vec::new(), Vec::new());
    for _ in 0..source.bytes.int_in_range(1..=SURFACES)? {
        if !surfaces.is_empty() && source.chance(1)? {
            // The same once more.
            surfaces.push(source.one(&surfaces)?);
        } else {
            surfaces.push(source.surface()?);
        }
    }
    let place = |s: &Value| {
        let steps = s["transform"].as_array()?;
        let at = steps.iter().find_map(|step| step["translate"].as_array())?;
        Some([at[0].as_f64()?, at[1].as_f64()?, at[2].as_f64()?])
    };
    let on: Vec<[f64; 3]> = surfaces.iter().filter_map(place).collect();
    for _ in 0..source.bytes.int_in_range(0..=LIGHTS)? {
        source.light(&on, &mut surfaces, &mut lights)?;
    }
    // All of it elsewhere and in another size.
    let scale = source.unit_of_length;
    let shift = source.one(&[0.0, 0.0, 0.0, 1.0, 1e3])? * scale;
    for thing in surfaces.iter_mut().chain([&mut camera]) {
        if let Some(steps) = thing["transform"].as_array_mut() {
            steps.extend([json!({ "scale": scale }), json!({ "translate": [shift, -shift, shift] })]);
        }
    }
    for light in &mut lights {
        if let Some(at) = light["position"].as_array() {
            let at: Vec<f64> = at.iter().filter_map(Value::as_f64).collect();
            light["position"] = json!([at[0] * scale + shift, at[1] * scale - shift, at[2] * scale + shift]);
        }
    }
    let mut scene = json!({ "camera": camera, "surfaces": surfaces, "lights": lights });
    if source.chance(1)? {
        scene["background"] = source.emission()?;
    }
    Ok(Made { scene, settings, blinding: source.blinding, peaked: source.peaked })
}
