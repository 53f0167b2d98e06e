//! What users get wrong on the command line, and what they are told: tables behind `docs/ERRORS.md`.

/// A command line with a mistake in it.
pub struct Arguments {
    /// In words.
    pub what: &'static str,
    /// What follows `twinlight render`, or in `COMMANDS` `twinlight` alone, separated by spaces.
    pub arguments: &'static str,
    /// The exit status.
    pub status: i32,
    /// The first paragraph of what is said.
    pub message: &'static str,
}

/// What is wrong with the command line itself. `scene.json` is right.
pub const ARGUMENTS: &[Arguments] = &[
    Arguments {
        what: "A scene that is not there",
        arguments: "none.json",
        status: 1,
        message: "twinlight: none.json: cannot read the scene file: No such file or directory (os error 2); check the name and \
                  the permissions",
    },
    Arguments {
        what: "A folder for a scene",
        arguments: "folder.exr",
        status: 1,
        message: "twinlight: folder.exr: cannot read the scene file: this is a folder; give the scene file inside (no .json \
                  file is there)",
    },
    Arguments {
        what: "The folder of the scene",
        arguments: ".",
        status: 1,
        message: "twinlight: .: cannot read the scene file: this is a folder; give the scene file inside (found: large.json, \
                  latin1.json, old.json, scene.json, utf16.json)",
    },
    Arguments {
        what: "An image for a scene",
        arguments: "image.png",
        status: 65,
        message: "twinlight: image.png: this is an image (PNG), not a scene; did you mean `twinlight compare` or `twinlight \
                  convert`?",
    },
    Arguments {
        what: "Anything else for a scene",
        arguments: "binary",
        status: 65,
        message: "twinlight: binary: this is a binary file, not a scene; a scene is JSON text",
    },
    Arguments {
        what: "A scene in UTF-16",
        arguments: "utf16.json",
        status: 65,
        message: "twinlight: utf16.json:1:1: the file is UTF-16; a scene must be UTF-8 text: save it as UTF-8 without a byte \
                  order mark",
    },
    Arguments {
        what: "A scene in Latin-1",
        arguments: "latin1.json",
        status: 65,
        message: "twinlight: latin1.json:1:3: byte 0xe9 is not UTF-8; a scene must be UTF-8 text",
    },
    Arguments {
        what: "No scene",
        arguments: "--spp 4",
        status: 2,
        message: "error: the following required arguments were not provided:\n  <SCENE>",
    },
    Arguments {
        what: "An unknown option",
        arguments: "scene.json --sp 4",
        status: 2,
        message: "error: unexpected argument '--sp' found",
    },
    Arguments {
        what: "No samples",
        arguments: "scene.json --spp 0",
        status: 2,
        message: "error: invalid value '0' for '--spp <N>': write it as a whole number, 1 or more (at most 4294967295)",
    },
    Arguments {
        what: "A size of zero",
        arguments: "scene.json --size 0x64",
        status: 2,
        message: "error: invalid value '0x64' for '--size <WxH>': each side must be 1 to 65536 pixels, the area at most \
                  268435456",
    },
    Arguments {
        what: "An absurd size",
        arguments: "scene.json --size 65536x65536",
        status: 2,
        message: "error: invalid value '65536x65536' for '--size <WxH>': each side must be 1 to 65536 pixels, the area \
                  at most 268435456",
    },
    Arguments {
        what: "Half a size",
        arguments: "scene.json --size 64",
        status: 2,
        message: "error: invalid value '64' for '--size <WxH>': write it as 640x480",
    },
    Arguments {
        what: "An empty crop",
        arguments: "scene.json --crop 4,4,4,8",
        status: 2,
        message: "error: invalid value '4,4,4,8' for '--crop <x0,y0,x1,y1>': no pixel lies in columns 4..4 and rows 4..8: \
                  the ends are exclusive and must come after the starts",
    },
    Arguments {
        what: "A crop outside the image",
        arguments: "scene.json --crop 0,0,9,8",
        status: 2,
        message: "twinlight: --crop 0,0,9,8 reaches outside the image: it is 8 × 8 pixels, the ends of a crop are exclusive",
    },
    Arguments {
        what: "A crop of three numbers",
        arguments: "scene.json --crop 0,0,8",
        status: 2,
        message: "error: invalid value '0,0,8' for '--crop <x0,y0,x1,y1>': write it as x0,y0,x1,y1 in pixels, for \
                  example 0,0,64,64",
    },
    Arguments {
        what: "No threads",
        arguments: "scene.json --threads 0",
        status: 2,
        message: "error: invalid value '0' for '--threads <N>': write it as a whole number, 1 or more (at most 4096)",
    },
    Arguments {
        what: "A negative seed",
        arguments: "scene.json --seed -1",
        status: 2,
        message: "error: invalid value '-1' for '--seed <N>': write it as a whole number, 0 or more (at most \
                  18446744073709551615)",
    },
    Arguments {
        what: "A negative number of bounces",
        arguments: "scene.json --max-bounces -1",
        status: 2,
        message: "error: invalid value '-1' for '--max-bounces <N>': write it as a whole number, 0 or more (at most 1000000)",
    },
    Arguments {
        what: "A broken number of light subpaths",
        arguments: "scene.json --light-paths 1.5",
        status: 2,
        message: "error: invalid value '1.5' for '--light-paths <N>': write it as a whole number, 0 or more (at most 1024)",
    },
    Arguments {
        what: "A pyramid of too long paths",
        arguments: "scene.json --pyramid pyramid --pyramid-edges 65",
        status: 2,
        message: "error: invalid value '65' for '--pyramid-edges <N>': write it as a whole number, 1 or more (at most 64)",
    },
    Arguments {
        what: "No technique",
        arguments: "scene.json --technique 2",
        status: 2,
        message: "error: invalid value '2' for '--technique <s,t>': write it as s,t, for example 1,2",
    },
    Arguments {
        what: "A technique without the camera",
        arguments: "scene.json --technique 2,0",
        status: 2,
        message: "error: invalid value '2,0' for '--technique <s,t>': t counts the camera's own vertex: it is at least 1",
    },
    Arguments {
        what: "A technique of one vertex",
        arguments: "scene.json --technique 0,1",
        status: 2,
        message: "error: invalid value '0,1' for '--technique <s,t>': a path has at least two vertices: s + t must be at \
                  least 2",
    },
    Arguments {
        what: "An unknown integrator",
        arguments: "scene.json --integrator bpdt",
        status: 2,
        message: "error: invalid value 'bpdt' for '--integrator <X>'\n  [possible values: auto, bdpt, path, light]",
    },
    Arguments {
        what: "An exposure that is no number",
        arguments: "scene.json --exposure nan",
        status: 2,
        message: "error: invalid value 'nan' for '--exposure <STOPS>': write it as a number of stops from -100 to 100, \
                  for example 1.5",
    },
    Arguments {
        what: "An exposure and no PNG",
        arguments: "scene.json --exposure 0",
        status: 2,
        message: "twinlight: --exposure 0 brightens PNG files, and none is written: an EXR stays linear; add -o NAME.png",
    },
    Arguments {
        what: "Light subpaths for a path tracer",
        arguments: "scene.json --integrator path --light-paths 1",
        status: 2,
        message: "twinlight: --light-paths 1: the path integrator traces no light subpaths; use --integrator bdpt",
    },
    Arguments {
        what: "Connections for a path tracer",
        arguments: "scene.json --integrator path --connections 1",
        status: 2,
        message: "twinlight: --connections 1: the path integrator connects no subpaths; use --integrator bdpt",
    },
    Arguments {
        what: "Connections for a light tracer",
        arguments: "scene.json --integrator light --light-paths 2 --connections 1",
        status: 2,
        message: "twinlight: --connections 1: the light integrator connects no subpaths; use --integrator bdpt",
    },
    Arguments {
        what: "More connections than light subpaths",
        arguments: "scene.json --light-paths 2 --connections 3",
        status: 2,
        message: "twinlight: --connections 3 is more than --light-paths 2: a camera vertex connects to each light subpath \
                  once at most; give --light-paths 3 or more",
    },
    Arguments {
        what: "More connections than the one light subpath there is by default",
        arguments: "scene.json --connections 2",
        status: 2,
        message: "twinlight: --connections 2 is more than the one light subpath of each sample; give --light-paths 2 or more",
    },
    Arguments {
        what: "A heuristic and no weights",
        arguments: "scene.json --technique 1,2 --unweighted --heuristic power",
        status: 2,
        message: "error: the argument '--unweighted' cannot be used with '--heuristic <X>'",
    },
    Arguments {
        what: "A light tracer without light subpaths",
        arguments: "scene.json --integrator light --light-paths 0",
        status: 2,
        message: "twinlight: --light-paths 0 leaves the light tracer nothing to do: give at least 1",
    },
    Arguments {
        what: "A technique that the integrator has not",
        arguments: "scene.json --integrator path --technique 2,2",
        status: 2,
        message: "twinlight: --technique 2,2: the path integrator has no such technique; use bdpt",
    },
    Arguments {
        what: "A technique without its light subpaths",
        arguments: "scene.json --technique 1,1 --light-paths 0",
        status: 2,
        message: "twinlight: --technique 1,1: it takes light subpaths; give --light-paths 1 or more",
    },
    Arguments {
        what: "A technique without its connections",
        arguments: "scene.json --technique 2,2 --connections 0",
        status: 2,
        message: "twinlight: --technique 2,2: it takes connections; give --connections 1 or more",
    },
    Arguments {
        what: "A technique of too long paths",
        arguments: "scene.json --technique 3,3 --max-bounces 2",
        status: 2,
        message: "twinlight: --technique 3,3: its paths scatter 4 times and max_bounces is 2; give --max-bounces 4 or more",
    },
    Arguments {
        what: "An output of no known format",
        arguments: "scene.json -o image.jpg",
        status: 2,
        message: "twinlight: cannot write `image.jpg`: the extension `.jpg` names no known format; use `.exr` (linear) or \
                  `.png` (sRGB)",
    },
    Arguments {
        what: "Auxiliary images and no EXR",
        arguments: "scene.json --aovs depth -o image.png",
        status: 2,
        message: "twinlight: --aovs writes its images into an EXR, and none is written: add -o NAME.exr",
    },
    Arguments {
        what: "Statistics where no file can be",
        arguments: "scene.json --stats /dev/null",
        status: 2,
        message: "twinlight: cannot write `/dev/null`: it is not a regular file, which writing would replace; choose another \
                  name",
    },
    Arguments {
        what: "An output without an extension",
        arguments: "scene.json -o image",
        status: 2,
        message: "twinlight: cannot write `image`: the name has no extension to choose the format by; add `.exr` (linear) or \
                  `.png` (sRGB)",
    },
    Arguments {
        what: "An output in no folder",
        arguments: "scene.json -o none/image.exr",
        status: 2,
        message: "twinlight: cannot write `none/image.exr`: the folder `none` cannot be entered (No such file or \
                  directory (os error 2)); create it first",
    },
    Arguments {
        what: "An output in a file's place",
        arguments: "scene.json -o old.exr/image.exr",
        status: 2,
        message: "twinlight: cannot write `old.exr/image.exr`: `old.exr` is not a folder; choose another place",
    },
    Arguments {
        what: "An output in a folder's place",
        arguments: "scene.json -o folder.exr",
        status: 2,
        message: "twinlight: cannot write `folder.exr`: it is a folder; give a file's name inside it",
    },
    Arguments {
        what: "The scene as an output",
        arguments: "scene.json --stats ./scene.json",
        status: 2,
        message: "twinlight: ./scene.json: this is the scene itself; choose another name",
    },
    Arguments {
        what: "Two outputs of one name",
        arguments: "scene.json -o image.exr --stats ./image.exr",
        status: 2,
        message: "twinlight: ./image.exr: two outputs would be written to this file; choose another name",
    },
    Arguments {
        what: "Statistics in no folder",
        arguments: "scene.json --stats none/stats.json",
        status: 2,
        message: "twinlight: cannot write `none/stats.json`: the folder `none` cannot be entered (No such file or \
                  directory (os error 2)); create it first",
    },
    Arguments {
        what: "A pyramid's size and no pyramid",
        arguments: "scene.json --pyramid-edges 6",
        status: 2,
        message: "error: the following required arguments were not provided:\n  --pyramid <DIR>",
    },
    Arguments {
        what: "A pyramid in no folder",
        arguments: "scene.json --pyramid none/pyramid",
        status: 2,
        message: "twinlight: --pyramid: cannot write `none/pyramid`: the folder `none` cannot be entered (No such file or \
                  directory (os error 2)); create it first",
    },
    Arguments {
        what: "An output that the pyramid would overwrite",
        arguments: "scene.json --pyramid . -o s1_t2.exr",
        status: 2,
        message: "twinlight: s1_t2.exr: the pyramid writes a file of this name there; choose another name or folder",
    },
    Arguments {
        what: "A pyramid in a file's place",
        arguments: "scene.json --pyramid old.exr",
        status: 2,
        message: "twinlight: --pyramid: cannot write `old.exr/s0_t2.exr`: `old.exr` is not a folder; choose another place",
    },
    Arguments {
        what: "A pyramid beyond memory",
        arguments: "scene.json --size 16384x16384 --pyramid stages --max-memory 16G",
        status: 2,
        message: "twinlight: the film of 16384 × 16384 pixels and those of 27 techniques take 420.0 GiB, more than the 16.0 GiB of \
                  --max-memory; use a smaller --size or a --crop or fewer --pyramid-edges or a larger --max-memory",
    },
    Arguments {
        what: "Techniques kept apart beyond memory for auxiliary images",
        arguments: "scene.json --size 8192x8192 --aovs direct --max-memory 16G",
        status: 2,
        message: "twinlight: the film of 8192 × 8192 pixels, those of 5 techniques, 9 auxiliary channels take 24.8 GiB, more \
                  than the 16.0 GiB of --max-memory; use a smaller --size or a --crop or fewer --aovs or a larger --max-memory",
    },
    Arguments {
        what: "A variance beyond memory",
        arguments: "scene.json --size 16384x16384 --aovs variance --max-memory 16G",
        status: 2,
        message: "twinlight: the film of 16384 × 16384 pixels and 3 auxiliary channels take 57.0 GiB, more than the 16.0 GiB \
                  of --max-memory; use a smaller --size or a --crop or fewer --aovs or a larger --max-memory",
    },
    Arguments {
        what: "A scene beyond memory",
        arguments: "scene.json --size 512x512 --max-memory 16M",
        status: 2,
        message: "twinlight: the render takes about 25.0 MiB at once (film 15.0 MiB, the program itself 10.0 MiB), more than the \
                  16.0 MiB of --max-memory; use a smaller --size or a --crop or a simpler scene or a larger --max-memory",
    },
    Arguments {
        what: "A mesh beyond memory (`large.obj`, which `large.json` names, has 2 MiB)",
        arguments: "large.json --max-memory 1M",
        status: 65,
        message: "twinlight: large.json:1:58: /surfaces/0/filename: large.obj has 2.0 MiB: more than the 1.0 MiB of memory \
                  allowed; use a simpler mesh or a larger --max-memory",
    },
    Arguments {
        what: "Memory without a unit",
        arguments: "scene.json --max-memory 8",
        status: 2,
        message: "error: invalid value '8' for '--max-memory <SIZE>': write it as a number and a unit, K, M, G or T, for example \
                  8G or 512M",
    },
    Arguments {
        what: "No memory",
        arguments: "scene.json --max-memory 0G",
        status: 2,
        message: "error: invalid value '0G' for '--max-memory <SIZE>': the number must be above 0 and at most 1000000, for \
                  example 8G or 512M",
    },
];

