//! Values at known points.

use super::*;
use crate::math::{PointWithError, Vec3};

fn at(p: Vec3, uv: [f32; 2]) -> SurfacePoint {
    let point = PointWithError { p, error: Vec3::ZERO };
    SurfacePoint { point, ng: Vec3::Z, ns: Vec3::Z, surface: 0, primitive: 0, uv }
}

const A: Texture = Texture::Constant(Rgb::new(1.0, 2.0, 3.0));
const B: Texture = Texture::Constant(Rgb::new(4.0, 8.0, 0.0));

fn checker(factor: f64, offset: DVec3, scale: DVec3) -> Texture {
    Texture::Checker(Arc::new(Checker { to_world: ToWorld { factor, offset }, scale, even: A, odd: B }))
}

#[test]
fn checkers_follow_the_sign_of_the_product_in_world_space() {
    let cells = checker(1.0, DVec3::ZERO, DVec3::ONE);
    for (p, odd) in [
        ([0.5, 0.5, 0.5], false),
        ([-0.5, 0.5, 0.5], true),
        ([-0.5, -0.5, 0.5], false),
        ([-0.5, -0.5, -0.5], true),
        ([3.5, 0.5, 0.5], true),
        ([6.5, 0.5, 0.5], false),
    ] {
        let wanted = if odd { Rgb::new(4.0, 8.0, 0.0) } else { Rgb::new(1.0, 2.0, 3.0) };
        assert_eq!(cells.color(&at(Vec3::from(p), [0.0; 2])), wanted, "{p:?}");
    }
    // x in [π/2, π] of the world, from render space: (0.25·8 − 1)·2 = 2 and (0.5·8 − 1)·2 = 6.
    let moved = checker(8.0, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(2.0, 1.0, 1.0));
    assert_eq!(moved.color(&at(Vec3::new(0.25, 0.0, 0.0), [0.0; 2])).x, 1.0);
    assert_eq!(moved.color(&at(Vec3::new(0.5, 0.0, 0.0), [0.0; 2])).x, 4.0);
    assert_eq!(moved.scalar(&at(Vec3::new(0.5, 0.0, 0.0), [0.0; 2])), 4.0);
}

/// A plane on which a sine is zero has the pattern's value there, not that of its points' rounding.
#[test]
fn a_plane_of_the_pattern_is_even_all_over() {
    let cells = checker(1.0, DVec3::ZERO, DVec3::splat(3.0));
    for z in [0.0, 1e-7, -1e-7] {
        for i in 0..100 {
            let p = Vec3::new(i as f32 * 0.37, i as f32 * 0.73, z);
            assert_eq!(cells.color(&at(p, [0.0; 2])), Rgb::new(1.0, 2.0, 3.0));
        }
    }
}

#[test]
fn marble_runs_from_base_to_veins_along_z_where_the_noise_is_zero() {
    let marble = |scale| {
        let to_world = ToWorld { factor: 2.0, offset: DVec3::ZERO };
        Texture::Marble(Arc::new(Marble { to_world, scale, base: A, veins: B }))
    };
    // On the lattice there is no turbulence: ½(1 + sin(scale·z)) alone.
    for (scale, z, t) in
        [(1.0, 0.0, 0.5), (0.25 * std::f64::consts::PI, 2.0, 1.0), (0.25 * std::f64::consts::PI, -2.0, 0.0)]
    {
        let found = marble(scale).color(&at(Vec3::new(1.5, -0.5, z * 0.5), [0.0; 2]));
        let wanted = Rgb::new(1.0, 2.0, 3.0).lerp(Rgb::new(4.0, 8.0, 0.0), t);
        assert!((found - wanted).abs().max_element() < 1e-5, "{scale} {z}: {found}, not {wanted}");
    }
    // Beside it there is.
    let (a, b) =
        (marble(0.0).color(&at(Vec3::splat(0.1), [0.0; 2])), marble(0.0).color(&at(Vec3::splat(0.3), [0.0; 2])));
    assert!((a - b).abs().max_element() > 1e-2, "{a} {b}");
}

#[test]
fn bounds_hold_and_uv_is_asked_for_where_an_image_is() {
    let texels = Arc::new(vec![[0.0, 1.0, 5.0], [7.0, 0.5, 0.0]]);
    let image =
        ImageTexture::new(Arc::clone(&texels), [2, 1], 0.5, Wrap::Clamp, true).map(Texture::Image).expect("2 texels");
    assert_eq!(image.largest(), Rgb::new(3.5, 0.5, 2.5));
    assert!(image.needs_uv() && !A.needs_uv());
    let to_world = ToWorld { factor: 1.0, offset: DVec3::ZERO };
    let mixed = Texture::Marble(Arc::new(Marble { to_world, scale: 1.0, base: image, veins: A }));
    assert!(mixed.needs_uv());
    assert_eq!(mixed.largest(), Rgb::new(3.5, 2.0, 3.0));
    assert!(ImageTexture::new(texels, [2, 2], 1.0, Wrap::Clamp, true).is_none(), "too few texels");
}
