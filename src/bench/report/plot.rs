//! Error against time, both logarithmic, as SVG.

use std::fmt::Write;

use super::html::escaped;
use super::text;
use crate::compare::stats::Interval;

/// A configuration in the plot.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Processor seconds: median and interval.
    pub time: (f64, Interval),
    /// relMSE: median and interval, whose lower end is −∞ where it is below the reference's noise. `None` where the median is.
    pub error: Option<(f64, Interval)>,
}

/// A line: what differs in the number of samples alone.
#[derive(Clone, Debug)]
pub struct Series {
    /// What stands in the legend and at the line's end.
    pub label: String,
    /// Index of its colour.
    pub color: usize,
    /// Index of its dashes and of the shape of its points.
    pub style: usize,
    /// By time.
    pub points: Vec<Point>,
}

/// Colours that the colour-blind tell apart (Okabe and Ito 2008, "Color Universal Design").
const COLORS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00"];

/// Dashes of lines.
const DASHES: [&str; 2] = ["none", "6 3"];

const WIDTH: f64 = 760.0;
/// The plot's frame; the legend is above, labels at the lines' ends to the right.
const LEFT: f64 = 70.0;
const RIGHT: f64 = 620.0;
const TOP: f64 = 20.0;
const FRAME: f64 = 360.0;
/// Height of a row of the legend, and its entries.
const ROW: f64 = 20.0;
const PER_ROW: usize = 4;

/// One axis: decades to pixels.
#[derive(Clone, Copy, Debug)]
struct Axis {
    /// Decimal logarithms at the ends.
    ends: [f64; 2],
    /// Pixels there.
    pixels: [f64; 2],
}

impl Axis {
    /// Around values, all positive, with some room; at least half a decade.
    fn around(values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let logs = values.filter(|x| x.is_finite() && *x > 0.0).map(f64::log10);
        let (low, high) = logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let (low, high) = if low <= high { (low, high) } else { (-1.0, 0.0) };
        let room = (0.08 * (high - low)).max(0.25 - 0.5 * (high - low)).max(0.03);
        Self { ends: [low - room, high + room], pixels }
    }