/// The other commands. `a.exr` and `b.exr` are images of 2 × 2 and 3 × 2 pixels, `a.png` and `a.exr` show the same.
pub const COMMANDS: &[Arguments] = &[
    Arguments {
        what: "A scene that is not there",
        arguments: "info none.json",
        status: 1,
        message: "twinlight: none.json: cannot read the scene file: No such file or directory (os error 2); check the name and \
                  the permissions",
    },
    Arguments {
        what: "Images of several sizes",
        arguments: "compare a.exr b.exr --difference old.png",
        status: 65,
        message: "twinlight: the image has 2 × 2 pixels, the reference 3 × 2: render or crop them to one size",
    },
    Arguments {
        what: "An image that is not there",
        arguments: "compare none.exr a.exr",
        status: 1,
        message: "twinlight: cannot read `none.exr`: No such file or directory (os error 2); check the name and the permissions",
    },
    Arguments {
        what: "A folder for an image",
        arguments: "compare a.exr folder.exr",
        status: 1,
        message: "twinlight: cannot read `folder.exr`: it is a folder; give an image file inside it",
    },
    Arguments {
        what: "No image",
        arguments: "compare a.exr binary --difference old.png",
        status: 65,
        message: "twinlight: cannot read `binary`: it is no EXR, PNG or Radiance HDR image; convert it to one of them",
    },
    Arguments {
        what: "A difference that is no PNG",
        arguments: "compare a.exr a.exr --difference old.exr",
        status: 2,
        message: "twinlight: --difference old.exr: the difference is a picture in false colours, not data; give it a name that \
                  ends in .png",
    },
    Arguments {
        what: "A difference in an image's place",
        arguments: "compare a.exr a.png --difference a.png",
        status: 2,
        message: "twinlight: a.png: this is an image to compare; choose another name",
    },
    Arguments {
        what: "A range of no difference",
        arguments: "compare a.exr a.exr --difference old.png --range 0",
        status: 2,
        message: "error: invalid value '0' for '--range <PERCENT>': write it as a number of percent from 0.001 to 1000000, for \
                  example 50",
    },
    Arguments {
        what: "A layer that is not there",
        arguments: "convert a.exr old.png --layer depth",
        status: 65,
        message: "twinlight: cannot read `a.exr`: no layer is named \"depth\"; it has none",
    },
    Arguments {
        what: "A layer of what has none",
        arguments: "convert a.png old.png --layer depth",
        status: 65,
        message: "twinlight: cannot read `a.png`: it has no layers: it is no EXR; leave out --layer",
    },
    Arguments {
        what: "An image that is not there",
        arguments: "convert none.exr old.png",
        status: 1,
        message: "twinlight: cannot read `none.exr`: No such file or directory (os error 2); check the name and the permissions",
    },
    Arguments {
        what: "No image",
        arguments: "convert binary old.png",
        status: 65,
        message: "twinlight: cannot read `binary`: it is no EXR, PNG or Radiance HDR image; convert it to one of them",
    },
    Arguments {
        what: "An unknown format",
        arguments: "convert a.exr image.tiff",
        status: 2,
        message: "twinlight: cannot write `image.tiff`: the extension `.tiff` names no known format; use `.exr` (linear) or \
                  `.png` (sRGB)",
    },
    Arguments {
        what: "An image onto itself",
        arguments: "convert a.exr ./a.exr",
        status: 2,
        message: "twinlight: ./a.exr: this is the image to convert; choose another name",
    },
    Arguments {
        what: "An exposure and no PNG",
        arguments: "convert a.exr old.exr --exposure 1",
        status: 2,
        message: "twinlight: --exposure 1 brightens PNG files: an EXR stays linear; leave it out or write a PNG",
    },
];
