//! The inputs that the fuzzers have kept, each through its target: what once broke something, and what reaches most of the
//! code in few bytes. `scripts/fuzz` looks for more.

#[path = "fuzz/targets/mod.rs"]
mod targets;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use targets::TARGETS;

/// The files of a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    entries.map(|entry| entry.unwrap().path()).collect()
}

#[test]
fn every_kept_input_holds() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus");
    let mut inputs = Vec::new();
    for (name, target) in TARGETS {
        let of_target = files(&corpus.join(name));
        assert!(of_target.len() > 10, "{name}: {} inputs", of_target.len());
        inputs.extend(of_target.into_iter().map(|file| (*target, file)));
    }
    assert_eq!(files(&corpus).len(), TARGETS.len(), "a folder of no target");
    let failed = |(target, file): &(fn(&[u8]), PathBuf)| {
        let bytes = fs::read(file).unwrap();
        catch_unwind(AssertUnwindSafe(|| target(&bytes))).is_err().then(|| file.display().to_string())
    };
    let failed: Vec<String> = inputs.par_iter().filter_map(failed).collect();
    assert!(failed.is_empty(), "{} of {} inputs, see above:\n{}", failed.len(), inputs.len(), failed.join("\n"));
}

/// One input in a program without libFuzzer: `TWINLIGHT_FUZZ=TARGET:FILE`.
#[test]
#[ignore = "for one input by hand"]
fn one() {
    let Some(what) = std::env::var_os("TWINLIGHT_FUZZ") else { return };
    let what = what.into_string().unwrap();
    let (name, file) = what.split_once(':').expect("TARGET:FILE");
    let (_, target) = TARGETS.iter().find(|(n, _)| *n == name).expect("a target");
    target(&fs::read(file).unwrap());
}
