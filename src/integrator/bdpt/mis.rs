//! Multiple importance sampling in constant time per vertex: the recursive partial sums of `docs/MIS.md`.
//!
//! A full path x₀ … x_k (x₀ on the light) can be made by technique j, with j light vertices, with area-product
//! density p_j. Its weight is `w_s = 1 / Σ_j h(n_j p_j) / h(n_s p_s)` with `h(x) = x^β` (β = 2, 1) or the indicator
//! of `x > 0` (uniform), and n_j the number of samples technique j takes. The sum splits at the connection into a
//! part over the light subpath (j < s) and one over the camera subpath (j > s), each carried along as two numbers.
//!
//! At a vertex i of a subpath, with p_i its density per area from its own side, g_{i−1} = cosθ_{i−1}/d² and q the
//! density per solid angle with which the *other* side would find vertex i−1 from i:
//!
//! ```text
//! direct_i  = δ_i h(1/p_i)                                                        (technique i itself)
//! earlier_i = h(g_{i−1}/p_i) · (h(n_{i−1}) direct_{i−1} + earlier_{i−1} h(q_{i−1}))   (all before it)
//! ```
//!
//! and what a technique needs of the subpath that ends in i is `h(p←_i) (h(n_i) direct_i + earlier_i h(q_i))`.
//! δ_i is 1 when both ends of the edge i−1, i can be connected to. In `g/p` the d² cancel and are never formed.

use super::sums::Sums;
use crate::integrator::{LENGTHS, SplatConfidence};
use crate::planted::{Bug, planted};
use crate::scene::desc::Heuristic;

/// The heuristic with the sample counts it is given: one set of them, or several side by side (`Sums`).
#[derive(Clone, Copy, Debug)]
pub struct Mis<S = f64> {
    heuristic: Heuristic,
    weighted: bool,
    /// `h` of the number of next-event samples (s = 1).
    pub next_event: S,
    /// `h` of the number of light subpaths a camera vertex connects to (s ≥ 2, t ≥ 2).
    pub connections: S,
    /// `h` of the number of light subpaths that may land on the pixel (t = 1).
    light_paths: S,
    /// `h` of the confidence in splats (t = 1) on paths of 1, 2, … edges; the last is that of all longer ones.
    confidence: [f64; LENGTHS],
}

/// What a subpath carries for the weights of the techniques that share its path.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Partial<S = f64> {
    /// `direct_i`, the sample count left out.
    pub direct: f64,
    /// `earlier_i`; on a camera subpath without technique t = 1, whose count depends on the length of the whole path.
    pub earlier: S,
    /// That technique's part, its confidence left out.
    pub splat: S,
}

impl<S: Sums> Partial<S> {
    /// By the counts that samples are taken with.
    #[inline]
    pub fn taken(&self) -> Partial {
        Partial { direct: self.direct, earlier: self.earlier.taken(), splat: self.splat.taken() }
    }
}

/// A vertex that scatters, as the edge that leaves it sees it.
#[derive(Clone, Copy, Debug)]
pub struct Departure<S = f64> {
    /// The vertex's own partial sums.
    pub partial: Partial<S>,
    /// `h` of the number of samples of the technique that `partial.direct` stands for.
    pub count: S,
    /// The same where that is technique t = 1, `count` being 0 then.
    pub splats: S,
    /// |cosine| between its geometric normal and the edge.
    pub cos: f64,
    /// Density per solid angle of the edge's direction.
    pub pdf_fwd: f64,
    /// Density per solid angle of going back where it came from.
    pub pdf_rev: f64,
    /// Whether a delta lobe was sampled.
    pub delta: bool,
}

impl<S: Sums> Mis<S> {
    /// For the given heuristic and sample counts.
    pub fn new(heuristic: Heuristic, weighted: bool, connections: S, light_paths: S) -> Self {
        let none = S::default();
        let confidence = [1.0; LENGTHS];
        let mut mis = Self { heuristic, weighted, next_event: none, connections: none, light_paths: none, confidence };
        mis.next_event = S::splat(mis.h(1.0));
        mis.connections = connections.map(|n| mis.h(n));
        mis.light_paths = light_paths.map(|n| mis.h(if planted(Bug::NoCountInWeights) { n.min(1.0) } else { n }));
        mis
    }

    /// The same counts, with confidence in splats on paths of 1, 2, … edges.
    pub fn trusting(self, confidence: &SplatConfidence) -> Self {
        Self { confidence: std::array::from_fn(|i| self.h(confidence.on(i as u32 + 1))), ..self }
    }

    /// `h` of the number of samples that technique t = 1 counts for on a path of so many edges.
    #[inline(always)]
    pub fn splats(&self, edges: u32) -> S {
        self.light_paths * self.confidence_on(edges)
    }

    #[inline(always)]
    fn confidence_on(&self, edges: u32) -> f64 {
        self.confidence[(edges as usize - 1).min(LENGTHS - 1)]
    }

    /// The same counts, every weight being 1.
    pub fn unweighted(self) -> Self {
        Self { weighted: false, ..self }
    }

    /// What the heuristic makes of a density, or of a product of densities and counts.
    #[inline(always)]
    pub fn h(&self, x: f64) -> f64 {
        let x = if planted(Bug::Remap0) && x == 0.0 { 1.0 } else { x };
        match self.heuristic {
            Heuristic::Power => x * x,
            Heuristic::Balance => x,
            Heuristic::Uniform => f64::from(u8::from(x > 0.0)),
        }
    }

