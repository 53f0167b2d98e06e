//! Where an image is brighter than its reference and where darker.

use crate::film::Image;

/// Side of the blocks that noise is averaged over, so that structure shows.
pub const BLOCK: u32 = 4;

/// Relative difference, in percent, that has full colour unless something else is asked for.
pub const FULL_COLOUR: f32 = 10.0;

/// Signed relative difference of block means over all channels: red brighter, blue darker than the reference. 0.01 added
/// to the reference's sum of channels keeps it finite in the dark. `range` is the difference in percent that has full
/// colour. Panics where the reference is smaller than the image.
pub fn difference(image: &Image, reference: &Image, range: f32) -> Image {
    let mut out = Image::new(image.width, image.height);
    for y0 in (0..image.height).step_by(BLOCK as usize) {
        for x0 in (0..image.width).step_by(BLOCK as usize) {
            let (x1, y1) = ((x0 + BLOCK).min(image.width), (y0 + BLOCK).min(image.height));
            let (mut a, mut r) = (0.0f32, 0.0f32);
            for y in y0..y1 {
                for x in x0..x1 {
                    a += image.get(x, y).iter().sum::<f32>();
                    r += reference.get(x, y).iter().sum::<f32>();
                }
            }
            let d = 100.0 / range * (a - r) / (r + 0.01 * ((x1 - x0) * (y1 - y0)) as f32);
            let color = [d.clamp(0.0, 1.0), 0.0, (-d).clamp(0.0, 1.0)];
            for y in y0..y1 {
                for x in x0..x1 {
                    out.rgb[(y * image.width + x) as usize] = color;
                }
            }
        }
    }
    out
}
