//! `--max-memory`: what is foreseen is what is taken.

use super::Folder;

/// A wavy square of 2·n² triangles on shared vertices, as a binary PLY.
fn grid(n: usize) -> Vec<u8> {
    let side = n + 1;
    let mut bytes = header(side * side, 2 * n * n);
    for i in 0..side * side {
        let (x, y) = ((i / side) as f32 / n as f32, (i % side) as f32 / n as f32);
        for coordinate in [x, y, 0.1 * (40.0 * x).sin() * (23.0 * y).cos()] {
            bytes.extend(coordinate.to_le_bytes());
        }
    }
    for i in 0..n * n {
        let a = i / n * side + i % n;
        triangle(&mut bytes, [a, a + side, a + 1]);
        triangle(&mut bytes, [a + 1, a + side, a + side + 1]);
    }
    bytes
}

/// Small triangles all over a cube that share nothing.
fn soup(triangles: usize) -> Vec<u8> {
    let mut bytes = header(3 * triangles, triangles);
    let mut state = 1u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    for _ in 0..triangles {
        let corner = [random(), random(), random()];
        for _ in 0..3 {
            corner.iter().for_each(|x| bytes.extend((x + 0.01 * random()).to_le_bytes()));
        }
    }
    (0..triangles).for_each(|i| triangle(&mut bytes, [3 * i, 3 * i + 1, 3 * i + 2]));
    bytes
}

fn header(vertices: usize, faces: usize) -> Vec<u8> {
    format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\nproperty float \
         z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes()
}

fn triangle(bytes: &mut Vec<u8>, corners: [usize; 3]) {
    bytes.push(3);
    corners.iter().for_each(|corner| bytes.extend((*corner as i32).to_le_bytes()));
}

/// Renders each mesh on each accelerator, dark and shining, and compares what `info` says with what the system says.
fn foreseen_is_taken(folder: &Folder, meshes: &[(&str, Vec<u8>)]) {
    for (name, bytes) in meshes {
        folder.write("mesh.ply", bytes);
        for material in [r#""type": "lambertian", "albedo": 0.5"#, r#""type": "diffuse light", "emit": 1"#] {
            folder.write(
                "s.json",
                format!(
                    r#"{{"camera": {{"transform": {{"translate": [0.5, 0.5, 2]}}, "resolution": 64}}, "image_samples": 1,
                        "background": 1, "surfaces": [{{"type": "mesh", "filename": "mesh.ply", "material": {{{material}}}}}]}}"#
                ),
            );
            let info: serde_json::Value =
                serde_json::from_str(&folder.ok(&["info", "s.json", "--json"]).stdout).unwrap();
            let peaks = info["memory"]["peak"].as_object().unwrap();
            assert_eq!(peaks.len(), if cfg!(feature = "embree") { 2 } else { 1 });
            for (accel, foreseen) in peaks {
                folder.ok(&["render", "s.json", "-q", "--accel", accel, "--threads", "2", "--stats", "stats.json"]);
                let taken = folder.json("stats.json")["peak_memory_bytes"].as_f64().unwrap();
                let ratio = foreseen.as_f64().unwrap() / taken;
                println!("{name}, {material}, {accel}: {taken:e} bytes, foreseen {ratio:.3} of it");
                assert!((0.75..1.3).contains(&ratio), "{name}, {material}, {accel}: foreseen {ratio} of {taken} bytes");
            }
        }
    }
}

#[test]
fn what_is_foreseen_is_what_is_taken() {
    let folder = Folder::new("memory");
    foreseen_is_taken(&folder, &[("grid", grid(224)), ("soup", soup(100_000))]);
}

#[test]
#[ignore = "deep"]
fn what_is_foreseen_is_what_is_taken_by_a_million_triangles() {
    let folder = Folder::new("memory_deep");
    foreseen_is_taken(&folder, &[("grid", grid(707)), ("soup", soup(1_000_000))]);
}

#[test]
fn what_takes_most_and_what_helps_is_told() {
    let folder = Folder::new("memory_told");
    folder.write("mesh.ply", soup(100_000));
    folder.write(
        "s.json",
        r#"{"camera": {"resolution": 64}, "surfaces": [{"type": "mesh", "filename": "mesh.ply", "material": {"type": "mirror"}}]}"#,
    );
    let refused = |options: &[&str]| {
        let outcome = folder.run(&[&["render", "s.json", "-o", "a.exr"], options].concat());
        assert_eq!(outcome.status, Some(2), "{outcome:?}");
        assert!(!folder.path("a.exr").exists());
        outcome.stderr
    };
    let said = refused(&["--accel", "bvh", "--max-memory", "40M"]);
    let start = "twinlight: the render takes about 53.3 MiB at once (geometry 6.1 MiB, accelerator while it is built 37.2 MiB, the \
                 program itself 10.0 MiB), more than the 40.0 MiB of --max-memory; use ";
    let embree = if cfg!(feature = "embree") { "--accel embree or " } else { "" };
    assert_eq!(said, format!("{start}{embree}a simpler scene or a larger --max-memory\n"));
    // The film is what can be made smaller, where it takes a part.
    let said = refused(&["--accel", "bvh", "--max-memory", "40M", "--size", "512x512"]);
    assert!(said.contains("a smaller --size or a --crop") == said.contains("film"), "{said}");
    let said = refused(&["--accel", "bvh", "--max-memory", "80M", "--size", "1024x1024"]);
    assert!(
        said.contains("film 60.0 MiB") && said.contains("; use a smaller --size or a --crop or a simpler scene"),
        "{said}"
    );
    folder.ok(&["render", "s.json", "-q", "--max-memory", "0.5GiB", "--spp", "1"]);
    folder.ok(&["render", "s.json", "-q", "--max-memory", "100mb", "--spp", "1"]);
    let info = folder.ok(&["info", "s.json"]).stdout;
    assert!(info.contains("53.3 MiB with bvh (geometry 6.1 MiB, textures 0.0 MiB, film 0.2 MiB)\n"), "{info}");
    // A compressed file's own size says nothing; the others count together.
    folder.write(
        "two.json",
        r#"{"camera": {}, "surfaces": [{"type": "mesh", "filename": "mesh.ply", "material": {"type": "mirror"}},
        {"type": "mesh", "filename": "mesh.ply", "material": {"type": "mirror"}}]}"#,
    );
    let outcome = folder.run(&["render", "two.json", "--max-memory", "6M"]);
    let said = "twinlight: two.json:2:38: /surfaces/1/filename: mesh.ply has 4.7 MiB, the meshes before it 4.6 MiB: more than the \
                6.0 MiB of memory allowed; use a simpler mesh or a larger --max-memory\n";
    assert_eq!((outcome.status, outcome.stderr.as_str()), (Some(65), said));
}