    fn at(&self, x: f64) -> f64 {
        let share = (x.log10() - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    /// `at`, but for what lies outside, which is moved to the edge.
    fn within(&self, x: f64) -> f64 {
        let [a, b] = self.pixels;
        if x > 0.0 { self.at(x).clamp(a.min(b), a.max(b)) } else { a }
    }

    /// Values in range with a line, and whether it is a labelled one: the decades, and where there are few of them, their
    /// halves and fifths.
    fn ticks(&self) -> Vec<(f64, bool)> {
        let [low, high] = self.ends;
        let span = high - low;
        let mut out = Vec::new();
        for decade in low.floor() as i32..=high.floor() as i32 {
            for digit in 1..10 {
                // As it is written, so that 3·10⁻² is the nearest number to it.
                let Ok(x) = format!("{digit}e{decade}").parse::<f64>() else { continue };
                let labelled = match digit {
                    1 => span < 12.0 || decade % 5 == 0,
                    2 | 5 => span < 1.5,
                    _ => false,
                };
                if (low..=high).contains(&x.log10()) && (labelled || span < 5.0) {
                    out.push((x, labelled));
                }
            }
        }
        out
    }
}

/// A tick's label.
fn tick_label(x: f64) -> String {
    let power = (x.log10() + 1e-9).floor() as i32;
    if (-2..=3).contains(&power) {
        return format!("{x}");
    }
    let raised = |c: char| match c {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        c => c.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(c),
    };
    let raised: String = power.to_string().chars().map(raised).collect();
    match (x / 10f64.powi(power)).round() as i32 {
        1 => format!("10{raised}"),
        digit => format!("{digit}·10{raised}"),
    }
}

/// Error against time; `floor` is the reference's noise.
pub fn plot(series: &[Series], floor: Option<f64>) -> String {
    let legend = ROW * series.len().div_ceil(PER_ROW) as f64;
    let (top, bottom) = (TOP + legend, TOP + legend + FRAME);
    let points = || series.iter().flat_map(|s| &s.points);
    let times = points().flat_map(|p| [p.time.0, p.time.1.low, p.time.1.high]);
    let x = Axis::around(times, [LEFT, RIGHT]);
    let errors = || points().filter_map(|p| p.error).flat_map(|(e, interval)| [e, interval.low, interval.high]);
    let least = errors().filter(|e| *e > 0.0).fold(f64::INFINITY, f64::min);
    // A floor far below would press the lines together; it is told in words then.
    let floor = floor.filter(|f| *f > 0.0 && f.is_finite());
    let shown = floor.filter(|f| least.is_infinite() || *f > 0.05 * least);
    let y = Axis::around(errors().chain(shown), [bottom, top]);

    let height = bottom + 50.0;
    // Writing to a String cannot fail.
    let mut out = String::new();
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" width=\"{WIDTH}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\" role=\"img\" aria-label=\"relMSE against CPU seconds\">\n\
         <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>"
    );
    if let Some(floor) = shown {
        let at = y.within(floor);
        let (width, height) = (RIGHT - LEFT, bottom - at);
        let _ = writeln!(
            out,
            "<rect class=\"noise\" x=\"{LEFT}\" y=\"{at:.1}\" width=\"{width}\" height=\"{height:.1}\" fill=\"#ddd\"/>"
        );
    }
    grid(&mut out, &x, &y, top, bottom);
    if let Some(floor) = floor {
        let where_it_is = if shown.is_some() { "" } else { ": below this range" };
        let text = format!("noise of the reference, {}{where_it_is}", text::figures(floor));
        remark(&mut out, LEFT + 6.0, bottom - 6.0, &text);
    }
    if let Some((point, (error, _))) = points().find_map(|p| Some((p, p.error?))) {
        guide(&mut out, &x, &y, point.time.0, error);
    }
    for s in series {
        line(&mut out, s, &x, &y, shown);
    }
    labels(&mut out, series, &x, &y);
    for (i, s) in series.iter().enumerate() {
        let (left, middle) = (LEFT + (i % PER_ROW) as f64 * 170.0, 12.0 + ROW * (i / PER_ROW) as f64);
        let (color, dash) = (color(s), dash(s));
        let _ = writeln!(
            out,
            "<path d=\"M{left} {middle}h26\" stroke=\"{color}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/>\n{}\
             <text x=\"{}\" y=\"{}\">{}</text>",
            mark(s, left + 13.0, middle),
            left + 32.0,
            middle + 4.0,
            escaped(&s.label)
        );
    }
    out.push_str("</svg>\n");
    out
}

fn color(s: &Series) -> &'static str {
    COLORS[s.color % COLORS.len()]
}

fn dash(s: &Series) -> &'static str {
    DASHES[s.style % DASHES.len()]
}

/// A point's mark.
fn mark(s: &Series, x: f64, y: f64) -> String {
    let color = color(s);
    if s.style % 2 == 0 {
        format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{color}\"/>\n")
    } else {
        let (left, top) = (x - 3.5, y - 3.5);
        format!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"7\" height=\"7\" fill=\"#fff\" stroke=\"{color}\" stroke-width=\"2\"/>\n"
        )
    }
}

/// Words inside the frame, readable over lines.
fn remark(out: &mut String, x: f64, y: f64, text: &str) {
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" fill=\"#666\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\">{text}</text>"
    );
}

