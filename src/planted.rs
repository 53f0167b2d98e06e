//! Planted bugs: mistakes that bidirectional path tracers are known for, each behind a switch that tests alone can turn.
//!
//! A suite that stays green whatever the code does proves nothing. `scripts/test-planted` runs it once for each [`Bug`]
//! and demands that it turns red (docs/PLANTED.md is what it found). The switches exist with the feature `planted-bugs`
//! only: without it [`planted`] is the constant `false`, and what it guards is not compiled into the program.

/// The mistakes, from one list: the type, its names and what each does cannot drift apart.
macro_rules! bugs {
    ($($bug:ident, $name:literal, $what:literal;)*) => {
        /// A mistake that can be planted.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Bug { $(#[doc = $what] $bug,)* }

        impl Bug {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$bug,)*];

            /// What it is chosen by.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$bug => $name,)* }
            }

            /// What it does, in a line.
            pub const fn what(self) -> &'static str {
                match self { $(Self::$bug => $what,)* }
            }
        }
    };
}

bugs! {
    // Scattering.
    NoRadianceScale, "no-eta-squared", "refraction leaves radiance as it is: no η² [Veach97 (5.13)]";
    ImportanceScaled, "eta-squared-of-importance", "refraction scales importance as it does radiance";
    NoSolidAngleRatio, "no-ratio-of-solid-angles", "a refracting delta lobe's reverse density lacks dωi/dωo (MIS (16))";
    NoAdjointFactor, "no-adjoint-factor", "light subpaths lack the adjoint factor of shading normals [Veach97 (5.19)]";
    CosineTwice, "cosine-twice", "diffuse reflection is multiplied by the cosine once more";
    CosineTwiceInConnections, "cosine-twice-in-connections", "a connection's geometry term brings the cosines that F holds already";
    // Walks.
    DepthOfPath, "depth-of-path", "the path tracer scatters once more than `max_bounces`";
    DepthOfLight, "depth-of-light", "the light tracer scatters once less than `max_bounces`";
    DepthOfConnections, "depth-of-connections", "connections s ≥ 2, t ≥ 2 make paths that scatter once more than `max_bounces`";
    DepthOfAll, "depth-of-all", "all integrators scatter once more than `max_bounces`";
    RouletteUncompensated, "roulette-uncompensated", "roulette's survivors are not divided by their probability";
    RouletteAboveOne, "roulette-above-one", "roulette divides by probabilities above 1, too";
    RayRouletteUncompensated, "ray-roulette-uncompensated", "visibility rays that roulette lets live are not divided by its probability";
    SparseUncompensated, "sparse-uncompensated", "light subpaths of one sample in n count as if each sample had some";
    OneStream, "one-stream", "light subpaths are drawn with the camera subpath's numbers";
    // Lights.
    LightChoiceOfOneMore, "light-choice-of-one-more", "the choice among N lights is counted as one among N + 1";
    NoLightChoice, "no-light-choice", "light subpaths forget the probability of the choice among lights";
    NoLightChoiceAtHits, "no-light-choice-at-hits", "bdpt's s = 0 compares with next-event estimation without the choice among lights";
    NoLightChoiceAtHitsOfPath, "no-light-choice-at-hits-of-path", "the path tracer's s = 0 compares with next-event estimation without the choice among lights";
    UniformEmission, "uniform-emission", "emission's density of direction is 1/2π, uniform, where directions are cosine-distributed";
    NoCosineAtLight, "no-cosine-at-light", "bdpt's light subpaths start without the cosine at the light";
    FixedLightNormal, "fixed-light-normal", "area lights emit about −y, whichever way they face";
    EmissionOnBothSides, "emission-on-both-sides", "one-sided lights shine on both sides when they are hit or chosen";
    SpotUnnormalised, "spot-unnormalised", "a spot's density of direction is its attenuation, not divided by the integral";
    SpotOverCosine, "spot-over-cosine", "a spot's intensity is divided by the cosine to its axis";
    NoSineInMap, "no-sine-in-map", "the density of an environment map lacks 1/sinθ";
    DeltaLightUnconnected, "delta-light-unconnected", "bdpt's s = 1 drops delta lights, which have no normal";
    NoEmissionDensity, "no-emission-density", "bdpt's s = 1 takes the emission density of the light for 0";
    DirectByArea, "direct-by-area", "the density of next-event estimation is asked for per area where it samples solid angles";
    OneReceiver, "one-receiver", "light subpaths ask how next-event estimation chooses a light at the origin, not where they arrive";
    BackForgotten, "back-forgotten", "the light tree takes a group for one-sided where one of its emitters shines on both";
    // Weights.
    Remap0, "remap0", "densities of 0 count as 1 in the ratios of the weights";
    BalanceRecursion, "balance-recursion", "partial sums of the power heuristic go on by ratio × (sum + 1), without squares";
    SumsFromOne, "sums-from-one", "the camera side's sums start at 1";
    NoCountInWeights, "no-count-in-weights", "weights count one light subpath for the pixel, not all of the pass";
    TrustOfSubpath, "trust-of-subpath", "how far splats are trusted goes by the camera subpath's length, not by the path's";
    LightSeenTwice, "light-seen-twice", "a light seen directly (0,2) does not share with (1,1)";
    WindowsConnect, "windows-connect", "weights count connections across index-matched windows";
    EmissionInConnections, "emission-in-connections", "a general connection adds the camera vertex's emission";
    NoLightTracing, "no-light-tracing", "bdpt counts t = 1 in its weights and never connects to the camera";
    // Camera and film.
    TruncatedSplat, "truncated-splat", "film coordinates are cast to integers before they are compared: (−1, 0) is column 0";
    SplatCount, "splat-count", "splats are divided by the number of pixels, whatever the light subpaths of each";
    SplatCountOfCrop, "splat-count-of-crop", "splats are divided by the number of light subpaths of the crop";
    OneRowLow, "one-row-low", "splats land one row low";
    NoCoverage, "no-coverage", "splats are not multiplied by the sum of the filters that cover the place";
    ShadowEndsEarly, "shadow-ends-early", "visibility is tested up to t < 1 − ε with ε = 0.001";
}

