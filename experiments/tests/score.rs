//! `score` as a user meets it: the numbers of an oracle that knows nothing of ours, and what is refused.

use crate::closet;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use experiments::page::decoded;
use grid::{GridSpec, Raster, npy};
use proptest::prelude::*;
use serde_json::Value;
use tempfile::TempDir;

use crate::checked::checked;

struct Place(TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("temporary folder"))
    }

    fn path(&self) -> &Path {
        self.0.path()
    }

    fn put(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.path().join(name), bytes).expect("writable");
    }

    /// An array of shares, NaN for unknown.
    fn array(&self, name: &str, width: usize, shares: &[f32]) {
        let spec = GridSpec { cell_m: 1.0, origin_m: [0.0; 2], width, height: shares.len() / width };
        let mut bytes = Vec::new();
        npy::write(&Raster::new(spec, shares.to_vec()), &mut bytes).expect("memory");
        self.put(name, bytes);
    }

    fn expect(&self, code: i32, args: &[&str]) -> (String, String) {
        let mut command = Command::cargo_bin("experiments").expect("built");
        checked(code, &args, &command.current_dir(self.path()).args(args).output().expect("runs"))
    }

    fn rows(&self, args: &[&str]) -> Vec<Value> {
        let (out, _) = self.expect(0, &[&["score", "--format", "json"], args].concat());
        let json: Value = serde_json::from_str(&out).expect("JSON");
        assert_eq!(json["schema_version"], 1);
        json["rows"].as_array().expect("rows").clone()
    }

    fn value(&self, args: &[&str], metric: &str) -> f64 {
        let rows = self.rows(args);
        let row = rows.iter().find(|row| row["metric"] == metric).expect(metric);
        row["value"].as_f64().expect(metric)
    }

    fn refused(&self, args: &[&str], message: &str) {
        let (out, err) = self.expect(2, &[&["score"], args].concat());
        assert!(out.is_empty() && err.contains(message), "{args:?}: {err}");
    }
}

/// An NPY file in double precision, written by hand.
fn doubles(width: usize, shares: &[f64]) -> Vec<u8> {
    let head = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {width}), }}", shares.len() / width);
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{head:<117}\n").bytes());
    bytes.extend(shares.iter().flat_map(|share| share.to_le_bytes()));
    bytes
}

const AT: [&str; 4] = ["--resolution", "0.5", "--origin", "1,2,0"];

