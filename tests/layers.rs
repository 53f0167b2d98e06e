//! The layering: every path in `src` that names another module of the crate, or a part of the standard library that
//! is kept to some modules, obeys ARCHITECTURE.md.
//!
//! The order of the layers is read from the line that ARCHITECTURE.md and `lib.rs` share, so that neither can say
//! anything else than what holds. Test code (`#[cfg(test)]`) may import what it likes, since a test puts scenes
//! together that no layer below `cli` does; the rules about `unsafe` and Embree hold there, too.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// A module imports from those before it; those in braces are peers.
const ORDER: &str = "planted → math, pdf → sampling → geometry → texture → {accel, bsdf, light, camera, film} → scene → integrator → render → {stress, bench} → cli";

/// Modules beside the order, and the only ones they import from. `scene::desc` is counted apart from `scene`: it is
/// plain data, with `sampling`'s own enum for the sampler among it.
const BESIDE: [(&str, &[&str]); 5] = [
    ("scene::desc", &["math", "sampling"]),
    ("decode", &[]),
    ("import", &["math", "scene::desc", "decode"]),
    ("output", &["film", "decode"]),
    ("compare", &["film"]),
];

/// Imports that the order would allow and that are none: BSDFs are plain values, resolved from textures before.
const EXCEPT: [(&str, &str); 1] = [("bsdf", "texture")];

/// What only some modules may name, tests aside.
const KEPT: [(&str, &[&str]); 11] = [
    ("std::env::args", &["cli"]),
    ("std::env::args_os", &["cli"]),
    ("std::env::var", &["cli"]),
    ("std::env::var_os", &["cli", "planted"]), // `planted` for tests alone.
    ("std::io::IsTerminal", &["cli"]),
    ("std::process", &["cli", "main", "output"]), // `output` numbers its temporary files by the process.
    ("std::fs", &["cli", "bench", "decode", "import", "output"]),
    ("std::io", &["cli", "decode", "import", "output"]),
    ("std::time", &["cli", "bench", "render"]),
    ("std::thread", &["cli", "bench", "render"]),
    ("rayon", &["render", "stress"]),
];

/// Printing is for the one module that knows whether anybody is there to read.
const PRINTING: [&str; 5] = ["print", "println", "eprint", "eprintln", "dbg"];

#[derive(Clone, Debug, PartialEq)]
struct Token {
    text: String,
    line: usize,
}

/// The code with comments, strings and characters blanked out, its lines kept.
fn code_only(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let mut out = String::with_capacity(text.len());
    let mut i = 0;
    while i < chars.len() {
        let end = match chars[i] {
            '/' if at(i + 1) == '/' => (i..chars.len()).find(|&j| chars[j] == '\n').unwrap_or(chars.len()),
            '/' if at(i + 1) == '*' => {
                let (mut j, mut depth) = (i + 2, 1);
                while depth > 0 && j < chars.len() {
                    match (chars[j], at(j + 1)) {
                        ('/', '*') => (depth, j) = (depth + 1, j + 2),
                        ('*', '/') => (depth, j) = (depth - 1, j + 2),
                        _ => j += 1,
                    }
                }
                j
            }
            '"' => {
                let hashes = (0..i).rev().take_while(|&j| chars[j] == '#').count();
                let raw = i > hashes && chars[i - hashes - 1] == 'r';
                let mut j = i + 1;
                while j < chars.len() {
                    if raw && chars[j] == '"' && (1..=hashes).all(|k| at(j + k) == '#') {
                        break;
                    }
                    if !raw && chars[j] == '"' {
                        break;
                    }
                    j += if !raw && chars[j] == '\\' { 2 } else { 1 };
                }
                j + 1
            }
            '\'' if at(i + 1) == '\\' => {
                (i + 3..chars.len()).find(|&j| chars[j] == '\'').map_or(chars.len(), |j| j + 1)
            }
            '\'' if at(i + 2) == '\'' => i + 3,
            c => {
                out.push(c);
                i += 1;
                continue;
            }
        };
        let end = end.min(chars.len());
        out.extend(chars[i..end].iter().map(|&c| if c == '\n' { '\n' } else { ' ' }));
        i = end;
    }
    out
}

