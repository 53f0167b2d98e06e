//! Values at known points.

use super::*;
use crate::geometry::SurfaceTag;
use crate::math::{PointWithError, Vec3};

fn at(p: Vec3, uv: [f32; 2]) -> SurfacePoint {
    let point = PointWithError { p, error: Vec3::ZERO };
    SurfacePoint { point, ng: Vec3::Z, ns: Vec3::Z, tag: SurfaceTag::new(0, 0, uv) }
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

/// A plane on which a sine is zero has the pattern's value there, not that of its points' rounding, at every size of the
/// cells and of the world.
#[test]
fn a_plane_of_the_pattern_is_even_all_over() {
    // z = 30 is 2.5 in a render space scaled by 1/8 and moved by 10: known to a bound of a few units in the last place.
    let bound = Vec3::splat(2.5 * 1e-6);
    for cells_across in [1.0, 1e3, 1e5] {
        let scale = DVec3::splat(std::f64::consts::PI * cells_across / 30.0);
        let cells = checker(8.0, DVec3::splat(10.0), scale);
        for i in 0..1000 {
            let z = f32::from_bits(2.5f32.to_bits() + i % 4 - 2);
            let point = PointWithError { p: Vec3::new(i as f32 * 0.0037, i as f32 * 0.0073, z), error: bound };
            let at = SurfacePoint { point, ..at(Vec3::ZERO, [0.0; 2]) };
            assert_eq!(cells.color(&at), Rgb::new(1.0, 2.0, 3.0), "{cells_across} cells, {point:?}");
        }
    }
}

/// Beside it the pattern is itself: no wider than the rounding is the band in which the sine counts as zero.
#[test]
fn beside_a_plane_of_the_pattern_the_cells_begin() {
    // Cells a million across: a ten-thousandth off the plane is 3e-10 radians, and no rounding.
    let cells = checker(1.0, DVec3::ZERO, DVec3::splat(std::f64::consts::PI * 1e-6));
    let error = Vec3::splat(1e-6);
    for (z, odd) in [(1e-4, false), (-1e-4, true), (1.0, false), (-1.0, true), (5e-7, false), (-5e-7, false)] {
        let at =
            SurfacePoint { point: PointWithError { p: Vec3::new(2.0, 3.0, z), error }, ..at(Vec3::ZERO, [0.0; 2]) };
        assert_eq!(cells.color(&at).x == 4.0, odd, "{z}");
    }
    // A surface through it has a half of each, however near.
    let point = PointWithError { p: Vec3::new(2.0, 3.0, -5e-7), error };
    let tilted = SurfacePoint { point, ng: Vec3::new(0.6, 0.0, 0.8), ..at(Vec3::ZERO, [0.0; 2]) };
    assert_eq!(cells.color(&tilted).x, 4.0);
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

/// Every surface asks for the bounds of its textures: they are found once, or this takes minutes.
#[test]
fn an_images_bounds_are_found_once() {
    let mut texels = vec![[0.5; 3]; 1 << 20];
    (texels[77], texels[1 << 19]) = ([0.25, 0.5, 0.5], [0.5, 0.5, 4.0]);
    let image = ImageTexture::new(Arc::new(texels), [1 << 10; 2], 0.5, Wrap::Clamp, true).expect("texels");
    let start = std::time::Instant::now();
    for _ in 0..200_000 {
        let image = std::hint::black_box(Texture::Image(image.clone()));
        assert_eq!((image.largest(), image.smallest()), (Rgb::new(0.25, 0.25, 2.0), Rgb::new(0.125, 0.25, 0.25)));
        assert!(start.elapsed().as_secs() < 20, "a million texels were looked through for each of 200 000 surfaces");
    }
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
