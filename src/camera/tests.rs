use super::*;
use crate::math::DVec3;

const LENS: ThinLens = ThinLens { radius: 0.2, focus: 1.7 };

fn pose() -> DAffine3 {
    DAffine3::from_rotation_translation(
        glam::DQuat::from_axis_angle(DVec3::new(0.3, 1.0, -0.2).normalize(), 0.7),
        DVec3::new(0.5, -0.25, 2.0),
    )
}

fn camera() -> Camera {
    Camera::pinhole(&pose(), 70.0, 64, 48)
}

fn every_kind() -> [Camera; 3] {
    [camera(), Camera::thin_lens(&pose(), 70.0, LENS, 64, 48), Camera::orthographic(&pose(), 1.3, 64, 48)]
}

fn numbers(u: [f32; 2]) -> LensNumbers {
    LensNumbers { lens: u, ..LensNumbers::IDLE }
}

#[test]
fn a_ray_is_seen_through_the_pixel_it_was_made_for() {
    for c in every_kind() {
        for pixel in [[0, 0], [63, 0], [0, 47], [63, 47], [31, 20]] {
            for u in [[0.01, 0.01], [0.99, 0.99], [0.5, 0.3]] {
                let lens = [u[1], 0.7];
                let r = c.generate_ray(pixel, u, lens);
                let s = c.sample_lens(r.ray.at(3.7), &numbers(lens)).expect("in view");
                assert_eq!(s.pixel, pixel);
                assert!((s.pdf.0 / r.pdf.0 - 1.0).abs() < 1e-5);
                assert!((s.wi + r.ray.d).length() < 1e-6);
                assert!((s.p - r.ray.o).length() < 1e-6);
                assert!((s.d2 / c.edge_d2(r.ray.o, r.ray.at(3.7)) - 1.0).abs() < 1e-5);
            }
        }
    }
}

/// With a filter, the pixels' rays cross each other's pixels; all have the density of the pixels together.
#[test]
fn a_filtered_ray_has_the_density_that_its_place_is_seen_with() {
    for filter in [Filter::Box(0.8), Filter::Tent(1.2), Filter::Gaussian(1.5)] {
        for c in every_kind().map(|c| c.with_filter(filter)) {
            for pixel in [[0, 0], [63, 47], [31, 20]] {
                for u in [[0.07, 0.1], [0.93, 0.9], [0.5, 0.3]] {
                    let r = c.generate_ray(pixel, u, [0.2, 0.7]);
                    let mut found = false;
                    for i in 0..100 {
                        let pixel_u = [(i % 10) as f32 / 10.0 + 0.05, (i / 10) as f32 / 10.0 + 0.05];
                        let n = LensNumbers { lens: [0.2, 0.7], pixel: pixel_u };
                        let s = c.sample_lens(r.ray.at(2.3), &n).expect("in reach");
                        // A tent falls to nothing at its rim, where the place's rounding shows.
                        assert!((s.pdf.0 / r.pdf.0 - 1.0).abs() < 1e-4, "{filter:?} {pixel:?}: {s:?} {r:?}");
                        found |= s.pixel == pixel;
                    }
                    assert!(found, "{filter:?}: {pixel:?} never gets back what it sees at {u:?}");
                }
            }
        }
    }
}

#[test]
fn just_outside_each_edge_there_is_no_pixel() {
    for c in every_kind() {
        let (w, h) = (c.half_width, c.half_height);
        // In the plane in focus, where a point of the film is seen from all of the lens.
        let focus =
            if let Projection::ThinLens { inverse_focus, .. } = c.projection { 1.0 / inverse_focus } else { 1.0 };
        let at = |x: f32, y: f32| c.position + (c.right * x + c.up * y + c.forward) * focus;
        for n in [[0.5, 0.5], [0.0, 0.4], [0.9, 0.9]].map(numbers) {
            for (x, y) in [(-w, 0.0), (w, 0.0), (0.0, h), (0.0, -h)] {
                assert!(c.sample_lens(at(x * 1.001, y * 1.001), &n).is_none());
                assert!(c.sample_lens(at(x * 0.999, y * 0.999), &n).is_some());
            }
            assert!(c.sample_lens(c.position - c.forward, &n).is_none());
        }
        assert!(c.sample_lens(c.position, &LensNumbers::IDLE).is_none());
    }
}

