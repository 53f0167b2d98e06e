//! The pyramid's contact sheet: all techniques' images side by side, labelled, after Veach's figures (1997, ch. 10).
//!
//! A row holds the paths of one length, s grows to the right. Long paths carry little light, so that each row is
//! multiplied by a power of two of its own, which is written beside it; within a row brightnesses can be compared. The
//! factors never decrease with the length, and follow means, which a few samples estimate without bias: any quantile of
//! an image that is mostly black still, as those of long paths are for long, says more about the samples than about it.

use std::collections::BTreeMap;

use crate::film::Image;
use crate::integrator::Technique;

/// The sheet and how it is to be read.
pub struct Sheet {
    /// The picture, exposed: to be written as it is.
    pub image: Image,
    /// Path length in edges and factor of each row that has images, from short to long.
    pub rows: Vec<(u32, u32)>,
}

/// Largest side of one image on the sheet, and of the columns of them all, in pixels.
const CELL: u32 = 160;
const ALL_CELLS: u32 = 8192;

/// Pixels between things.
const GAP: u32 = 6;

/// Pixels of the sheet per pixel of the font.
const FONT_SCALE: u32 = 2;
const TEXT_HEIGHT: u32 = 5 * FONT_SCALE;

/// Linear grey of the sheet and of its letters: an image that is black shows as one.
const PAPER: [f32; 3] = [0.05; 3];
const INK: [f32; 3] = [0.6; 3];

/// Rows are brightened 2 to this power at most: beyond it there is noise alone.
const MOST_STOPS: f64 = 16.0;

/// The mean that brightening must not drive an image beyond: pictures whose brightest parts are several times their mean
/// still show them.
const LARGEST_MEAN: f64 = 0.25;

/// Where things are on the sheet.
struct Layout {
    /// Side of the square of pixels that one pixel of a tile averages.
    step: u32,
    /// Width and height of a tile.
    tile: [u32; 2],
    /// Width and height from one tile to the next.
    pitch: [u32; 2],
    /// Column of the first tile; row labels are left of it.
    margin: u32,
    /// Path lengths in edges of the first and the last row.
    edges: [u32; 2],
    columns: u32,
}

impl Layout {
    fn new(techniques: &BTreeMap<Technique, Image>) -> Option<Self> {
        let any = techniques.values().next()?;
        let edges = |t: &Technique| t.s + t.t - 1;
        let edges = [techniques.keys().map(edges).min()?, techniques.keys().map(edges).max()?];
        let columns = techniques.keys().map(|t| t.s).max()? + 1;
        let cell = (ALL_CELLS / columns).clamp(CELL / 5, CELL);
        let step = any.width.max(any.height).div_ceil(cell).max(1);
        let tile = [any.width, any.height].map(|n| n.div_ceil(step));
        let label = techniques.keys().map(|t| text_width(&tile_label(*t))).max()?;
        let pitch = [tile[0].max(label) + GAP, (TEXT_HEIGHT + GAP / 2 + tile[1]).max(2 * TEXT_HEIGHT + GAP) + GAP];
        let margin = GAP + text_width(&row_label(edges[1])).max(text_width(&factor_label(1 << 16))) + 2 * GAP;
        Some(Self { step, tile, pitch, margin, edges, columns })
    }

    fn size(&self) -> [u32; 2] {
        let rows = self.edges[1] - self.edges[0] + 1;
        [self.margin + self.columns * self.pitch[0], GAP + rows * self.pitch[1]]
    }

    /// Top of a row: of its labels.
    fn row(&self, edges: u32) -> u32 {
        GAP + (edges - self.edges[0]) * self.pitch[1]
    }

    /// Top left pixel of a technique's image.
    fn place(&self, t: Technique) -> [u32; 2] {
        [self.margin + t.s * self.pitch[0], self.row(t.s + t.t - 1) + TEXT_HEIGHT + GAP / 2]
    }
}

fn tile_label(t: Technique) -> String {
    format!("{},{}", t.s, t.t)
}

fn row_label(edges: u32) -> String {
    format!("{edges} EDGE{}", if edges == 1 { "" } else { "S" })
}

fn factor_label(factor: u32) -> String {
    format!("×{factor}")
}

