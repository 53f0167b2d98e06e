//! A linear RGB image in memory.

/// Linear RGB, row-major from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// One triple per pixel.
    pub rgb: Vec<[f32; 3]>,
}

impl Image {
    /// A black image.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, rgb: vec![[0.0; 3]; width as usize * height as usize] }
    }

    /// The pixel in column `x`, row `y` from the top left. Panics outside the image.
    pub fn get(&self, x: u32, y: u32) -> [f32; 3] {
        self.rgb[y as usize * self.width as usize + x as usize]
    }

    /// Mean per channel, summed in f64.
    pub fn mean(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for pixel in &self.rgb {
            for (s, x) in sum.iter_mut().zip(pixel) {
                *s += f64::from(*x);
            }
        }
        sum.map(|s| s / self.rgb.len().max(1) as f64)
    }
}
