//! `twinlight precision`.

use super::Folder;

#[test]
fn the_report_is_there_for_people_and_for_programs() {
    let folder = Folder::with_room("precision");
    let text = folder.ok(&["precision", "room.json", "--spp", "2"]).stdout;
    for part in
        ["room.json: bdpt, 2 spp", "paths against f64", "the image: ", "by the condition", "times the condition"]
    {
        assert!(text.contains(part), "{part:?} is missing: {text}");
    }
    let json = folder.ok(&["precision", "room.json", "--spp", "2", "--json", "--size", "8x6", "--accel", "bvh"]).stdout;
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let paths = json["paths"].as_u64().expect("a count");
    assert!(paths > 50, "{json}");
    let rows = json["rows"].as_array().expect("rows");
    let (all, by_length) = rows.split_last().expect("rows");
    assert_eq!((&all["edges"], all["paths"].as_u64()), (&"all".into(), Some(paths)));
    assert_eq!(by_length.iter().map(|row| row["paths"].as_u64().expect("a count")).sum::<u64>(), paths);
    assert!(all["weight"][0].as_f64().is_some_and(|median| median < 1e-6), "{json}");
    assert_eq!(folder.names(), ["room.json"]);
}

#[test]
fn a_bad_scene_is_refused() {
    let folder = Folder::new("precision-bad");
    folder.write("bad.json", "{}");
    let outcome = folder.run(&["precision", "bad.json"]);
    assert_eq!((outcome.status, outcome.stdout.as_str()), (Some(65), ""));
}

#[test]
fn paths_longer_than_memory_holds_are_refused() {
    let folder = Folder::with_room("precision-long");
    let outcome = folder.run(&["precision", "room.json", "--max-bounces", "1000000"]);
    assert_eq!((outcome.status, outcome.stdout.as_str()), (Some(2), ""));
    assert!(
        outcome.stderr.contains("1000000 bounces") && outcome.stderr.contains("fewer --max-bounces"),
        "{}",
        outcome.stderr
    );
}