/// Puts the sheet together, `exposure` in stops; `None` without images.
pub fn sheet(techniques: &BTreeMap<Technique, Image>, exposure: f32) -> Option<Sheet> {
    let layout = Layout::new(techniques)?;
    let [width, height] = layout.size();
    let mut image = Image { width, height, rgb: vec![PAPER; width as usize * height as usize] };
    let mut tiles: BTreeMap<u32, Vec<(Technique, Image)>> = BTreeMap::new();
    for (t, full) in techniques {
        tiles.entry(t.s + t.t - 1).or_default().push((*t, shrunk(full, &layout, exposure.exp2())));
    }
    let factors = row_factors(tiles.values().map(|row| row_mean(row)).collect());
    let rows: Vec<(u32, u32)> = tiles.keys().copied().zip(factors).collect();
    for (&(edges, factor), tiles) in rows.iter().zip(tiles.values()) {
        let top = layout.row(edges);
        write(&mut image, [GAP, top], &row_label(edges));
        write(&mut image, [GAP, top + TEXT_HEIGHT + GAP], &factor_label(factor));
        for (t, tile) in tiles {
            let [x0, y0] = layout.place(*t);
            write(&mut image, [x0, top], &tile_label(*t));
            for y in 0..tile.height {
                for x in 0..tile.width {
                    set(&mut image, x0 + x, y0 + y, tile.get(x, y).map(|v| v * factor as f32));
                }
            }
        }
    }
    Some(Sheet { image, rows })
}

/// An image at a tile's size, each pixel the mean over a square of its pixels, times `scale`.
fn shrunk(full: &Image, layout: &Layout, scale: f32) -> Image {
    let mut tile = Image::new(layout.tile[0], layout.tile[1]);
    for y in 0..tile.height {
        for x in 0..tile.width {
            let value = mean(full, x * layout.step, y * layout.step, layout.step).map(|v| v * scale);
            set(&mut tile, x, y, value);
        }
    }
    tile
}

/// Mean over a square of pixels.
fn mean(image: &Image, x0: u32, y0: u32, side: u32) -> [f32; 3] {
    let (x1, y1) = ((x0 + side).min(image.width), (y0 + side).min(image.height));
    let mut sum = [0.0f32; 3];
    for y in y0..y1 {
        for x in x0..x1 {
            for (s, v) in sum.iter_mut().zip(image.get(x, y)) {
                *s += v;
            }
        }
    }
    let n = ((x1 - x0) * (y1 - y0)).max(1) as f32;
    sum.map(|s| s / n)
}

/// Mean of the largest channel over the brightest of a row's images.
fn row_mean(tiles: &[(Technique, Image)]) -> f64 {
    let mean = |tile: &Image| {
        let sum: f64 = tile.rgb.iter().map(|p| f64::from(p[0].max(p[1]).max(p[2]))).sum();
        sum / tile.rgb.len().max(1) as f64
    };
    tiles.iter().map(|(_, tile)| mean(tile)).fold(0.0, f64::max)
}

/// From the rows' means, short paths first: the largest powers of two, at least 1, that drive no mean beyond the largest
/// and do not decrease. A row that is darker than a longer one's is shown as dark as it is; a black one has no say.
fn row_factors(means: Vec<f64>) -> Vec<u32> {
    let largest = |mean: f64| 1u32 << (LARGEST_MEAN / mean).log2().clamp(0.0, MOST_STOPS) as u32;
    let mut limit = None;
    let mut factors: Vec<Option<u32>> = (means.iter().rev())
        .map(|&mean| {
            if mean > 0.0 {
                limit = Some(limit.map_or(largest(mean), |limit: u32| limit.min(largest(mean))));
            }
            limit
        })
        .collect();
    factors.reverse();
    // Black rows at the end go on as the last one before them.
    let mut last = 1;
    let forward = |factor: Option<u32>| {
        last = factor.unwrap_or(last);
        last
    };
    factors.into_iter().map(forward).collect()
}

fn set(image: &mut Image, x: u32, y: u32, value: [f32; 3]) {
    image.rgb[y as usize * image.width as usize + x as usize] = value;
}