    /// The sums at a vertex reached by a scattered edge with distance² `d2` and |cosine| `cos` at its end.
    /// `connectible` is false across an index-matched window.
    #[inline(always)]
    pub fn arrive(&self, from: &Departure<S>, d2: f64, cos: f64, connectible: bool) -> Partial<S> {
        // p·d²: the density per area with its 1/d² left out, so that d² cancels in `earlier`.
        let p_d2 = from.pdf_fwd * cos;
        let h = |x| if planted(Bug::BalanceRecursion) { x } else { self.h(x) };
        let sum = |count: S, earlier: S| {
            if from.delta {
                // Neither of the edges at a delta vertex can be a connection: only what came before remains.
                earlier * h(from.cos * from.pdf_rev / p_d2)
            } else {
                let inner = count * from.partial.direct + earlier * h(from.pdf_rev);
                inner.saturated() * h(from.cos / p_d2)
            }
        };
        let earlier = sum(from.count, from.partial.earlier).saturated();
        let splat = sum(from.splats, from.partial.splat).saturated();
        let direct = if from.delta || !connectible { 0.0 } else { h(d2 / p_d2) };
        Partial { direct: direct.saturated(), earlier, splat }
    }

    /// The sums at the first surface a light reaches. `ratio` is p_direct/p_emit of the light vertex (area measure);
    /// `cos_light`, zero for a delta light, belongs to technique 0, hitting the light by chance.
    #[inline(always)]
    pub fn arrive_from_light(&self, start: &LightStart, d2: f64, cos: f64, connectible: bool) -> Partial<S> {
        let p_d2 = start.pdf_direction * cos;
        let direct = if connectible { self.h(start.direct_over_emission * d2 / p_d2) } else { 0.0 };
        let earlier = self.h(start.cos / (start.pdf_position * p_d2));
        Partial { direct: direct.saturated(), earlier: S::splat(earlier.saturated()), splat: S::default() }
    }

    /// The sums at the first surface the camera sees, reached with the density `pdf_direction`.
    #[inline(always)]
    pub fn arrive_from_camera(&self, pdf_direction: f64, d2: f64, cos: f64, connectible: bool) -> Partial<S> {
        let direct = if connectible { self.h(d2 / (pdf_direction * cos)) } else { 0.0 };
        let earlier = S::splat(if planted(Bug::SumsFromOne) { 1.0 } else { 0.0 });
        Partial { direct: direct.saturated(), earlier, splat: S::default() }
    }

    /// The earlier techniques of a camera subpath that is part of a path of so many edges.
    #[inline(always)]
    pub fn earlier(&self, partial: &Partial<S>, edges: u32) -> S {
        partial.earlier + partial.splat * self.confidence_on(edges)
    }

    /// What a light subpath that ends at a vertex adds, but for the factor `h` of the vertex's density from the other
    /// side: `h(n) direct + earlier h(q)`.
    #[inline(always)]
    pub fn behind(&self, partial: &Partial<S>, count: S, pdf_rev: f64) -> S {
        (count * partial.direct + partial.earlier * self.h(pdf_rev)).saturated()
    }

    /// The same of a camera subpath that ends at vertex `number`, on a path of so many edges.
    #[inline(always)]
    pub fn behind_camera(&self, partial: &Partial<S>, number: u32, edges: u32, pdf_rev: f64) -> S {
        let count = if number == 2 { self.splats(edges) } else { self.connections };
        (count * partial.direct + self.earlier(partial, edges) * self.h(pdf_rev)).saturated()
    }

    /// `h` of the numbers of samples that belong to `direct` at camera vertex `number`: technique t = 1's where it is
    /// that, without confidence, is the second.
    #[inline(always)]
    pub fn counts_at_camera_vertex(&self, number: u32) -> [S; 2] {
        if number == 2 { [S::default(), self.light_paths] } else { [self.connections, S::default()] }
    }

    /// The weight of a technique whose alternatives sum to `others` (relative to its own `h(n p)`).
    #[inline(always)]
    pub fn weight(&self, others: f64) -> f64 {
        if self.weighted { 1.0 / (1.0 + others) } else { 1.0 }
    }

    /// `w/d²` for a connection over distance² `d2` whose alternatives sum to `others · h(1/d²)`. For the power
    /// heuristic that is `d²/(d⁴ + others)`: where another technique can make the path, 1/d² is never formed, and
    /// the product stays finite as the distance shrinks.
    #[inline(always)]
    pub fn weight_over_d2(&self, others: f64, d2: f64) -> f64 {
        if !self.weighted {
            return 1.0 / d2;
        }
        match self.heuristic {
            Heuristic::Power => d2 / (d2 * d2 + others),
            Heuristic::Balance => 1.0 / (d2 + others),
            Heuristic::Uniform => 1.0 / (d2 * (1.0 + others)),
        }
    }
}

/// The start of a light subpath, as its first edge sees it.
#[derive(Clone, Copy, Debug)]
pub struct LightStart {
    /// Density of the point, the choice of the light included.
    pub pdf_position: f64,
    /// Density per solid angle of the first direction.
    pub pdf_direction: f64,
    /// Density of the point by next-event estimation over that by emission.
    pub direct_over_emission: f64,
    /// |cosine| at an area light, 0 at a delta light: nothing hits it by chance.
    pub cos: f64,
}
