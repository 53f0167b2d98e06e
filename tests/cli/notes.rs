//! What is told of a scene that is rendered all the same: the last table behind `docs/ERRORS.md`.

use super::Folder;
use super::mistakes::marked;

/// A scene that is rendered, with what is told of it.
pub struct Note {
    /// In words.
    pub what: &'static str,
    /// The scene's text; `«` marks the places that messages name with `@`, in their order but for the camera's.
    pub text: &'static str,
    /// Arguments after `twinlight render scene.json`.
    pub arguments: &'static str,
    /// The lines `note: …` and `warning: …`; `@` stands for `scene.json:LINE:COLUMN`.
    pub messages: &'static [&'static str],
    /// Whether the image is black.
    pub black: bool,
}

const BLACK: Note = Note { what: "", text: "", arguments: "", messages: &[], black: true };
const LIT: Note = Note { black: false, ..BLACK };

/// All of them end with status 0 and an image.
pub const NOTES: &[Note] = &[
    Note {
        what: "No light at all",
        text: r#"{"camera": «{"resolution": 8}, "surfaces": [{"type": "quad", "material": {"type": "mirror"}}]}"#,
        messages: &["warning: @: /camera: nothing in the scene shines: the image will be black"],
        ..BLACK
    },
    Note {
        what: "A lamp without area",
        text: "{\"camera\": «{\"resolution\": 8},\n  \"surfaces\": [««{\"type\": \"triangle\", \"positions\": [[0, 0, 0], [1, 0, 0], \
               [2, 0, 0]],\n    \"material\": {\"type\": \"diffuse light\", \"emit\": 1}}]}",
        messages: &[
            "warning: @: /surfaces/0: 1 triangle without area dropped, of 1",
            "warning: @: /surfaces/0: the light has no area: it emits nothing",
            "warning: @: /camera: nothing in the scene shines: the image will be black",
        ],
        ..BLACK
    },
    Note {
        what: "A light without power",
        text: "{\"camera\": «{\"resolution\": 8}, \"lights\": [«{\"type\": \"point\", \"position\": 0, \"intensity\": 0},\n  \
               «{\"type\": \"directional\", \"direction\": 1, \"irradiance\": 0}]}",
        messages: &[
            "warning: @: /lights/0: the light emits no power: it is left out",
            "warning: @: /lights/1: the light emits no power: it is left out",
            "warning: @: /camera: nothing in the scene shines: the image will be black",
        ],
        ..BLACK
    },
    Note {
        what: "A sky of black texels (`black.exr` is all zero)",
        text: r#"{"camera": «{"resolution": 8}, "background": «{"type": "image", "filename": "black.exr"}}"#,
        messages: &[
            "warning: @: /background: the image is all black: the light emits no power and is left out",
            "warning: @: /camera: nothing in the scene shines: the image will be black",
        ],
        ..BLACK
    },
    Note {
        what: "Triangles without area",
        text: "{\"camera\": {\"resolution\": 8}, \"background\": 1, \"surfaces\": [\n  «{\"type\": \"mesh\", \"material\": {\"type\": \
               \"mirror\"}, \"positions\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],\n   \"indices\": [[0, 1, 2], [0, 1, 1], [2, 2, \
               2]]}]}",
        messages: &["warning: @: /surfaces/0: 2 triangles without area dropped, of 3"],
        ..LIT
    },
    Note {
        what: "A lamp that is there twice",
        text: "{\"camera\": {\"resolution\": 8, \"transform\": {\"translate\": [0, 0, 3]}}, \"surfaces\": [{\"type\": \"sphere\", \"material\": {\"type\": \"diffuse light\", \
               \"emit\": 1}},\n  «{\"type\": \"sphere\", \"material\": {\"type\": \"diffuse light\", \"emit\": 1}}]}",
        messages: &["warning: @: /surfaces/1: this light is exactly where another one is: it is left out"],
        ..LIT
    },
    Note {
        what: "A lamp of which a triangle is there twice",
        text: "{\"camera\": {\"resolution\": 8, \"transform\": {\"translate\": [0, 0, 3]}}, \"surfaces\": [\n  «{\"type\": \"mesh\", \
               \"material\": {\"type\": \"diffuse light\", \"emit\": 1}, \"positions\": [[0, 0, 0], [1, 0, 0], [0, 1, 0]],\n   \
               \"indices\": [[0, 1, 2], [1, 2, 0]]}]}",
        messages: &["warning: @: /surfaces/0: 1 triangle of a light, of 2, exactly where others are: left out"],
        ..LIT
    },
    Note {
        what: "A checker that does not vary across its surface",
        text: "{\"camera\": {\"resolution\": 8, \"transform\": {\"translate\": [0, 0, 1]}}, \"background\": 1, \"surfaces\": [\n  \
               «{\"type\": \"quad\", \"size\": 9, \"material\": {\"type\": \"lambertian\",\n   \"albedo\": {\"type\": \"checker\", \
               \"even\": 0.8, \"odd\": 0.2, \"scale\": [1, 1, 0]}}}]}",
        messages: &[
            "warning: @: /surfaces/0: the scale of its checker along z is 0, where a sine is zero everywhere: all of the \
             surface is \"even\"; give the checker another scale along z",
        ],
        ..LIT
    },
    Note {
        what: "A checker in one of its own planes",
        text: "{\"camera\": {\"resolution\": 8, \"transform\": {\"translate\": [0, 0, 1]}}, \"background\": 1, \"surfaces\": [\n  \
               «{\"type\": \"quad\", \"size\": 9, \"material\": {\"type\": \"lambertian\",\n   \"albedo\": {\"type\": \"checker\", \
               \"even\": 0.8, \"odd\": 0.2}}}]}",
        messages: &[
            "warning: @: /surfaces/0: the surface lies in the plane z = 0, where a sine of its checker is zero: all of it is \
             \"even\"; move it along z, by half a cell (π/2 over the checker's scale) say",
        ],
        ..LIT
    },
    Note {
        what: "What is read and ignored, or read as something else",
        text: "{\"camera\": {\"resolution\": 8}, \"background\": 1, \"accelerator\": «{\"type\": \"bvh\"}, \"media\": «[{}],\n  \
               \"integrator\": «\"path_tracer_mis\", \"image_samples\": «4, \"sampler\": {\"type\": «\"halton\", \"samples\": 1}}",
        messages: &[
            "note: @: /accelerator: the accelerator is ignored: it is chosen on the command line",
            "note: @: /media: the media are ignored: nothing may use them (participating media are not supported)",
            "note: @: /integrator: the integrator \"path_tracer_mis\" is read as \"path\"",
            "note: @: /image_samples: image_samples 4 is overruled by the sampler's samples",
            "note: @: /sampler/type: the sampler \"halton\" is read as \"sobol\"",
        ],
        ..LIT
    },
    Note {
        what: "Caustics that are not found",
        text: CAUSTICS,
        messages: &[
            "note: caustics of point, spot and directional lights are missing where they are seen in mirrors or through smooth \
             glass",
        ],
        ..LIT
    },
    Note {
        what: "Caustics that are not found without light subpaths",
        text: CAUSTICS,
        arguments: "--integrator path",
        messages: &[
            "note: caustics of point, spot and directional lights are missing: only light subpaths find them; use bdpt, which \
             finds those that are not seen in mirrors or through smooth glass",
        ],
        ..LIT
    },
    Note {
        what: "What a light tracer does not find",
        text: "{\"camera\": {\"resolution\": 8, \"transform\": {\"translate\": [0, 0, 2]}}, \"background\": 1, \"surfaces\": [{\"type\": \
               \"sphere\", \"material\": {\"type\": \"mirror\"}},\n  {\"type\": \"quad\", \"size\": 9, \"material\": {\"type\": \"lambertian\", \
               \"albedo\": 0.5}},\n  {\"type\": \"disk\", \"material\": {\"type\": \"null\"}}]}",
        arguments: "--integrator light",
        messages: &[
            "note: what is seen in mirrors or through smooth glass is missing: light subpaths cannot be joined to the camera \
             there; use bdpt",
            "note: what is seen through windows (`null`) is missing: they block connections to the camera; use bdpt",
            "note: the sky itself is missing: the light integrator finds only what it lights; use bdpt",
        ],
        ..LIT
    },
    Note {
        what: "Options of weights where there are none",
        text: r#"{"camera": {"resolution": 8}, "lights": [{"type": "point", "position": 0, "intensity": 1}]}"#,
        arguments: "--integrator light --heuristic balance",
        messages: &[
            "note: --heuristic changes nothing: the light integrator has one technique for each path, whose weight is 1",
        ],
        ..BLACK
    },
    Note {
        what: "Roulette that never begins",
        text: r#"{"camera": {"resolution": 8}, "background": 1, "integrator": {"russian_roulette": false}}"#,
        arguments: "--roulette-after 2",
        messages: &["note: --roulette-after changes nothing: the scene turns roulette off"],
        ..LIT
    },
    Note {
        what: "A pyramid of paths that are too long",
        text: r#"{"camera": {"resolution": 8}, "background": 1, "integrator": {"max_bounces": 1}}"#,
        arguments: "--pyramid stages --pyramid-edges 4",
        messages: &["note: --pyramid-edges 4 is more than paths can have: max_bounces 1 ends them at 2"],
        ..LIT
    },
    Note {
        what: "A technique that finds nothing",
        text: r#"{"camera": {"resolution": 8}, "lights": [{"type": "point", "position": 0, "intensity": 1}]}"#,
        arguments: "--technique 0,2",
        messages: &[
            "note: --technique 0,2: the image will be black: paths can hit no light by chance: all are point, spot or \
             directional lights",
        ],
        ..BLACK
    },
    Note {
        what: "The variance of one sample",
        text: r#"{"camera": {"resolution": 8}, "background": 1}"#,
        arguments: "--spp 1 --aovs variance",
        messages: &[
            "note: the variance of one sample per pixel cannot be told and is written as 0; use --spp 2 or more",
        ],
        ..LIT
    },
];