/// Whether this mistake is to be made: never, for programs are built without the feature `planted-bugs`.
#[cfg(not(feature = "planted-bugs"))]
#[inline(always)]
pub const fn planted(_: Bug) -> bool {
    false
}

/// Whether this mistake is to be made: the one that the environment variable [`VARIABLE`] names, if there is one.
///
/// # Panics
/// When it names none that there is: a test run that plants nothing would pass for one that found nothing.
#[cfg(feature = "planted-bugs")]
#[inline]
pub fn planted(bug: Bug) -> bool {
    static CHOSEN: std::sync::LazyLock<Option<Bug>> = std::sync::LazyLock::new(|| {
        let name = std::env::var_os(VARIABLE).filter(|name| !name.is_empty())?;
        let bug = Bug::ALL.iter().find(|bug| name == bug.name());
        Some(*bug.unwrap_or_else(|| panic!("{VARIABLE} names no bug: {name:?}")))
    });
    *CHOSEN == Some(bug)
}

/// The environment variable that chooses a bug by name, where the feature `planted-bugs` is compiled in.
pub const VARIABLE: &str = "TWINLIGHT_PLANTED";

/// No program built without the feature makes one of the mistakes: it would not compile.
#[cfg(not(feature = "planted-bugs"))]
const _: () = {
    let mut i = 0;
    while i < Bug::ALL.len() {
        assert!(!planted(Bug::ALL[i]));
        i += 1;
    }
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_for_the_shell() {
        for (i, bug) in Bug::ALL.iter().enumerate() {
            assert!(!bug.name().is_empty() && bug.name().bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-'));
            assert!(Bug::ALL[..i].iter().all(|other| other.name() != bug.name()), "{bug:?}");
        }
    }

    /// Not a test: the list that `scripts/test-planted` goes through, a line of name and what it does for each bug.
    #[test]
    #[ignore = "a list for scripts/test-planted"]
    fn list() {
        for bug in Bug::ALL {
            println!("bug\t{}\t{}", bug.name(), bug.what());
        }
    }
}