/// The letters of the labels: five rows of three bits.
fn glyph(c: char) -> [u8; 5] {
    match c {
        '0' => [0b111, 0b101, 0b101, 0b101, 0b111],
        '1' => [0b010, 0b110, 0b010, 0b010, 0b111],
        '2' => [0b111, 0b001, 0b111, 0b100, 0b111],
        '3' => [0b111, 0b001, 0b111, 0b001, 0b111],
        '4' => [0b101, 0b101, 0b111, 0b001, 0b001],
        '5' => [0b111, 0b100, 0b111, 0b001, 0b111],
        '6' => [0b111, 0b100, 0b111, 0b101, 0b111],
        '7' => [0b111, 0b001, 0b010, 0b010, 0b010],
        '8' => [0b111, 0b101, 0b111, 0b101, 0b111],
        '9' => [0b111, 0b101, 0b111, 0b001, 0b111],
        ',' => [0b000, 0b000, 0b000, 0b010, 0b100],
        '×' => [0b000, 0b101, 0b010, 0b101, 0b000],
        'D' => [0b110, 0b101, 0b101, 0b101, 0b110],
        'E' => [0b111, 0b100, 0b110, 0b100, 0b111],
        'G' => [0b111, 0b100, 0b101, 0b101, 0b111],
        'S' => [0b011, 0b100, 0b111, 0b001, 0b110],
        _ => [0; 5],
    }
}

/// Pixels that a text takes, its last gap left out.
fn text_width(text: &str) -> u32 {
    (4 * text.chars().count() as u32).saturating_sub(1) * FONT_SCALE
}

