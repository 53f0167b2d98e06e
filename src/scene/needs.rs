//! What a scene's content makes necessary, and so what can be skipped exactly: no estimate changes.

use crate::bsdf::Bsdf;
use crate::light::Light;

use super::Surface;

/// Facts about a scene that decide which work can never contribute.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SceneNeeds {
    /// Some light can be hit: technique s = 0 exists.
    pub emitter_hits: bool,
    /// Some light is a delta light.
    pub delta_lights: bool,
    /// Some surface can be connected to: techniques with s ≥ 1 and t ≥ 2, or s ≥ 2, exist.
    pub connections: bool,
    /// Some surface scatters by a delta lobe.
    pub delta_surfaces: bool,
    /// Some surface is an index-matched window.
    pub windows: bool,
    /// Some surface is partly opaque: what lies between two points is more than yes or no.
    pub opacity: bool,
    /// Some light shines at all.
    pub light: bool,
}

impl SceneNeeds {
    /// Reads them off a scene.
    pub fn of(surfaces: &[Surface], lights: &[Light]) -> Self {
        let any = |f: &dyn Fn(&Bsdf) -> bool| surfaces.iter().any(|s| f(&s.bsdf));
        Self {
            emitter_hits: lights.iter().any(|l| !l.is_delta()),
            delta_lights: lights.iter().any(Light::is_delta),
            connections: any(&|b| b.is_connectible()),
            delta_surfaces: any(&Bsdf::has_delta_lobe),
            windows: any(&|b| matches!(b, Bsdf::Null)),
            opacity: false,
            light: !lights.is_empty(),
        }
    }

    /// What no technique of any integrator can find in such a scene, in words.
    ///
    /// A path is found by a technique that connects two of its neighbours, neither of which is a delta surface (the light
    /// and the camera may be either), or that hits the light by chance. A delta light's caustic that is seen in a mirror
    /// has no such technique: light – delta surface – diffuse surface – delta surface – camera.
    pub fn missing(&self) -> Vec<&'static str> {
        let mut out = Vec::new();
        if self.delta_lights && self.delta_surfaces && self.connections {
            out.push(
                "caustics of point, spot and directional lights are missing where they are seen in mirrors or through \
                 smooth glass",
            );
        }
        out
    }

    /// Each thing that will be skipped, in words.
    pub fn skipped(&self) -> Vec<&'static str> {
        let mut out = Vec::new();
        if !self.light {
            out.push("all of the work: nothing in the scene shines");
        }
        if !self.emitter_hits {
            out.push("finding lights by chance (techniques 0,t): no light can be hit");
        }
        if !self.connections {
            out.push(
                "light subpaths and connections: there is no surface but mirrors, smooth glass and what reflects nothing",
            );
        }
        if !self.delta_lights {
            out.push("intersection with point and spot lights: there are none");
        } else {
            out.push("intersection with point and spot lights: they have no size, so that no ray can hit them");
        }
        if !self.windows {
            out.push("looking through index-matched windows (`null` materials): there are none");
        }
        out
    }
}
