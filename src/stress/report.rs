//! What came of it: a table to read, and the same as JSON and HTML.

use std::fmt::Write;

use serde_json::{Value, json};

use super::measure::Audit;
use super::{Case, Expected};
use crate::compare::stats::Interval;
use crate::integrator::Integrator;

/// A case by one integrator on one accelerator.
#[derive(Clone, Debug)]
pub struct Row {
    /// Name of the case.
    pub case: String,
    /// What is disturbed.
    pub what: &'static str,
    /// Name of the integrator.
    pub integrator: &'static str,
    /// Name of the accelerator.
    pub accelerator: &'static str,
    /// What the image is judged by.
    pub judged: String,
    /// Mean radiance.
    pub mean: f64,
    /// What it should be.
    pub expected: Option<f64>,
    /// 99 % interval of the relative difference of the energy from what is expected.
    pub energy: Option<Interval>,
    /// Contributions that were not finite, before the gate.
    pub rejected: u64,
    /// Rays of the audit.
    pub rays: u64,
    /// Rays that met the primitive they left.
    pub self_hits: u64,
    /// Rays that left a closed room.
    pub leaks: u64,
    /// The largest |Σw − 1| of `bdpt`'s paths.
    pub weights: Option<f64>,
    /// What is wrong; empty when nothing is.
    pub faults: Vec<String>,
}

impl Row {
    pub(super) fn new(case: &Case, integrator: Integrator, accelerator: &'static str) -> Self {
        Self {
            case: case.name.clone(),
            what: case.what,
            integrator: match integrator {
                Integrator::Path => "path",
                Integrator::Light => "light",
                Integrator::Bdpt => "bdpt",
                Integrator::Auto => "auto",
            },
            accelerator,
            judged: judged(case),
            mean: f64::NAN,
            expected: None,
            energy: None,
            rejected: 0,
            rays: 0,
            self_hits: 0,
            leaks: 0,
            weights: None,
            faults: Vec::new(),
        }
    }

    pub(super) fn walked(&mut self, audit: &Audit) {
        (self.rays, self.self_hits, self.leaks) = (audit.rays, audit.self_hits, audit.escapes);
        if audit.self_hits > 0 {
            self.faults.push(format!("{} of {} rays meet the primitive they left", audit.self_hits, audit.rays));
        }
        if audit.escapes > 0 {
            self.faults.push(format!("{} of {} rays leave the closed room", audit.escapes, audit.rays));
        }
    }

    /// `ok`, or what is wrong.
    pub fn verdict(&self) -> String {
        if self.faults.is_empty() { "ok".to_owned() } else { self.faults.join("; ") }
    }

    fn energy_text(&self) -> String {
        self.energy.map_or("-".to_owned(), |e| format!("{:+.3} … {:+.3} %", 100.0 * e.low, 100.0 * e.high))
    }

    fn weights_text(&self) -> String {
        self.weights.map_or("-".to_owned(), |w| format!("{w:.1e}"))
    }

    /// The columns of the pages' tables.
    fn cells(&self) -> [String; 11] {
        [
            self.case.clone(),
            self.what.to_owned(),
            self.integrator.to_owned(),
            self.accelerator.to_owned(),
            self.judged.clone(),
            self.energy_text(),
            self.rejected.to_string(),
            self.self_hits.to_string(),
            self.leaks.to_string(),
            self.weights_text(),
            self.verdict(),
        ]
    }

    /// A line of the table.
    pub fn line(&self) -> String {
        format!(
            "{:<26} {:<6} {:<7} {:<11} {:>22} {:>4} {:>4} {:>4} {:>8}  {}",
            self.case,
            self.integrator,
            self.accelerator,
            self.judged,
            self.energy_text(),
            self.rejected,
            self.self_hits,
            self.leaks,
            self.weights_text(),
            self.verdict()
        )
    }
}

/// The heading of the table.
pub const HEADING: &str =
    "case                       by     on      judged by                   energy  n/f self leak     Σw−1  verdict";