/// Words, `::` and single characters.
fn tokens(code: &str) -> Vec<Token> {
    let mut out = Vec::new();
    for (n, line) in code.lines().enumerate() {
        let mut rest = line.trim_start();
        while let Some(c) = rest.chars().next() {
            let word = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            let length = match word {
                0 if rest.starts_with("::") => 2,
                0 => c.len_utf8(),
                word => word,
            };
            out.push(Token { text: rest[..length].to_owned(), line: n + 1 });
            rest = rest[length..].trim_start();
        }
    }
    out
}

/// Takes out the items under `#[cfg(test)]`; returns the names of test modules in files of their own.
fn without_tests(tokens: &[Token]) -> (Vec<Token>, Vec<String>) {
    const MARK: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let is = |i: usize, text: &str| tokens.get(i).is_some_and(|t| t.text == text);
    let (mut kept, mut files) = (Vec::new(), Vec::new());
    let mut i = 0;
    while i < tokens.len() {
        if !MARK.iter().enumerate().all(|(k, text)| is(i + k, text)) {
            kept.push(tokens[i].clone());
            i += 1;
            continue;
        }
        i += MARK.len();
        if is(i, "mod") && is(i + 2, ";") {
            files.push(tokens[i + 1].text.clone());
        }
        // The item ends at its first semicolon or after its first block, whichever comes first outside brackets.
        let (import, mut depth) = (is(i, "use"), 0);
        while i < tokens.len() {
            let text = tokens[i].text.as_str();
            i += 1;
            match text {
                "{" | "(" | "[" => depth += 1,
                "}" | ")" | "]" => depth -= 1,
                _ => {}
            }
            if depth == 0 && (text == ";" || text == "}" && !import) {
                break;
            }
        }
    }
    (kept, files)
}

/// Every path that starts with one of `roots`, groups written out, with its line.
fn paths(tokens: &[Token], roots: &[&str]) -> Vec<(Vec<String>, usize)> {
    fn tree(tokens: &[Token], i: &mut usize, mut path: Vec<String>, out: &mut Vec<Vec<String>>) {
        let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
        if text(*i) == "{" {
            *i += 1;
            while !matches!(text(*i), "}" | "") {
                let before = *i;
                tree(tokens, i, path.clone(), out);
                *i += usize::from(*i == before || text(*i) == ",");
            }
            *i += 1;
            return;
        }
        let word = text(*i);
        if word != "*" && !word.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            out.push(path);
            return;
        }
        path.push(word.to_owned());
        *i += 1;
        if text(*i) == "::" {
            *i += 1;
            return tree(tokens, i, path, out);
        }
        if text(*i) == "as" {
            *i += 2;
        }
        out.push(path);
    }
    let mut found = Vec::new();
    for (i, token) in tokens.iter().enumerate() {
        let starts = roots.contains(&token.text.as_str()) && (i == 0 || tokens[i - 1].text != "::");
        if starts && tokens.get(i + 1).is_some_and(|t| t.text == "::") {
            let mut out = Vec::new();
            tree(tokens, &mut i.clone(), Vec::new(), &mut out);
            found.extend(out.into_iter().map(|path| (path, token.line)));
        }
    }
    found
}

/// The module of a file under `src`: `accel/bvh/ray.rs` is `[accel, bvh, ray]`, `lib.rs` the empty path.
fn module_of(file: &str) -> Vec<String> {
    let mut parts: Vec<String> = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
    if matches!(parts.last().map(String::as_str), Some("mod" | "lib")) {
        parts.pop();
    }
    parts
}

/// What the rules call a module: its first name, but for `scene::desc`.
fn room_of(path: &[String]) -> &str {
    match path {
        [a, b, ..] if a == "scene" && b == "desc" => "scene::desc",
        [a, ..] => a,
        [] => "lib",
    }
}