/// Decades with their labels, frame, names of the axes.
fn grid(out: &mut String, x: &Axis, y: &Axis, top: f64, bottom: f64) {
    for (value, labelled) in x.ticks() {
        let (at, color) = (x.at(value), if labelled { "#bbb" } else { "#eee" });
        let _ = writeln!(out, "<path d=\"M{at:.1} {top}V{bottom}\" stroke=\"{color}\"/>");
        if labelled {
            let (below, label) = (bottom + 17.0, tick_label(value));
            let _ = writeln!(out, "<text x=\"{at:.1}\" y=\"{below}\" text-anchor=\"middle\">{label}</text>");
        }
    }
    for (value, labelled) in y.ticks() {
        let (at, color) = (y.at(value), if labelled { "#bbb" } else { "#eee" });
        let _ = writeln!(out, "<path d=\"M{LEFT} {at:.1}H{RIGHT}\" stroke=\"{color}\"/>");
        if labelled {
            let (left, below, label) = (LEFT - 6.0, at + 4.0, tick_label(value));
            let _ = writeln!(out, "<text x=\"{left}\" y=\"{below:.1}\" text-anchor=\"end\">{label}</text>");
        }
    }
    let (middle, half) = (0.5 * (LEFT + RIGHT), 0.5 * (top + bottom));
    let _ = writeln!(
        out,
        "<rect x=\"{LEFT}\" y=\"{top}\" width=\"{}\" height=\"{FRAME}\" fill=\"none\" stroke=\"#444\"/>\n\
         <text x=\"{middle}\" y=\"{}\" text-anchor=\"middle\">CPU seconds of the render</text>\n\
         <text x=\"16\" y=\"{half}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {half})\">relMSE</text>",
        RIGHT - LEFT,
        bottom + 38.0
    );
}

/// What an error falling as one over the time would look like, through the first point: all that independent samples can do.
fn guide(out: &mut String, x: &Axis, y: &Axis, time: f64, error: f64) {
    if !(time > 0.0 && error > 0.0 && error.is_finite()) {
        return;
    }
    // Where the line enters the frame and where it leaves it: by time, or by error where that is reached first.
    let product = (time * error).log10();
    let from = x.ends[0].max(product - y.ends[1]);
    let to = x.ends[1].min(product - y.ends[0]);
    let pixel = |log: f64| (x.at(10f64.powf(log)), y.at(10f64.powf(product - log)));
    let ((x0, y0), (x1, y1)) = (pixel(from), pixel(to));
    let _ = writeln!(
        out,
        "<path class=\"guide\" d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"#888\" stroke-dasharray=\"2 4\"/>"
    );
    // Where the line enters, below it: the series' ends and their labels are on the other side.
    remark(out, x0 + 6.0, (y0 + 36.0).min(y.pixels[0] - 22.0), "slope −1");
}

/// A series' line, bars and points. What is below the noise is an open triangle on it.
fn line(out: &mut String, s: &Series, x: &Axis, y: &Axis, floor: Option<f64>) {
    let (color, dash) = (color(s), dash(s));
    let known: Vec<String> = (s.points.iter())
        .filter_map(|p| Some(format!("{:.1} {:.1}", x.within(p.time.0), y.within(p.error?.0))))
        .collect();
    if known.len() > 1 {
        let _ = writeln!(
            out,
            "<path class=\"line\" d=\"M{}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/>",
            known.join("L")
        );
    }
    for p in &s.points {
        let at = x.within(p.time.0);
        let Some((error, bar)) = p.error else {
            let on = floor.map_or(y.pixels[0], |f| y.within(f));
            let _ = writeln!(
                out,
                "<path class=\"below\" d=\"M{:.1} {on:.1}h10l-5 8z\" fill=\"#fff\" stroke=\"{color}\" stroke-width=\"2\"/>",
                at - 5.0
            );
            continue;
        };
        let level = y.within(error);
        let [left, right] = [p.time.1.low, p.time.1.high].map(|t| x.within(t));
        let [low, high] = [bar.low, bar.high].map(|e| y.within(e));
        let _ = write!(
            out,
            "<path class=\"bar\" d=\"M{at:.1} {low:.1}V{high:.1}M{left:.1} {level:.1}H{right:.1}\" stroke=\"{color}\"/>\n{}",
            mark(s, at, level)
        );
    }
}

