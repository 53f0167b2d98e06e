//! Random scenes over everything the format has: a room, closed or open to the sky, with lights, things, windows and a
//! camera in a random pose of a random size.

use serde_json::{Value, json};
use twinlight::integrator::{Integrator, Settings};
use twinlight::math::{DAffine3, DVec3};
use twinlight::sampling::SamplerKind;
use twinlight::scene::desc::Heuristic;

use super::deck::Deck;
use super::materials::{EMITTERS, MATERIALS, Materials, WALLS};
use super::textures::{Textures, sky};
use crate::common::{Random, facing, matrix, point, quad, scene_json, settings, sphere};

/// The lights, each a kind by itself for the tests' sums.
pub const LIGHTS: &[&str] = &[
    "quad",
    "quad, two-sided",
    "sphere",
    "ellipsoid",
    "disk",
    "mesh",
    "point",
    "spot",
    "directional",
    "constant",
    "image",
];

const SHAPES: &[&str] =
    &["quad", "disk", "sphere", "ellipsoid", "triangle with normals", "mesh with normals", "mesh without normals"];
const CAMERAS: &[&str] = &["pinhole", "thin lens", "orthographic"];
const FILTERS: &[&str] = &["box", "wide box", "tent", "gaussian"];
const WINDOWS: &[&str] = &["none", "none", "before the lights", "before the camera"];
const COUNTS: &[&str] = &["one light", "one light", "two lights", "three lights", "five lights"];

/// Scattering events that random scenes are rendered with: paths of up to four edges.
pub const BOUNCES: u32 = 3;

/// A scene with settings to render it bidirectionally.
pub struct RandomScene {
    pub json: Value,
    pub settings: Settings,
    /// What is in it, as `list: feature`.
    pub features: Vec<String>,
}

/// The first `count` scenes of a sequence, and all features there are; which are dealt when does not depend on the seed.
pub fn random_scenes(count: usize, seed: u64) -> (Vec<RandomScene>, Vec<String>) {
    let mut deck = Deck::default();
    let scenes = (0..count as u64)
        .map(|n| {
            let mut random = Random((seed << 32) + n);
            let scale = random.between(-4.0, 4.0).exp2();
            let pose = random.pose(2.0 * scale) * DAffine3::from_scale(DVec3::splat(scale));
            let textures = Textures { scale };
            let room = Room { random, deck: &mut deck, textures, pose, scale, surfaces: vec![], lights: vec![] };
            room.furnish()
        })
        .collect();
    (scenes, deck.known.into_iter().collect())
}

/// A scene in the making: in a box of ±1 about the origin, moved and scaled by `pose` in the end.
struct Room<'a> {
    random: Random,
    deck: &'a mut Deck,
    textures: Textures,
    pose: DAffine3,
    scale: f64,
    surfaces: Vec<Value>,
    lights: Vec<Value>,
}