/// Every metric straight from its definition, in the order of the table: value and support.
fn oracle(cells: &[(f64, bool)], cell_area: f64) -> Vec<(&'static str, Option<f64>, usize)> {
    let n = cells.len();
    let count = |of: &dyn Fn(f64, bool) -> bool| cells.iter().filter(|(p, t)| of(*p, *t)).count();
    let share = |part: usize, of: usize| (of > 0).then(|| part as f64 / of as f64);
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        (n > 0).then(|| cells.iter().map(|(p, t)| of(*p, f64::from(u8::from(*t)))).sum::<f64>() / n as f64)
    };
    let (free, occupied) = (count(&|_, t| !t), count(&|_, t| t));
    let mut pairs = 0.0;
    for (p, _) in cells.iter().filter(|c| c.1) {
        for (q, _) in cells.iter().filter(|c| !c.1) {
            pairs += if (p - q).abs() < 1e-9 { 0.5 } else { f64::from(u8::from(p > q)) };
        }
    }
    // 15 bins of equal count; each cell with the mean outcome of those of its probability.
    let mut sorted: Vec<(f64, f64)> = cells
        .iter()
        .map(|(p, _)| {
            let tie: Vec<_> = cells.iter().filter(|c| (c.0 - p).abs() < 1e-9).collect();
            (*p, tie.iter().filter(|c| c.1).count() as f64 / tie.len() as f64)
        })
        .collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let bins = (0..15).map(|b| &sorted[b * n / 15..(b + 1) * n / 15]);
    let ece: f64 = bins.map(|bin| bin.iter().map(|(p, t)| p - t).sum::<f64>().abs()).sum();
    let held_free = count(&|p, _| p < 0.2);
    let decided_occupied = count(&|p, _| p > 0.8);
    let union = count(&|p, t| p > 0.5 || t);
    let phantom = count(&|p, t| !t && p > 0.5);
    let area = |part: usize, of: usize| (of > 0).then_some(part as f64 * cell_area);
    let loss = |p: f64, t: f64| -(if t > 0.5 { p } else { 1.0 - p }).clamp(1e-4, 1.0 - 1e-4).ln();
    vec![
        ("log_loss", mean(&loss), n),
        ("brier", mean(&|p, t| (p - t) * (p - t)), n),
        ("ece", (n > 0).then(|| ece / n as f64), n),
        ("auc", (free > 0 && occupied > 0).then(|| pairs / (free * occupied) as f64), n),
        ("iou", share(count(&|p, t| p > 0.5 && t), union), union),
        ("decided", share(held_free + decided_occupied, n), n),
        ("free_agreement", share(count(&|p, t| p < 0.2 && !t), held_free), held_free),
        ("occupied_agreement", share(count(&|p, t| p > 0.8 && t), decided_occupied), decided_occupied),
        ("phantom_area", area(phantom, free), free),
        ("missed_area", area(count(&|p, t| t && p < 0.2), occupied), occupied),
        ("free_known", share(count(&|p, t| !t && p < 0.2), free), free),
        ("free_lost", share(phantom, free), free),
        ("recall_50", share(count(&|p, t| t && p > 0.5), occupied), occupied),
        ("recall_65", share(count(&|p, t| t && p > 0.65), occupied), occupied),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn the_numbers_are_those_of_the_definitions(
        cells in prop::collection::vec((prop::option::weighted(0.8, 0_u8..=10), prop::option::weighted(0.9, any::<bool>())), 30),
        treatment in 0_usize..3,
    ) {
        prop_assume!(cells.iter().any(|cell| cell.1.is_some()));
        let place = Place::new();
        // 0.104 and 0.96 keep the array from being taken for states or shades.
        let share = |k: u8| f64::from(k) / 10.0 * 0.856 + 0.104;
        let map: Vec<f32> = cells.iter().map(|(p, _)| p.map_or(f32::NAN, |k| share(k) as f32)).collect();
        let truth: Vec<f32> = cells.iter().map(|(_, t)| t.map_or(f32::NAN, |t| f32::from(u8::from(t)))).collect();
        place.array("map.npy", 6, &map);
        place.array("truth.npy", 6, &truth);
        let unknown = ["prior", "skip", "occupied"][treatment];
        let counts_as = [Some(0.3), None, Some(1.0)][treatment];
        let judged: Vec<(f64, bool)> = cells.iter().filter_map(|(p, t)| Some((p.map(share).or(counts_as)?, (*t)?))).collect();
        let known = cells.iter().filter(|(p, t)| p.is_some() && t.is_some()).count();
        let all = cells.iter().filter(|(_, t)| t.is_some()).count();
        let rows = place.rows(&[&["map.npy", "--truth", "truth.npy", "--unknown", unknown, "--prior", "0.3", "--plan-pairs", "0"], &AT[..]].concat());
        let mut expected = oracle(&judged, 0.25);
        expected.push(("known", Some(known as f64 / all as f64), all));
        expected.push(("outside", Some(0.0), all));
        prop_assert_eq!(rows.len(), expected.len());
        for (row, (metric, value, support)) in rows.iter().zip(expected) {
            prop_assert_eq!((&row["map"], &row["region"], &row["metric"]), (&"map".into(), &"all".into(), &metric.into()));
            prop_assert_eq!(row["support"].as_u64(), Some(support as u64), "{}", metric);
            match (row["value"].as_f64(), value) {
                (Some(found), Some(value)) => prop_assert!((found - value).abs() <= 1e-5 * (1.0 + value.abs()), "{metric} {found} {value}"),
                (found, value) => prop_assert_eq!(found, value, "{}", metric),
            }
        }
    }
}