const CAUSTICS: &str = "{\"camera\": {\"resolution\": 8, \"transform\": {\"translate\": [0, 0, 4]}}, \"lights\": [{\"type\": \"point\", \"position\": [0, 0, 3], \
     \"intensity\": 9}],\n  \"surfaces\": [{\"type\": \"sphere\", \"material\": {\"type\": \"mirror\"}},\n    {\"type\": \"quad\", \"size\": 9, \
     \"material\": {\"type\": \"lambertian\", \"albedo\": 0.5}}]}";

impl Note {
    /// The text as the program reads it, and the lines that it must say.
    pub fn unmarked(&self) -> (String, String) {
        let (text, mut places) = marked(self.text);
        // What is told of the camera comes last, though the camera may stand first.
        if self.messages.last().is_some_and(|m| m.contains("@: /camera")) {
            places.rotate_left(1);
        }
        let mut places = places.into_iter();
        let mut said = String::new();
        for message in self.messages {
            let place = if message.contains('@') { places.next() } else { None };
            let place = place.map(|(line, column)| format!("scene.json:{line}:{column}"));
            said += &message.replace('@', &place.unwrap_or_default());
            said.push('\n');
        }
        assert_eq!(places.next(), None, "{}: marks and messages differ in number", self.what);
        (text, said)
    }
}

