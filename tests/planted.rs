//! The planted bugs (`src/planted.rs`): the page of what they turn red names each of them, and no program that was built
//! as users build it makes any.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use twinlight::planted::{Bug, VARIABLE};

/// `docs/PLANTED.md` is made by `scripts/test-planted`, which takes long; this takes no time and tells that it is due.
#[test]
fn the_page_of_planted_bugs_names_each_and_what_found_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/PLANTED.md");
    let page = fs::read_to_string(&path).expect("docs/PLANTED.md");
    let rows: Vec<Vec<&str>> = page
        .lines()
        .filter(|line| line.starts_with("| `"))
        .map(|line| line.trim_matches('|').split(" | ").map(str::trim).collect())
        .collect();
    let told: Vec<(&str, &str)> = rows.iter().map(|row| (row[0].trim_matches('`'), row[1])).collect();
    let bugs: Vec<(&str, &str)> = Bug::ALL.iter().map(|bug| (bug.name(), bug.what())).collect();
    assert_eq!(told, bugs, "docs/PLANTED.md is stale: scripts/test-planted");
    for row in rows {
        assert!(row[2].parse::<u32>().is_ok_and(|red| red > 0) && !row[3].is_empty(), "nothing turns red: {row:?}");
    }
}

/// The files of Rust below a folder, as paths relative to it.
fn sources(root: &Path, folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(root.join(folder)).expect("a folder of sources");
    let paths = entries.map(|entry| folder.join(entry.expect("an entry").file_name()));
    let below = |path: std::path::PathBuf| match root.join(&path).is_dir() {
        true => sources(root, &path),
        false => path.to_str().filter(|p| p.ends_with(".rs")).map(str::to_owned).into_iter().collect(),
    };
    paths.flat_map(below).collect()
}

/// The tests of a file, as they are named on the page, with the number of folders that a test program's own modules lie in.
fn tests_of(root: &Path, file: &str, folders: usize) -> Vec<String> {
    let text = fs::read_to_string(root.join(file)).expect("a source");
    let mut parts: Vec<&str> = file.trim_end_matches(".rs").split('/').skip(folders).collect();
    parts.retain(|part| *part != "mod");
    let mut tests = Vec::new();
    let (mut in_tests, mut marked) = (false, false);
    for line in text.lines() {
        in_tests |= line.trim() == "mod tests {";
        marked |= line.trim() == "#[test]";
        if let (true, Some(name)) = (marked, line.trim().strip_prefix("fn ")) {
            let name = name.split('(').next().expect("a name");
            let modules = parts.iter().copied().chain(in_tests.then_some("tests"));
            tests.push(modules.chain([name]).collect::<Vec<&str>>().join("::"));
            marked = false;
        }
    }
    tests
}

/// What the page names is there to be run.
#[test]
fn the_tests_that_the_page_names_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let of_library = sources(root, Path::new("src")).into_iter().map(|file| (file, 1));
    let of_programs = sources(root, Path::new("tests")).into_iter().map(|file| (file, 2));
    let tests: Vec<String> = of_library.chain(of_programs).flat_map(|(file, n)| tests_of(root, &file, n)).collect();
    assert!(tests.len() > 200, "{}", tests.len());
    let page = fs::read_to_string(root.join("docs/PLANTED.md")).expect("docs/PLANTED.md");
    let mut named = 0;
    for row in page.lines().filter(|line| line.starts_with("| `")) {
        let last = row.trim_matches('|').split(" | ").last().expect("a column");
        for name in last.split('`').skip(1).step_by(2) {
            assert!(tests.iter().any(|test| test == name), "docs/PLANTED.md names {name}, which is no test: {row}");
            named += 1;
        }
    }
    assert!(named > 100, "{named}");
}

/// A floor under a lamp and a point light.
const SCENE: &str = r#"{
  "camera": {"transform": {"from": [0, 1, 3], "at": [0, 0, 0]}, "vfov": 40, "resolution": [8, 6]},
  "integrator": {"type": "bdpt", "max_bounces": 3},
  "sampler": {"type": "sobol", "samples": 2, "seed": 3},
  "surfaces": [
    {"type": "quad", "size": 3, "transform": {"rotate": [-90, 1, 0, 0]}, "material": {"type": "lambertian", "albedo": 0.5}},
    {"type": "quad", "size": 0.5, "transform": [{"rotate": [90, 1, 0, 0]}, {"translate": [0, 0.8, 0]}],
     "material": {"type": "lambertian", "albedo": 0.5, "emit": 3}}
  ],
  "lights": [{"type": "point", "position": [0.5, 0.7, 0.2], "intensity": 1}]
}"#;

/// Renders the scene with a bug chosen by its name; the image is `name.exr`.
fn render(folder: &Path, name: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_twinlight"))
        .args(["render", "scene.json", "--quiet", "-o", &format!("{name}.exr")])
        .current_dir(folder)
        .env(VARIABLE, name)
        .output()
        .expect("the program runs")
}

fn folder() -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("planted");
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("scene.json"), SCENE).unwrap();
    folder
}

/// Without the feature the variable is nobody's, whatever it says.
#[cfg(not(feature = "planted-bugs"))]
#[test]
fn a_program_without_the_feature_plants_nothing() {
    let folder = folder();
    let image = |name: &str| {
        let output = render(&folder, name);
        assert!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        fs::read(folder.join(format!("{name}.exr"))).unwrap()
    };
    let plain = image("no-such-bug");
    for bug in Bug::ALL {
        assert!(image(bug.name()) == plain, "{} changes the image", bug.name());
    }
}

/// With it a bug is made, and a name that is none is not taken for "no bug".
#[cfg(feature = "planted-bugs")]
#[test]
fn a_program_with_the_feature_plants_what_is_named() {
    let folder = folder();
    assert!(render(&folder, Bug::LightChoiceOfOneMore.name()).status.success());
    assert!(render(&folder, Bug::NoLightTracing.name()).status.success());
    let image = |bug: Bug| fs::read(folder.join(format!("{}.exr", bug.name()))).unwrap();
    assert!(image(Bug::LightChoiceOfOneMore) != image(Bug::NoLightTracing), "the same image under two bugs");
    let refused = render(&folder, "no-such-bug");
    assert!(!refused.status.success() && String::from_utf8_lossy(&refused.stderr).contains("names no bug"));
}
