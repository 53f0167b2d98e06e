//! Where contributions go: the gate that every one of them passes before the film.

use crate::math::Rgb;

use super::Crop;
use super::bdpt::CANDIDATES;
use super::trace::Step;

/// A sampling technique: `s` light vertices, `t` camera vertices (the camera's own included).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Technique {
    /// Light vertices.
    pub s: u32,
    /// Camera vertices.
    pub t: u32,
}

/// A contribution to one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Contribution {
    /// Pixel index within the crop, row-major.
    pub pixel: u32,
    /// What it adds to the pixel's sum over samples.
    pub value: Rgb,
    /// How it was made.
    pub technique: Technique,
}

/// A contribution as a survey sees it: with the sums that several sets of sample counts make of its path's densities.
#[derive(Clone, Copy, Debug)]
pub struct Noted {
    /// How it was made.
    pub technique: Technique,
    /// The pixel it went to, if not the sample's own.
    pub splat: Option<[u32; 2]>,
    /// What it added to the pixel's sum.
    pub value: Rgb,
    /// `h` of the technique's own number of samples.
    pub own: [f64; CANDIDATES],
    /// Σ h(n_j p_j)/h(p_s) over the other techniques.
    pub others: [f64; CANDIDATES],
}

/// Why a contribution was kept from the film.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Reason {
    /// It was not finite.
    NotFinite,
    /// It was larger than the film can sum (`film::Accumulator::largest`).
    TooLarge,
}

/// A contribution that was kept from the film, with what makes it again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rejected {
    /// Why.
    pub reason: Reason,
    /// Column and row of the pixel whose sample it came from.
    pub pixel: [u32; 2],
    /// Number of that sample.
    pub sample: u32,
    /// How it was made.
    pub technique: Technique,
}

/// Counted work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rays {
    /// Nearest-hit rays of camera subpaths.
    pub camera: u64,
    /// Nearest-hit rays of light subpaths.
    pub light: u64,
    /// Occlusion rays of next-event estimation.
    pub shadow: u64,
    /// Occlusion rays of connections between subpaths.
    pub connection: u64,
    /// Occlusion rays from light subpaths to the camera.
    pub lens: u64,
    /// Camera subpaths.
    pub camera_paths: u64,
    /// Light subpaths.
    pub light_paths: u64,
}

impl Rays {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.camera + self.light + self.shadow + self.connection + self.lens
    }
}

impl std::ops::AddAssign for Rays {
    fn add_assign(&mut self, o: Self) {
        self.camera += o.camera;
        self.light += o.light;
        self.shadow += o.shadow;
        self.connection += o.connection;
        self.lens += o.lens;
        self.camera_paths += o.camera_paths;
        self.light_paths += o.light_paths;
    }
}

/// How many rejected contributions a recorder remembers in full, for each reason; all are counted.
const REMEMBERED: u64 = 16;

/// Collects the contributions of samples, one thread's. If `TRACED`, each step of theirs as well; what a plain one is not
/// told costs it nothing.
#[derive(Clone, Debug)]
pub struct Recorder<const TRACED: bool = false> {
    crop: Crop,
    /// The sample under way.
    pixel: [u32; 2],
    sample: u32,
    /// Sum over the sample's own pixel.
    radiance: Rgb,
    /// Contributions to any pixel.
    splats: Vec<Contribution>,
    /// Everything by technique, when asked for.
    by_technique: Option<Vec<Contribution>>,
    /// Counted work.
    pub rays: Rays,
    /// Contributions from here on are too large.
    limit: f32,
    /// By reason.
    rejected_count: [u64; 2],
    rejected: Vec<Rejected>,
    steps: Vec<Step>,
    noted: Vec<Noted>,
}

impl Recorder {
    /// For the pixels in `crop`. With `by_technique` every contribution is kept apart as well.
    pub fn new(crop: Crop, by_technique: bool) -> Self {
        Self::empty(crop, by_technique)
    }
}

impl Recorder<true> {
    /// For the pixels in `crop`; keeps each step, and every contribution by technique.
    pub fn traced(crop: Crop) -> Self {
        Self::empty(crop, true)
    }

    /// The steps since the last `clear`.
    pub fn steps(&self) -> &[Step] {
        &self.steps
    }
}

impl<const TRACED: bool> Recorder<TRACED> {
    fn empty(crop: Crop, by_technique: bool) -> Self {
        Self {
            crop,
            pixel: [0, 0],
            sample: 0,
            radiance: Rgb::ZERO,
            splats: Vec::new(),
            by_technique: by_technique.then(Vec::new),
            rays: Rays::default(),
            limit: f32::INFINITY,
            rejected_count: [0; 2],
            rejected: Vec::new(),
            steps: Vec::new(),
            noted: Vec::new(),
        }
    }

    /// For a film that cannot sum contributions of `limit` or more.
    #[must_use]
    pub fn within(self, limit: f32) -> Self {
        Self { limit, ..self }
    }

    /// Whether a contribution is finite, and small enough.
    #[inline(always)]
    fn fits(&self, value: Rgb) -> bool {
        // False of NaN, and of ∞.
        value.abs().cmplt(Rgb::splat(self.limit)).all()
    }

    /// Keeps a step, which is made only where steps are kept.
    #[inline(always)]
    pub fn tell(&mut self, step: impl FnOnce() -> Step) {
        if TRACED {
            self.steps.push(step());
        }
    }

    /// Names what blocks a connection through which nothing passes.
    #[inline(always)]
    pub fn tell_blocker(&mut self, visible: f32, blocker: impl FnOnce() -> Option<u32>) {
        if TRACED && visible == 0.0 {
            self.steps.extend(blocker().map(|surface| Step::Blocked { surface }));
        }
    }

