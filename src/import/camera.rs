//! The camera.

use super::context::{Context, Keys, Object, Type};
use super::json::{Kind, Node};
use super::value::{NON_NEGATIVE, POSITIVE, Range};
use crate::scene::desc::{CameraDesc, FilterDesc, FilterKind, Projection};

const PERSPECTIVE: &[&str] = &["type", "transform", "resolution", "vfov", "fdist", "aperture", "filter"];
const ORTHOGRAPHIC: &[&str] = &["type", "transform", "resolution", "height", "filter"];
/// Where the type is not known, the keys of both.
const EITHER: &[&str] = &["type", "transform", "resolution", "vfov", "fdist", "aperture", "height", "filter"];

/// Largest width and height of an image.
const MAX_SIDE: u64 = 1 << 16;

/// Largest number of pixels of an image.
const MAX_PIXELS: u64 = 1 << 28;

/// Below it the rounding of a splat's place is larger than the filter; above it a splat visits too many pixels.
const FILTER_RADIUS: Range = Range { text: "0.01 to 100 pixels", holds: |x| (0.01..=100.0).contains(&x) };

/// What is said of a scene without a camera.
const NO_CAMERA: &str = "\"camera\" is missing; for example \"camera\": {\"transform\": {\"from\": [0, 1, 5], \"at\": [0, 0, 0], \
                         \"up\": [0, 1, 0]}, \"vfov\": 40}";

const FIELD_OF_VIEW: Range = Range { text: "between 0 and 180 degrees", holds: |x| x > 0.0 && x < 180.0 };

impl<'a> Context<'a> {
    /// The scene's camera.
    pub fn camera(&mut self, scene: &Object<'a>) -> Option<CameraDesc> {
        if self.is_untold(scene, "camera") {
            self.error(&scene.node, NO_CAMERA.to_owned());
        }
        let node = scene.get("camera")?;
        let object = self.object(node, "an object")?;
        let kind = self.type_of(&object, "camera type", &["perspective", "orthographic"], &[]);
        let (parallel, keys) = match kind {
            Type::Known("orthographic") => (true, ORTHOGRAPHIC),
            Type::Unknown if object.has("type") => (false, EITHER),
            _ => (false, PERSPECTIVE),
        };
        self.check_keys(&object, &Keys::only(keys));
        let transform = self.transform(&object);
        let resolution = object.get("resolution").map_or(Some([512, 512]), |n| self.resolution(n));
        let projection = if parallel {
            self.required(&object, "height")
                .and_then(|n| self.number(n, POSITIVE))
                .map(|height| Projection::Orthographic { height })
        } else {
            let vfov = object.get("vfov").map_or(Some(90.0), |n| self.number(n, FIELD_OF_VIEW));
            let fdist = object.get("fdist").map_or(Some(1.0), |n| self.number(n, POSITIVE));
            let aperture = object.get("aperture").map_or(Some(0.0), |n| self.number(n, NON_NEGATIVE));
            vfov.zip(fdist).zip(aperture).map(|((vfov, fdist), aperture)| Projection::Perspective {
                vfov,
                fdist,
                aperture,
            })
        };
        let filter = object.get("filter").map_or(Some(FilterDesc::default()), |n| self.filter(n));
        let at = self.place(&object.node);
        Some(CameraDesc {
            transform: transform?,
            resolution: resolution?,
            projection: projection?,
            filter: filter?,
            at,
        })
    }

    fn resolution(&mut self, node: &Node<'a>) -> Option<[u32; 2]> {
        let nodes = self.vector_nodes::<2>(node)?;
        let [width, height] = if node.kind() == Kind::Number {
            [self.integer(node, 1, MAX_SIDE); 2]
        } else {
            nodes.map(|n| self.integer(&n, 1, MAX_SIDE))
        };
        let (width, height) = (width?, height?);
        if width * height > MAX_PIXELS {
            let message = format!("{width} × {height} pixels are too many; allowed: {MAX_PIXELS} in all");
            self.error(node, message);
            return None;
        }
        Some([u32::try_from(width).ok()?, u32::try_from(height).ok()?])
    }

    /// The pixel filter; each has a radius of its own that is usual.
    fn filter(&mut self, node: &Node<'a>) -> Option<FilterDesc> {
        let object = self.object(node, "an object")?;
        self.check_keys(&object, &Keys::only(&["type", "radius"]));
        self.required(&object, "type");
        let kind = self.type_of(&object, "filter", &["box", "tent", "gaussian"], &[]);
        let radius = object.get("radius").map(|n| self.number(n, FILTER_RADIUS));
        let (kind, usual) = match kind {
            Type::Known("box") => (FilterKind::Box, 0.5),
            Type::Known("tent") => (FilterKind::Tent, 1.0),
            Type::Known("gaussian") => (FilterKind::Gaussian, 1.5),
            _ => return None,
        };
        Some(FilterDesc { kind, radius: radius.unwrap_or(Some(usual))? })
    }
}
