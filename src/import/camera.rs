//! The camera.

use super::context::{Context, Keys, Object, Type};
use super::json::{Kind, Node};
use super::value::{NON_NEGATIVE, POSITIVE, Range};
use crate::scene::desc::CameraDesc;

const KEYS: Keys = Keys {
    allowed: &["type", "transform", "resolution", "vfov", "fdist"],
    idle: &["aperture", "filter"],
    later: &["height"],
};

/// Largest width and height of an image.
const MAX_SIDE: u64 = 1 << 16;

/// Largest number of pixels of an image.
const MAX_PIXELS: u64 = 1 << 28;

const FIELD_OF_VIEW: Range = Range { text: "between 0 and 180 degrees", holds: |x| x > 0.0 && x < 180.0 };

impl<'a> Context<'a> {
    /// The scene's camera.
    pub fn camera(&mut self, scene: &Object<'a>) -> Option<CameraDesc> {
        let node = self.required(scene, "camera")?;
        let object = self.object(node, "an object")?;
        self.type_of(&object, "camera type", &["perspective"], &["orthographic"]);
        self.check_keys(&object, &KEYS);
        let transform = self.transform(&object);
        let resolution = object.get("resolution").map_or(Some([512, 512]), |n| self.resolution(n));
        let vfov = object.get("vfov").map_or(Some(90.0), |n| self.number(n, FIELD_OF_VIEW));
        let fdist = object.get("fdist").map_or(Some(1.0), |n| self.number(n, POSITIVE));
        if let Some(aperture) = object.get("aperture") {
            if self.number(aperture, NON_NEGATIVE).is_some_and(|radius| radius > 0.0) {
                let message = "an aperture above 0 (thin lens) is not supported yet; supported: 0 (pinhole)";
                self.error(aperture, message);
            }
        }
        if let Some(filter) = object.get("filter") {
            self.filter(filter);
        }
        let at = self.place(&object.node);
        Some(CameraDesc { transform: transform?, resolution: resolution?, vfov: vfov?, fdist: fdist?, at })
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

    /// The pixel filter: only the box of one pixel exists so far, so that there is nothing to keep.
    fn filter(&mut self, node: &Node<'a>) -> Option<()> {
        let object = self.object(node, "an object")?;
        self.check_keys(&object, &Keys::only(&["type", "radius"]));
        self.required(&object, "type");
        let kind = self.type_of(&object, "filter", &["box"], &["tent", "gaussian"]);
        let radius = object.get("radius")?;
        // Another filter's radius is not what is wrong with it.
        if self.number(radius, POSITIVE)? != 0.5 && kind != Type::Later {
            let message =
                format!("a filter of radius {} is not supported yet; supported: 0.5 (one pixel)", radius.text);
            self.error(radius, message);
        }
        Some(())
    }
}
