//! Radiance from an equirectangular image, sampled in proportion to itself.
//!
//! In the map's own frame the rows run from +y (top) to −y; the middle of the image is −z, which a camera without a
//! transform looks along, and columns grow toward +x. Radiance is interpolated bilinearly between texel centres,
//! across the seam; above the first and below the last row of centres it does not change with the angle to the pole.
//! *Cells* are the rectangles between neighbouring centres, in which the interpolation is one bilinear form, and the
//! half rows at the poles.
//!
//! Sampling chooses a cell by its integral, then a point in it by the bilinear form's luminance: the density follows the
//! luminance exactly but for the variation of sinθ within a cell, where it takes the row's mean.

use std::f64::consts::{PI, TAU};

use crate::math::{DMat3, DVec3, Rgb, Vec3, luminance};
use crate::pdf::LightPointPdf;
use crate::planted::{Bug, planted};
use crate::sampling::AliasTable;

/// An equirectangular image as a light at infinity.
#[derive(Clone, Debug)]
pub struct EnvironmentMap {
    width: usize,
    height: usize,
    /// Radiance by row from +y, W·m⁻²·sr⁻¹.
    texels: Vec<Rgb>,
    /// Render space to the map's frame, and back: a rotation.
    to_map: DMat3,
    to_render: DMat3,
    /// Chooses cells: (height + 1) rows of `width`.
    cells: AliasTable,
    /// Mean of sinθ over each row of cells.
    row_sin: Vec<f64>,
    /// Σ over cells of luminance × mean sinθ × extent in the unit square.
    total: f64,
}

/// Where a direction falls: the cell, and the place in it.
struct Place {
    column: usize,
    row: usize,
    x: f64,
    y: f64,
    sin: f64,
}

impl EnvironmentMap {
    /// A map of `height` rows of `width` texels, rotated into render space by `to_render`; `None` when it is all black.
    /// Texels are finite and not negative.
    pub fn new(width: usize, height: usize, texels: Vec<Rgb>, to_render: DMat3) -> Option<Self> {
        assert!(width > 0 && height > 0 && texels.len() == width * height, "an image without its texels");
        let n = height as f64;
        let theta = |row: usize| PI * (row as f64 - 0.5).clamp(0.0, n) / n;
        // ∫ sinθ dθ over the row, as a difference of cosines by 2 sin sin, which does not cancel at the poles.
        let row_sin: Vec<f64> = (0..=height)
            .map(|row| {
                let (a, b) = (theta(row), theta(row + 1));
                2.0 * (0.5 * (a + b)).sin() * (0.5 * (b - a)).sin() / (b - a)
            })
            .collect();
        let mut map = Self {
            width,
            height,
            texels,
            to_map: to_render.transpose(),
            to_render,
            cells: AliasTable::new(&[1.0])?,
            row_sin,
            total: 0.0,
        };
        let mut weights = Vec::with_capacity(width * (height + 1));
        for row in 0..=height {
            let extent = map.row_height(row) / width as f64;
            for column in 0..width {
                let mean = map.corners(column, row).iter().map(|c| f64::from(luminance(*c))).sum::<f64>() / 4.0;
                weights.push(mean * map.row_sin[row] * extent);
            }
        }
        map.total = weights.iter().sum();
        map.cells = AliasTable::new(&weights)?;
        Some(map)
    }

    /// Height of a row of cells in the unit square.
    fn row_height(&self, row: usize) -> f64 {
        let full = 1.0 / self.height as f64;
        if row == 0 || row == self.height { 0.5 * full } else { full }
    }

    /// Top of a row of cells in the unit square.
    fn row_top(&self, row: usize) -> f64 {
        if row == 0 { 0.0 } else { (row as f64 - 0.5) / self.height as f64 }
    }

    /// The texels at a cell's corners: top left, top right, bottom left, bottom right.
    #[inline]
    fn corners(&self, column: usize, row: usize) -> [Rgb; 4] {
        let (left, right) = (column, if column + 1 == self.width { 0 } else { column + 1 });
        let (top, bottom) = (row.saturating_sub(1), row.min(self.height - 1));
        let at = |x: usize, y: usize| self.texels[y * self.width + x];
        [at(left, top), at(right, top), at(left, bottom), at(right, bottom)]
    }

