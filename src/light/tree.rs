//! Choosing among many emitters by what they may send to the receiver.
//!
//! A binary tree over bounds of emitters in space and direction, descended at random in proportion to a bound-like estimate
//! of each half's contribution (Conty Estevez, Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree
//! Splitting", without the splitting; the estimate follows [PBRT4, 12.6.3]). The probability of an emitter is found again by
//! descending to it along the same decisions, in O(depth).

mod bound;

pub use bound::EmitterBound;

use super::Receiver;
use crate::math::{Vec3, gamma};

/// Buckets that a split is looked for between.
const BUCKETS: usize = 12;

/// Depth beyond which groups are halved by number, which bounds the depth by 40 + log₂ n ≤ 64 + 8.
const DEEPEST_SORTED: u32 = 40;

/// The least cosine, at either end, that an emitter which shines on the receiver is counted with: at the receiver shading
/// normals and lobes do not follow the geometric cosine, at the emitter the bounds know it to a rounding only.
const LEAST_COSINE: f32 = 0.05;

/// The least d² that an emitter is counted with: intensities are shares, so that all that is divided by it fits an f32.
const LEAST_D2: f32 = 1e-30;

/// Rounding of a cosine, for which no emitter may lose its chance.
const SLACK: f32 = 1e-4;

/// A node: a leaf of one emitter, or two halves.
#[derive(Clone, Copy, Debug)]
struct Node {
    /// A ball around the emitters.
    center: [f32; 3],
    radius2: f32,
    /// The cone of their normals, and how far beyond it they shine.
    axis: [f32; 3],
    cos_normals: f32,
    sin_normals: f32,
    cos_reach: f32,
    /// Share of the intensity of all emitters.
    intensity: f32,
    /// The second half's node, the first follows its parent; of a leaf the emitter.
    link: u32,
    leaf: bool,
    two_sided: bool,
}

/// A tree over emitters that are numbered in the order of construction.
#[derive(Clone, Debug)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// By emitter: the halves taken on the way from the root, from the lowest bit on.
    trails: Vec<u128>,
}

