//! Passes on what the final link needs for the Embree that `embree4-sys` found, and the commit this is built from.

use std::env;
use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if env::var_os("CARGO_FEATURE_EMBREE").is_some() {
        // Run path and loader are properties of programs, so a library cannot set them for its dependents.
        for arg in env::var("DEP_EMBREE4_LINK_ARGS").unwrap_or_default().split(';').filter(|a| !a.is_empty()) {
            println!("cargo::rustc-link-arg={arg}");
        }
    }
    println!("cargo::rustc-env=TWINLIGHT_GIT_HASH={}", git_hash().unwrap_or_else(|| "unknown".to_owned()));
}

/// The commit's abbreviated hash; `None` outside a git working copy of this project, or without git.
fn git_hash() -> Option<String> {
    let root = env::var("CARGO_MANIFEST_DIR").ok()?;
    // A source archive unpacked inside another project's working copy is not at that project's commit.
    if !Path::new(&root).join(".git").exists() {
        return None;
    }
    let git = |args: &[&str]| {
        let output = Command::new("git").arg("-C").arg(&root).args(args).output().ok()?;
        let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
        (output.status.success() && !text.is_empty()).then_some(text)
    };
    // HEAD names a branch; the reflog grows with every commit and checkout, wherever the branch's own file is.
    for file in ["HEAD", "logs/HEAD"] {
        let path = git(&["rev-parse", "--git-path", file])?;
        let path = Path::new(&root).join(path);
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    git(&["rev-parse", "--short=12", "HEAD"])
}