    /// The cell that a direction falls into.
    #[inline]
    fn place(&self, toward: Vec3) -> Place {
        let d = self.to_map * toward.as_dvec3();
        let sin = (d.x * d.x + d.z * d.z).sqrt();
        let theta = sin.atan2(d.y);
        let phi = d.x.atan2(-d.z);
        // The middle column looks along −z; columns grow toward +x.
        let u = (phi / TAU + 0.5) * self.width as f64 - 0.5;
        let column = u.floor();
        let v = theta / PI * self.height as f64 + 0.5;
        let row = (v as usize).min(self.height);
        let y = match row {
            0 => 2.0 * v - 1.0,
            _ if row == self.height => 2.0 * (v - row as f64),
            _ => v - row as f64,
        };
        let columns = self.width as i64;
        Place { column: (column as i64).rem_euclid(columns) as usize, row, x: u - column, y: y.clamp(0.0, 1.0), sin }
    }

    #[inline]
    fn interpolate(corners: [Rgb; 4], x: f64, y: f64) -> Rgb {
        let (x, y) = (x as f32, y as f32);
        let top = corners[0] * (1.0 - x) + corners[1] * x;
        let bottom = corners[2] * (1.0 - x) + corners[3] * x;
        top * (1.0 - y) + bottom * y
    }

    /// Radiance that arrives from the unit direction `toward`.
    #[inline]
    pub fn radiance(&self, toward: Vec3) -> Rgb {
        let at = self.place(toward);
        Self::interpolate(self.corners(at.column, at.row), at.x, at.y)
    }

    /// A direction with its density per solid angle; `None` at a pole itself, which has no solid angle.
    #[inline]
    pub fn sample(&self, u_cell: f64, u: [f32; 2]) -> Option<(Vec3, LightPointPdf)> {
        let (cell, _) = self.cells.sample(u_cell);
        let (row, column) = (cell / self.width, cell % self.width);
        let [a, b, c, d] = self.corners(column, row).map(|c| f64::from(luminance(c)));
        // The marginal in y is linear between the means of the top and the bottom edge, then x given y.
        let y = sample_linear(f64::from(u[1]), a + b, c + d);
        let x = sample_linear(f64::from(u[0]), a + (c - a) * y, b + (d - b) * y);
        let theta = PI * (self.row_top(row) + y * self.row_height(row));
        let phi = TAU * ((column as f64 + 0.5 + x) / self.width as f64 - 0.5);
        let (sin, cos) = theta.sin_cos();
        let d = DVec3::new(sin * phi.sin(), cos, -sin * phi.cos());
        let toward = (self.to_render * d).as_vec3a().normalize();
        // The density of the direction as it was rounded, which is what the other techniques will ask for.
        let pdf = self.pdf(toward);
        (pdf.0 > 0.0 && pdf.0.is_finite()).then_some((toward, pdf))
    }

    /// Density per solid angle with which `sample` chooses a direction: p(u, v)/(2π² sinθ).
    #[inline]
    pub fn pdf(&self, toward: Vec3) -> LightPointPdf {
        let at = self.place(toward);
        if at.sin <= 0.0 {
            return LightPointPdf::IMPOSSIBLE;
        }
        let value = luminance(Self::interpolate(self.corners(at.column, at.row), at.x, at.y));
        let sin = if planted(Bug::NoSineInMap) { 1.0 } else { at.sin };
        LightPointPdf(f64::from(value) * self.row_sin[at.row] / (self.total * 2.0 * PI * PI * sin))
    }

    /// ∫ L dω, up to the variation of sinθ within a cell.
    pub fn integral(&self) -> Rgb {
        let mut sum = DVec3::ZERO;
        for row in 0..=self.height {
            let weight = self.row_sin[row] * self.row_height(row) / self.width as f64 * 2.0 * PI * PI;
            for column in 0..self.width {
                sum += self.corners(column, row).iter().map(|c| c.as_dvec3()).sum::<DVec3>() * (0.25 * weight);
            }
        }
        sum.as_vec3a()
    }

    /// The largest radiance of any channel.
    pub fn brightest(&self) -> f32 {
        self.texels.iter().map(|t| t.max_element()).fold(0.0, f32::max)
    }
}

/// A number in [0, 1] with a density linear from `a` to `b` (not both zero), by inverting a·x + (b − a)x²/2, in the form
/// that does not cancel.
#[inline]
fn sample_linear(u: f64, a: f64, b: f64) -> f64 {
    if a + b <= 0.0 {
        return u;
    }
    let root = (a * a * (1.0 - u) + b * b * u).sqrt();
    if a + root > 0.0 { (u * (a + b) / (a + root)).min(1.0) } else { 0.0 }
}