/// Names at the lines' right ends, moved apart where they would cover each other.
fn labels(out: &mut String, series: &[Series], x: &Axis, y: &Axis) {
    let mut at: Vec<(f64, f64, &Series)> = (series.iter())
        .filter_map(|s| {
            let last = s.points.iter().rev().find_map(|p| Some((p.time.0, p.error?.0)));
            last.map(|(time, error)| (y.within(error), x.within(time), s))
        })
        .collect();
    at.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut free = f64::NEG_INFINITY;
    for (level, end, s) in at {
        let text = level.max(free);
        free = text + 15.0;
        let (color, from) = (color(s), end + 7.0);
        let _ = writeln!(
            out,
            "<path d=\"M{from:.1} {level:.1}L{:.1} {text:.1}\" stroke=\"{color}\" stroke-width=\".5\"/>\n\
             <text x=\"{}\" y=\"{:.1}\" fill=\"{color}\">{}</text>",
            RIGHT + 6.0,
            RIGHT + 9.0,
            text + 4.0,
            escaped(&s.label)
        );
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::assert_balanced;
    use super::*;

    fn point(time: f64, error: Option<f64>) -> Point {
        let around = |x: f64| (x, Interval { low: 0.9 * x, high: 1.1 * x });
        Point { time: around(time), error: error.map(around) }
    }

    fn series() -> Vec<Series> {
        let make = |label: &str, color, style, points: &[(f64, Option<f64>)]| Series {
            label: label.to_owned(),
            color,
            style,
            points: points.iter().map(|(t, e)| point(*t, *e)).collect(),
        };
        vec![
            make("path, embree", 0, 0, &[(0.1, Some(1.0)), (1.0, Some(0.1)), (10.0, Some(0.01))]),
            make("<bdpt> & \"bvh\"", 1, 1, &[(0.2, Some(0.3)), (2.0, Some(0.03)), (20.0, None)]),
        ]
    }

    #[test]
    fn the_plot_is_well_formed() {
        let svg = plot(&series(), Some(0.008));
        assert_balanced(&svg);
        assert!(
            svg.contains("&lt;bdpt&gt; &amp; &quot;bvh&quot;") && !svg.contains("NaN") && !svg.contains("inf"),
            "{svg}"
        );
        for (what, times) in
            [("class=\"line\"", 2), ("class=\"bar\"", 5), ("class=\"below\"", 1), ("class=\"guide\"", 1)]
        {
            assert_eq!(svg.matches(what).count(), times, "{what}\n{svg}");
        }
        assert!(svg.contains("noise of the reference, 0.00800<"), "{svg}");
        // Far below, it is told in words.
        assert!(plot(&series(), Some(1e-7)).contains("noise of the reference, 1.00e-7: below this range"));
        assert!(!plot(&series(), None).contains("noise"));
    }

    #[test]
    fn nothing_and_extremes_are_plotted_too() {
        let hidden = Interval { low: f64::NEG_INFINITY, high: 1e-30 };
        let odd = Point { time: (1e-9, Interval { low: 0.0, high: 1e9 }), error: Some((1e-31, hidden)) };
        let zero = Point {
            time: (1.0, Interval { low: 1.0, high: 1.0 }),
            error: Some((0.0, Interval { low: 0.0, high: 0.0 })),
        };
        let series = |points: &[Point]| Series { points: points.to_vec(), ..series().remove(0) };
        for all in [
            vec![],
            vec![series(&[])],
            vec![series(&[odd, zero])],
            vec![series(&[zero])],
            vec![series(&[point(1.0, None)])],
        ] {
            for floor in [None, Some(0.0), Some(1e-3), Some(f64::NAN)] {
                let svg = plot(&all, floor);
                assert_balanced(&svg);
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            }
        }
    }

    #[test]
    fn points_lie_where_they_belong() {
        let x = Axis::around([0.1, 10.0].into_iter(), [0.0, 116.0]);
        // Two decades with 8 % to each side.
        let px: Vec<f64> = [0.1, 1.0, 10.0].iter().map(|t| x.at(*t)).collect();
        assert!(px.iter().zip([8.0, 58.0, 108.0]).all(|(a, b)| (a - b).abs() < 1e-9), "{px:?}");
        let labelled: Vec<f64> = x.ticks().into_iter().filter_map(|(t, labelled)| labelled.then_some(t)).collect();
        assert_eq!(labelled, [0.1, 1.0, 10.0]);
        for (x, label) in [(0.01, "0.01"), (1000.0, "1000"), (1e-3, "10⁻³"), (5e-12, "5·10⁻¹²"), (1e4, "10⁴")]
        {
            assert_eq!(tick_label(x), label);
        }
    }
}
