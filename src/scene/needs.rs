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
            delta_surfaces: any(&|b| matches!(b, Bsdf::Mirror { .. } | Bsdf::Dielectric { .. })),
            windows: any(&|b| matches!(b, Bsdf::Null)),
            opacity: false,
            light: !lights.is_empty(),
        }
    }

    /// Each thing that will be skipped, in words.
    pub fn skipped(&self) -> Vec<&'static str> {
        let mut out = Vec::new();
        if !self.light {
            out.push("every ray: nothing shines");
        }
        if !self.emitter_hits {
            out.push("emitter hits (s = 0): there is no area light");
        }
        if !self.connections {
            out.push("light subpaths and connections: no surface can be connected to");
        }
        if !self.delta_lights {
            out.push("user geometry for delta points: there is none");
        } else {
            out.push("user geometry for delta points: transport never asks for it");
        }
        if !self.windows {
            out.push("window tests: no surface is index-matched");
        }
        out
    }
}