/// For each module, those it may import from.
fn rules() -> BTreeMap<&'static str, BTreeSet<&'static str>> {
    let (mut rules, mut before) = (BTreeMap::new(), BTreeSet::new());
    for layer in ORDER.split(" → ") {
        let peers = layer.strip_prefix('{').and_then(|l| l.strip_suffix('}'));
        let mut now = before.clone();
        for name in peers.unwrap_or(layer).split(", ") {
            rules.insert(name, if peers.is_some() { before.clone() } else { now.clone() });
            now.insert(name);
        }
        before = now;
        if before.contains("scene") {
            before.insert("scene::desc");
        }
    }
    for (name, allowed) in BESIDE {
        rules.insert(name, allowed.iter().copied().collect());
    }
    for (name, other) in EXCEPT {
        rules.get_mut(name).expect("a module").remove(other);
    }
    let everything: Vec<&str> = rules.keys().copied().collect();
    for (name, allowed) in &mut rules {
        match *name {
            "cli" => allowed.extend(&everything),
            "scene" => allowed.extend(["scene::desc"]),
            // It writes scenes as users do, and judges images as `compare` does.
            "stress" => allowed.extend(["import", "compare"]),
            // It builds scenes from their descriptions, judges images, and puts them into its pages.
            "bench" => allowed.extend(["compare", "output"]),
            _ => {}
        }
    }
    rules.insert("main", BTreeSet::from(["cli"]));
    rules.insert("lib", BTreeSet::new());
    rules
}

/// Whether `path` is `prefix` or below it.
fn below(path: &[String], prefix: &str) -> bool {
    let prefix: Vec<&str> = prefix.split("::").collect();
    path.len() >= prefix.len() && path.iter().zip(prefix).all(|(a, b)| a == b)
}

/// What is wrong with a file; `test` says that all of it is test code.
fn violations(file: &str, text: &str, test: bool) -> Vec<String> {
    let all = tokens(&code_only(text));
    let code = if test { Vec::new() } else { without_tests(&all).0 };
    let (module, rules) = (module_of(file), rules());
    let room = room_of(&module);
    let mut out = Vec::new();
    let mut report = |line: usize, what: String| out.push(format!("src/{file}:{line}: {what}"));

    let Some(allowed) = rules.get(room) else {
        return vec![format!("src/{file}:1: module {room} is in no layer: place it in ARCHITECTURE.md and here")];
    };
    for (path, line) in paths(&code, &["crate", "super", "twinlight"]) {
        let ups = path.iter().take_while(|p| *p == "super").count();
        let from_root = if ups > 0 { &module[..module.len().saturating_sub(ups)] } else { &[] };
        let named = &path[if ups > 0 { ups } else { 1 }..];
        let target: Vec<String> = from_root.iter().chain(named).cloned().collect();
        let to = room_of(&target);
        if to != room && !allowed.contains(to) {
            report(line, format!("{room} imports from {to} ({})", path.join("::")));
        }
    }
    for (path, line) in paths(&code, &["std", "rayon"]) {
        for (kept, rooms) in KEPT {
            if below(&path, kept) && !rooms.contains(&room) {
                report(line, format!("{room} names {kept}, which is for {}", rooms.join(", ")));
            }
        }
    }
    for pair in code.windows(2) {
        if PRINTING.contains(&pair[0].text.as_str()) && pair[1].text == "!" && room != "cli" {
            report(pair[0].line, format!("{room} prints ({}!)", pair[0].text));
        }
    }
    let embree = below(&module, "accel::embree");
    for token in &all {
        let for_embree = matches!(token.text.as_str(), "unsafe" | "embree4_sys");
        if for_embree && !embree || token.text == "unsafe_code" && file != "lib.rs" {
            report(token.line, format!("{} is for accel/embree alone", token.text));
        }
    }
    out
}

