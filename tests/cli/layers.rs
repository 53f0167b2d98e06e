//! The layers of EXR files: those that a render writes, and those that `convert` takes.

use std::io::Cursor;

use exr::prelude::{SpecificChannels, Vec2, WritableImage as _};

use super::Folder;

#[test]
fn auxiliary_images_lie_beside_the_picture() {
    let folder = Folder::with_room("aovs");
    folder.ok(&["render", "room.json", "-q", "-o", "plain.exr"]);
    folder.ok(&["render", "room.json", "-q", "-o", "all.exr", "-o", "all.png", "--aovs", "all"]);
    folder.ok(&["render", "room.json", "-q", "-o", "again.exr", "--aovs", "all", "--threads", "2"]);
    folder.ok(&["render", "room.json", "-q", "-o", "few.exr", "--aovs", "depth,normal"]);
    // The picture keeps its bits, and the file its bytes.
    assert_eq!(folder.image("plain.exr"), folder.image("all.exr"));
    assert_eq!(folder.bytes("all.exr"), folder.bytes("again.exr"));
    let channels = |name: &str| -> Vec<String> {
        let meta = exr::meta::MetaData::read_from_file(folder.path(name), false).unwrap();
        meta.headers[0].channels.list.iter().map(|c| c.name.to_string()).collect()
    };
    assert_eq!(channels("few.exr"), ["B", "G", "R", "depth.Z", "normal.X", "normal.Y", "normal.Z"]);
    let all = channels("all.exr");
    for name in [
        "albedo.R",
        "shading_normal.Y",
        "primitive.id",
        "material.id",
        "emission.R",
        "direct.G",
        "indirect.B",
        "depth1.R",
        "depth6.B",
        "variance.R",
        "samples.count",
        "lights.id",
        "lights.visible",
    ] {
        assert!(all.iter().any(|c| c == name), "{name} is missing: {all:?}");
    }
    let refused = folder.run(&["render", "room.json", "-o", "x.png", "--aovs", "depth"]);
    assert_eq!(refused.status, Some(2));
    assert!(refused.stderr.contains("--aovs writes its images into an EXR"), "{}", refused.stderr);
}

#[test]
fn convert_takes_a_layer_and_says_what_it_leaves_out() {
    let folder = Folder::with_room("layers");
    folder.ok(&["render", "room.json", "-q", "-o", "all.exr", "--aovs", "depth,normal,samples"]);
    // The picture by default, with a word about the rest.
    let told = folder.ok(&["convert", "all.exr", "picture.exr"]);
    assert_eq!(
        told.stderr,
        "note: of all.exr the layers depth, normal, samples are left out: --layer NAME takes one\n"
    );
    assert_eq!(folder.image("picture.exr"), folder.image("all.exr"));
    assert_eq!(folder.ok(&["convert", "picture.exr", "again.exr"]).stderr, "");
    // One channel is grey; samples are known.
    for (layer, extension) in [("samples", "exr"), ("depth", "exr"), ("normal", "exr"), ("depth", "png")] {
        let out = format!("{layer}.{extension}");
        assert_eq!(folder.ok(&["convert", "all.exr", &out, "--layer", layer]).stderr, "");
    }
    assert!(folder.image("samples.exr").rgb.iter().all(|p| *p == [4.0; 3]));
    let channel = |name: &str| -> Vec<f32> {
        let file = exr::prelude::read_all_flat_layers_from_file(folder.path("all.exr")).unwrap();
        let list = &file.layer_data[0].channel_data.list;
        list.iter().find(|c| c.name.eq(name)).unwrap().sample_data.values_as_f32().collect()
    };
    let normal = folder.image("normal.exr");
    for (i, name) in ["normal.X", "normal.Y", "normal.Z"].into_iter().enumerate() {
        assert_eq!(normal.rgb.iter().map(|p| p[i]).collect::<Vec<f32>>(), channel(name), "{name}");
    }
    assert_eq!(folder.image("depth.exr").rgb.iter().map(|p| p[1]).collect::<Vec<f32>>(), channel("depth.Z"));
    // What made it stays known.
    assert!(super::exr_header(&folder.path("depth.exr")).0.contains_key("twinlight:spp"));
}

