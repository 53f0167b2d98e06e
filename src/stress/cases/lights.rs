//! Tiny, huge, many and misplaced lights.

use serde_json::{Value, json};

use super::super::{Case, Expected};
use super::room::{LAMP, Room, X, ball, delta, delta_toward, quad, shining};

pub fn cases(full: bool) -> Vec<Case> {
    let mut all = Vec::new();
    tiny(&mut all);
    bright(&mut all);
    delta_points(&mut all);
    many(&mut all, full);
    all
}

/// A room lit by these surfaces.
fn lit(lights: Vec<Value>) -> Value {
    Room::new().lit_by(lights).json()
}

fn point(intensity: f64) -> Value {
    json!({ "type": "point light", "emit": intensity })
}

/// Where the camera does not see it: behind, and above; in numbers of few bits, beside which a lamp of 2⁻²⁰ is exact in f32.
const PLACE: [f64; 3] = [0.0625, 0.625, 0.96875];

fn tiny(all: &mut Vec<Case>) {
    // I(θ) = L A cosθ: a spot whose intensity falls as the cosine from its axis to a right angle.
    let side = (-20.0_f64).exp2();
    let small = quad([side; 2], 90.0, X, PLACE, shining(1.0 / (side * side)));
    let cosine = json!({ "type": "spot light", "emit": 1, "inner_angle": 0, "outer_angle": 90, "falloff": 1 });
    let below = [PLACE[0], -1.0, PLACE[2]];
    let expected =
        Expected::SameAs { scene: lit(vec![delta_toward(PLACE, below, [0.0, 0.0, 1.0], cosine)]), times: 1.0 };
    let what = "a lamp of area 2⁻⁴⁰ against a point with its intensity, L A cosθ";
    all.push(Case::new("tiny quad", what, lit(vec![small]), expected).closed().samples(64).within(0.02));
    let radius = 1e-6_f64;
    let small = ball(PLACE, radius, shining(1.0 / (std::f64::consts::PI * radius * radius)));
    let expected = Expected::SameAs { scene: lit(vec![delta(PLACE, point(1.0))]), times: 1.0 };
    let what = "a shining ball of radius 10⁻⁶ against a point with its intensity, L π R²";
    all.push(Case::new("tiny ball", what, lit(vec![small]), expected).closed().samples(64).within(0.02));
}

fn bright(all: &mut Vec<Case>) {
    for power in [-66, 66] {
        let factor = f64::from(power).exp2();
        let mut room = Room::new();
        room.surfaces[LAMP]["material"] = shining(4.0 * factor);
        let expected = Expected::SameBits { scene: Room::new().json(), times: factor };
        let what = "radiance times a power of two, near 10^±20";
        all.push(Case::new(format!("radiance 2^{power}"), what, room.json(), expected).closed());
    }
}

fn delta_points(all: &mut Vec<Case>) {
    let same = |lights: Vec<Value>, times: f64| Expected::SameAs { scene: lit(lights), times };
    let one = vec![delta(PLACE, point(1.0))];
    let two = lit(vec![delta(PLACE, point(1.0)), delta(PLACE, point(1.0))]);
    all.push(
        Case::new("two in one place", "two points of light in one place", two, same(one.clone(), 2.0))
            .closed()
            .within(0.02)
            .samples(2),
    );
    let up = json!({ "type": "spot light", "emit": 1, "inner_angle": 90, "outer_angle": 90 });
    let at = [0.5, -1.0, 0.3];
    let above = delta_toward([at[0], -1.0 + 1e-4, at[2]], [at[0], 1.0, at[2]], [0.0, 0.0, 1.0], up);
    let what = "a point of light on the floor, against the upper half of one just above it";
    let case = Case::new("point on the floor", what, lit(vec![delta(at, point(1.0))]), same(vec![above], 1.0));
    all.push(case.closed().samples(64).within(0.02));
    let spot = |inner: f64, outer: f64| {
        let light = json!({ "type": "spot light", "emit": 1, "inner_angle": inner, "outer_angle": outer });
        lit(vec![delta_toward(PLACE, [PLACE[0], -1.0, PLACE[2]], [0.0, 0.0, 1.0], light)])
    };
    // As small as what it keeps out is large as seen from the point: what it hides otherwise is nothing.
    let masked = |mask: Value| lit(vec![delta(PLACE, point(1.0)), mask]);
    let what = "a spot without a rim, against a point in a black shade";
    let expected = Expected::SameAs { scene: masked(shade(30.0)), times: 1.0 };
    let case = Case::new("spot 30° hard", what, spot(30.0, 30.0), expected).closed().within(0.02);
    // Of the light paths that start in the shade, one in fifteen leaves it.
    let light = Case { name: "spot 30° hard, light".to_owned(), ..case.clone() };
    all.extend([case.from_camera().samples(64), light.by_light().samples(1024)]);
    let what = "a spot that is half a point, against a point under a black lid";
    let expected = Expected::SameAs { scene: masked(lid()), times: 1.0 };
    let case = Case::new("spot 90° hard", what, spot(90.0, 90.0), expected).closed().samples(64).within(0.02);
    all.push(case.apart(1e-3, "light leaves below the lid at less than 2⁻¹⁰ above the point's plane"));
    let what = "a spot that is a whole point";
    all.push(Case::new("spot 180° hard", what, spot(180.0, 180.0), same(one, 1.0)).closed().samples(64).within(0.02));
    all.push(Case::new("spot 0°", "a spot of no width", spot(0.0, 0.0), Expected::Nothing).closed());
    // Both light a point of the floor, which sends on what its cone holds: 1 − cosθ.
    let versine = |degrees: f64| 2.0 * (0.5 * degrees.to_radians()).sin().powi(2);
    let expected = Expected::SameAs { scene: spot(0.0, 0.05), times: versine(1e-4) / versine(0.05) };
    let what = "a spot of a ten-thousandth of a degree, against one 500 times as wide";
    let case = Case::new("spot 1e-4°", what, spot(0.0, 1e-4), expected).closed().samples(4).within(0.02);
    all.push(Case { integrators: Case::FROM_LIGHT, ..case });
}

