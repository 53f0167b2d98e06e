//! The report for people: one file without scripts or anything from elsewhere.

use std::fmt::Write;

use super::base64::base64;
use super::plot::{Point, Series, plot};
use super::table::Cells;
use super::{ConfigurationReport, Report, SceneReport, text};
use crate::compare::stats::Median;
use crate::compare::{FULL_COLOUR, difference};
use crate::film::Image;
use crate::output::encode_png;

/// Text for HTML and its attributes.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const HEAD: &str = concat!(
    "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<title>Twinlight bench</title>\n<style>\n",
    "body { font: 14px sans-serif; margin: 2em; max-width: 75em; background: #fff; color: #222 }\n",
    "table { border-collapse: collapse; margin: 1em 0 }\n",
    "th, td { padding: .2em .7em; text-align: right; border-bottom: 1px solid #ccc; white-space: nowrap }\n",
    "th { vertical-align: bottom } td.name, th.name { text-align: left } td small { color: #666 }\n",
    "figure { display: inline-block; margin: 0 1em 1em 0; vertical-align: top } figcaption { color: #444; max-width: 24em }\n",
    "img { image-rendering: pixelated; min-width: 128px }\n",
    "</style>\n</head>\n<body>\n",
);

/// What the columns and the plots mean, once for all scenes.
const EXPLANATION: &str = "<p>relMSE is the mean over pixels and channels of (x − r)² / (r² + 0.01), r being the reference; where the \
     reference's noise is known it is subtracted, and “&lt; noise” is what is left when that is below it. Efficiency is \
     1 / (relMSE × CPU seconds) in 1/s; × first is the median of its ratios to the first configuration, repetition by \
     repetition. Energy is the mean over the reference's. CPU seconds are those of the render, all threads; Mrays/s are per \
     CPU second; memory is the largest resident one of the process during a run, its reference and pages that the allocator \
     kept among it.</p>\n";

const COLUMNS: &str = "<tr><th class=\"name\">integrator</th><th class=\"name\">accel</th><th>spp</th><th>CPU s</th><th>relMSE</th>\
     <th>without worst 0.1 %</th><th>MSE</th><th>efficiency, 1/s</th><th>× first</th><th>energy</th><th>Mrays/s</th><th>MiB</th>\
     </tr>\n";

impl Report {
    /// The report for people.
    pub fn html(&self) -> String {
        let mut out = String::from(HEAD);
        let machine = &self.machine;
        let threads = if self.threads == 1 { "1 thread".to_owned() } else { format!("{} threads", self.threads) };
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            "<h1>Twinlight bench</h1>\n<p>twinlight {} ({}), {} of {} on {}, {}.</p>\n<p>{}</p>\n{EXPLANATION}",
            self.version,
            self.git,
            threads,
            machine.processors,
            escaped(machine.cpu.as_deref().unwrap_or("an unnamed processor")),
            escaped(&machine.system),
            escaped(&self.intervals())
        );
        self.scenes.iter().for_each(|scene| section(&mut out, scene));
        out.push_str("</body>\n</html>\n");
        out
    }
}

fn section(out: &mut String, scene: &SceneReport) {
    let [width, height] = scene.resolution;
    let _ = write!(
        out,
        "<h2>{}</h2>\n<p>{}, {width} × {height} pixels, max_bounces {}; {}.</p>\n",
        escaped(&scene.name),
        escaped(&scene.file),
        scene.max_bounces,
        escaped(&scene.about_reference())
    );
    if !scene.notes.is_empty() {
        let notes = scene.notes.iter().map(|note| format!("<li>{}</li>\n", escaped(note)));
        let _ = write!(out, "<ul>\n{}</ul>\n", notes.collect::<String>());
    }
    out.push_str(&plot(&series(scene), scene.measure.rel_mse));
    out.push_str("<table>\n");
    out.push_str(COLUMNS);
    for (index, c) in scene.configurations.iter().enumerate() {
        row(out, c, index == 0);
    }
    out.push_str("</table>\n");
    let reference = &scene.measure.reference.image;
    out.push_str(&figure("reference", reference));
    for c in &scene.configurations {
        let Some(image) = &c.image else { continue };
        let name = format!("{}, {}, {} spp", c.integrator, c.backend.name(), c.samples);
        out.push_str(&figure(&name, image));
        let caption =
            format!("{name}: against the reference, means over 4 × 4 pixels, red where brighter, ±{FULL_COLOUR} %");
        out.push_str(&figure(&caption, &difference(image, reference, FULL_COLOUR)));
    }
}