/// Writes a text with its top left corner at `x0`, `y0`.
fn write(image: &mut Image, [x0, y0]: [u32; 2], text: &str) {
    for (i, c) in text.chars().enumerate() {
        for (row, bits) in glyph(c).into_iter().enumerate() {
            for column in (0..3).filter(|column| bits >> (2 - column) & 1 == 1) {
                let (x, y) = (x0 + (4 * i as u32 + column) * FONT_SCALE, y0 + row as u32 * FONT_SCALE);
                for dy in 0..FONT_SCALE {
                    for dx in 0..FONT_SCALE {
                        set(image, x + dx, y + dy, INK);
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(width: u32, height: u32, value: f32) -> Image {
        Image { width, height, rgb: vec![[value; 3]; (width * height) as usize] }
    }

    /// A text's letters as they stand on an image.
    fn stands(image: &Image, at: [u32; 2], text: &str) -> bool {
        let [width, height] = [text_width(text), TEXT_HEIGHT];
        let mut expected = Image { width, height, rgb: vec![PAPER; (width * height) as usize] };
        write(&mut expected, [0, 0], text);
        assert!(expected.rgb.contains(&INK));
        (0..height).all(|y| (0..width).all(|x| image.get(at[0] + x, at[1] + y) == expected.get(x, y)))
    }

    #[test]
    fn rows_are_labelled_and_brightened_by_a_power_of_two() {
        // Two edges: 0.1 and less; three: 0.01; one: brighter than white. 0.1 · 2 < 0.25 < 0.1 · 4, 0.01 · 16 < 0.25.
        let values = [((0, 2), 3.0), ((0, 3), 0.03), ((1, 2), 0.1), ((2, 2), 0.01), ((3, 1), 0.0)];
        let techniques: BTreeMap<Technique, Image> =
            values.iter().map(|&((s, t), value)| (Technique { s, t }, flat(40, 30, value))).collect();
        let sheet = sheet(&techniques, 0.0).unwrap();
        assert_eq!(sheet.rows, [(1, 1), (2, 2), (3, 16)]);
        let layout = Layout::new(&techniques).unwrap();
        assert_eq!([sheet.image.width, sheet.image.height], layout.size());
        for ((s, t), value) in values {
            let technique = Technique { s, t };
            let [x0, y0] = layout.place(technique);
            let factor = sheet.rows[(s + t - 2) as usize].1 as f32;
            for (x, y) in [(0, 0), (39, 0), (0, 29), (39, 29)] {
                assert_eq!(sheet.image.get(x0 + x, y0 + y), [value * factor; 3], "{s},{t} at {x}, {y}");
            }
            for (x, y) in [(x0 - 1, y0), (x0 + 40, y0), (x0, y0 - 1), (x0, y0 + 30)] {
                assert_eq!(sheet.image.get(x, y), PAPER, "{s},{t}: beside it");
            }
            assert!(stands(&sheet.image, [x0, layout.row(s + t - 1)], &format!("{s},{t}")), "{s},{t}");
        }
        for (edges, row, factor) in [(1, "1 EDGE", "×1"), (2, "2 EDGES", "×2"), (3, "3 EDGES", "×16")] {
            let top = layout.row(edges);
            assert!(stands(&sheet.image, [GAP, top], row) && stands(&sheet.image, [GAP, top + 16], factor), "{row}");
        }
    }

    #[test]
    fn exposure_brightens_the_images_and_not_the_labels() {
        let techniques = BTreeMap::from([(Technique { s: 0, t: 3 }, flat(5, 7, 0.1))]);
        // Two stops down are made up for by the row's factor.
        for (stops, factor) in [(0.0, 2), (-2.0, 8), (3.0, 1), (9.0, 1)] {
            let sheet = sheet(&techniques, stops).unwrap();
            assert_eq!(sheet.rows, [(2, factor)]);
            let value = 0.1 * stops.exp2() * factor as f32;
            assert!(sheet.image.rgb.contains(&[value; 3]) && sheet.image.rgb.contains(&INK));
        }
    }

    #[test]
    fn sizes_stay_sensible() {
        // Large images are shrunk, by means; tiny ones keep room for their labels; none makes no sheet.
        let mut image = flat(1000, 500, 0.12);
        image.rgb[0] = [0.12 + 49.0 * 0.12; 3];
        let techniques = BTreeMap::from([(Technique { s: 1, t: 2 }, image)]);
        let layout = Layout::new(&techniques).unwrap();
        assert_eq!((layout.step, layout.tile), (7, [143, 72]));
        let picture = sheet(&techniques, 0.0).unwrap();
        assert_eq!(picture.rows, [(2, 2)]);
        let [x0, y0] = layout.place(Technique { s: 1, t: 2 });
        // The mean over 7 × 7 pixels is twice what it would be without the bright one, and the row doubles it.
        assert!(
            (picture.image.get(x0, y0)[0] / 0.48 - 1.0).abs() < 1e-6
                && (picture.image.get(x0 + 1, y0)[2] / 0.24 - 1.0).abs() < 1e-6
        );
        let tiny = BTreeMap::from([(Technique { s: 12, t: 13 }, flat(1, 1, 1.0))]);
        assert!(Layout::new(&tiny).unwrap().pitch[0] >= text_width("12,13") + GAP);
        let many = BTreeMap::from([(Technique { s: 64, t: 1 }, flat(4000, 4000, 1.0))]);
        assert!(Layout::new(&many).unwrap().size()[0] < 10_000);
        assert!(sheet(&BTreeMap::new(), 0.0).is_none());
    }

    #[test]
    fn a_row_is_as_bright_as_its_brightest_image_on_average() {
        let row = |images: Vec<Image>| {
            let tiles: Vec<_> = (0..).zip(images).map(|(s, image)| (Technique { s, t: 2 }, image)).collect();
            row_factors(vec![row_mean(&tiles)])[0]
        };
        // One pixel of 400 has all of the light, as at few samples, or each has its part: the same factor.
        let mut sparse = flat(20, 20, 0.0);
        sparse.rgb[7] = [0.0, 0.3 * 400.0 / 64.0, 0.0];
        assert_eq!((row(vec![sparse]), row(vec![flat(20, 20, 0.3 / 64.0)])), (32, 32));
        assert_eq!(row(vec![flat(20, 20, 0.001), flat(9, 9, 0.03), flat(20, 20, 0.0)]), 8);
        assert_eq!(row(vec![flat(20, 20, 0.25)]), 1);
        assert_eq!(row(vec![flat(20, 20, 0.124)]), 2);
        assert_eq!(row(vec![flat(20, 20, 0.0)]), 1);
        assert_eq!(row(vec![flat(20, 20, 1e-20)]), 1 << 16);
        assert_eq!(row(vec![flat(20, 20, f32::INFINITY)]), 1);
    }

    #[test]
    fn factors_never_decrease_and_drive_no_row_beyond_white() {
        let factors = |means: &[f64]| row_factors(means.to_vec());
        assert_eq!(factors(&[3.0, 0.2, 0.06, 0.02, 0.004]), [1, 1, 4, 8, 32]);
        // A lamp that is a few pixels large, or what lies in the dark but for long paths, is left dark, ...
        assert_eq!(factors(&[1e-4, 0.2, 0.06]), [1, 1, 4]);
        // ... and noise in the means does not jump about.
        assert_eq!(factors(&[0.004, 0.000_2, 0.008, 0.001]), [16, 16, 16, 128]);
        // What is black limits nothing.
        assert_eq!(factors(&[0.0, 0.06, 0.0, 0.004, 0.0]), [4, 4, 32, 32, 32]);
        assert_eq!(factors(&[0.0, 0.0]), [1, 1]);
        assert_eq!(factors(&[]), [0u32; 0]);
    }
}