/// What a case's image is judged by, in a few letters.
fn judged(case: &Case) -> String {
    let apart = case.apart.map_or_else(String::new, |(by, _)| format!(" {:+.2}", 100.0 * by));
    let percent = format!("±{} %{apart}", 100.0 * case.bound);
    match &case.expected {
        Expected::SameAs { .. } | Expected::Mean(_) => percent,
        Expected::SameBits { .. } => "same bits".to_owned(),
        Expected::Nothing => "black".to_owned(),
    }
}

/// What the verdict `ok` means.
pub const LEGEND: &str = "\
ok: no contribution is not finite, no ray meets the primitive it left or leaves a closed room, the weights of bdpt's paths sum
to 1 within 1e-4, and the image is what it is judged by: ±x %, the 99 % interval of its energy, relative to what is expected,
lies within x % and no test finds a difference (+y: what is compared differs by y % by itself, for the reason that the case
gives); same bits, every pixel is the undisturbed scene's times a power of two; black, nothing is seen.";

/// All rows.
#[derive(Clone, Debug)]
pub struct Report {
    /// In the order in which they were made.
    pub rows: Vec<Row>,
}

impl Report {
    /// How many rows are not as they must be.
    pub fn failures(&self) -> usize {
        self.rows.iter().filter(|row| !row.faults.is_empty()).count()
    }

    /// The report for programs.
    pub fn json(&self) -> Value {
        let row = |row: &Row| {
            json!({
                "case": row.case,
                "what": row.what,
                "integrator": row.integrator,
                "accelerator": row.accelerator,
                "judged_by": row.judged,
                "mean": row.mean,
                "expected": row.expected,
                "energy_low": row.energy.map(|e| e.low),
                "energy_high": row.energy.map(|e| e.high),
                "non_finite": row.rejected,
                "rays": row.rays,
                "self_hits": row.self_hits,
                "leaks": row.leaks,
                "weights": row.weights,
                "faults": row.faults,
            })
        };
        json!({ "failures": self.failures(), "rows": self.rows.iter().map(row).collect::<Vec<Value>>() })
    }

    /// The report as a page of the documents.
    /// `command` is what it was made by.
    pub fn markdown(&self, command: &str) -> String {
        let mut out = format!(
            "# Stress\n\nMade by `{command}`; not to be edited. Each case is a scene at the edge of \
             what numbers can\nhold, with what it must look like; its energy is compared over 16 seeds. *Not finite* counts \
             contributions before the\nfilm's gate, *self-hits* rays that met the primitive they left, *leaks* rays that left a \
             closed room, *Σw − 1*\nhow far the weights of 20 000 random paths are from summing to one at the worst.\n\n{LEGEND}\n\n",
        );
        let _ = writeln!(out, "{} rows, {} not as they must be.\n", self.rows.len(), self.failures());
        out.push_str("| case | what | by | on | judged by | energy, 99 % | not finite | self-hits | leaks | Σw − 1 | verdict |\n");
        out.push_str("|---|---|---|---|---|---|---|---|---|---|---|\n");
        for row in &self.rows {
            let _ = writeln!(out, "| {} |", row.cells().join(" | "));
        }
        out
    }

    /// The report for people.
    pub fn html(&self) -> String {
        let mut out = String::from(concat!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>Twinlight stress</title>\n<style>\n",
            "body { font: 14px sans-serif; margin: 2em } table { border-collapse: collapse }\n",
            "th, td { padding: .2em .7em; text-align: left; border-bottom: 1px solid #ccc }\n",
            "tr.bad { background: #fcc }\n</style>\n<h1>Stress</h1>\n",
        ));
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "<p>{} rows, {} not as they must be.</p>\n<p>{}</p>",
            self.rows.len(),
            self.failures(),
            escaped(LEGEND)
        );
        out.push_str(
            "<table>\n<tr><th>case<th>what<th>by<th>on<th>judged by<th>energy, 99 %<th>not finite<th>self-hits<th>leaks<th>Σw − 1<th>verdict\n",
        );
        for row in &self.rows {
            let class = if row.faults.is_empty() { "" } else { " class=\"bad\"" };
            let _ = writeln!(out, "<tr{class}><td>{}", row.cells().map(|cell| escaped(&cell)).join("<td>"));
        }
        out.push_str("</table>\n");
        out
    }
}

/// Text for HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
