//! Each map against sums over the shape's area, which know nothing of solid angles: dω = |cosθ| dA/d².

use super::*;
use crate::sampling::ONE_MINUS_EPSILON;

const N: u32 = 512;

/// Midpoints of a grid over the unit square.
fn grid() -> impl Iterator<Item = [f64; 2]> {
    (0..N * N).map(|i| [f64::from(i % N) + 0.5, f64::from(i / N) + 0.5].map(|x| x / f64::from(N)))
}

/// Moments of a direction that tell densities apart.
fn moments(w: DVec3) -> [f64; 9] {
    [w.x, w.y, w.z, w.x * w.x, w.y * w.y, w.x * w.y, w.y * w.z, w.x * w.z, (w.x + 2.0 * w.y).powi(3)]
}

/// Demands that what is sampled is uniform in solid angle: `area` gives point, normal and dA of each grid point.
fn check(
    what: &str,
    solid_angle: f64,
    tolerance: f64,
    direction: impl Fn([f32; 2]) -> DVec3,
    area: impl Fn([f64; 2]) -> (DVec3, DVec3, f64),
) {
    let count = f64::from(N * N);
    let (mut subtended, mut expected) = (0.0, [0.0; 9]);
    for u in grid() {
        let (p, n, da) = area(u);
        let w = p.normalize();
        // What faces away lies behind what faces the point.
        let omega = (-n.dot(w)).max(0.0) * da / (p.length_squared() * count);
        subtended += omega;
        expected.iter_mut().zip(moments(w)).for_each(|(e, m)| *e += omega * m);
    }
    assert!((subtended / solid_angle - 1.0).abs() < tolerance, "{what}: Ω {solid_angle}, summed {subtended}");
    let mut seen = [0.0; 9];
    for u in grid() {
        let w = direction([u[0] as f32, u[1] as f32]);
        assert!((w.length() - 1.0).abs() < 1e-9, "{what}: {w}");
        seen.iter_mut().zip(moments(w)).for_each(|(s, m)| *s += m / count);
    }
    for (k, (s, e)) in seen.into_iter().zip(expected).enumerate() {
        let e = e / subtended;
        assert!((s - e).abs() < tolerance * e.abs().max(1.0), "{what}, moment {k}: {s}, expected {e}");
    }
    for a in [0.0, ONE_MINUS_EPSILON] {
        for b in [0.0, ONE_MINUS_EPSILON] {
            assert!(direction([a, b]).is_finite(), "{what}: {a}, {b}");
        }
    }
}

#[test]
fn rectangles() {
    for (corner, size) in [
        (DVec3::new(-0.5, -0.5, 1.0), [1.0, 1.0]),
        (DVec3::new(0.3, -2.0, 0.4), [0.7, 3.0]),
        (DVec3::new(1.0, 1.5, -0.05), [2.0, 1.0]),
        (DVec3::new(-3.0, -3.0, 0.05), [6.0, 6.0]),
        (DVec3::new(5.0, 4.0, 3.0), [1.0, 0.2]),
    ] {
        // Turned, so that no axis is special.
        let turn = glam::DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.8);
        let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| turn * a);
        let corner = turn * corner;
        let r = SphericalRectangle::new(corner, [x, y], size).expect("inside the safe range");
        let place = |u: [f64; 2]| corner + x * (u[0] * size[0]) + y * (u[1] * size[1]);
        let facing = if corner.dot(z) > 0.0 { -z } else { z };
        // The sum near the plane is over a peak.
        let tolerance = if corner.dot(z).abs() < 0.1 { 5e-3 } else { 2e-5 };
        check(
            &format!("rectangle at {corner}"),
            r.solid_angle(),
            tolerance,
            |u| {
                let [s, t] = r.sample(u);
                assert!((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t), "{s}, {t}");
                place([s, t]).normalize()
            },
            |u| (place(u), facing, size[0] * size[1]),
        );
    }
}