#[test]
fn what_is_no_error_is_told_and_rendered() {
    let folder = Folder::new("notes");
    twinlight::output::write_exr(
        &folder.path("black.exr"),
        &twinlight::film::Image::new(2, 1),
        &twinlight::output::Metadata::default(),
    )
    .unwrap();
    for note in NOTES {
        let (text, said) = note.unmarked();
        folder.write("scene.json", text);
        let arguments = note.arguments.split(' ').filter(|a| !a.is_empty());
        let args: Vec<&str> = ["render", "scene.json"].into_iter().chain(arguments).collect();
        let outcome = folder.ok(&args);
        let told = |line: &&str| line.starts_with("note: ") || line.starts_with("warning: ");
        let lines: String = outcome.stderr.lines().filter(told).flat_map(|line| [line, "\n"]).collect();
        assert_eq!(lines, said, "{}", note.what);
        let image = folder.image("scene.exr");
        assert_eq!(image.rgb.iter().flatten().all(|v| *v == 0.0), note.black, "{}", note.what);
        // Not where nothing but errors is to be told; and `info` tells what is the scene's own.
        assert_eq!(folder.ok(&[&args[..], &["--quiet"]].concat()).stderr, "", "{}", note.what);
        if note.arguments.is_empty() {
            let info = folder.ok(&["info", "scene.json"]).stdout;
            for line in said.lines().filter_map(|line| line.split_once(": ")) {
                assert!(info.contains(&format!("  note: {}\n", line.1)), "{}: {info}", note.what);
            }
        }
    }
}
