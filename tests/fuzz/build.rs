//! Passes on what the final link needs for the Embree that `embree4-sys` found, as the renderer's own build script does.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    for arg in std::env::var("DEP_EMBREE4_LINK_ARGS").unwrap_or_default().split(';').filter(|a| !a.is_empty()) {
        println!("cargo::rustc-link-arg={arg}");
    }
}
