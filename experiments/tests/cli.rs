//! The command line as a user meets it: exit codes, messages, files, and the same bytes every time.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use tempfile::TempDir;

use crate::attic::FAMILY;
use crate::checked::checked;
use crate::closet::SCENE;

struct Place {
    folder: TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::write(folder.path().join("closet.toml"), SCENE).expect("writable");
        Self { folder }
    }

    fn path(&self) -> &Path {
        self.folder.path()
    }

    fn run(&self, args: &[&str]) -> Output {
        let mut command = Command::cargo_bin("experiments").expect("built");
        command.current_dir(self.path()).args(args).output().expect("runs")
    }

    /// Runs and expects an exit code; gives stdout and stderr.
    fn expect(&self, code: i32, args: &[&str]) -> (String, String) {
        checked(code, &args, &self.run(args))
    }

    fn edit(&self, from: &str, to: &str) {
        assert!(SCENE.contains(from), "{from}");
        fs::write(self.path().join("closet.toml"), SCENE.replacen(from, to, 1)).expect("writable");
    }
}

/// Every file of a folder with its bytes.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("there").map(|entry| entry.expect("entry").path());
    let read = |path: std::path::PathBuf| {
        (path.file_name().expect("named").to_string_lossy().into_owned(), fs::read(&path).expect("readable"))
    };
    entries.map(read).collect()
}

#[test]
fn room_leaves_every_file_it_promises() {
    let place = Place::new();
    let (out, err) = place.expect(0, &["room", "--scene", "closet.toml"]);
    assert!(out.contains("visibility-printed") && err.contains("report.html"));
    let found = files(&place.path().join("results/closet"));
    let names: Vec<&str> = found.keys().map(String::as_str).collect();
    let expected = [
        "conventional-end.npy",
        "conventional-end.pgm",
        "conventional-end.yaml",
        "maps.png",
        "metrics.csv",
        "regions.png",
        "report.html",
        "run.json",
        "scans.csv",
        "scene.png",
        "timeline.csv",
        "timeline.png",
        "truth.npy",
        "visibility-end.npy",
        "visibility-end.pgm",
        "visibility-end.yaml",
        "visibility-lateral-end.npy",
        "visibility-lateral-end.pgm",
        "visibility-lateral-end.yaml",
        "visibility-printed-end.npy",
        "visibility-printed-end.pgm",
        "visibility-printed-end.yaml",
    ];
    assert_eq!(names, expected);

    let record: serde_json::Value = serde_json::from_slice(&found["run.json"]).expect("JSON");
    assert_eq!(record["schema_version"], 1);
    assert_eq!(record["grid"], serde_json::json!({"cell_m": 0.1, "origin_m": [0.0, 0.0], "width": 30, "height": 20}));
    let listed: Vec<&str> =
        record["files"].as_array().into_iter().flatten().filter_map(|f| f["name"].as_str()).collect();
    assert_eq!(listed, expected.into_iter().filter(|name| *name != "run.json").collect::<Vec<_>>());

    let text = |name: &str| String::from_utf8(found[name].clone()).expect("text");
    let metrics = text("metrics.csv");
    assert!(metrics.starts_with("scene,seed,mapper,stage,region,metric,value,unit,support\n"));
    // Mappers x regions x metrics, and the head.
    // Fifteen metrics in each of seven regions, and six of drives.
    assert_eq!(metrics.lines().count(), 4 * (7 * 15 + 6) + 1);
    let scans = text("scans.csv");
    assert!(scans.starts_with("scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px,true_range_m\n"));
    // Base64 has no colon: no maps can look like an address.
    assert!(!text("report.html").contains("://"), "the report needs no network");
    let truth = &found["truth.npy"];
    assert_eq!(truth.len() % 64, (30 * 20 * 4) % 64, "a padded NPY head and 600 float32");
}

#[test]
fn the_same_seed_gives_the_same_bytes_with_any_number_of_threads() {
    let place = Place::new();
    for (folder, threads) in [("one", "1"), ("two", "2"), ("again", "2")] {
        place.expect(0, &["room", "--scene", "closet.toml", "--out", folder, "--threads", threads, "--seeds", "3"]);
    }
    let one = files(&place.path().join("one"));
    assert_eq!(one, files(&place.path().join("two")));
    assert_eq!(one, files(&place.path().join("again")));
    place.expect(0, &["room", "--scene", "closet.toml", "--out", "other", "--seed", "2"]);
    assert_ne!(one["scans.csv"], files(&place.path().join("other"))["scans.csv"]);
}

