//! The undisturbed scene: a closed room with a lamp, a ball and a leaning board, seen from inside.

use serde_json::{Value, json};

/// A scene in parts that can be changed.
#[derive(Clone, Debug)]
pub struct Room {
    pub camera: Value,
    pub surfaces: Vec<Value>,
    pub lights: Vec<Value>,
}

/// A diffuse material.
pub fn diffuse(albedo: f64) -> Value {
    json!({ "type": "lambertian", "albedo": [albedo, 0.9 * albedo, 0.8 * albedo] })
}

/// A black emitter.
pub fn shining(radiance: f64) -> Value {
    json!({ "type": "diffuse light", "emit": radiance })
}

/// A quad of these extents about `center`, turned by `degrees` about an axis from facing along z.
pub fn quad(size: [f64; 2], degrees: f64, axis: [f64; 3], center: [f64; 3], material: Value) -> Value {
    json!({
        "type": "quad", "size": size, "material": material,
        "transform": [{ "axis": axis, "angle": degrees }, { "translate": center }]
    })
}

/// A ball.
pub fn ball(center: [f64; 3], radius: f64, material: Value) -> Value {
    json!({ "type": "sphere", "radius": radius, "material": material, "transform": [{ "translate": center }] })
}

/// A delta point with this light.
pub fn delta(position: [f64; 3], material: Value) -> Value {
    json!({ "type": "delta point", "material": material, "transform": [{ "translate": position }] })
}

/// A delta light that shines along a direction.
pub fn delta_toward(position: [f64; 3], at: [f64; 3], up: [f64; 3], material: Value) -> Value {
    json!({ "type": "delta point", "material": material, "transform": [{ "from": position, "at": at, "up": up }] })
}

/// Axes to turn about.
pub const X: [f64; 3] = [1.0, 0.0, 0.0];
pub const Y: [f64; 3] = [0.0, 1.0, 0.0];

/// The place among the surfaces of the floor, the ceiling, the back wall and the lamp.
pub const FLOOR: usize = 0;
pub const CEILING: usize = 1;
pub const BACK: usize = 4;
pub const LAMP: usize = 6;

impl Room {
    /// Two units wide, with a lamp below the ceiling.
    pub fn new() -> Self {
        let wall = |degrees, axis, center, albedo| quad([2.0; 2], degrees, axis, center, diffuse(albedo));
        let board = json!({ "type": "lambertian", "albedo": 0.4, "two_sided": true });
        Self {
            camera: json!({
                "transform": [{ "from": [0.1, 0.05, 0.93], "at": [0, -0.25, -1], "up": [0, 1, 0] }],
                "resolution": [8, 8], "vfov": 75
            }),
            surfaces: vec![
                wall(-90.0, X, [0.0, -1.0, 0.0], 0.7),
                wall(90.0, X, [0.0, 1.0, 0.0], 0.6),
                wall(90.0, Y, [-1.0, 0.0, 0.0], 0.5),
                wall(-90.0, Y, [1.0, 0.0, 0.0], 0.3),
                wall(0.0, Y, [0.0, 0.0, -1.0], 0.6),
                wall(180.0, Y, [0.0, 0.0, 1.0], 0.6),
                quad([0.7, 0.6], 90.0, X, [0.05, 0.9, -0.1], shining(4.0)),
                ball([-0.4, -0.65, -0.3], 0.3, diffuse(0.7)),
                quad([0.6, 0.8], -35.0, X, [0.45, -0.6, -0.4], board),
            ],
            lights: vec![],
        }
    }

    /// Without the lamp, with these surfaces instead.
    pub fn lit_by(mut self, lights: Vec<Value>) -> Self {
        self.surfaces.remove(LAMP);
        self.surfaces.extend(lights);
        self
    }

    /// With these surfaces more.
    pub fn with(mut self, more: Vec<Value>) -> Self {
        self.surfaces.extend(more);
        self
    }

    /// With another surface in the place of one.
    pub fn replacing(mut self, index: usize, surface: Value) -> Self {
        self.surfaces[index] = surface;
        self
    }

    /// Moved and scaled as a whole.
    pub fn posed(mut self, steps: &[Value]) -> Self {
        for thing in self.surfaces.iter_mut().chain([&mut self.camera]) {
            let chain = thing["transform"].as_array_mut().expect("transforms of rooms are chains");
            chain.extend_from_slice(steps);
        }
        self
    }

    /// The file.
    pub fn json(&self) -> Value {
        json!({ "camera": self.camera, "surfaces": self.surfaces, "lights": self.lights })
    }
}

/// An empty scene that a camera looks at from the origin along −z.
pub fn alone(surfaces: Vec<Value>, lights: Vec<Value>) -> Room {
    Room {
        camera: json!({
            "transform": [{ "from": [0, 0, 0], "at": [0, 0, -1], "up": [0, 1, 0] }], "resolution": [8, 8], "vfov": 60
        }),
        surfaces,
        lights,
    }
}
