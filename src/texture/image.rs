//! Images over texture coordinates.

use std::sync::Arc;

use crate::math::{Rgb, Vec3};

/// What lies beyond an image's edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    Repeat,
    /// Its outermost texels.
    Clamp,
}

/// An image with the rules for looking it up. u runs to the right, v upwards: (0, 0) is the lower left corner, and
/// texel centres lie half a texel inside.
#[derive(Clone, Debug)]
pub struct ImageTexture {
    /// Linear texels, row-major from the top left; shared.
    texels: Arc<Vec<[f32; 3]>>,
    size: [u32; 2],
    scale: f32,
    wrap: Wrap,
    bilinear: bool,
    /// The smallest and the largest value of each channel, already scaled: each surface asks for them.
    bounds: [Rgb; 2],
}

impl ImageTexture {
    /// An image of `width × height` texels, each multiplied by `scale`. `None` when there is no texel or not so many.
    pub fn new(texels: Arc<Vec<[f32; 3]>>, size: [u32; 2], scale: f32, wrap: Wrap, bilinear: bool) -> Option<Self> {
        let count = size[0] as usize * size[1] as usize;
        // Indices are kept in i32, with room for a neighbour.
        let fits = size.iter().all(|&n| n > 0 && n < i32::MAX as u32 / 2);
        if !fits || texels.len() != count {
            return None;
        }
        let all = || texels.iter().map(|t| Vec3::from_array(*t));
        let bounds = [all().fold(Rgb::INFINITY, Rgb::min) * scale, all().fold(Rgb::ZERO, Rgb::max) * scale];
        Some(Self { texels, size, scale, wrap, bilinear, bounds })
    }

    /// Columns and rows.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The value at texture coordinates.
    pub fn value(&self, [u, v]: [f32; 2]) -> Rgb {
        let [w, h] = self.size;
        // The fraction first: a coordinate of a thousand repeats keeps its bits.
        let (u, v) = match self.wrap {
            Wrap::Repeat => (fraction(u), fraction(v)),
            Wrap::Clamp => (u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)),
        };
        let (x, y) = (u * w as f32, (1.0 - v) * h as f32);
        let value = if self.bilinear {
            let (x, y) = (x - 0.5, y - 0.5);
            let (x0, y0) = (x.floor(), y.floor());
            let (fx, fy) = (x - x0, y - y0);
            let (x0, y0) = (x0 as i32, y0 as i32);
            let row = |y: i32| self.texel(x0, y) * (1.0 - fx) + self.texel(x0 + 1, y) * fx;
            row(y0) * (1.0 - fy) + row(y0 + 1) * fy
        } else {
            self.texel(x.floor() as i32, y.floor() as i32)
        };
        value * self.scale
    }

    /// The texel of a column and row, which may lie beyond the edges by up to one image.
    fn texel(&self, x: i32, y: i32) -> Rgb {
        let [w, h] = self.size.map(|n| n as i32);
        let (x, y) = match self.wrap {
            Wrap::Repeat => (x.rem_euclid(w), y.rem_euclid(h)),
            Wrap::Clamp => (x.clamp(0, w - 1), y.clamp(0, h - 1)),
        };
        Vec3::from_array(self.texels[y as usize * w as usize + x as usize])
    }

    /// The largest value of each channel.
    pub(super) fn largest(&self) -> Rgb {
        self.bounds[1]
    }

    /// The smallest value of each channel.
    pub(super) fn smallest(&self) -> Rgb {
        self.bounds[0]
    }
}

/// x − ⌊x⌋ in [0, 1]: a tiny negative x rounds up to 1.
fn fraction(x: f32) -> f32 {
    x - x.floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Columns 0…3 hold x, rows 0…1 hold y (from the top), in the first two channels.
    fn ramp(wrap: Wrap, bilinear: bool) -> ImageTexture {
        let texels = (0..8).map(|i| [(i % 4) as f32, (i / 4) as f32, 1.0]).collect();
        ImageTexture::new(Arc::new(texels), [4, 2], 2.0, wrap, bilinear).expect("8 texels")
    }

    fn check(image: &ImageTexture, uv: [f32; 2], x: f32, y: f32) {
        let found = image.value(uv);
        let wanted = Vec3::new(2.0 * x, 2.0 * y, 2.0);
        assert!((found - wanted).abs().max_element() < 1e-5, "{image:?} at {uv:?}: {found}, not {wanted}");
    }

    #[test]
    fn texel_centres_hold_the_texels() {
        for wrap in [Wrap::Repeat, Wrap::Clamp] {
            for bilinear in [false, true] {
                for (x, y) in (0..4).flat_map(|x| (0..2).map(move |y| (x as f32, y as f32))) {
                    // Row 0 is the top, where v is near 1.
                    check(&ramp(wrap, bilinear), [(x + 0.5) / 4.0, 1.0 - (y + 0.5) / 2.0], x, y);
                }
            }
        }
    }

    #[test]
    fn nearest_is_constant_over_a_texel_and_bilinear_is_linear_between() {
        check(&ramp(Wrap::Clamp, false), [0.2499, 0.9], 0.0, 0.0);
        check(&ramp(Wrap::Clamp, false), [0.2501, 0.9], 1.0, 0.0);
        check(&ramp(Wrap::Clamp, true), [0.25, 0.75], 0.5, 0.0);
        check(&ramp(Wrap::Clamp, true), [0.4375, 0.5], 1.25, 0.5);
    }

    #[test]
    fn edges_wrap_or_clamp() {
        // The left edge, u = 0: halfway between the last column and the first, or the first alone.
        check(&ramp(Wrap::Repeat, true), [0.0, 0.75], 1.5, 0.0);
        check(&ramp(Wrap::Repeat, true), [1.0, 0.75], 1.5, 0.0);
        check(&ramp(Wrap::Clamp, true), [0.0, 0.75], 0.0, 0.0);
        check(&ramp(Wrap::Clamp, true), [1.0, 0.75], 3.0, 0.0);
        // The top and bottom edge.
        check(&ramp(Wrap::Repeat, true), [0.125, 1.0], 0.0, 0.5);
        check(&ramp(Wrap::Repeat, true), [0.125, 0.0], 0.0, 0.5);
        check(&ramp(Wrap::Clamp, true), [0.125, 1.0], 0.0, 0.0);
        check(&ramp(Wrap::Clamp, true), [0.125, 0.0], 0.0, 1.0);
        // Beyond them.
        for image in [ramp(Wrap::Repeat, true), ramp(Wrap::Repeat, false)] {
            check(&image, [7.625, -2.25], 2.0, 0.0);
            check(&image, [-0.375, 3.25], 2.0, 1.0);
        }
        check(&ramp(Wrap::Clamp, false), [7.6, -3.0], 3.0, 1.0);
        check(&ramp(Wrap::Clamp, false), [-7.6, 3.0], 0.0, 0.0);
        // What rounds up to a whole repeat is still in range.
        let edge = ramp(Wrap::Repeat, false).value([-1e-12, -1e-12]);
        assert!(edge.x >= 0.0 && edge.x <= 6.0);
    }
}