/// A world that is no mirror of itself, of 40 x 30 cells, and a map of it that errs here and there.
fn world(place: &Place) {
    let occupied = |x: usize, y: usize| {
        x < 1
            || y < 1
            || x > 38
            || y > 28
            || (5..12).contains(&x) && (6..20).contains(&y)
            || (20..33).contains(&x) && (4..9).contains(&y)
    };
    let truth: Vec<bool> = (0..1200).map(|k| occupied(k % 40, k / 40)).collect();
    place.array("truth.npy", 40, &truth.iter().map(|t| f32::from(u8::from(*t))).collect::<Vec<_>>());
    let map = |k: usize, sure: f32| match k % 11 {
        3 => f32::NAN,
        7 => 0.4,
        _ => {
            if truth[k] {
                sure
            } else {
                1.0 - sure
            }
        }
    };
    place.array("good.npy", 40, &(0..1200).map(|k| map(k, 0.97)).collect::<Vec<_>>());
    place.array("poor.npy", 40, &(0..1200).map(|k| map(k, 0.7)).collect::<Vec<_>>());
    place.put("run.json", r#"{"grid": {"cell_m": 0.1, "origin_m": [1.0, -2.0], "width": 40, "height": 30}}"#);
}

#[test]
fn the_terminal() {
    let place = Place::new();
    world(&place);
    let drives = ["--plan-unknown", "free"];
    let (out, err) =
        place.expect(0, &[&["score", "good.npy", "poor.npy", "--truth", "truth.npy"], &drives[..]].concat());
    assert_eq!(err, "", "all is well");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    insta::assert_snapshot!(out);
}

#[test]
fn the_truth_itself_scores_perfectly_and_the_order_of_files_does_not_matter() {
    let place = Place::new();
    world(&place);
    for (metric, expected) in
        [("brier", 0.0), ("ece", 0.0), ("auc", 1.0), ("iou", 1.0), ("phantom_area", 0.0), ("missed_area", 0.0)]
    {
        let found = place.value(&["truth.npy", "--truth", "truth.npy"], metric);
        assert!((found - expected).abs() < 1e-12, "{metric} {found}");
    }
    let of = |rows: Vec<Value>, map: &str| rows.into_iter().filter(|row| row["map"] == map).collect::<Vec<_>>();
    let one = place.rows(&["good.npy", "poor.npy", "--truth", "truth.npy"]);
    let other = place.rows(&["poor.npy", "good.npy", "--truth", "truth.npy"]);
    for map in ["good", "poor"] {
        assert_eq!(of(one.clone(), map), of(other.clone(), map));
    }
    // What knows nothing is the prior.
    place.array("nothing.npy", 40, &[f32::NAN; 1200]);
    place.array("prior.npy", 40, &[0.1; 1200]);
    let strip = |rows: Vec<Value>| {
        rows.into_iter().filter(|row| row["metric"] != "known").map(|row| row["value"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(
        strip(place.rows(&["nothing.npy", "--truth", "truth.npy", "--plan-unknown", "free"])),
        strip(place.rows(&["prior.npy", "--truth", "truth.npy"]))
    );
}

#[test]
fn a_map_in_other_cells_is_resampled_and_aligned() {
    let place = Place::new();
    world(&place);
    place.expect(0, &["convert", "truth.npy", "truth.yaml"]);
    let text = fs::read_to_string(place.path().join("truth.yaml")).expect("written");
    let line = text.lines().find(|line| line.starts_with("origin")).expect("origin").to_owned();
    // 0.37 cells and 1.5 degrees about the lower-left corner.
    place.put("off.yaml", text.replace(&line, "origin: [1.037, -2.037, 0.0261799]"));
    let rows = place.rows(&["off.yaml", "--truth", "truth.yaml", "--align", "rigid"]);
    let value = |metric: &str| {
        rows.iter().find(|row| row["metric"] == metric).and_then(|row| row["value"].as_f64()).expect(metric)
    };
    assert!((value("align_turn") + 1.5).abs() < 0.1, "{}", value("align_turn"));
    // About the truth's middle, (3, -0.5): where the map's own middle has come to, and back.
    let (sin, cos) = 0.026_179_9_f64.sin_cos();
    let middle = [1.037 + 2.0 * cos - 1.5 * sin, -2.037 + 2.0 * sin + 1.5 * cos];
    let moved = [middle[0] - 3.0, middle[1] + 0.5];
    let back = [-(cos * moved[0] + sin * moved[1]), -(-sin * moved[0] + cos * moved[1])];
    assert!(
        (value("align_x") - back[0]).abs() < 0.01 && (value("align_y") - back[1]).abs() < 0.01,
        "{rows:?} {back:?}"
    );
    assert!(value("iou") > 0.98 && value("unaligned_iou") < 0.97, "{rows:?}");
    let (out, _) = place.expect(0, &["score", "off.yaml", "--truth", "truth.yaml", "--align", "rigid"]);
    assert!(out.contains("its origin would be [") && out.lines().all(|line| line.chars().count() <= 80), "{out}");

    place.put("half.yaml", text.replace(&line, "origin: [1.05, -1.95, 0.0]"));
    let (_, err) = place.expect(0, &["score", "half.yaml", "--truth", "truth.yaml"]);
    assert!(err.starts_with("warning: half.yaml: lies half a cell off: moved by (-0.5"), "{err}");
    let (_, err) = place.expect(0, &["score", "truth.npy", "--truth", "truth.yaml", "--row-order", "top"]);
    assert!(err.starts_with("warning: truth.npy: agrees better with its rows in the other order"), "{err}");
    place.put("far.yaml", text.replace(&line, "origin: [1.3, -2.0, 0.0]"));
    let (_, err) =
        place.expect(0, &["score", "far.yaml", "--truth", "truth.yaml", "--align", "shift", "--align-bound", "0.2"]);
    assert!(err.contains("far.yaml: agrees best at the bound of 0.2 m; give more with --align-bound"), "{err}");
}

#[test]
fn what_is_refused() {
    let place = Place::new();
    world(&place);
    for (bad, shown) in [(f32::INFINITY, "inf"), (1.5, "1.5"), (-0.25, "-0.25")] {
        let mut shares = [0.3_f32; 1200];
        shares[2 * 40 + 7] = bad;
        place.array("bad.npy", 40, &shares);
        place.refused(
            &["bad.npy", "--truth", "truth.npy"],
            &format!("bad.npy: value [2, 7] = {shown}: must be from 0 to 1, or NaN"),
        );
        place.refused(&["good.npy", "--truth", "bad.npy"], "bad.npy: value [2, 7]");
    }
    fs::remove_file(place.path().join("run.json")).expect("there");
    place.refused(
        &["good.npy", "--truth", "truth.npy"],
        "truth.npy: has no resolution and origin; give --resolution M and --origin",
    );
    place.refused(&["good.npy", "--truth", "truth.npy", "--resolution", "0.1"], "must stand together");
    place.array("unknown.npy", 40, &[f32::NAN; 1200]);
    place.refused(&[&["good.npy", "--truth", "unknown.npy"], &AT[..]].concat(), "nothing to score");
    place.refused(
        &[&["good.npy", "good.npy", "--truth", "truth.npy"], &AT[..]].concat(),
        "good.npy: must be named once",
    );
    place.expect(0, &["convert", "truth.npy", "t.yaml", "--resolution", "0.1", "--origin", "0,0,0"]);
    place.expect(0, &["convert", "truth.npy", "far.yaml", "--resolution", "0.1", "--origin", "90,0,0"]);
    place.refused(
        &["far.yaml", "--truth", "t.yaml"],
        "far.yaml: covers 4 x 3 m from (90, 0) m, which holds no known cell of the truth",
    );
    place.refused(&["t.yaml", "--truth", "t.yaml", "--row-order", "top"], "--row-order: must stand with an .npy file");
    place.refused(&["t.yaml", "--truth", "t.yaml", "--grid", "0.2"], "--grid: must stand with a scene as the truth");
    place.array("small.npy", 20, &[0.3; 600]);
    place.refused(
        &["small.npy", "--truth", "t.yaml"],
        "small.npy: has no resolution and origin, and 20 x 30 cells where the truth has 40 x 30",
    );
    place.refused(&["t.pgm", "--truth", "absent.yaml"], "absent.yaml: cannot be read");
    for folder in ["f.npy", "f.yaml", "f.png"] {
        fs::create_dir(place.path().join(folder)).expect("made");
        place.refused(&[folder, "--truth", "t.yaml"], &format!("{folder}: is a folder; name the file of a map in it"));
        place.refused(&["t.yaml", "--truth", folder], &format!("{folder}: is a folder; name the file of a map in it"));
    }
    #[cfg(unix)]
    {
        let made = std::process::Command::new("mkfifo").arg(place.path().join("pipe.npy")).status().expect("mkfifo");
        assert!(made.success());
        place.refused(&["pipe.npy", "--truth", "t.yaml"], "pipe.npy: is a pipe or a device; save the map to a file");
    }
}

#[test]
fn a_folder_of_results_is_written_whole_and_replaces_nothing_of_others() {
    let place = Place::new();
    world(&place);
    let args = ["score", "good.npy", "poor.npy", "--truth", "truth.npy", "--out"];
    place.expect(0, &[&args[..], &["out"]].concat());
    let mut names: Vec<String> = fs::read_dir(place.path().join("out"))
        .expect("there")
        .map(|e| e.expect("entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    let expected =
        ["differences.csv", "errors.png", "metrics.csv", "reliability.png", "report.html", "run.json", "viewer.json"];
    assert_eq!(names, expected);
    let html = fs::read_to_string(place.path().join("out/report.html")).expect("text");
    let world = decoded(&html).expect("a page with a viewer").remove(0);
    assert_eq!(world.mappers.iter().map(|mapper| mapper.name.as_str()).collect::<Vec<_>>(), ["good", "poor"]);
    let loss = |mapper: usize| {
        let (map, truth) = (&world.mappers[mapper].maps[0], world.truth.as_ref().expect("known"));
        score::log_loss(map, truth, &truth.map(Option::is_some)).expect("probabilities").value
    };
    let table = fs::read_to_string(place.path().join("out/metrics.csv")).expect("text");
    for (number, name) in ["good", "poor"].into_iter().enumerate() {
        let row = table.lines().find_map(|row| row.strip_prefix(&format!("{name},all,log_loss,"))).expect("a row");
        let value: f64 = row.split(',').next().and_then(|value| value.parse().ok()).expect("a number");
        assert!(
            loss(number).is_some_and(|page| (page - value).abs() < 2e-3),
            "{name}: {:?} on the page, {value}",
            loss(number)
        );
    }
    let metrics = fs::read_to_string(place.path().join("out/metrics.csv")).expect("text");
    assert!(metrics.starts_with("map,region,metric,value,unit,support\ngood,all,log_loss,"), "{metrics}");
    place.expect(0, &[&args[..], &["out"]].concat());
    fs::create_dir(place.path().join("mine")).expect("made");
    place.put("mine/metrics.csv", "mine");
    place.refused(&[&args[1..], &["mine"]].concat(), "metrics.csv: was not written by an earlier `score`");
    assert_eq!(fs::read_to_string(place.path().join("mine/metrics.csv")).expect("there"), "mine");
    // run.json of the folder says where the arrays lie: it is not this command's.
    place.refused(&[&args[1..], &["."]].concat(), "run.json");
}

#[test]
fn a_room_is_scored_as_room_scores_it() {
    let place = Place::new();
    place.put("closet.toml", closet::SCENE);
    place.expect(0, &["room", "--scene", "closet.toml", "--mappers", "visibility", "--out", "room"]);
    let by_array = place.rows(&["room/visibility-end.npy", "--truth", "room/truth.npy"]);
    let by_scene = place.rows(&["room/visibility-end.npy", "--truth", "closet.toml"]);
    let driven = ["reached", "colliding", "detour", "footprint_reached", "footprint_colliding", "footprint_detour"];
    let is_driven = |row: &Value| driven.iter().any(|metric| row["metric"] == *metric);
    let (driven, by_scene): (Vec<Value>, Vec<Value>) = by_scene.into_iter().partition(is_driven);
    let all = |row: &Value| row["region"] == "all" && !is_driven(row);
    assert_eq!(
        by_array.into_iter().filter(all).collect::<Vec<_>>(),
        by_scene.into_iter().filter(all).collect::<Vec<_>>()
    );
    // Drives among the scene's obstacles are those of the room: the same pairs, plans and collisions.
    assert_eq!(driven.len(), 6);
    // A file holds no joint probabilities, of which the room's footprints are made.
    let by_cells =
        driven.into_iter().filter(|row| !row["metric"].as_str().is_some_and(|name| name.starts_with("footprint")));
    let csv = fs::read_to_string(place.path().join("room/metrics.csv")).expect("text");
    for row in by_cells {
        let begins = format!("closet,1,visibility,end,all,{},", row["metric"].as_str().expect("a name"));
        let of_room = csv.lines().find_map(|line| line.strip_prefix(&begins)).expect("a row");
        let fields: Vec<Option<f64>> = of_room.split(',').map(|field| field.parse().ok()).collect();
        assert_eq!([fields[0], fields[2]], [row["value"].as_f64(), row["support"].as_f64()], "{row}");
    }
}

#[test]
fn drives_are_planned_on_the_map_and_driven_in_the_truth() {
    let place = Place::new();
    world(&place);
    place.array("empty.npy", 40, &[0.104; 1200]);
    place.array("full.npy", 40, &[0.96; 1200]);
    let metrics = |map: &str, more: &[&str]| {
        let rows = place.rows(&[&[map, "--truth", "truth.npy"], more].concat());
        let of = |metric: &str| rows.iter().find(|row| row["metric"] == metric).expect("a row").clone();
        ["reached", "colliding", "detour"].map(|metric| (of(metric)["value"].as_f64(), of(metric)["support"].as_u64()))
    };
    let share = |value: f64| (Some(value), Some(200));
    assert_eq!(metrics("truth.npy", &[]), [share(1.0), share(0.0), share(1.0)]);
    assert_eq!(metrics("full.npy", &[]), [share(0.0), share(0.0), (None, Some(0))]);
    let [reached, colliding, _] = metrics("empty.npy", &[]).map(|(value, _)| value.expect("a value"));
    assert!(colliding > 0.2 && (reached + colliding - 1.0).abs() < 1e-9, "{reached} {colliding}");
    // Above every probability of the map nothing is an obstacle; a robot without room has no pairs.
    assert_eq!(metrics("full.npy", &["--plan-threshold", "0.97"])[..2], metrics("empty.npy", &[])[..2]);
    assert_eq!(metrics("truth.npy", &["--robot-radius", "1.6"]), [(None, Some(0)); 3]);
    assert_eq!(metrics("truth.npy", &["--plan-pairs", "15"])[0], (Some(1.0), Some(15)));
    // What it does not know a robot keeps off, or not.
    place.array("nothing.npy", 40, &[f32::NAN; 1200]);
    assert_eq!(metrics("nothing.npy", &[])[0], share(0.0));
    assert_eq!(metrics("nothing.npy", &["--plan-unknown", "free"]), metrics("empty.npy", &[]));
    let rows = place.rows(&["truth.npy", "--truth", "truth.npy", "--plan-pairs", "0"]);
    assert!(rows.iter().all(|row| row["metric"] != "reached"), "{rows:?}");
    place.refused(&["truth.npy", "--truth", "truth.npy", "--robot-radius", "0"], "from 0.001 to 1000");
    place.refused(&["truth.npy", "--truth", "truth.npy", "--plan-threshold", "1.5"], "from 0 to 1");
}

#[test]
fn with_scans_regions_are_those_of_the_room() {
    let place = Place::new();
    place.put("closet.toml", closet::SCENE);
    place.expect(0, &["room", "--scene", "closet.toml", "--mappers", "visibility", "--out", "room"]);
    let csv = fs::read_to_string(place.path().join("room/metrics.csv")).expect("text");
    let of_room = |region: &str, metric: &str| {
        let row = csv.lines().find(|line| line.contains(&format!(",{region},{metric},"))).expect("a row");
        let fields: Vec<f64> = row.split(',').skip(6).filter_map(|field| field.parse().ok()).collect();
        [fields[0], fields[fields.len() - 1]]
    };
    let scans = ["--scans", "room/scans.csv"];
    let by_scene = place.rows(&[&["room/visibility-end.npy", "--truth", "closet.toml"], &scans[..]].concat());
    let by_cells = place.rows(&[&["room/visibility-end.npy", "--truth", "room/truth.npy"], &scans[..]].concat());
    let of = |rows: &[Value], region: &str, metric: &str| {
        let row = rows.iter().find(|row| row["region"] == region && row["metric"] == metric).expect("a row");
        [row["value"].as_f64().expect("a value"), row["support"].as_f64().expect("a support")]
    };
    for (region, metric) in [("observable", "log_loss"), ("observable", "brier"), ("surface", "missed_area")] {
        let [value, support] = of_room(region, metric);
        // Poses of the table have six digits.
        let [found, cells] = of(&by_scene, region, metric);
        assert!((found - value).abs() < 0.01 * (0.01 + value) && (cells - support).abs() <= 2.0, "{region} {metric}");
        // Walls of cells cover more than walls.
        let [_, cells] = of(&by_cells, region, metric);
        assert!((cells - support).abs() < 0.1 * support, "{region} {metric}: {cells}, not {support}");
    }
    place.refused(&["room/truth.npy", "--truth", "room/truth.npy", "--scans", "absent.csv"], "absent.csv");
}

/// A corridor of 24 x 3 cells of half a metre with a wall at its right end, and one beam along it from (0.25, 0.75) m.
fn corridor(place: &Place) -> Vec<&'static str> {
    let truth: Vec<f32> = (0..72).map(|k| if k % 24 == 23 { 1.0 } else { 0.0 }).collect();
    place.array("truth.npy", 24, &truth);
    place.put("run.json", r#"{"grid": {"cell_m": 0.5, "origin_m": [0.0, 0.0], "width": 24, "height": 3}}"#);
    place.put(
        "scans.csv",
        "scan,time_s,x_m,y_m,theta_rad,bearing_rad,range_m\n0,0,0.25,0.75,0,0,11\n0,0,0.25,0.75,0,0,11\n",
    );
    let map = |of: fn(usize) -> f32| (0..72).map(of).collect::<Vec<f32>>();
    place.array("map.npy", 24, &map(|k| 0.1 + 0.035 * (k % 24) as f32));
    place.array("part.npy", 24, &map(|k| if k % 24 > 5 && k % 24 != 23 { f32::NAN } else { 0.37 }));
    vec!["--truth", "truth.npy", "--scans", "scans.csv"]
}

#[test]
fn error_against_range_is_that_of_the_cells_that_the_beam_entered_there() {
    let place = Place::new();
    let given = corridor(&place);
    // The beam enters cell k of the middle row at 0.5 k - 0.25 m, the first one at 0 m, and hits the wall, cell 23, at 11.25 m.
    let entered = |k: usize| if k == 0 { 0.0 } else { 0.5 * k as f64 - 0.25 };
    let loss = |k: usize, p: f64| -(if k == 23 { p } else { 1.0 - p }).ln();
    let edges = [0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, f64::INFINITY];
    let expected = |losses: &dyn Fn(usize) -> Option<f64>| -> Vec<(String, f64, u64)> {
        let bins = edges.windows(2).filter_map(|edge| {
            let inside: Vec<f64> =
                (0..24).filter(|k| (edge[0]..edge[1]).contains(&entered(*k))).filter_map(losses).collect();
            let to = if edge[1].is_finite() { edge[1].to_string() } else { String::new() };
            let mean = inside.iter().sum::<f64>() / inside.len() as f64;
            (!inside.is_empty()).then(|| (format!("range {}-{to}", edge[0]), mean, inside.len() as u64))
        });
        bins.collect()
    };
    let check = |map: &str, more: &[&str], losses: &dyn Fn(usize) -> Option<f64>| {
        let rows = place.rows(&[&[map], &given[..], more].concat());
        let of_range = |row: &&Value| {
            row["region"].as_str().is_some_and(|r| r.starts_with("range")) && row["metric"] == "log_loss"
        };
        let found: Vec<_> = rows.iter().filter(of_range).collect();
        let expected = expected(losses);
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (row, (region, mean, cells)) in found.iter().zip(&expected) {
            assert_eq!((&row["region"], row["support"].as_u64()), (&region.as_str().into(), Some(*cells)));
            let value = row["value"].as_f64().expect("a value");
            assert!((value - mean).abs() < 1e-5 * mean, "{region} {value} {mean}");
        }
        let looks: Vec<_> =
            rows.iter().filter(|row| row["region"] == "looks 2-4" && row["metric"] == "log_loss").collect();
        assert_eq!(looks[0]["support"].as_u64(), Some(expected.iter().map(|bin| bin.2).sum()), "two beams each");
    };
    check("map.npy", &[], &|k| Some(loss(k, 0.1 + 0.035 * k as f64)));
    let known = |k: usize| k <= 5 || k == 23;
    check("part.npy", &["--prior", "0.2"], &|k| Some(loss(k, if known(k) { 0.37 } else { 0.2 })));
    check("part.npy", &["--unknown", "skip"], &|k| known(k).then(|| loss(k, 0.37)));
    let without = place.rows(&["map.npy", "--truth", "truth.npy"]);
    assert!(without.iter().all(|row| row["region"] == "all"), "without scans nobody knows from where cells were seen");
}

#[test]
fn the_page_is_laid_anew_from_the_folder_alone() {
    let place = Place::new();
    let given = corridor(&place);
    let run = |maps: &[&str], more: &[&str]| {
        place.expect(0, &[&["score"], maps, &["--truth", "truth.npy", "--out", "out"], more].concat());
    };
    let read = |name: &str| fs::read(place.path().join(name)).expect("there");
    for (maps, more) in [(&["map.npy", "part.npy"][..], &given[2..]), (&["map.npy"], &given[2..]), (&["map.npy"], &[])]
    {
        run(maps, more);
        let [page, record] = ["out/report.html", "out/run.json"].map(read);
        fs::remove_file(place.path().join("out/report.html")).expect("there");
        fs::rename(place.path().join("map.npy"), place.path().join("away.npy")).expect("there");
        place.expect(0, &["report", "out"]);
        assert_eq!((read("out/report.html"), read("out/run.json")), (page.clone(), record));
        place.expect(0, &["report", "out", "--out", "page.html", "--force"]);
        assert_eq!(read("page.html"), page);
        fs::rename(place.path().join("away.npy"), place.path().join("map.npy")).expect("there");
    }
    run(&["map.npy"], &given[2..]);
    let table = String::from_utf8(read("out/profiles.csv")).expect("text");
    assert!(table.starts_with("map,covariate,from,to,cells,log_loss,brier\nmap,range_m,0.0,0.25,1,"), "{table}");
    assert_eq!(table.lines().count(), 1 + 10 + 11, "all bins");
    assert!(String::from_utf8(read("out/report.html")).expect("text").contains("Log loss by the range from which"));
    fs::write(place.path().join("out/profiles.csv"), table.replace("0.25,1,", "0.25,2,")).expect("writable");
    let (out, err) = place.expect(2, &["report", "out"]);
    assert!(out.is_empty() && err.contains("profiles.csv: has changed since the run that wrote it"), "{err}");
}

#[test]
fn arrays_in_double_precision_are_scored_as_they_are() {
    let place = Place::new();
    place.array("truth.npy", 2, &[1.0, 0.0]);
    // Rounded to single precision, the first is 2e-4 above itself relative to what it lacks of one, and the others tie.
    let sure = 1.0 - 1.23456e-4;
    place.put("map.npy", doubles(2, &[sure, 0.25]));
    let args = [&["map.npy", "--truth", "truth.npy"], &AT[..]].concat();
    let expected = (-sure.ln() - 0.75_f64.ln()) / 2.0;
    let squares = ((1.0 - sure) * (1.0 - sure) + 0.0625) / 2.0;
    assert!((place.value(&args, "log_loss") - expected).abs() < 1e-6);
    assert!((place.value(&args, "brier") - squares).abs() < 1e-7);
    place.put("map.npy", doubles(2, &[0.5 + 5e-9, 0.5]));
    assert!((place.value(&args, "auc") - 1.0).abs() < 1e-12, "the two differ by less than single precision can tell");
    place.put("map.npy", doubles(2, &[0.19999999999, 0.2]));
    assert!((place.value(&args, "missed_area") - 0.25).abs() < 1e-12, "below the threshold");
}

#[test]
fn what_is_suspicious_is_warned_of() {
    let place = Place::new();
    world(&place);
    place.array("blank.npy", 40, &[f32::NAN; 1200]);
    let (_, err) = place.expect(0, &["score", "blank.npy", "--truth", "truth.npy"]);
    assert!(err.starts_with("warning: blank.npy: knows nothing of any cell of the truth"), "{err}");
    for (order, remedy) in [(&[][..], "with --row-order top"), (&["--row-order", "bottom"], "with --row-order top")] {
        let picture: Vec<f32> = (0..1200).map(|k| if (39 - k % 40) > 30 || k / 40 < 10 { 0.9 } else { 0.1 }).collect();
        let upwards: Vec<f32> = picture.chunks(40).rev().flatten().map(|p| f32::from(u8::from(*p > 0.5))).collect();
        place.array("up.npy", 40, &upwards);
        place.array("picture.npy", 40, &picture);
        let (_, err) = place.expect(0, &[&["score", "picture.npy", "--truth", "up.npy"], order].concat());
        assert!(
            err.contains("picture.npy: agrees better with its rows in the other order") && err.contains(remedy),
            "{err}"
        );
        let top = place.expect(0, &["score", "picture.npy", "--truth", "up.npy", "--row-order", "top"]);
        assert_eq!(top.1, "", "the remedy is one");
    }
}