#[test]
fn triangles() {
    for corners in [
        [DVec3::new(0.0, 0.0, 1.0), DVec3::new(1.0, 0.0, 1.0), DVec3::new(0.0, 1.0, 1.2)],
        [DVec3::new(1.0, 0.1, 0.0), DVec3::new(-0.2, 1.0, 0.0), DVec3::new(0.1, 0.0, 1.0)],
        [DVec3::new(-3.0, -2.0, 0.7), DVec3::new(3.0, -2.5, 0.8), DVec3::new(0.0, 4.0, 0.6)],
        [DVec3::new(2.0, 2.0, 3.0), DVec3::new(2.3, 2.0, 2.9), DVec3::new(2.0, 2.9, 3.1)],
    ] {
        let t = SphericalTriangle::new(corners).expect("inside the safe range");
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let n = cross.normalize();
        let facing = if n.dot(a) > 0.0 { -n } else { n };
        // The square folded onto the triangle, area-preserving.
        let place = |u: [f64; 2]| {
            let root = u[0].sqrt();
            a * (1.0 - root) + b * (root * (1.0 - u[1])) + c * (root * u[1])
        };
        check(
            &format!("triangle {corners:?}"),
            t.solid_angle(),
            5e-4,
            |u| t.sample(u),
            |u| (place(u), facing, 0.5 * cross.length()),
        );
    }
}

#[test]
fn spheres() {
    for (center, radius) in
        [(DVec3::new(0.0, 0.0, 3.0), 1.0), (DVec3::new(1.0, -2.0, 0.5), 2.25), (DVec3::new(-3.0, 4.0, 1.0), 0.01)]
    {
        let cone = SphereCone::new(center, radius).expect("outside");
        let place = |n: DVec3| center + n * radius;
        check(
            &format!("sphere at {center}"),
            cone.solid_angle(),
            2e-3,
            |u| {
                let n = cone.sample(u);
                assert!(n.dot(place(n)) <= 1e-9, "{n} faces away");
                place(n).normalize()
            },
            |u| {
                let z = 1.0 - 2.0 * u[0];
                let (sin, cos) = (2.0 * PI * u[1]).sin_cos();
                let r = (1.0 - z * z).sqrt();
                let n = DVec3::new(r * cos, r * sin, z);
                (place(n), n, 4.0 * PI * radius * radius)
            },
        );
    }
    assert!(SphereCone::new(DVec3::new(0.0, 0.5, 0.0), 1.0).is_none(), "from inside");
    assert!(SphereCone::new(DVec3::ZERO, 1.0).is_none(), "from the centre");
    // A far small one: Ω = π(R/d)².
    let cone = SphereCone::new(DVec3::new(0.0, 0.0, 1e6), 1e-3).expect("outside");
    assert!((cone.solid_angle() / (PI * 1e-18) - 1.0).abs() < 1e-9);
}

#[test]
fn outside_the_safe_range_there_is_no_map() {
    let axes = [DVec3::X, DVec3::Y];
    assert!(SphericalRectangle::new(DVec3::new(0.0, 0.0, 100.0), axes, [1.0, 1.0]).is_none(), "far");
    assert!(SphericalRectangle::new(DVec3::new(0.0, 0.0, 0.0), axes, [1.0, 1.0]).is_none(), "in its plane");
    assert!(SphericalRectangle::new(DVec3::new(-1e3, -1e3, 1e-3), axes, [2e3, 2e3]).is_none(), "all around");
    let corners = [DVec3::new(0.0, 0.0, 100.0), DVec3::new(1.0, 0.0, 100.0), DVec3::new(0.0, 1.0, 100.0)];
    assert!(SphericalTriangle::new(corners).is_none(), "far");
    assert!(SphericalTriangle::new([DVec3::ZERO, DVec3::X, DVec3::Y]).is_none(), "at a corner");
}

/// A cube's six faces, seen from anywhere inside, are all directions.
#[test]
fn faces_of_a_cube_subtend_the_sphere() {
    let p = DVec3::new(0.21, -0.43, 0.37);
    let mut sum = 0.0;
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let at = |i: usize| DVec3::AXES[i % 3];
            let corner = at(axis) * side - at(axis + 1) - at(axis + 2) - p;
            let face = SphericalRectangle::new(corner, [at(axis + 1), at(axis + 2)], [2.0, 2.0]).expect("safe");
            let edges = [at(axis + 1) * 2.0, at(axis + 2) * 2.0];
            let halves = [
                [corner, corner + edges[0], corner + edges[0] + edges[1]],
                [corner, corner + edges[1], corner + edges[0] + edges[1]],
            ];
            let split: f64 = halves.map(|t| SphericalTriangle::new(t).expect("safe").solid_angle()).iter().sum();
            assert!((face.solid_angle() - split).abs() < 1e-12, "{} {split}", face.solid_angle());
            sum += face.solid_angle();
        }
    }
    assert!((sum - 4.0 * PI).abs() < 1e-12, "{sum}");
}