    /// Starts a sample of `pixel` (full image coordinates, inside the crop).
    #[inline]
    pub fn begin(&mut self, pixel: [u32; 2], sample: u32) {
        self.pixel = pixel;
        self.sample = sample;
        self.radiance = Rgb::ZERO;
    }

    /// Adds to the pixel of the sample under way.
    #[inline]
    pub fn add(&mut self, s: u32, t: u32, value: Rgb) {
        if !self.fits(value) {
            self.reject(value, Technique { s, t });
            return;
        }
        self.radiance += value;
        if let Some(list) = &mut self.by_technique {
            let pixel = index(&self.crop, self.pixel);
            list.push(Contribution { pixel, value, technique: Technique { s, t } });
        }
    }

    /// Adds to any pixel of the image; pixels outside the crop are passed over.
    #[inline]
    pub fn splat(&mut self, s: u32, t: u32, pixel: [u32; 2], value: Rgb) {
        if !self.fits(value) {
            self.reject(value, Technique { s, t });
            return;
        }
        if !self.crop.contains(pixel) {
            return;
        }
        let contribution = Contribution { pixel: index(&self.crop, pixel), value, technique: Technique { s, t } };
        self.splats.push(contribution);
        if let Some(list) = &mut self.by_technique {
            list.push(contribution);
        }
    }

    /// Keeps a contribution for a survey.
    #[inline]
    pub fn note(&mut self, noted: Noted) {
        self.noted.push(noted);
    }

    /// What was noted since it was last taken.
    pub fn take_notes(&mut self) -> std::vec::Drain<'_, Noted> {
        self.noted.drain(..)
    }

    #[cold]
    fn reject(&mut self, value: Rgb, technique: Technique) {
        let reason = if value.is_finite() { Reason::TooLarge } else { Reason::NotFinite };
        let count = &mut self.rejected_count[reason as usize];
        *count += 1;
        if *count <= REMEMBERED {
            self.rejected.push(Rejected { reason, pixel: self.pixel, sample: self.sample, technique });
        }
    }

    /// What the sample under way has added to its own pixel.
    #[inline]
    pub fn radiance(&self) -> Rgb {
        self.radiance
    }

    /// Contributions to any pixel since the last `clear`.
    pub fn splats(&self) -> &[Contribution] {
        &self.splats
    }

    /// Every contribution since the last `clear`, when they are kept apart.
    pub fn by_technique(&self) -> &[Contribution] {
        self.by_technique.as_deref().unwrap_or(&[])
    }

    /// Forgets contributions and steps; counts stay.
    pub fn clear(&mut self) {
        self.splats.clear();
        if let Some(list) = &mut self.by_technique {
            list.clear();
        }
        self.steps.clear();
        self.noted.clear();
    }

    /// Forgets contributions and counts.
    pub fn reset(&mut self) {
        self.clear();
        self.rays = Rays::default();
        self.rejected_count = [0; 2];
        self.rejected.clear();
    }

    /// How many contributions were not finite, and the first of all that were kept out.
    pub fn rejected(&self) -> (u64, &[Rejected]) {
        (self.rejected_count[Reason::NotFinite as usize], &self.rejected)
    }

    /// How many were too large.
    pub fn overflows(&self) -> u64 {
        self.rejected_count[Reason::TooLarge as usize]
    }
}

/// Row-major index of a pixel within the crop.
#[inline]
fn index(crop: &Crop, [x, y]: [u32; 2]) -> u32 {
    (y - crop.y0) * crop.width() + (x - crop.x0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_finite_is_counted_and_named_and_kept_out() {
        let mut r = Recorder::new(Crop::full([4, 4]), true);
        r.begin([1, 2], 7);
        r.add(0, 3, Rgb::new(1.0, f32::NAN, 0.0));
        r.splat(2, 1, [0, 0], Rgb::splat(f32::INFINITY));
        r.add(1, 2, Rgb::ONE);
        assert_eq!(r.radiance(), Rgb::ONE);
        assert!(r.splats().is_empty());
        let (count, first) = r.rejected();
        assert_eq!(count, 2);
        let reason = Reason::NotFinite;
        assert_eq!(first[0], Rejected { reason, pixel: [1, 2], sample: 7, technique: Technique { s: 0, t: 3 } });
        assert_eq!(first[1].technique, Technique { s: 2, t: 1 });
    }

    #[test]
    fn what_is_too_large_is_counted_and_named_and_kept_out() {
        let mut r = Recorder::new(Crop::full([4, 4]), true).within(100.0);
        r.begin([1, 2], 7);
        r.add(0, 3, Rgb::new(1.0, 100.0, 0.0));
        r.add(0, 2, Rgb::new(1.0, 99.0, f32::NAN));
        r.splat(2, 1, [0, 0], Rgb::splat(99.0));
        assert_eq!((r.radiance(), r.splats().len(), r.by_technique().len()), (Rgb::ZERO, 1, 1));
        assert_eq!((r.overflows(), r.rejected().0), (1, 1));
        let first = r.rejected().1[0];
        assert_eq!((first.reason, first.pixel, first.technique.t), (Reason::TooLarge, [1, 2], 3));
    }

    #[test]
    fn splats_outside_the_crop_are_passed_over() {
        let mut r = Recorder::new(Crop { x0: 2, y0: 1, x1: 4, y1: 3 }, false);
        r.begin([2, 1], 0);
        for pixel in [[1, 1], [4, 1], [2, 0], [2, 3]] {
            r.splat(2, 1, pixel, Rgb::ONE);
        }
        r.splat(2, 1, [3, 2], Rgb::ONE);
        assert_eq!(r.splats().len(), 1);
        assert_eq!(r.splats()[0].pixel, 3);
    }
}