#[test]
fn an_absent_reading_is_an_empty_field() {
    let place = Place::new();
    place.edit("[robot]", "[sensor]\ndetection_rate = 0.0\n[robot]");
    place.expect(0, &["room", "--scene", "closet.toml", "--out", "o"]);
    let scans = String::from_utf8(fs::read(place.path().join("o/scans.csv")).expect("there")).expect("text");
    assert!(scans.lines().skip(1).all(|line| line.split(',').nth(6) == Some("")));
}

#[test]
fn tables_as_csv_and_json_hold_the_same_rows() {
    let place = Place::new();
    let args = ["room", "--scene", "closet.toml", "--out", "o", "--mappers", "conventional", "--format"];
    let (csv, _) = place.expect(0, &[&args[..], &["csv"]].concat());
    assert_eq!(csv.as_bytes(), files(&place.path().join("o"))["metrics.csv"]);
    let (json, _) = place.expect(0, &[&args[..], &["json"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(csv.lines().count() - 1));
    assert_eq!(json["rows"][0]["metric"], "log_loss");
}

/// Every mapper is shown the near readings alone, and the record says so.
#[test]
fn far_readings_are_thrown_away_for_every_mapper() {
    let place = Place::new();
    let room = |out: &str, more: &[&str]| {
        let args = ["room", "--scene", "closet.toml", "--out", out, "--mappers", "visibility,conventional,mrf,prior"];
        place.expect(0, &[&args[..], more].concat());
        files(&place.path().join(out))
    };
    let (all, far) = (room("all", &[]), room("far", &["--max-range", "1000"]));
    let (near, none) = (room("near", &["--max-range", "1"]), room("none", &["--max-range", "0.001"]));
    let map = |folder: &BTreeMap<String, Vec<u8>>, mapper: &str| {
        let name = folder.keys().find(|name| name.starts_with(mapper) && name.ends_with(".npy")).expect("a map");
        folder[name].clone()
    };
    for mapper in ["visibility", "conventional", "mrf"] {
        assert!(map(&all, mapper) == map(&far, mapper), "{mapper}: nothing is so far");
        assert!(map(&all, mapper) != map(&near, mapper), "{mapper}");
    }
    assert!(map(&none, "visibility") == map(&none, "prior"), "nothing is so near");
    assert!(all["scans.csv"] == none["scans.csv"], "the readings are what they were");
    let record = |folder: &BTreeMap<String, Vec<u8>>| String::from_utf8(folder["run.json"].clone()).expect("text");
    assert!(record(&near).contains("\"max_range_m\": 1.0") && !record(&all).contains("max_range_m"));
}

#[test]
fn a_claim_that_does_not_hold_is_exit_code_3_and_says_which() {
    let place = Place::new();
    // In a closet nothing is far: the conventional rule loses nothing.
    place.edit("radius = 0.3", "radius = 0.3\nclaims = true");
    let (out, err) = place.expect(3, &["room", "--scene", "closet.toml", "--out", "o"]);
    assert!(err.contains("X: conventional now has them occupied: 0.0000, at least 0.1"), "{err}");
    assert!(out.contains("FAILS  X: conventional now has them occupied"));
    assert!(place.path().join("o/metrics.csv").exists(), "the results are there to look into");
    // With one of the two mappers there is nothing to judge, and that is said.
    let (_, err) = place.expect(0, &["room", "--scene", "closet.toml", "--out", "o", "--mappers", "visibility"]);
    assert!(err.contains("they are not judged"), "{err}");
    // Nor where far readings are thrown away, which the claims are not about.
    let (_, err) = place.expect(0, &["room", "--scene", "closet.toml", "--out", "o", "--max-range", "2"]);
    assert!(err.contains("with --max-range they are not judged"), "{err}");
    // Without a free cell there is nothing to claim.
    place.edit("radius = 0.3", "radius = 1e-6\nclaims = true");
    let (_, err) = place.expect(2, &["room", "--scene", "closet.toml", "--out", "p"]);
    assert!(err.contains("region X: has claims = true but no free cell") && !place.path().join("p").exists(), "{err}");
}

#[test]
fn bad_options_are_refused_before_any_work() {
    let place = Place::new();
    let refused = |args: &[&str], message: &str| {
        let (_, err) = place.expect(2, &[&["room", "--scene", "closet.toml", "--out", "o"], args].concat());
        assert!(err.contains(message), "{args:?}: {err}");
        assert!(!place.path().join("o").exists(), "{args:?} left something");
    };
    refused(&["--mappers", "visibilty"], "no mapper \"visibilty\"; the nearest is 'visibility', all are: visibility, ");
    refused(&["--mappers", "conventional,conventional"], "given twice");
    refused(&["--grid", "0"], "must be a number above 0 and finite");
    refused(&["--grid", "nan"], "must be a number above 0 and finite");
    for range in ["0", "-2", "inf", "far"] {
        refused(&["--max-range", range], "--max-range <M>': must be a number above 0 and finite");
    }
    refused(&["--grid", "-1"], "must be a number above 0 and finite");
    refused(&["--threads", "100000"], "1..=1024");
    refused(&["--prior", "1.5"], "must be a number from 0 to 1");
    refused(&["--seeds", "0"], "--seeds");
    refused(&["--seed", "18446744073709551615", "--seeds", "2"], "begin lower");
    refused(&["--threads", "0"], "--threads");
    refused(&["--format", "xml"], "csv");
}

#[test]
fn a_bad_scene_is_one_line_with_its_place_and_leaves_nothing() {
    let place = Place::new();
    place.edit("size = [0.4, 0.4]", "size = [0.4, -0.2]");
    for args in [&["room", "--scene", "closet.toml", "--out", "o"][..], &["check", "closet.toml"]] {
        let (out, err) = place.expect(2, args);
        assert!(err.starts_with("error: closet.toml:26:8:"), "{err}");
        assert!(err.contains("-0.2") && err.lines().count() == 1, "{err}");
        assert_eq!(out, "");
        assert!(!place.path().join("o").exists());
    }
    let (_, err) = place.expect(2, &["check", "nowhere.toml"]);
    assert!(err.contains("nowhere.toml"), "{err}");
}

#[test]
fn what_is_no_scene_is_named_with_the_command_that_reads_it() {
    let place = Place::new();
    fs::write(place.path().join("map.yaml"), "image: map.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
        .expect("writable");
    fs::write(place.path().join("map.pgm"), b"P5\n2 2\n255\n\xcd\xcd\xcd\xcd").expect("writable");
    fs::write(place.path().join("a.log"), "PARAM robot_length 1\nFLASER 1 1 0 0 0 0 0 0 0 host 0\n").expect("writable");
    for command in [&["check"][..], &["estimate"], &["room", "--scene"], &["scene", "generate"]] {
        for (file, reader) in [("map.yaml", "`scene from-map"), ("map.pgm", "`scene from-map"), ("a.log", "`replay`")] {
            let (out, err) = place.expect(2, &[command, &[file]].concat());
            assert!(err.starts_with(&format!("error: {file}:1:1: is ")) && err.contains(reader), "{command:?}: {err}");
            assert!(out.is_empty() && err.lines().count() == 1, "{err}");
        }
        let (_, err) = place.expect(2, &[command, &["closets.tml"]].concat());
        assert!(err.contains("there is no such file (did you mean `closet.toml`?)"), "{err}");
    }
}

#[test]
fn an_output_folder_that_cannot_be_written_is_refused_and_a_failed_run_keeps_the_former_results() {
    let place = Place::new();
    fs::write(place.path().join("file"), "in the way").expect("writable");
    let (_, err) = place.expect(2, &["room", "--scene", "closet.toml", "--out", "file"]);
    assert!(err.contains("file: the output folder"), "{err}");

    place.expect(0, &["room", "--scene", "closet.toml", "--out", "o"]);
    let before = files(&place.path().join("o"));
    place.edit("B = [2.4, 1.2]", "B = [2.6, 0.45]");
    place.expect(2, &["room", "--scene", "closet.toml", "--out", "new"]);
    assert!(!place.path().join("new").exists(), "a blocked route leaves no folder");
    let (_, err) = place.expect(2, &["room", "--scene", "closet.toml", "--out", "o"]);
    assert!(err.contains("blocked") && err.contains("box 1"), "{err}");
    assert_eq!(before, files(&place.path().join("o")));
}

#[test]
fn report_makes_the_same_page_from_the_folder_alone() {
    let place = Place::new();
    place.expect(
        0,
        &["room", "--scene", "closet.toml", "--out", "o", "--seeds", "3", "--grid", "0.07", "--prior", "0.123"],
    );
    let before = files(&place.path().join("o"));
    place.expect(0, &["report", "o", "--out", "page.html"]);
    assert_eq!(fs::read(place.path().join("page.html")).expect("there"), before["report.html"]);
    fs::remove_file(place.path().join("o/report.html")).expect("removable");
    let (out, err) = place.expect(0, &["report", "o"]);
    assert_eq!((out.as_str(), err.contains("report.html")), ("", true));
    assert_eq!(files(&place.path().join("o")), before, "nothing else is touched");
}

#[test]
fn report_refuses_a_folder_that_it_cannot_vouch_for() {
    let place = Place::new();
    let refused = |message: &str| {
        let (_, err) = place.expect(2, &["report", "o"]);
        assert!(err.contains(message) && err.lines().count() == 1, "{err}");
    };
    refused("run.json: cannot be read");
    place.expect(0, &["room", "--scene", "closet.toml", "--out", "o"]);
    let path = |name: &str| place.path().join("o").join(name);
    let [record, metrics] = ["run.json", "metrics.csv"].map(|name| fs::read_to_string(path(name)).expect("there"));
    let put = |name: &str, text: &str| fs::write(path(name), text).expect("writable");

    put("run.json", "{");
    refused("is no record of a run");
    put("run.json", "{}");
    refused("names no command");
    put("run.json", &record.replace("\"room\"", "\"cooking\""));
    refused("the command \"cooking\" leaves no page");
    for (was, is) in [("\"seed\": 1", "\"seed\": 2"), ("\"scaled\"", "\"fixed\""), ("metrics.csv", "metrics2.csv")] {
        put("run.json", &record.replace(was, is));
        refused("run.json: was changed after the run that wrote it");
    }
    put("run.json", &record);

    put(
        "metrics.csv",
        &metrics.replacen(
            "closet,1,visibility,end,visible,log_loss,0.",
            "closet,1,visibility,end,visible,log_loss,1.",
            1,
        ),
    );
    refused("metrics.csv: line 2 is");
    put("metrics.csv", &metrics);
    place.edit("columns = 24", "columns = 25");
    refused("configuration.columns was 24 and would now be 25: the scene has changed");
    place.edit("columns = 24", "columns = 24");
    fs::remove_file(path("maps.png")).expect("removable");
    refused("maps.png: cannot be read");
    fs::remove_file(place.path().join("closet.toml")).expect("removable");
    let (_, err) = place.expect(2, &["report", "o"]);
    assert!(err.contains("closet.toml"), "{err}");
}

#[test]
fn the_program_bears_the_projects_name_too() {
    let help = |name: &str| {
        let output = Command::cargo_bin(name).expect("built").args(["guide", "--help"]).output().expect("starts");
        String::from_utf8(output.stdout).expect("text").replace(name, "NAME")
    };
    assert_eq!(help("sightgrid"), help("experiments"));
}

#[test]
fn the_guide_is_printed_page_by_page() {
    let place = TempDir::new().expect("temporary folder");
    let guide =
        |args: &[&str]| Command::cargo_bin("experiments").expect("built").current_dir(&place).args(args).output();
    let pages = guide(&["guide"]).expect("starts");
    assert!(String::from_utf8_lossy(&pages.stdout).contains("glossary         Glossary of metrics"));
    let page = guide(&["guide", "compare"]).expect("starts");
    assert!(String::from_utf8_lossy(&page.stdout).starts_with("# Which mapper is better"));
    let none = guide(&["guide", "compair"]).expect("starts");
    assert_eq!(none.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&none.stderr).contains("the nearest is 'compare'"));
}

#[test]
fn check_says_what_a_scene_holds() {
    let place = Place::new();
    let (out, _) = place.expect(0, &["check", "closet.toml"]);
    insta::assert_snapshot!(out);
}

#[test]
fn list_names_experiments_mappers_and_scenes() {
    let place = Place::new();
    fs::create_dir(place.path().join("scenes")).expect("writable");
    fs::rename(place.path().join("closet.toml"), place.path().join("scenes/closet.toml")).expect("writable");
    fs::write(place.path().join("scenes/broken.toml"), "name = 1").expect("writable");
    fs::write(place.path().join("scenes/attics.toml"), FAMILY).expect("writable");
    let (out, _) = place.expect(0, &["list"]);
    insta::assert_snapshot!(out);
}

#[test]
fn the_shipped_scenes_are_valid() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    for scene in [
        "room",
        "uma",
        "clutter",
        "closets",
        "corridors",
        "halls",
        "two-rooms",
        "corridor-people",
        "office-visits",
        "waiting-people",
    ]
    .map(|name| format!("scenes/{name}.toml"))
    {
        let mut command = Command::cargo_bin("experiments").expect("built");
        command.current_dir(&root).args(["check", &scene]).assert().success();
    }
}

#[test]
fn a_family_takes_a_layout_and_a_scene_does_not() {
    let place = Place::new();
    fs::write(place.path().join("attics.toml"), FAMILY).expect("writable");
    let (first, _) = place.expect(0, &["check", "attics.toml"]);
    assert!(first.starts_with("attics.toml, layout 1: valid"), "{first}");
    assert_eq!(first, place.expect(0, &["check", "attics.toml", "--layout", "1"]).0);
    assert_ne!(first.replace("layout 1", "layout 2"), place.expect(0, &["check", "attics.toml", "--layout", "2"]).0);

    let run = ["room", "--scene", "attics.toml", "--layout", "2", "--mappers", "conventional"];
    place.expect(0, &run);
    let record = fs::read(place.path().join("results/attic-2/run.json")).expect("written");
    let record: serde_json::Value = serde_json::from_slice(&record).expect("JSON");
    assert_eq!(
        (&record["configuration"]["scene"], &record["configuration"]["layout"]),
        (&"attics.toml".into(), &2.into())
    );

    for args in [&["check", "closet.toml", "--layout", "2"][..], &["room", "--scene", "closet.toml", "--layout", "2"]] {
        let (_, err) = place.expect(2, args);
        assert!(err.contains("layout 2 was asked for: must be a family of scenes to have layouts"), "{err}");
    }
    let (_, err) = place.expect(2, &["check", "attics.toml", "--layout", "-1"]);
    assert!(err.contains("--layout"), "{err}");
    assert!(!place.path().join("results/closet").exists());
}

#[test]
fn a_generated_scene_file_is_the_layout() {
    let place = Place::new();
    fs::write(place.path().join("attics.toml"), FAMILY).expect("writable");
    let generate = ["scene", "generate", "attics.toml", "--layout", "3"];
    let (text, _) = place.expect(0, &generate);
    assert_eq!(place.expect(0, &[&generate[..], &["--out", "three.toml"]].concat()).0, "");
    assert_eq!(fs::read_to_string(place.path().join("three.toml")).expect("written"), text);
    let [from_file, from_family] =
        [&["check", "three.toml"][..], &["check", "attics.toml", "--layout", "3"]].map(|args| place.expect(0, args).0);
    assert_eq!(from_file.lines().skip(1).collect::<Vec<_>>(), from_family.lines().skip(1).collect::<Vec<_>>());

    let (larger, _) = place.expect(0, &[&generate[..], &["--size-factor", "2"]].concat());
    assert!(larger != text && larger.contains("obstacle size times 2"), "{larger}");
    let (_, err) = place.expect(2, &[&generate[..], &["--size-factor", "100"]].concat());
    assert!(err.contains("must be a number from 0.1 to 10"), "{err}");
    let (_, err) = place.expect(2, &["scene", "generate", "closet.toml"]);
    assert!(err.contains("closet.toml:3:2: the family: unknown key `bounds`"), "{err}");
    place.expect(2, &[&generate[..], &["--out", "no/such/folder.toml"]].concat());
    let (_, err) = place.expect(2, &[&generate[..], &["--out", "./attics.toml"]].concat());
    assert!(err.contains("./attics.toml: is read by this run"), "{err}");
    assert_eq!(place.expect(0, &generate).0, text, "and it is as it was");
}

#[test]
fn a_floor_plan_and_a_map_become_scenes_that_are_valid() {
    let place = Place::new();
    let at = |name: &str| place.path().join(name);
    fs::create_dir(at("plans")).expect("made");
    fs::write(at("plans/flat.json"), "{\"verts\": [[0, 0], [5, 0], [5, 2], [2, 2], [2, 4], [0, 4]]}").expect("written");
    let pixels: Vec<u8> =
        (0..400).map(|k| if k % 20 == 0 || k % 20 == 19 || k / 20 == 0 || k / 20 == 19 { 0 } else { 254 }).collect();
    fs::write(at("m.pgm"), [b"P5\n20 20\n255\n".to_vec(), pixels].concat()).expect("written");
    let yaml = "image: /elsewhere/m.pgm\nresolution: 0.2\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
    fs::write(at("m.yaml"), yaml).expect("written");
    for (kind, source, scene, named) in [
        ("from-plan", "plans/flat.json", "flat.toml", "plans/flat.json"),
        ("from-map", "m.yaml", "plans/m.toml", "../m.yaml"),
    ] {
        let (text, _) = place.expect(0, &["scene", kind, source, "--out", scene]);
        assert!(text.contains("of the floor from at most 4 m away"), "{text}");
        let cells = if kind == "from-map" { "324 free, 76 occupied and 0 unknown cells\n" } else { " unknown cells\n" };
        assert!(text.contains(cells) && text.contains("of it with obstacles all round"), "{text}");
        let written = fs::read_to_string(at(scene)).expect("written");
        assert!(written.contains(&format!("file = \"{named}\"")), "{written}");
        assert!(place.expect(0, &["check", scene]).0.contains(": valid"));
    }
    let (printed, _) = place.expect(0, &["scene", "from-plan", "plans/flat.json"]);
    assert_eq!(printed, fs::read_to_string(at("flat.toml")).expect("written"), "for the folder one is in");
    for (args, message) in [
        (&["--out", "m.yaml"][..], "--out m.yaml: must be a file that ends in .toml"),
        (&["--radius", "3"], "m.yaml: a robot of radius 3 m with 0.05 m to spare fits nowhere"),
        (&["--start", "0.1,-1"], "m.yaml: start 0.1,-1: must lie in the largest space"),
        (&["--start", "x"], "must be two numbers in m, such as 1.5,-2"),
        (&["--clearance", "0"], "must be a number in m from 0.005 to 10"),
    ] {
        let (_, err) = place.expect(2, &[&["scene", "from-map", "m.yaml"][..], args].concat());
        assert!(err.contains(message), "{err}");
    }
    assert_eq!(fs::read_to_string(at("m.yaml")).expect("there"), yaml, "the map is as it was");
    // A rim of the shade that savers write for unknown cells, outside the walls.
    let rim = |k: usize| (k % 30).min(29 - k % 30).min((k / 30).min(29 - k / 30));
    let pixels: Vec<u8> = (0..900).map(|k| [205, 205, 205, 205, 205, 0].get(rim(k)).copied().unwrap_or(254)).collect();
    fs::write(at("m.pgm"), [b"P5\n30 30\n255\n".to_vec(), pixels].concat()).expect("written");
    fs::write(at("m.yaml"), yaml.replace("0.196", "0.25")).expect("written");
    let (_, err) = place.expect(0, &["scene", "from-map", "m.yaml", "--out", "leaky.toml"]);
    assert!(err.contains("warning: m.yaml:6:14: free_thresh = 0.25: 500 of 900 pixels"), "{err}");
    assert!(err.contains("warning: m.yaml: ") && err.contains("does the robot drive outside the building?"), "{err}");
    for command in ["check", "room"] {
        let args: &[&str] = if command == "room" { &["--scene", "leaky.toml", "--out", "o"] } else { &["leaky.toml"] };
        let (_, err) = place.expect(0, &[&[command], args].concat());
        assert!(
            err.contains("free_thresh = 0.25: 500 of 900 pixels") && err.contains("outside the building?"),
            "{err}"
        );
    }
    fs::write(at("m.yaml"), yaml).expect("written");
    assert_eq!(place.expect(0, &["scene", "from-map", "m.yaml", "--out", "closed.toml"]).1, "");
}

#[test]
fn check_reports_every_mistake_of_a_file_in_its_order() {
    let place = Place::new();
    let scene = r#"nam = "x"
[bounds]
min = [0.0, 0.0]
max = [4.0, 3.0]
[[box]]
center = [1.0]
size = [0.1, -1.0]
[[disc]]
center = [9.0, 1.0]
radius = 0.1
[waypoints]
A = [1.0, 1.0]
B = [30.0, 1.0]
[route]
stops = ["A", "B", "Z"]
[camera]
columns = 1.5
field_of_view = 70
[sensor]
correct_match = 1.2
persistence = 0.5
[robot]
radius = "0.2"
speed = 0
"#;
    fs::write(place.path().join("bad.toml"), scene).expect("writable");
    let (out, err) = place.expect(2, &["check", "bad"]);
    assert_eq!(out, "");
    insta::assert_snapshot!(err);
    let (_, one) = place.expect(2, &["room", "--scene", "bad"]);
    assert_eq!(one.lines().count(), 1, "other commands name the first: {one}");
    fs::write(place.path().join("family.toml"), FAMILY.replace("kind", "knd").replace("name = ", "name = 3 #"))
        .expect("writable");
    let (_, err) = place.expect(2, &["check", "family.toml"]);
    assert!(err.lines().count() >= 2 && err.contains(": name = 3"), "{err}");
}

#[test]
fn a_new_scene_is_valid_and_is_not_written_over() {
    let place = Place::new();
    place.expect(0, &["scene", "new", "my-room"]);
    let (out, err) = place.expect(0, &["check", "my-room", "--show"]);
    assert_eq!(err, "", "nothing is suspicious");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    assert!(out.lines().any(|line| line.starts_with('#') && line.contains("A.")), "{out}");
    fs::write(place.path().join("my-room.toml"), "mine").expect("writable");
    let (_, err) = place.expect(2, &["scene", "new", "my-room.toml"]);
    assert!(err.contains("my-room.toml"), "{err}");
    place.expect(0, &["scene", "new", "my-room.toml", "--force"]);
    for bad in ["a b", "x.json", "", "..", "sub/a b.toml", &"x".repeat(33)] {
        place.expect(2, &["scene", "new", bad]);
    }
}

#[test]
fn tables_are_sorted_by_a_column_and_another_is_refused_before_any_work() {
    let place = Place::new();
    let args = ["room", "--scene", "closet.toml", "--out", "o", "--mappers", "prior,visibility,conventional", "--sort"];
    let order = |column: &str| {
        let (out, _) = place.expect(0, &[&args[..], &[column]].concat());
        let first = out.split("\n\n").nth(1).expect("a table").lines().skip(3).map(str::to_owned);
        first.collect::<Vec<_>>()
    };
    let number = |line: &String| -> f64 {
        line.split_whitespace()
            .nth(1)
            .and_then(|cell| cell.trim_end_matches(['*', '=']).parse().ok())
            .expect("a number")
    };
    let losses: Vec<f64> = order("log loss").iter().map(number).collect();
    assert!(losses.len() == 3 && losses.is_sorted(), "{losses:?}");
    assert_eq!(order("log_loss"), order("Log-Loss"));
    assert!(order("log loss")[0].contains('*'), "the best has a mark");

    let (_, err) = place.expect(2, &["room", "--scene", "closet.toml", "--out", "new", "--sort", "los"]);
    assert!(err.starts_with("error: --sort los: must be a column of the tables printed: mapper, log loss,"), "{err}");
    assert!(!place.path().join("new").exists());

    let csv = |extra: &[&str]| place.expect(0, &[&args[..7], &["--format", "csv"], extra].concat()).0;
    let (plain, sorted) = (csv(&[]), csv(&["--sort", "value"]));
    assert!(!plain.contains(['*', '=']), "marks are for reading");
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<std::collections::BTreeSet<_>>();
    assert_eq!(lines(&plain), lines(&sorted));
    let values: Vec<f64> = sorted.lines().skip(1).filter_map(|line| line.split(',').nth(6)?.parse().ok()).collect();
    assert!(values.len() > 100 && values.is_sorted());

    let (names, _) = place.expect(0, &["list", "--format", "csv", "--sort", "name"]);
    let mappers: Vec<&str> = names.lines().filter(|line| line.starts_with("mapper,")).collect();
    assert!(mappers.len() > 20 && mappers.is_sorted());
    place.expect(2, &["list", "--sort", "age"]);
}

#[test]
fn quiet_leaves_warnings_and_errors_and_verbose_tells_the_files() {
    let place = Place::new();
    let args = ["room", "--scene", "closet.toml", "--out", "o"];
    let err = |extra: &[&str]| place.expect(0, &[&args[..], extra].concat()).1;
    assert_eq!(err(&["-q"]), "");
    let verbose = err(&["--verbose"]);
    for line in ["reads closet.toml", "writes o/metrics.csv", "writes o/run.json", " s in all"] {
        assert!(verbose.contains(line), "{line}: {verbose}");
    }
    assert!(!err(&[]).contains("writes"));
    let (_, err) = place.expect(2, &["--quiet", "room", "--scene", "no.toml"]);
    assert!(err.starts_with("error: no.toml"), "{err}");
    place.expect(2, &["room", "-q", "-v"]);
}

#[test]
fn a_page_is_shown_when_it_is_written_and_without_a_browser_a_note_says_where_it_is() {
    let place = Place::new();
    let run = |path: &Path| {
        let mut command = Command::cargo_bin("experiments").expect("built");
        let args = ["room", "--scene", "closet.toml", "--out", "o", "--open"];
        let out = command.current_dir(place.path()).env("PATH", path).args(args).output().expect("runs");
        checked(0, &args, &out).1
    };
    let empty = tempfile::tempdir().expect("a folder");
    let err = run(empty.path());
    assert!(err.contains("there is no such program; open o/report.html in a browser"), "{err}");
    place.expect(2, &["score", "o/visibility-end.npy", "--truth", "closet.toml", "--open"]);
}

/// What `--open` starts is told the page, by its whole path.
#[cfg(target_os = "linux")]
#[test]
fn the_browser_is_told_the_page() {
    use std::os::unix::fs::PermissionsExt as _;
    let place = Place::new();
    let bin = tempfile::tempdir().expect("a folder");
    let (browser, told) = (bin.path().join("xdg-open"), bin.path().join("told"));
    let script = format!("#!/bin/sh\necho \"$1\" > '{0}.part'\n/bin/mv '{0}.part' '{0}'\n", told.display());
    fs::write(&browser, script).expect("writable");
    fs::set_permissions(&browser, fs::Permissions::from_mode(0o755)).expect("ours");
    let mut command = Command::cargo_bin("experiments").expect("built");
    let args = ["room", "--scene", "closet.toml", "--out", "o", "--open", "--mappers", "prior"];
    let out = command.current_dir(place.path()).env("PATH", bin.path()).args(args).output().expect("runs");
    checked(0, &args, &out);
    while !told.exists() {
        std::thread::sleep(std::time::Duration::from_millis(10)); // the program does not wait for the browser
    }
    let page = fs::read_to_string(&told).expect("there");
    let expected = place.path().join("o/report.html").canonicalize().expect("written");
    assert_eq!(Path::new(page.trim_end()), expected);
}

#[test]
fn every_mistake_of_a_sweep_is_reported_by_check_and_where_it_is_read() {
    let place = Place::new();
    let sweep = r#"mapers = ["prior"]
families = ["clutter", "clutter"]
scene = "closet.toml"
regions = ["observable", "everywhere"]
[seeds]
count = 0
[set]
prior = 2.0
grid = 0.1
[vary]
grid = [0.1, -1.0, 0.1]
correlation = { from = 0.5, to = 0.1, steps = 4 }
[paired]
disparity_sigma = [0.5, 1.0]
believed_sigma = [0.5, 0.6, 0.7]
"#;
    fs::write(place.path().join("bad.toml"), sweep).expect("writable");
    let (_, checked) = place.expect(2, &["check", "bad"]);
    insta::assert_snapshot!(checked);
    assert_eq!(place.expect(2, &["sweep", "bad.toml", "--out", "o"]).1, checked);
    assert!(!place.path().join("o").exists());

    // What a sweep names is read too, and options that are about scenes are refused.
    let sweep = "mappers = [\"prior\"]\nscenes = [\"closet.toml\", \"no.toml\", \"none.toml\"]\n";
    fs::write(place.path().join("far.toml"), sweep).expect("writable");
    let (_, err) = place.expect(2, &["check", "far.toml"]);
    assert!(err.contains("error: no.toml: ") && err.contains("error: none.toml: "), "{err}");
    assert!(place.expect(2, &["check", "cell-size", "--show"]).1.contains("--show: is about scenes"));
    let (out, _) = place.expect(0, &["check", "cell-size"]);
    assert!(out.starts_with("experiments/sweeps/cell-size.toml: valid\n") && out.contains("\njobs "), "{out}");
}

#[test]
fn every_mistake_of_gates_is_reported_by_check_and_where_they_are_read() {
    let place = Place::new();
    let gates = r#"[[gate]]
name = "a"
mapper = "visibilty"
metric = "log_loss"
at_most = "much"
[[gate]]
name = "a"
mapper = "prior"
metric = "detour"
region = "observable"
better_than = "prior"
by = -1.0
seeds = 1
[[gate]]
nam = "c"
mapper = "prior"
metric = "brier"
scene = "no.toml"
set = "tuning"
"#;
    fs::write(place.path().join("bad.toml"), gates).expect("writable");
    let (_, checked) = place.expect(2, &["check", "bad"]);
    insta::assert_snapshot!(checked);
    assert_eq!(place.expect(2, &["gate", "--gates", "bad.toml"]).1, checked);
    let (out, _) = place.expect(0, &["check", "results/gates.toml"]);
    assert!(out.starts_with("results/gates.toml: valid\n") && out.contains("\ngates with a baseline "), "{out}");
}

#[test]
fn a_scene_is_drawn_into_a_file() {
    let place = Place::new();
    let (shown, _) = place.expect(0, &["check", "closet", "--show"]);
    let (_, err) = place.expect(0, &["check", "closet", "--out", "a.txt"]);
    assert_eq!(err, "a.txt\n");
    let drawn = fs::read_to_string(place.path().join("a.txt")).expect("there");
    assert!(drawn.contains('#') && shown.contains(&drawn), "{drawn}");
    place.expect(0, &["check", "closet", "--show", "--out", "a.png"]);
    place.expect(0, &["check", "closet", "--out", "a.svg"]);
    let read = |name: &str| fs::read(place.path().join(name)).expect("there");
    assert!(read("a.png").starts_with(b"\x89PNG") && read("a.svg").starts_with(b"<svg"));
    place.expect(0, &["room", "--scene", "closet", "--mappers", "prior", "--out", "o"]);
    assert_eq!(read("a.png"), read("o/scene.png"), "the picture of room");

    fs::write(place.path().join("mine.png"), "mine").expect("writable");
    let (_, err) = place.expect(2, &["check", "closet", "--out", "mine.png"]);
    assert!(err.contains("--force"), "{err}");
    place.expect(0, &["check", "closet", "--out", "mine.png", "--force"]);
    assert_eq!(read("mine.png"), read("a.png"));
    let (_, err) = place.expect(2, &["check", "closet", "--out", "a.gif"]);
    assert!(err.contains("must end in .png, .svg, or .txt"), "{err}");
    place.expect(2, &["check", "closet", "--out", "closet.toml"]);
}
