//! What came of it: a table to read, and the same as JSON and HTML.

use std::fmt::Write;

use serde_json::{Value, json};

use super::Case;
use super::measure::Audit;
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
    fn cells(&self) -> [String; 10] {
        [
            self.case.clone(),
            self.what.to_owned(),
            self.integrator.to_owned(),
            self.accelerator.to_owned(),
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
            "{:<26} {:<6} {:<7} {:>22} {:>4} {:>4} {:>4} {:>8}  {}",
            self.case,
            self.integrator,
            self.accelerator,
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
    "case                       by     on                      energy  n/f self leak     Σw−1  verdict";

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
    pub fn markdown(&self) -> String {
        let mut out = String::from(
            "# Stress\n\nMade by `twinlight stress --full -o docs/STRESS.md`; not to be edited. Each case is a scene at the edge of \
             what numbers can\nhold, with what it must look like; its energy is compared over 16 seeds. *Not finite* counts \
             contributions before the\nfilm's gate, *self-hits* rays that met the primitive they left, *leaks* rays that left a \
             closed room, *Σw − 1*\nhow far the weights of 20 000 random paths are from summing to one at the worst.\n\n",
        );
        let _ = writeln!(out, "{} rows, {} not as they must be.\n", self.rows.len(), self.failures());
        out.push_str("| case | what | by | on | energy, 99 % | not finite | self-hits | leaks | Σw − 1 | verdict |\n");
        out.push_str("|---|---|---|---|---|---|---|---|---|---|\n");
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
        let _ = writeln!(out, "<p>{} rows, {} not as they must be.</p>", self.rows.len(), self.failures());
        out.push_str(
            "<table>\n<tr><th>case<th>what<th>by<th>on<th>energy, 99 %<th>not finite<th>self-hits<th>leaks<th>Σw − 1<th>verdict\n",
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