/// A cell whose attribute has all digits, for those who copy numbers.
fn cell(out: &mut String, class: &str, median: Option<Median>, shown: &str, interval: &str) {
    let value = median.filter(|m| m.median.is_finite()).map_or(String::new(), |m| m.median.to_string());
    let interval = if interval.is_empty() { String::new() } else { format!(" <small>{}</small>", escaped(interval)) };
    let _ = write!(out, "<td class=\"{class}\" data-value=\"{value}\">{}{interval}</td>", escaped(shown));
}

fn row(out: &mut String, c: &ConfigurationReport, first: bool) {
    let (cells, s) = (Cells::of(c, first), &c.summary);
    let budget =
        c.budget.map_or(String::new(), |(seconds, _)| format!(" <small>for {} s</small>", text::figures(seconds)));
    let auto = if c.integrator == c.renders_by() { String::new() } else { format!(" = {}", c.renders_by()) };
    let _ = write!(
        out,
        "<tr><td class=\"name\">{}{auto}</td><td class=\"name\" title=\"{}\">{}</td><td>{}{budget}</td>",
        c.integrator,
        escaped(&c.accelerator),
        c.backend.name(),
        c.samples
    );
    let error = |m: Option<Median>| match m {
        None => "-".to_owned(),
        Some(m) if m.median == f64::NEG_INFINITY => "< noise".to_owned(),
        Some(m) => text::figures(m.median),
    };
    cell(out, "cpu", s.cpu_seconds, &cells.cpu, "");
    cell(out, "rel_mse", s.rel_mse, &cells.rel_mse, "");
    cell(out, "rel_mse_trimmed", s.rel_mse_trimmed, &error(s.rel_mse_trimmed), "");
    cell(out, "mse", s.mse, &error(s.mse), "");
    cell(out, "efficiency", s.efficiency, &cells.efficiency[0], &cells.efficiency[1]);
    cell(out, "ratio", s.ratio, &cells.ratio[0], &cells.ratio[1]);
    cell(out, "energy", s.energy, &cells.energy, "");
    cell(out, "rays", s.rays_per_cpu_second, &cells.mega_rays, "");
    cell(out, "memory", s.peak_memory, &cells.memory, "");
    out.push_str("</tr>\n");
}

fn figure(caption: &str, image: &Image) -> String {
    let caption = escaped(caption);
    match encode_png(image, 0.0) {
        Ok(png) => format!(
            "<figure><img alt=\"{caption}\" src=\"data:image/png;base64,{}\"/><figcaption>{caption}</figcaption></figure>\n",
            base64(&png)
        ),
        Err(why) => format!("<figure><figcaption>{caption}: {}</figcaption></figure>\n", escaped(&why)),
    }
}

/// A line for each integrator on each accelerator.
fn series(scene: &SceneReport) -> Vec<Series> {
    let mut out: Vec<Series> = Vec::new();
    let (mut integrators, mut backends) = (Vec::new(), Vec::new());
    let mut index = |c: &ConfigurationReport| {
        let of = |list: &mut Vec<String>, name: &str| {
            list.iter().position(|n| n == name).unwrap_or_else(|| {
                list.push(name.to_owned());
                list.len() - 1
            })
        };
        (of(&mut integrators, c.integrator), of(&mut backends, c.backend.name()))
    };
    for c in &scene.configurations {
        let (color, style) = index(c);
        let Some(time) = c.summary.cpu_seconds else { continue };
        let error = c.summary.rel_mse.filter(|m| m.median.is_finite());
        // What has no median for another reason than noise is not shown.
        if error.is_none() && !c.below_noise() {
            continue;
        }
        let point = Point { time: (time.median, time.interval), error: error.map(|m| (m.median, m.interval)) };
        match out.iter_mut().find(|s| (s.color, s.style) == (color, style)) {
            Some(s) => s.points.push(point),
            None => {
                let label = format!("{}, {}", c.integrator, c.backend.name());
                out.push(Series { label, color, style, points: vec![point] });
            }
        }
    }
    out.iter_mut().for_each(|s| s.points.sort_by(|a, b| a.time.0.total_cmp(&b.time.0)));
    out
}