/// All files under `src` with their texts.
fn sources() -> BTreeMap<String, String> {
    fn walk(folder: &Path, root: &Path, out: &mut BTreeMap<String, String>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path: PathBuf = entry.unwrap().path();
            if path.is_dir() {
                walk(&path, root, out);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
                out.insert(name, fs::read_to_string(&path).unwrap());
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut out = BTreeMap::new();
    walk(&root, &root, &mut out);
    out
}

/// Files that are test code as a whole: those that a `#[cfg(test)] mod name;` names, and what is below them.
fn test_files(sources: &BTreeMap<String, String>) -> BTreeSet<&str> {
    let mut modules = Vec::new();
    for (file, text) in sources {
        for name in without_tests(&tokens(&code_only(text))).1 {
            modules.push([module_of(file), vec![name]].concat());
        }
    }
    let is_test = |file: &str| modules.iter().any(|m| module_of(file).starts_with(m));
    sources.keys().map(String::as_str).filter(|file| is_test(file)).collect()
}

#[test]
fn every_module_imports_from_those_before_it_only() {
    let sources = sources();
    let tests = test_files(&sources);
    assert!(sources.len() > 50 && tests.contains("output/tests.rs"), "{} files, tests: {tests:?}", sources.len());
    let found: Vec<String> =
        sources.iter().flat_map(|(file, text)| violations(file, text, tests.contains(file.as_str()))).collect();
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

/// Paths are found at all: a parser that sees nothing would find no fault.
#[test]
fn the_imports_are_seen() {
    let sources = sources();
    let seen = |file: &str, target: &str| {
        let code = tokens(&code_only(&sources[file]));
        paths(&code, &["crate", "std", "rayon"]).iter().any(|(path, _)| path.join("::") == target)
    };
    for (file, target) in [
        ("render/mod.rs", "crate::film::Accumulator"),
        ("render/mod.rs", "std::time::Instant"),
        ("integrator/path.rs", "crate::scene::desc::Heuristic"),
        ("cli/progress.rs", "std::io::IsTerminal"),
        ("scene/desc.rs", "crate::sampling::SamplerKind"),
        ("import/mod.rs", "std::fs"),
    ] {
        assert!(seen(file, target), "{file} no longer names {target}, or the reader of this test is blind");
    }
}

#[test]
fn the_documents_state_the_order_that_is_checked() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for file in ["ARCHITECTURE.md", "src/lib.rs"] {
        let text = fs::read_to_string(root.join(file)).unwrap();
        assert!(text.contains(ORDER), "{file} does not hold the line `{ORDER}`");
    }
    let lib = fs::read_to_string(root.join("src/lib.rs")).unwrap();
    let lines: Vec<&str> = lib.lines().map(str::trim).collect();
    let declared: Vec<&str> = lines.iter().filter_map(|l| l.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
    assert!(declared.len() >= 16 && declared.iter().all(|m| rules().contains_key(m)), "{declared:?}");
    // The one exemption from `unsafe_code = "deny"`, on the line before `accel`.
    let exempt: Vec<usize> = (0..lines.len()).filter(|&i| lines[i].contains("unsafe_code")).collect();
    assert_eq!(exempt.len(), 1, "lib.rs speaks of unsafe_code other than once");
    assert!(lines[exempt[0]].starts_with("#[allow(unsafe_code)]") && lines[exempt[0] + 1] == "pub mod accel;");
}

#[test]
fn planted_violations_are_caught() {
    for (file, text, expected) in [
        ("math/ray.rs", "use crate::pdf::Pmf;", "math imports from pdf"),
        ("geometry/mod.rs", "use crate::{math::Vec3, accel::{self, Accel}};", "geometry imports from accel"),
        ("bsdf/mod.rs", "use crate::light::Light;", "bsdf imports from light"),
        ("bsdf/mod.rs", "use crate::texture::Texture;", "bsdf imports from texture"),
        ("texture/mod.rs", "use crate::scene::desc::Param;", "texture imports from scene::desc"),
        ("decode/mod.rs", "use crate::film::Image;", "decode imports from film"),
        ("import/textures.rs", "use crate::texture::Texture;", "import imports from texture"),
        ("light/area.rs", "\n\nfn f() { super::super::bsdf::f() }", ":3: light imports from bsdf"),
        ("camera/mod.rs", "use super::film::Image;", "camera imports from film"),
        ("film/image.rs", "fn f(c: &crate::camera::Camera) {}", "film imports from camera"),
        ("accel/mod.rs", "pub(in crate::scene) use crate::math::Ray;", "accel imports from scene"),
        ("scene/mod.rs", "use crate::integrator::Settings as S;", "scene imports from integrator"),
        ("scene/desc.rs", "use super::prepare;", "scene::desc imports from scene"),
        ("scene/desc.rs", "use crate::geometry::Geometry;", "scene::desc imports from geometry"),
        (
            "import/mod.rs",
            "use crate::scene::{desc::SceneDesc, Scene};",
            "import imports from scene (crate::scene::Scene)",
        ),
        ("import/value.rs", "use crate::sampling::SamplerKind;", "import imports from sampling"),
        ("output/exr.rs", "use crate::math::Rgb;", "output imports from math"),
        ("compare/mod.rs", "use crate::output;", "compare imports from output"),
        ("integrator/path.rs", "use crate::render::RenderJob;", "integrator imports from render"),
        ("render/mod.rs", "use crate::cli;", "render imports from cli"),
        ("render/mod.rs", "use crate::bench::Plan;", "render imports from bench"),
        ("bench/run.rs", "use crate::cli::stats;", "bench imports from cli"),
        ("bench/run.rs", "use crate::stress::Case;", "bench imports from stress"),
        ("stress/mod.rs", "use crate::bench::Plan;", "stress imports from bench"),
        ("pdf.rs", "use super::*;", "pdf imports from *"),
        ("main.rs", "fn main() { twinlight::render::render() }", "main imports from render"),
        ("extra.rs", "", "module extra is in no layer"),
        ("integrator/light.rs", "use std::{fmt, time::Instant};", "integrator names std::time"),
        ("integrator/light.rs", "fn f() { std::thread::yield_now() }", "integrator names std::thread"),
        ("integrator/bdpt/mod.rs", "use std::fs::File;", "integrator names std::fs"),
        ("scene/prepare.rs", "use std::fs;", "scene names std::fs"),
        ("import/mod.rs", "fn f() { std::env::args(); }", "import names std::env::args"),
        ("output/mod.rs", "use std::io::{self, IsTerminal};", "output names std::io::IsTerminal"),
        ("film/mod.rs", "use rayon::prelude::*;", "film names rayon"),
        ("scene/mod.rs", "fn f() { eprintln!(\"x\") }", "scene prints (eprintln!)"),
        ("accel/bvh/mod.rs", "use embree4_sys as sys;", "embree4_sys is for accel/embree alone"),
        ("accel/bvh/mod.rs", "fn f() { unsafe { g() } }", "unsafe is for accel/embree alone"),
        ("accel/bvh/mod.rs", "#[cfg(test)]\nmod tests { fn f() { unsafe { g() } } }", ":2: unsafe is for"),
        ("film/mod.rs", "#![allow(unsafe_code)]", "unsafe_code is for accel/embree alone"),
        (
            "math/mod.rs",
            "#[cfg(test)]\nuse crate::{cli, scene};\nuse crate::film::Image;",
            ":3: math imports from film",
        ),
        ("math/mod.rs", "#[cfg(test)]\nmod t { fn f() {} }\nuse crate::film::Image;", ":3: math imports from film"),
        ("math/mod.rs", "const A: &str = \"\\\"\"; const B: char = '\"'; use crate::film;", "math imports from film"),
    ] {
        let found = violations(file, text, false);
        assert!(found.iter().any(|v| v.contains(expected)), "{file}: {text}\nexpected `{expected}`, found {found:?}");
    }
}

#[test]
fn what_is_allowed_is_not_reported() {
    for (file, text) in [
        ("light/area.rs", "use crate::{geometry::Geometry, math::{Rgb, Vec3}, pdf::AreaPdf, sampling::warp};"),
        ("scene/prepare.rs", "use super::{Surface, desc::SceneDesc}; use crate::{accel::Accel, film::Image};"),
        ("integrator/bdpt/mod.rs", "use super::Recorder; pub(crate) fn f() {} pub(super) fn g() {}"),
        ("render/mod.rs", "use rayon::prelude::*; use std::time::Instant; use crate::film::Accumulator;"),
        (
            "math/mod.rs",
            "// use crate::cli;\n/* unsafe /* nested */ crate::cli */ const A: &str = r#\"crate::cli \" unsafe\"#;",
        ),
        (
            "math/mod.rs",
            "#[cfg(test)]\nmod tests {\n use crate::cli;\n fn f<'a>(_: &'a str) { println!(\"{}\", '\\'') }\n}",
        ),
        ("accel/embree/scene.rs", "use embree4_sys as sys; fn f() { unsafe { g() } }"),
        ("accel/embree/device.rs", "fn f() -> &'static str { std::env::consts::ARCH }"),
        ("bench/run.rs", "use std::time::Instant; use crate::{compare::metrics, output::encode_png, render::render};"),
        ("cli/mod.rs", "use std::io::IsTerminal; use crate::{import, render, compare}; fn f() { eprintln!(\"\") }"),
    ] {
        assert_eq!(violations(file, text, false), Vec::<String>::new(), "{file}: {text}");
    }
    assert!(violations("output/tests.rs", "use std::time::Instant; use crate::cli;", true).is_empty());
}
