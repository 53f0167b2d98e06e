//! libFuzzer's entry to `targets::scene_json`.
#![no_main]

mod hook;
#[path = "../targets/mod.rs"]
mod targets;

libfuzzer_sys::fuzz_target!(init: hook::set(), |bytes: &[u8]| targets::scene_json(bytes));