/// `cos(max(0, a − b))` from sines and cosines.
#[inline(always)]
fn cos_difference(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> f32 {
    if cos_a > cos_b { 1.0 } else { cos_a * cos_b + sin_a * sin_b }
}

/// `sin(max(0, a − b))`.
#[inline(always)]
fn sin_difference(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> f32 {
    if cos_a > cos_b { 0.0 } else { sin_a * cos_b - cos_a * sin_b }
}

#[inline(always)]
fn sin_of(cos: f32) -> f32 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

impl Node {
    /// `share` is the emitters' share of all intensity.
    fn new(b: &EmitterBound, share: f64, leaf: bool) -> Self {
        // The centre is rounded, and so are receivers: relative to where they are, not to the radius.
        let radius = 0.5 * (b.hi - b.lo).length() + gamma(4) * b.lo.abs().max(b.hi.abs()).max_element();
        Self {
            center: b.center().to_array(),
            // Rounded outwards.
            radius2: (radius * radius) * (1.0 + 1e-5),
            axis: b.axis.to_array(),
            cos_normals: b.theta_normals.cos(),
            sin_normals: b.theta_normals.sin(),
            cos_reach: b.theta_reach.cos() - SLACK,
            intensity: share as f32,
            link: 0,
            leaf,
            two_sided: b.two_sided,
        }
    }

    /// An estimate of what the emitters send to the receiver, zero only where they send nothing: intensity × cosine at the
    /// emitter × cosine at the receiver / d², each cosine the largest that the bounds allow [PBRT4, 12.6.3].
    #[inline]
    fn importance(&self, receiver: &Receiver) -> f32 {
        let to = Vec3::from_array(self.center) - receiver.p;
        let d2 = to.length_squared();
        if d2 <= self.radius2 {
            // Among them any direction may be the one.
            return self.intensity / self.radius2.max(LEAST_D2);
        }
        let inverse_d = 1.0 / d2.sqrt();
        let w = to * inverse_d;
        // The half angle b under which the ball is seen: neither cosine is known better than that.
        let sin2_b = self.radius2 / d2;
        let (sin_b, cos_b) = (sin2_b.sqrt(), (1.0 - sin2_b).max(0.0).sqrt());
        let toward = -w.dot(Vec3::from_array(self.axis));
        let cos_w = if self.two_sided { toward.abs() } else { toward };
        let sin_w = sin_of(cos_w);
        let cos_x = cos_difference(cos_w, sin_w, self.cos_normals, self.sin_normals);
        let sin_x = sin_difference(cos_w, sin_w, self.cos_normals, self.sin_normals);
        let cos_emitter = cos_difference(cos_x, sin_x, cos_b, sin_b);
        if cos_emitter <= self.cos_reach {
            return 0.0;
        }
        let mut importance = self.intensity * cos_emitter.abs().max(LEAST_COSINE) / d2.max(LEAST_D2);
        if receiver.n != Vec3::ZERO {
            let cos_i = receiver.n.dot(w);
            let cos_receiver = cos_difference(cos_i, sin_of(cos_i), cos_b, sin_b);
            if cos_receiver <= -SLACK {
                return 0.0;
            }
            importance *= cos_receiver.max(LEAST_COSINE);
        }
        importance
    }
}

impl LightTree {
    /// A tree over emitters of positive intensity; `None` over none.
    pub fn new(emitters: &[EmitterBound]) -> Option<Self> {
        if emitters.is_empty() {
            return None;
        }
        let mut order: Vec<u32> = (0..emitters.len() as u32).collect();
        let mut tree = Self { nodes: Vec::with_capacity(2 * emitters.len() - 1), trails: vec![0; emitters.len()] };
        let total = emitters.iter().map(|e| e.intensity).sum();
        let bound = bound_of(emitters, &order)?;
        tree.build(emitters, total, &mut order, &bound, 0, 0);
        Some(tree)
    }

    /// Appends the tree over the emitters in `order`, whose bounds are `bound`.
    fn build(
        &mut self,
        emitters: &[EmitterBound],
        total: f64,
        order: &mut [u32],
        bound: &EmitterBound,
        trail: u128,
        depth: u32,
    ) {
        let at = self.nodes.len();
        if let [emitter] = *order {
            let leaf = Node { link: emitter, ..Node::new(bound, bound.intensity / total, true) };
            self.nodes.push(leaf);
            self.trails[emitter as usize] = trail;
            return;
        }
        let (middle, bounds) = split(emitters, order, depth);
        self.nodes.push(Node::new(bound, bound.intensity / total, false));
        let (first, second) = order.split_at_mut(middle);
        self.build(emitters, total, first, &bounds[0], trail, depth + 1);
        self.nodes[at].link = self.nodes.len() as u32;
        self.build(emitters, total, second, &bounds[1], trail | 1 << depth, depth + 1);
    }

    /// The probabilities of going on to either half of an inner node; `None` where neither half sends anything.
    #[inline]
    fn halves(&self, at: usize, receiver: &Receiver) -> Option<[f64; 2]> {
        let a = f64::from(self.nodes[at + 1].importance(receiver));
        let b = f64::from(self.nodes[self.nodes[at].link as usize].importance(receiver));
        let sum = a + b;
        // The one is not taken from the other: beside a much stronger one nothing would be left of it.
        (sum > 0.0).then(|| [a / sum, b / sum])
    }

    /// Chooses an emitter by one uniform number in [0, 1), with its probability; `None` where none sends anything.
    #[inline]
    pub fn sample(&self, receiver: &Receiver, u: f64) -> Option<(u32, f64)> {
        let (mut at, mut u, mut p) = (0, u, 1.0);
        while !self.nodes[at].leaf {
            let [first, second] = self.halves(at, receiver)?;
            // What is left of the number is uniform again.
            if u < first || second == 0.0 {
                (u, p, at) = (u / first, p * first, at + 1);
            } else {
                (u, p, at) = ((u - first) / second, p * second, self.nodes[at].link as usize);
            }
            u = u.min(1.0 - 0.5 * f64::EPSILON);
        }
        (p > 0.0).then_some((self.nodes[at].link, p))
    }

    /// The probability of `sample` choosing an emitter.
    #[inline]
    pub fn pmf(&self, receiver: &Receiver, emitter: u32) -> f64 {
        let (mut at, mut p, mut trail) = (0, 1.0, self.trails[emitter as usize]);
        while !self.nodes[at].leaf {
            let Some([first, second]) = self.halves(at, receiver) else { return 0.0 };
            if trail & 1 == 0 {
                (p, at) = (p * first, at + 1);
            } else {
                (p, at) = (p * second, self.nodes[at].link as usize);
            }
            if p == 0.0 {
                return 0.0;
            }
            trail >>= 1;
        }
        p
    }
}

/// The bounds of some emitters; `None` of none.
fn bound_of(emitters: &[EmitterBound], order: &[u32]) -> Option<EmitterBound> {
    order.iter().map(|i| emitters[*i as usize]).reduce(EmitterBound::union)
}

/// Divides a group of two or more: its order is changed so that the first of it, whose number is returned, are one half, by
/// the cheapest of the cuts between buckets along the longest side of the box of centres; two emitters, those of one place and
/// those too deep for that are halved by number. With the bounds of both halves.
fn split(emitters: &[EmitterBound], order: &mut [u32], depth: u32) -> (usize, [EmitterBound; 2]) {
    let of = |i: &u32| &emitters[*i as usize];
    let (mut lo, mut hi) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for i in order.iter() {
        let center = of(i).center();
        (lo, hi) = (lo.min(center), hi.max(center));
    }
    let extent = hi - lo;
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let half = order.len() / 2;
    if extent[axis] > 0.0 && depth < DEEPEST_SORTED && order.len() > 2 {
        let scale = BUCKETS as f32 / extent[axis];
        let bucket = |i: &u32| (((of(i).center()[axis] - lo[axis]) * scale) as usize).min(BUCKETS - 1);
        let mut buckets: [Option<EmitterBound>; BUCKETS] = [None; BUCKETS];
        for i in order.iter() {
            let b = &mut buckets[bucket(i)];
            *b = Some(b.map_or(*of(i), |b| b.union(*of(i))));
        }
        let union = |a: Option<EmitterBound>, b: Option<EmitterBound>| match (a, b) {
            (Some(a), Some(b)) => Some(a.union(b)),
            (a, b) => a.or(b),
        };
        // Costs of all cuts: what lies before each, and what lies after.
        let mut before = [None; BUCKETS];
        let mut so_far = None;
        for (k, b) in buckets.iter().enumerate() {
            before[k] = so_far;
            so_far = union(so_far, *b);
        }
        let (mut after, mut best, mut halves) = (None, (f64::INFINITY, 0_usize), None);
        for k in (1..BUCKETS).rev() {
            after = union(after, buckets[k]);
            if let (Some(a), Some(b)) = (before[k], after) {
                let cost = a.cost() + b.cost();
                // Of cuts that cost the same, the one nearest to the middle: emitters in a row need a shallow tree.
                let nearer = k.abs_diff(BUCKETS / 2) < best.1.abs_diff(BUCKETS / 2);
                if cost < best.0 || (cost == best.0 && nearer) {
                    (best, halves) = ((cost, k), Some([a, b]));
                }
            }
        }
        if let Some(halves) = halves {
            return (partition(order, |i| bucket(i) < best.1), halves);
        }
    }
    order.select_nth_unstable_by(half, |a, b| (of(a).center()[axis].total_cmp(&of(b).center()[axis])).then(a.cmp(b)));
    let union = |o: &[u32]| o[1..].iter().fold(*of(&o[0]), |b, i| b.union(*of(i)));
    (half, [union(&order[..half]), union(&order[half..])])
}

/// Moves what satisfies `first` to the front; returns how many do. Keeps the order within both, so that trees do not
/// depend on anything but their emitters.
fn partition(order: &mut [u32], first: impl Fn(&u32) -> bool) -> usize {
    let (front, back): (Vec<u32>, Vec<u32>) = order.iter().partition(|i| first(i));
    order[..front.len()].copy_from_slice(&front);
    order[front.len()..].copy_from_slice(&back);
    front.len()
}

#[cfg(test)]
mod tests;
