//! Classes of paths: which of them the one-sided integrators could make as well.

use crate::light::Light;

/// A class of full paths, named by those who have a technique for each of its paths. For study: integrators can be
/// compared on the paths that both make, and what one of them misses can be looked at.
///
/// With x₀ on the light and x_k the camera, a path tracer has s = 0 where the light can be hit and s = 1 where x₁ scatters
/// by a lobe that is not a delta and no window lies between x₀ and x₁. A light tracer has t = 1 where the same holds of
/// x_{k−1} and x_k, and no environment is seen directly. Either is a matter of the first edge of one subpath and of how its
/// first vertex scatters; once that has gone wrong nothing of the class can follow. So a class is kept to by ending
/// subpaths, and no weight knows of it: weights are a function of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathClass {
    /// Only paths that `path` could make.
    pub of_path: bool,
    /// Only paths that `light` could make.
    pub of_light: bool,
}

impl PathClass {
    /// Whether all paths through a light subpath's vertex `number` are outside the class when one of the edges there is
    /// `closed` to connections: the edge behind by a window, both by a delta lobe.
    #[inline]
    pub(super) fn ends_light_subpath(self, light: &Light, number: u32, closed: bool) -> bool {
        self.of_path && closed && number == 2 && light.is_delta()
    }

    /// The same of a camera subpath; a direction, the place of an environment, is closed to light subpaths' connections.
    #[inline]
    pub(super) fn ends_camera_subpath(self, number: u32, closed: bool) -> bool {
        self.of_light && closed && number == 2
    }
}