#[test]
fn a_layer_that_is_not_there_is_told_with_those_that_are() {
    let folder = Folder::with_room("layers_refused");
    folder.ok(&["render", "room.json", "-q", "-o", "all.exr", "-o", "all.png", "--aovs", "depth,normal"]);
    folder.ok(&["render", "room.json", "-q", "-o", "plain.exr"]);
    let channels = SpecificChannels::build().with_channel("uv.u").with_channel("uv.v");
    let mut bytes = Cursor::new(Vec::new());
    let image = exr::prelude::Image::from_channels((2, 1), channels.with_pixel_fn(|_| (0.25f32, 0.5f32)));
    image.write().to_buffered(&mut bytes).unwrap();
    folder.write("uv.exr", bytes.into_inner());
    folder.write("old.exr", "what was there before");
    let before = folder.snapshot();
    for (input, layer, status, said) in [
        ("all.exr", "depht", 65, "cannot read `all.exr`: no layer is named \"depht\"; there are: depth, normal"),
        ("plain.exr", "depth", 65, "cannot read `plain.exr`: no layer is named \"depth\"; it has none"),
        ("all.png", "depth", 65, "cannot read `all.png`: it has no layers: it is no EXR; leave out --layer"),
        (
            "none.exr",
            "depth",
            1,
            "cannot read `none.exr`: No such file or directory (os error 2); check the name and the permissions",
        ),
        (
            "room.json",
            "depth",
            65,
            "cannot read `room.json`: it is no EXR, PNG or Radiance HDR image; convert it to one of them",
        ),
    ] {
        let outcome = folder.run(&["convert", input, "old.exr", "--layer", layer]);
        assert_eq!((outcome.status, outcome.stderr), (Some(status), format!("twinlight: {said}\n")));
        assert!(folder.snapshot() == before);
    }
    folder.ok(&["convert", "uv.exr", "red_green.exr", "--layer", "uv"]);
    assert_eq!(folder.image("red_green.exr").rgb, [[0.25, 0.5, 0.0]; 2]);
}

#[test]
fn names_in_a_file_do_not_steer_the_terminal() {
    let folder = Folder::with_room("layers_steering");
    let pixels = |Vec2(_, _): Vec2<usize>| (0.5_f32, 0.5_f32, 0.5_f32, 1.0_f32);
    let names = SpecificChannels::build().with_channel("R").with_channel("G").with_channel("B");
    let channels = names.with_channel("a\x1b[2J\x07.Z").with_pixel_fn(pixels);
    let mut bytes = Cursor::new(Vec::new());
    exr::prelude::Image::from_channels((2, 2), channels).write().to_buffered(&mut bytes).unwrap();
    folder.write("odd.exr", bytes.into_inner());
    let told = folder.ok(&["convert", "odd.exr", "picture.exr"]).stderr;
    assert!(told.contains("the layers a\\u{1b}[2J\\u{7} are left out"), "{told:?}");
    let refused = folder.run(&["convert", "odd.exr", "picture.exr", "--layer", "b"]).stderr;
    assert!(refused.contains("there are: a\\u{1b}[2J\\u{7}"), "{refused:?}");
    for text in [told, refused] {
        assert!(!text.contains(|c: char| c.is_control() && c != '\n'), "{text:?}");
    }
}

#[test]
fn a_channel_that_is_all_of_a_layer_stands_for_it() {
    let folder = Folder::with_room("layers_by_channel");
    folder.ok(&["render", "room.json", "-q", "-o", "all.exr", "--aovs", "depth,normal"]);
    folder.ok(&["convert", "all.exr", "by_layer.exr", "--layer", "depth"]);
    folder.ok(&["convert", "all.exr", "by_channel.exr", "--layer", "depth.Z"]);
    assert_eq!(folder.image("by_layer.exr"), folder.image("by_channel.exr"));
    let refused = folder.run(&["convert", "all.exr", "x.exr", "--layer", "normal.Z"]);
    assert_eq!(refused.status, Some(65));
}
