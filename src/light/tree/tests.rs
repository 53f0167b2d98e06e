use super::*;
use crate::sampling::warp;
use std::f32::consts::PI;

/// A stream of numbers in [0, 1).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    fn direction(&mut self) -> Vec3 {
        warp::uniform_sphere([self.next(), self.next()])
    }

    fn place(&mut self) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * 2.0 - Vec3::ONE
    }
}

/// Small flat emitters, spots and points all over a cube.
fn emitters(n: usize, seed: u64) -> Vec<EmitterBound> {
    let mut r = Numbers(seed);
    (0..n)
        .map(|i| {
            let (p, axis) = (r.place(), r.direction());
            let size = if i % 3 == 0 { Vec3::splat(0.1 * r.next()) } else { Vec3::ZERO };
            let (theta_normals, theta_reach) = match i % 3 {
                0 => (0.0, 0.5 * PI),
                1 => (0.2 + r.next(), 0.0),
                _ => (PI, 0.5 * PI),
            };
            let intensity = f64::powf(10.0, 6.0 * f64::from(r.next()) - 3.0);
            EmitterBound {
                lo: p - size,
                hi: p + size,
                axis,
                theta_normals,
                theta_reach,
                two_sided: i % 6 == 0,
                intensity,
            }
        })
        .collect()
}

/// A point light, as `Light::bound` describes it.
fn point(p: Vec3, intensity: f64) -> EmitterBound {
    EmitterBound { lo: p, hi: p, axis: Vec3::Z, theta_normals: PI, theta_reach: 0.0, two_sided: false, intensity }
}

fn receivers(n: usize) -> Vec<Receiver> {
    let mut r = Numbers(99);
    (0..n)
        .map(|i| {
            let p = r.place() * 1.5;
            Receiver { p, n: if i % 3 == 0 { Vec3::ZERO } else { r.direction() } }
        })
        .collect()
}

#[test]
fn the_probability_of_what_is_sampled_is_its_pmf_and_all_sum_to_one() {
    for n in [1, 2, 3, 7, 100] {
        let emitters = emitters(n, n as u64);
        let tree = LightTree::new(&emitters).expect("some emitters");
        for receiver in receivers(60) {
            let pmf: Vec<f64> = (0..n as u32).map(|e| tree.pmf(&receiver, e)).collect();
            let sum: f64 = pmf.iter().sum();
            // Where nothing shines a descent may end between two halves that send nothing, and part of the mass is lost.
            assert!(sum <= 1.0 + 1e-12, "{n}: {sum}");
            let everywhere: Vec<EmitterBound> =
                emitters.iter().map(|b| EmitterBound { theta_normals: PI, ..*b }).collect();
            let all = LightTree::new(&everywhere).expect("some emitters");
            let sum: f64 = (0..n as u32).map(|e| all.pmf(&Receiver::anywhere(receiver.p), e)).sum();
            assert!((sum - 1.0).abs() < 1e-12, "{n}: {sum}");
            let steps = 4000;
            let mut counts = vec![0u32; n];
            for i in 0..steps {
                let Some((e, p)) = tree.sample(&receiver, (f64::from(i) + 0.5) / f64::from(steps)) else { continue };
                assert_eq!(p, pmf[e as usize], "{n}: what was sampled has another probability when asked for");
                counts[e as usize] += 1;
            }
            for (c, p) in counts.iter().zip(&pmf) {
                // A strip of [0, 1) holds the midpoints of its length, up to one at each end; strips of one emitter are one.
                assert!((f64::from(*c) / f64::from(steps) - p).abs() < 2.0 / f64::from(steps), "{n}: {c} {p}");
            }
        }
    }
}

/// Points of flat emitters, and spots and points, that face a receiver which faces them always have a chance.
#[test]
fn what_shines_on_the_receiver_has_a_chance() {
    let n = 300;
    let emitters = emitters(n, 5);
    let tree = LightTree::new(&emitters).expect("some emitters");
    let mut r = Numbers(7);
    let mut shining = 0;
    for receiver in receivers(300) {
        for (e, b) in emitters.iter().enumerate() {
            let y = b.lo + (b.hi - b.lo) * Vec3::new(r.next(), r.next(), r.next());
            let w = (y - receiver.p).normalize();
            let theta = angle_between(-w, b.axis);
            let reach = b.theta_normals + b.theta_reach;
            let shines = b.theta_normals == PI || theta < reach || (b.two_sided && PI - theta < reach);
            let faces = receiver.n == Vec3::ZERO || w.dot(receiver.n) > 0.0;
            if shines && faces {
                shining += 1;
                assert!(tree.pmf(&receiver, e as u32) > 0.0, "{b:?} from {receiver:?}");
            }
        }
    }
    assert!(shining > 10_000, "{shining}");
}

/// The bounds of every node hold all that lies beneath it.
fn holds(tree: &LightTree, emitters: &[EmitterBound], at: usize) -> Vec<u32> {
    let node = &tree.nodes[at];
    let beneath = match node.leaf {
        true => vec![node.link],
        false => [holds(tree, emitters, at + 1), holds(tree, emitters, node.link as usize)].concat(),
    };
    for &e in &beneath {
        let b = &emitters[e as usize];
        for corner in 0..8 {
            let choose = |k: usize| if corner >> k & 1 == 0 { b.lo[k] } else { b.hi[k] };
            let p = Vec3::new(choose(0), choose(1), choose(2));
            assert!(p.distance_squared(Vec3::from_array(node.center)) <= node.radius2, "node {at}, emitter {e}: {p}");
        }
        let wide = node.cos_normals.acos() + 1e-3;
        let needed = angle_between(Vec3::from_array(node.axis), b.axis) + b.theta_normals;
        assert!(wide >= needed || wide >= PI, "node {at}, emitter {e}: a cone of {wide} for {needed}");
        assert!(node.cos_reach <= b.theta_reach.cos() && (node.two_sided || !b.two_sided), "node {at}, emitter {e}");
    }
    beneath
}