#[test]
fn a_pixels_density_integrates_to_one_over_its_directions() {
    // ∫ p_ω dω over the pixel = ∫ p_ω cos³θ dA, by the midpoint rule over the whole film: one per pixel.
    for c in every_kind() {
        let n = 400;
        let mut sum = 0.0;
        let parallel = matches!(c.projection, Projection::Orthographic);
        for i in 0..n * n {
            let at = |i: u32| (i as f32 + 0.5) / n as f32 * 2.0 - 1.0;
            let film = c.right * (at(i % n) * c.half_width) + c.up * (at(i / n) * c.half_height);
            let d = if parallel { c.forward } else { (film + c.forward).normalize() };
            let from = if parallel { c.position + film } else { c.position };
            // The lens's centre sees the film as a pinhole does; other points see it shifted.
            let s = c.sample_lens(from + d, &LensNumbers::IDLE).expect("in view");
            sum += s.pdf.0 * f64::from(d.dot(c.forward)).powi(3);
        }
        let area = 4.0 * f64::from(c.half_width) * f64::from(c.half_height);
        let total = sum * area / f64::from(n * n);
        assert!((total / (64.0 * 48.0) - 1.0).abs() < 1e-5, "{total}");
    }
}

#[test]
fn every_point_of_the_lens_sends_a_pixels_rays_to_one_point_in_focus() {
    let c = Camera::thin_lens(&pose(), 70.0, LENS, 64, 48);
    let pinhole = camera();
    for (pixel, u) in [([0, 0], [0.1, 0.2]), ([63, 20], [0.9, 0.5]), ([30, 47], [0.4, 0.8])] {
        let through_center = pinhole.generate_ray(pixel, u, [0.5; 2]);
        let focus = through_center.ray.at(LENS.focus as f32 / through_center.cos);
        let mut farthest = 0.0_f32;
        for i in 0..64 {
            let lens = [(i % 8) as f32 / 8.0, (i / 8) as f32 / 8.0];
            let r = c.generate_ray(pixel, u, lens);
            farthest = farthest.max((r.ray.o - c.position).length());
            assert!((r.ray.o - c.position).dot(c.forward).abs() < 1e-6);
            let at = r.ray.at(LENS.focus as f32 / r.cos);
            assert!((at - focus).length() < 2e-6 * 3.0, "{at} {focus}");
        }
        assert!((farthest - LENS.radius as f32).abs() < 1e-6);
    }
}

#[test]
fn parallel_rays_start_on_a_plane_that_moves_only_with_its_distance() {
    let near = Camera::orthographic(&DAffine3::from_translation(DVec3::new(0.1, -0.2, 3.0)), 1.3, 64, 48);
    let far = Camera::orthographic(&DAffine3::from_translation(DVec3::new(0.1, -0.2, 3e9)), 1.3, 64, 48);
    for pixel in [[0, 0], [63, 47], [31, 20]] {
        let (a, b) = (near.generate_ray(pixel, [0.3; 2], [0.5; 2]), far.generate_ray(pixel, [0.3; 2], [0.5; 2]));
        assert_eq!((a.ray.o.x, a.ray.o.y, a.ray.d), (b.ray.o.x, b.ray.o.y, b.ray.d));
        assert_eq!((a.ray.o.z, b.ray.o.z), (3.0, 4.0));
    }
    assert!(near.sample_lens(Vec3::new(0.0, 0.0, 3.5), &LensNumbers::IDLE).is_none(), "behind the film");
}