/// Black on both sides.
fn black() -> Value {
    json!({ "type": "lambertian", "albedo": 0, "two_sided": true })
}

/// A black bucket upside down about `PLACE`, through whose mouth the point sees the cone of this half-angle: of 256 corners, as
/// large as the circle.
fn shade(degrees: f64) -> Value {
    let (height, corners) = ((-10.0_f64).exp2(), 256);
    let step = std::f64::consts::TAU / f64::from(corners);
    let radius = height * degrees.to_radians().tan() * (step / step.sin()).sqrt();
    let ring = |y: f64| {
        (0..corners).map(move |i| (f64::from(i) * step, y)).map(move |(a, y)| [radius * a.cos(), y, radius * a.sin()])
    };
    let around = ring(-height).chain(ring(height)).chain([[0.0, height, 0.0]]);
    let positions: Vec<[f64; 3]> = around.map(|p| std::array::from_fn(|k| PLACE[k] + p[k])).collect();
    let n = corners as usize;
    let sides = (0..n).map(|i| vec![i, (i + 1) % n, n + (i + 1) % n, n + i]);
    let top = (0..n).map(|i| vec![n + i, n + (i + 1) % n, 2 * n]);
    let faces: Vec<Vec<usize>> = sides.chain(top).collect();
    json!({ "type": "mesh", "positions": positions, "indices": faces, "material": black(), "transform": [] })
}

/// A black sheet just above `PLACE`, a thousand times as wide as it is far.
fn lid() -> Value {
    quad([(-7.0_f64).exp2(); 2], 90.0, X, [PLACE[0], PLACE[1] + (-18.0_f64).exp2(), PLACE[2]], black())
}

fn many(all: &mut Vec<Case>, full: bool) {
    let strong = delta(PLACE, point(1.0));
    let weak = delta([-0.5, 0.2, 0.5], point(1e-12));
    let expected = Expected::SameAs { scene: lit(vec![strong.clone()]), times: 1.0 };
    let what = "two points of light, one 10¹² times as strong as the other";
    all.push(Case::new("powers 1 : 10¹²", what, lit(vec![strong, weak]), expected).closed().within(0.01));
    // A lamp in n × n cells.
    let cells = |n: usize| {
        let at = |i: usize, half: f64| half * (2.0 * i as f64 / n as f64 - 1.0);
        let corners = (0..=n).flat_map(|j| (0..=n).map(move |i| (i, j)));
        let positions: Vec<[f64; 3]> = corners.map(|(i, j)| [0.05 + at(i, 0.35), 0.9, -0.1 + at(j, 0.3)]).collect();
        let faces: Vec<[usize; 4]> = (0..n)
            .flat_map(|j| (0..n).map(move |i| j * (n + 1) + i))
            .map(|k| [k, k + 1, k + n + 2, k + n + 1])
            .collect();
        lit(vec![json!({ "type": "mesh", "positions": positions, "indices": faces, "material": shining(4.0) })])
    };
    let expected = Expected::SameAs { scene: Room::new().json(), times: 1.0 };
    let n = if full { 708 } else { 50 };
    let what = "the lamp in pieces, each of which is a light to choose";
    let name = format!("{} lights", 2 * n * n);
    all.push(Case::new(name, what, cells(n), expected).closed().samples(8).within(0.04));
}