#[test]
fn nodes_hold_what_lies_beneath_them() {
    let place = emitters(2, 1)[0];
    for all in [emitters(700, 5), emitters(2, 8), vec![place; 50]] {
        let tree = LightTree::new(&all).expect("some emitters");
        let mut found = holds(&tree, &all, 0);
        found.sort_unstable();
        assert_eq!(found, (0..all.len() as u32).collect::<Vec<_>>());
    }
}

fn angle_between(a: Vec3, b: Vec3) -> f32 {
    a.cross(b).length().atan2(a.dot(b))
}

/// The near, the facing and the bright are chosen more often: against the contributions of points to a plane.
#[test]
fn the_choice_follows_what_arrives() {
    let mut r = Numbers(3);
    let n = 200;
    let emitters: Vec<EmitterBound> = (0..n)
        .map(|_| {
            let p = r.place();
            point(p, f64::from(0.1 + r.next()))
        })
        .collect();
    let tree = LightTree::new(&emitters).expect("some emitters");
    let (mut by_tree, mut by_power) = (0.0, 0.0);
    for receiver in receivers(200).into_iter().filter(|r| r.n != Vec3::ZERO) {
        let arriving: Vec<f64> = emitters
            .iter()
            .map(|b| {
                let d = b.lo - receiver.p;
                b.intensity * f64::from((receiver.n.dot(d.normalize())).max(0.0) / d.length_squared())
            })
            .collect();
        let total: f64 = arriving.iter().sum();
        let power: f64 = emitters.iter().map(|b| b.intensity).sum();
        if total == 0.0 {
            continue;
        }
        // Second moments of the estimate of the total, relative.
        for (e, a) in arriving.iter().enumerate().filter(|(_, a)| **a > 0.0) {
            by_tree += (a / total).powi(2) / tree.pmf(&receiver, e as u32);
            by_power += (a / total).powi(2) / (emitters[e].intensity / power);
        }
    }
    assert!(by_tree < 0.3 * by_power, "{by_tree} against {by_power}");
}

#[test]
fn a_million_emitters_and_emitters_in_one_place() {
    let many = emitters(1_000_000, 11);
    let start = std::time::Instant::now();
    let tree = LightTree::new(&many).expect("some emitters");
    println!("10⁶ emitters in {:.2} s", start.elapsed().as_secs_f64());
    let receiver = receivers(2)[1];
    for i in 0..2000 {
        let Some((e, p)) = tree.sample(&receiver, (f64::from(i) + 0.5) / 2000.0) else { continue };
        assert_eq!(p, tree.pmf(&receiver, e));
    }
    let place = EmitterBound { theta_normals: PI, ..many[0] };
    let tree = LightTree::new(&vec![place; 10_000]).expect("some emitters");
    let sum: f64 = (0..10_000).map(|e| tree.pmf(&Receiver::anywhere(Vec3::splat(3.0)), e)).sum();
    assert!((sum - 1.0).abs() < 1e-9, "{sum}");
}

/// Lamps in a row, which have a box without area, make no list of the tree.
#[test]
fn lamps_in_a_row_make_a_shallow_tree() {
    let row: Vec<EmitterBound> = (0..1000).map(|i| point(Vec3::X * (i as f32 * 1e-3), 1.0)).collect();
    let tree = LightTree::new(&row).expect("some emitters");
    let depth = |e: usize| {
        let (mut at, mut trail, mut depth) = (0, tree.trails[e], 0);
        while !tree.nodes[at].leaf {
            at = if trail & 1 == 0 { at + 1 } else { tree.nodes[at].link as usize };
            (trail, depth) = (trail >> 1, depth + 1);
        }
        depth
    };
    let deepest = (0..1000).map(depth).max().expect("some");
    assert!(deepest <= 20, "{deepest}");
}

/// In the same place as a delta light, at the rim of a cone, with powers a trillion apart: finite, and a probability.
#[test]
fn extremes_are_finite() {
    let emitters = [point(Vec3::ZERO, 1e-20), point(Vec3::X, 1e-8), point(Vec3::Y, 1e20)];
    let tree = LightTree::new(&emitters).expect("some emitters");
    for p in [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::splat(1e-20), Vec3::splat(1e18)] {
        let pmf: Vec<f64> = (0..3).map(|e| tree.pmf(&Receiver::anywhere(p), e)).collect();
        assert!(pmf.iter().all(|p| p.is_finite() && *p >= 0.0), "{p}: {pmf:?}");
        assert!((pmf.iter().sum::<f64>() - 1.0).abs() < 1e-12, "{p}: {pmf:?}");
    }
}

/// The weaker of two emitters keeps its chance, whichever of the halves it is: taken from the other's, nothing is left of it.
#[test]
fn beside_a_much_stronger_one_an_emitter_keeps_its_chance() {
    let places = [Vec3::ZERO, Vec3::X];
    for weak in [0, 1] {
        let emitters = [0, 1].map(|i| point(places[i], if i == weak { 1e-20 } else { 1.0 }));
        let tree = LightTree::new(&emitters).expect("a tree");
        for receiver in receivers(30) {
            let [p, q] = [weak, 1 - weak].map(|i| tree.pmf(&receiver, i as u32));
            assert!(
                q == 0.0 || (p > 0.0 && p < 1e-15) || p == 0.0 && tree.nodes[1 + weak].importance(&receiver) == 0.0
            );
        }
    }
}