impl Room<'_> {
    fn furnish(mut self) -> RandomScene {
        let count = match self.deck.deal("lights", COUNTS) {
            "one light" => 1,
            "two lights" => 2,
            "three lights" => 3,
            _ => 5,
        };
        let mut open = false;
        for place in 0..count {
            let kind = self.deck.deal("light", LIGHTS);
            open |= ["directional", "constant", "image"].contains(&kind);
            // Side by side below the ceiling, out of each other's way.
            let x = [0.0, 0.55, -0.55, 0.55, -0.55][place] + self.random.between(-0.1, 0.1);
            let z = if count == 5 { [0.0, 0.45, 0.45, -0.45, -0.45][place] } else { self.random.between(-0.4, 0.3) };
            let p = DVec3::new(x, self.random.between(0.5, 0.65), z);
            let first = self.surfaces.len();
            self.light(kind, p);
            // The other side shines, onto the ceiling; a ball would shine inwards, and be of no use.
            let has_sides = ["quad", "disk", "mesh"].contains(&kind);
            if has_sides && self.deck.deal("emitting side", &["as it is", "as it is", "flipped"]) == "flipped" {
                for emitter in &mut self.surfaces[first..] {
                    emitter["flip_normals"] = json!(true);
                }
            }
        }
        self.walls(open);
        for _ in 0..5 {
            self.thing();
        }
        let camera = self.camera();
        // Everything elsewhere: transforms are applied in order, each on the left.
        let pose = matrix(&self.pose);
        for surface in &mut self.surfaces {
            let mut chain = match surface["transform"].take() {
                Value::Array(chain) => chain,
                one => vec![one],
            };
            chain.push(pose.clone());
            surface["transform"] = json!(chain);
        }
        let settings = self.settings();
        let features = std::mem::take(&mut self.deck.features).into_iter().collect();
        RandomScene { json: scene_json(camera, self.surfaces, self.lights), settings, features }
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.random.between(low, high)
    }

    fn material(&mut self, name: &str) -> Value {
        Materials { random: &mut self.random, textures: &self.textures, deck: self.deck }.make(name)
    }

    fn color(&mut self, low: f64, high: f64) -> [f64; 3] {
        [0; 3].map(|_| self.random.between(low, high))
    }

    /// A material that emits `radiance`.
    fn shining(&mut self, radiance: [f64; 3], two_sided: bool) -> Value {
        let name = self.deck.deal("emitter", EMITTERS);
        let mut material = self.material(name);
        material["emit"] = self.textures.color(self.deck, radiance);
        if two_sided {
            material["emit_two_sided"] = json!(true);
            if name == "diffuse light" {
                // It has a key of its own for that.
                material.as_object_mut().expect("a material is an object").remove("emit_two_sided");
                material["two_sided"] = json!(true);
            }
        }
        material
    }

    fn light(&mut self, kind: &str, p: DVec3) {
        let down = (self.random.direction() * 0.5 - DVec3::Y).normalize();
        let frame = facing(p, down);
        let radiance = self.color(4.0, 8.0);
        match kind {
            "quad" | "quad, two-sided" => {
                let material = self.shining(radiance, kind != "quad");
                self.surfaces.push(quad(&frame, [0.5, 0.4], material));
            }
            "sphere" => {
                let material = self.shining(radiance, false);
                self.surfaces.push(sphere(p, 0.2, false, material));
            }
            "ellipsoid" => {
                let material = self.shining(radiance, false);
                self.surfaces.push(json!({
                    "type": "sphere", "material": material,
                    "transform": [{ "scale": [0.22, 0.22, 0.15] }, matrix(&frame)]
                }));
            }
            "disk" => {
                let material = self.shining(radiance, false);
                let transform = matrix(&frame);
                self.surfaces
                    .push(json!({ "type": "disk", "radius": 0.25, "transform": transform, "material": material }));
            }
            "mesh" => {
                // A pyramid without a base: its faces see different parts of the room.
                let material = self.shining(radiance, false);
                let corners =
                    [[0.0, 0.0, 0.15], [0.25, 0.2, 0.0], [-0.2, 0.2, 0.0], [-0.2, -0.25, 0.0], [0.2, -0.2, 0.0]];
                self.surfaces.push(json!({
                    "type": "mesh", "material": material, "transform": matrix(&frame), "positions": corners,
                    "uvs": corners.map(|[x, y, _]| [0.5 + 2.0 * x, 0.5 + 2.0 * y]),
                    "indices": [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]]
                }));
            }
            "point" | "spot" => self.delta_point(kind, p, down),
            "directional" => {
                let direction = self.pose.transform_vector3((down * 1.5 - DVec3::new(0.4, 0.0, 0.7)).normalize());
                let irradiance = self.color(0.8, 2.0);
                self.lights.push(json!({
                    "type": "directional", "direction": point(direction), "irradiance": irradiance
                }));
            }
            "constant" => {
                let radiance = self.color(0.2, 0.8);
                self.lights.push(json!({ "type": "constant", "radiance": radiance }));
            }
            "image" => {
                let turn = DAffine3::from_axis_angle(self.random.direction(), self.random.between(0.0, 3.0));
                let scale = self.between(0.3, 0.8);
                self.lights.push(json!({
                    "type": "environment", "filename": sky(), "scale": scale, "transform": matrix(&turn)
                }));
            }
            _ => panic!("no light is named {kind:?}"),
        }
    }

    /// A point or spot light, as an entry of `lights` or as the surface it stands for.
    fn delta_point(&mut self, kind: &str, p: DVec3, axis: DVec3) {
        // Irradiance at corresponding points stays: I/r².
        let intensity = self.color(0.6, 1.2).map(|i| i * self.scale * self.scale);
        let (inner, outer, falloff) = (self.between(10.0, 30.0), self.between(45.0, 75.0), self.between(0.3, 2.0));
        let form = self.deck.deal("delta light", &["entry of lights", "delta point"]);
        let (spot, sugar) = (kind == "spot", form == "entry of lights");
        let mut light = json!({ "type": if sugar { kind.to_owned() } else { format!("{kind} light") } });
        light[if sugar { "intensity" } else { "emit" }] =
            json!(if spot { intensity.map(|i| 3.0 * i) } else { intensity });
        if spot {
            light["inner_angle"] = json!(inner);
            light["outer_angle"] = json!(outer);
            match self.deck.deal("spot profile", &["cosine", "angle"]) {
                "angle" => light["profile"] = json!("angle"),
                _ => light["falloff"] = json!(falloff),
            }
        }
        if sugar {
            light["position"] = point(self.pose.transform_point3(p));
            if spot {
                light["direction"] = point(self.pose.transform_vector3(axis));
            }
            self.lights.push(light);
        } else {
            // A spot's axis is local −z.
            let transform = matrix(&facing(p, -axis));
            self.surfaces.push(json!({ "type": "delta point", "material": light, "transform": transform }));
        }
    }

    /// The box; for light from infinity only a floor, a back and one side.
    fn walls(&mut self, open: bool) {
        let half = DVec3::new(self.between(0.9, 1.2), 1.0, self.between(0.9, 1.2));
        let toward = [DVec3::Y, DVec3::Z, DVec3::X, -DVec3::X, -DVec3::Y, -DVec3::Z];
        for inwards in &toward[..if open { 3 } else { 6 }] {
            let name = self.deck.deal("wall", WALLS);
            let material = self.material(name);
            // Larger than the room: walls cross at its edges.
            let mut wall = quad(&facing(-*inwards * half, *inwards), [2.6; 2], material);
            self.textures.map(self.deck, &mut wall);
            self.surfaces.push(wall);
        }
        match self.deck.deal("window", WINDOWS) {
            "before the lights" => {
                let frame = facing(DVec3::new(0.2, 0.25, 0.1), DVec3::Y);
                self.surfaces.push(quad(&frame, [0.9, 0.8], json!({ "type": "null" })));
            }
            "before the camera" => {
                let frame = facing(DVec3::new(0.1, 0.05, 0.4), DVec3::Z);
                self.surfaces.push(quad(&frame, [0.3, 0.4], json!({ "type": "null" })));
            }
            _ => {}
        }
    }

    fn thing(&mut self) {
        let name = self.deck.deal("material", MATERIALS);
        let shape = self.deck.deal("shape", SHAPES);
        let material = self.material(name);
        let p = DVec3::new(self.between(-0.6, 0.6), self.between(-0.8, -0.1), self.between(-0.7, 0.2));
        let frame = facing(p, self.random.direction() + DVec3::Z);
        let mut surface = match shape {
            "quad" => quad(&frame, [self.between(0.3, 0.6), self.between(0.3, 0.6)], material),
            "disk" => json!({ "type": "disk", "radius": self.between(0.15, 0.3), "transform": matrix(&frame),
                              "material": material }),
            "sphere" => sphere(p, self.between(0.12, 0.25), false, material),
            "ellipsoid" => {
                let half = [self.between(0.1, 0.25), self.between(0.1, 0.25), self.between(0.1, 0.25)];
                json!({ "type": "sphere", "transform": [{ "scale": half }, matrix(&frame)], "material": material })
            }
            "triangle with normals" => json!({
                "type": "triangle", "transform": matrix(&frame), "material": material,
                "positions": [[-0.3, -0.2, 0], [0.3, -0.25, 0], [0.05, 0.35, 0]],
                "normals": [[-0.4, -0.2, 1], [0.4, -0.1, 1], [0, 0.4, 1]], "uvs": [[0, 0], [1, 0], [0.5, 1]]
            }),
            _ => self.patch(&frame, material, shape == "mesh with normals"),
        };
        if self.deck.deal("side", &["as it is", "as it is", "flipped"]) == "flipped" {
            surface["flip_normals"] = json!(true);
        }
        self.textures.map(self.deck, &mut surface);
        if name == "cut-out" {
            surface["opacity"] = match self.deck.deal("opacity", &["one number", "texture"]) {
                "texture" => self.textures.opacity(),
                _ => json!(self.between(0.3, 0.8)),
            };
        }
        self.surfaces.push(surface);
    }

    /// A dented patch of four quads.
    fn patch(&mut self, frame: &DAffine3, material: Value, normals: bool) -> Value {
        let size = self.between(0.2, 0.3);
        let grid: Vec<(f64, f64)> = (0..9).map(|i| (f64::from(i % 3 - 1), f64::from(i / 3 - 1))).collect();
        let positions: Vec<_> = grid.iter().map(|(x, y)| [size * x, size * y, -0.3 * size * (x * x + y * y)]).collect();
        let uvs: Vec<_> = grid.iter().map(|(x, y)| [0.5 + 0.5 * x, 0.5 + 0.5 * y]).collect();
        let mut mesh = json!({
            "type": "mesh", "material": material, "transform": matrix(frame), "positions": positions, "uvs": uvs,
            "indices": [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]]
        });
        if normals {
            mesh["normals"] = json!(grid.iter().map(|(x, y)| [0.6 * x, 0.6 * y, 1.0]).collect::<Vec<_>>());
        }
        mesh
    }

    fn camera(&mut self) -> Value {
        let from = DVec3::new(self.between(-0.4, 0.4), self.between(-0.2, 0.4), 0.8);
        let at = DVec3::new(0.0, self.between(-0.4, 0.0), -0.5);
        let look = json!({ "from": point(from), "at": point(at), "up": point(DVec3::Y) });
        // Few pixels with many samples each: a sampler's points are even within a pixel's own sequence.
        let mut camera = json!({ "transform": [look, matrix(&self.pose)], "resolution": [2, 2] });
        match self.deck.deal("camera", CAMERAS) {
            "orthographic" => {
                camera["type"] = json!("orthographic");
                camera["height"] = json!(self.between(0.8, 1.2));
            }
            kind => {
                camera["vfov"] = json!(self.between(50.0, 85.0));
                if kind == "thin lens" {
                    camera["aperture"] = json!(self.between(0.03, 0.1));
                    camera["fdist"] = json!(self.between(0.6, 1.6));
                }
            }
        }
        match self.deck.deal("filter", FILTERS) {
            "box" => {}
            "wide box" => camera["filter"] = json!({ "type": "box", "radius": self.between(0.3, 0.9) }),
            kind => camera["filter"] = json!({ "type": kind, "radius": self.between(0.6, 1.2) }),
        }
        camera
    }

    /// Settings of `bdpt`, of which the others take what concerns them.
    fn settings(&mut self) -> Settings {
        let heuristic = match self.deck.deal("heuristic", &["power", "power", "balance"]) {
            "power" => Heuristic::Power,
            _ => Heuristic::Balance,
        };
        let sampler = match self.deck.deal("sampler", &["sobol", "sobol", "sobol", "independent"]) {
            "sobol" => SamplerKind::Sobol,
            _ => SamplerKind::Independent,
        };
        let (light_paths, connections) =
            match self.deck.deal("subpaths", &["1 and 1", "1 and 1", "1 and 0", "2 and 1", "3 and 2"]) {
                "1 and 0" => (1, 0),
                "2 and 1" => (2, 1),
                "3 and 2" => (3, 2),
                _ => (1, 1),
            };
        let (roulette, roulette_after) = match self.deck.deal("roulette", &["as usual", "at once", "none"]) {
            "at once" => (true, Some(0)),
            "none" => (false, None),
            _ => (true, None),
        };
        Settings {
            heuristic,
            sampler,
            light_paths,
            connections,
            roulette,
            roulette_after,
            ..settings(Integrator::Bdpt, BOUNCES)
        }
    }
}
