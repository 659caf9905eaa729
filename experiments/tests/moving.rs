//! Worlds that move, as the commands meet them.

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

use experiments::page::{DecodedWorld, decoded};
use score::{MovingRegion, Region, Scorer};

use crate::checked::checked;
use crate::closet::SCENE;
use crate::nook::FAMILY;

/// Somebody who walks along the far wall, a chair that is put elsewhere and a door that opens.
const THINGS: &str = r#"
[[mover]]
radius = 0.15
route = [[0.7, 1.65], [2.4, 1.65]]
speed_m_s = 0.4
repeat = "back_and_forth"
[[chair]]
center = [1.3, 0.4]
size = [0.3, 0.3]
moves = [{ at_s = 5.0, to_m = [0.9, 0.4] }]
[[door]]
hinge = [2.85, 0.3]
length = 0.4
closed_deg = 90.0
open_deg = 170.0
open_s = [[4.0, 1000.0]]
[[stage]]
name = "there"
after = ["A", "B"]
[[stage]]
name = "back"
after = ["A", "B", "A"]
"#;

fn put_scenes(folder: &Path) {
    fs::write(folder.join("moving.toml"), format!("{SCENE}{THINGS}")).expect("writable");
    fs::write(folder.join("still.toml"), SCENE).expect("writable");
    fs::write(folder.join("nook.toml"), FAMILY).expect("writable");
}

fn run(folder: &Path, code: i32, args: &[&str]) -> (String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    checked(code, &args, &command.current_dir(folder).args(args).output().expect("runs"))
}

/// Value and support by seed, mapper, stage, region and metric.
type Metrics = HashMap<[String; 5], (Option<f64>, usize)>;

fn metrics(path: &Path) -> Metrics {
    let mut reader = csv::Reader::from_path(path).expect("readable");
    let row = |row: csv::StringRecord| {
        let key = [1, 2, 3, 4, 5].map(|column| row[column].to_owned());
        (key, (row[6].parse().ok(), row[8].parse().expect("a number")))
    };
    reader.records().map(|record| row(record.expect("a row"))).collect()
}

fn of(metrics: &Metrics, key: [&str; 5]) -> (Option<f64>, usize) {
    metrics[&key.map(str::to_owned)]
}

const MAPPERS: [&str; 4] = ["visibility", "prior", "perfect", "mrf"];

#[test]
fn room_scores_what_moves_against_the_truth_of_the_moment() {
    let folder = tempfile::tempdir().expect("temporary folder");
    put_scenes(folder.path());
    let mappers = MAPPERS.join(",");
    let args = ["room", "--scene", "moving.toml", "--mappers", &mappers, "--seeds", "2", "--out"];
    let (out, _) = run(folder.path(), 0, &[&args[..], &["one", "--threads", "1"]].concat());
    assert!(out.contains("what has moved"), "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    let found = metrics(&folder.path().join("one/metrics.csv"));
    for (seed, mapper, stage) in ["1", "2"]
        .into_iter()
        .flat_map(|seed| MAPPERS.map(|mapper| (seed, mapper)))
        .flat_map(|(seed, mapper)| ["there", "back"].map(|stage| (seed, mapper, stage)))
    {
        let of = |region, metric| of(&found, [seed, mapper, stage, region, metric]);
        // Courses and looks are the same for every seed and mapper, and so are the cells.
        for region in ["static", "swept", "occupied-now", "changed"] {
            let cells = of(region, "log_loss").1;
            assert_eq!(cells, self::of(&found, ["1", "prior", stage, region, "log_loss"]).1, "{region}");
            assert!(cells > 0 || (region, stage) == ("changed", "there"), "{region} at {stage}");
        }
        assert_eq!(of("occupied-now", "phantom_area").1, 0, "nothing is free where something stands");
        assert_eq!(of("swept", "phantom_area"), of("swept", "trail_area"), "and all where it is no more");
        let ([s, d], cells) = (
            [of("static", "static_accuracy"), of("swept", "dynamic_accuracy")].map(|metric| metric.0.expect("cells")),
            of("static", "static_accuracy").1 + of("swept", "dynamic_accuracy").1,
        );
        let (harmonic, support) = of("swept", "harmonic_accuracy");
        assert!((harmonic.expect("cells") - 2.0 * s * d / (s + d)).abs() < 1e-5 && support == cells);
        assert!(of("changed", "ghost_area").0 <= of("changed", "phantom_area").0);
        let changes = of("changed", "lag_looks");
        assert_eq!(changes.0.is_some(), changes.1 > 0);
        assert!(changes.1 == 0 || mapper != "mrf", "a lag of {mapper}, which has no map after most scans");
        assert!(changes.1 > 0 || mapper == "mrf" || stage == "there", "{mapper}");
        if mapper == "prior" {
            // What says nothing of anything has no trail, and is right of every free cell.
            assert_eq!((of("swept", "trail_area").0, d), (Some(0.0), 1.0));
            let (free, all) = (of("static", "phantom_area").1, of("static", "log_loss").1);
            assert!((s - free as f64 / all as f64).abs() < 1e-5);
        }
    }
    run(folder.path(), 0, &[&args[..], &["other", "--threads", "2"]].concat());
    for file in ["metrics.csv", "timeline.csv", "scans.csv", "truth.npy", "maps.png", "movement.png"] {
        let [one, other] =
            ["one", "other"].map(|name| fs::read(folder.path().join(name).join(file)).expect("readable"));
        assert!(one == other, "{file} depends on the number of threads");
    }
    let html = fs::read_to_string(folder.path().join("one/report.html")).expect("readable");
    the_page_has(&decoded(&html).expect("a page with a viewer").remove(0), &found);
    // The page is made anew from what the folder holds.
    run(folder.path(), 0, &["report", "one", "--out", "again.html"]);
}

/// At the end of every stage the page has the truth of that moment, and maps with the metrics of the table.
fn the_page_has(world: &DecodedWorld, metrics: &Metrics) {
    assert_eq!(world.truths.len(), world.moments.len());
    assert_eq!(world.truths.last(), world.truth.as_ref(), "in the end");
    assert!(world.truths.windows(2).any(|pair| pair[0] != pair[1]), "something moves");
    assert_eq!(world.moving.len(), world.moments.len());
    for (stage, moment) in &world.stages {
        let truth = &world.truths[*moment];
        let part = |wanted: &[Region]| {
            let inside = |part: &Option<Region>| part.is_some_and(|part| wanted.contains(&part));
            world.parts[*moment].map(inside)
        };
        let (surface, observable) = (part(&[Region::Surface]), part(&[Region::Visible, Region::Surface]));
        let scorer = Scorer::new(truth, &surface).expect("one grid");
        for mapper in &world.mappers {
            let place = mapper.moments.iter().position(|at| at == moment).expect("a map at the end of a stage");
            let scores = scorer.scores(&mapper.maps[place], &observable).expect("probabilities");
            for (metric, bound) in [(scores.log_loss, 1e-3), (scores.phantom_area, 1e-5), (scores.missed_area, 1e-5)] {
                let (value, support) = of(metrics, ["1", &mapper.name, stage, "observable", metric.name]);
                assert_eq!(metric.support, support, "{} {stage} {}", mapper.name, metric.name);
                let off = metric.value.zip(value).map_or(f64::INFINITY, |(page, table)| (page - table).abs());
                assert!(off <= bound, "{} {stage} {}: {off}", mapper.name, metric.name);
            }
            for (bit, region) in MovingRegion::ALL.iter().enumerate() {
                let mask = world.moving[*moment].map(|bits| bits >> bit & 1 == 1);
                let scores = scorer.scores(&mapper.maps[place], &mask).expect("probabilities");
                for metric in [scores.log_loss, scores.phantom_area] {
                    let (value, support) = of(metrics, ["1", &mapper.name, stage, region.name(), metric.name]);
                    assert_eq!(metric.support, support, "{} {stage} {region:?} {}", mapper.name, metric.name);
                    let off = metric.value.zip(value).map_or(0.0, |(page, table)| (page - table).abs());
                    assert!(off <= 1e-3 * value.unwrap_or(1.0).max(1.0), "{} {stage} {region:?}: {off}", mapper.name);
                }
                // What the page has between stages too, from sums and not from levels.
                // A batch mapper has no history there.
                for metric in ["log_loss", "retention"].into_iter().filter(|m| *m == "log_loss" || mapper.name != "mrf")
                {
                    let page = mapper.exact[&(region.name().to_owned(), metric.to_owned())][place];
                    let table = of(metrics, ["1", &mapper.name, stage, region.name(), metric]).0;
                    let agrees =
                        page.zip(table).map_or(page.is_none() == table.is_none(), |(a, b)| (a - b).abs() <= 1e-5);
                    assert!(agrees, "{} {stage} {region:?} {metric}: {page:?} {table:?}", mapper.name);
                }
            }
        }
    }
}

#[test]
fn a_world_at_rest_has_no_rows_of_worlds_that_move() {
    let folder = tempfile::tempdir().expect("temporary folder");
    put_scenes(folder.path());
    let (out, _) = run(folder.path(), 0, &["room", "--scene", "still.toml", "--mappers", "visibility", "--out", "o"]);
    assert!(!out.contains("what has moved"), "{out}");
    let found = metrics(&folder.path().join("o/metrics.csv"));
    assert!(found.keys().all(|key| !["static", "swept", "occupied-now", "changed"].contains(&key[3].as_str())));
    let html = fs::read_to_string(folder.path().join("o/report.html")).expect("readable");
    let world = decoded(&html).expect("a page with a viewer").remove(0);
    assert!(world.truths.is_empty() && world.moving.is_empty());
    assert!(!folder.path().join("o/movement.png").exists());
}

fn gate(metric: &str, more: &str) -> String {
    format!("[[gate]]\nname = \"g\"\nmapper = \"visibility\"\nmetric = \"{metric}\"\nseeds = 1\n{more}\n")
}

#[test]
fn gates_bound_every_metric_of_what_moves() {
    let folder = tempfile::tempdir().expect("temporary folder");
    put_scenes(folder.path());
    let judged = |code, text: String| {
        fs::write(folder.path().join("gates.toml"), text).expect("writable");
        run(folder.path(), code, &["gate", "--gates", "gates.toml"])
    };
    for metric in [
        "static_accuracy",
        "dynamic_accuracy",
        "harmonic_accuracy",
        "trail_area",
        "ghost_area",
        "lag_looks",
        "lag_open",
        "followed_3",
        "cleared_3",
    ] {
        judged(0, gate(metric, "scene = \"moving.toml\"\nat_least = 0.0"));
        let (out, _) = judged(3, gate(metric, "scene = \"moving.toml\"\nat_least = 11.0"));
        assert!(out.contains("FAIL g"), "{out}");
    }
    judged(0, gate("log_loss", "scene = \"moving.toml\"\nregion = \"occupied-now\"\nat_most = 9.3"));
    // What does not go together is refused where it stands.
    for (metric, more, said) in [
        (
            "trail_area",
            "scene = \"still.toml\"\nat_most = 1.0",
            "gates.toml:4:10: gate 1: metric = \"trail_area\": must be a metric of worlds at rest",
        ),
        ("trail_area", "families = [\"nook.toml\"]\nat_most = 1.0", "gates.toml:4:10"),
        ("trail_area", "scene = \"moving.toml\"\nregion = \"static\"\nat_most = 1.0", "which is of that region alone"),
        ("log_loss", "scene = \"still.toml\"\nregion = \"swept\"\nat_most = 1.0", "gates.toml:7:10"),
    ] {
        let (_, err) = judged(2, gate(metric, more));
        assert!(err.contains(said), "{err}");
    }
}

#[test]
fn sweeps_have_the_metrics_of_worlds_that_move_where_they_ask_for_such_regions() {
    let folder = tempfile::tempdir().expect("temporary folder");
    put_scenes(folder.path());
    let swept = |regions: &str, out: &str| {
        let text = format!(
            "families = [\"nook.toml\"]\nmappers = [\"visibility\"]\nregions = [{regions}]\n[vary]\npeople_per_100_m2 = [8.0, 16.0]\npeople_speed_m_s = [0.4]\n"
        );
        fs::write(folder.path().join("sweep.toml"), text).expect("writable");
        run(folder.path(), 0, &["sweep", "sweep.toml", "--out", out]);
        fs::read_to_string(folder.path().join(out).join("table.csv")).expect("readable")
    };
    let plain = swept("\"observable\"", "plain");
    assert!(!plain.contains("trail_area"), "{plain}");
    let table = swept("\"observable\", \"static\", \"swept\", \"changed\"", "moving");
    let mut reader = csv::Reader::from_reader(table.as_bytes());
    let heads = reader.headers().expect("a head").clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap_or_else(|| panic!("{name}: {heads:?}"));
    let (region, trail, lag, error) = (column("region"), column("trail_area"), column("lag_looks"), column("error"));
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.len(), 2 * 4, "{table}");
    for row in &rows {
        assert_eq!(
            (!row[trail].is_empty(), !row[lag].is_empty()),
            (&row[region] == "swept", &row[region] == "changed"),
            "{row:?}"
        );
        assert_eq!(&row[error], "");
    }
}

#[test]
fn compare_judges_what_moves_under_the_condition_people() {
    let folder = tempfile::tempdir().expect("temporary folder");
    put_scenes(folder.path());
    let common = [
        "compare",
        "--families",
        "nook.toml",
        "--seeds",
        "2",
        "--mappers",
        "visibility,prior",
        "--conditions",
        "people",
        "--out",
        "o",
    ];
    let (_, err) = run(folder.path(), 2, &common);
    assert!(
        err.contains("--conditions people: worlds of the test set are as the mappers believe; add --set robustness"),
        "{err}"
    );
    let (out, _) = run(folder.path(), 0, &[&common[..], &["--set", "robustness"]].concat());
    assert!(out.contains("What has moved"), "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    let read = |name: &str| fs::read_to_string(folder.path().join("o").join(name)).expect("readable");
    let summary = read("summary.csv");
    for row in [
        "all,swept,visibility,trail_area,m²,2,",
        "all,static,prior,static_accuracy,1,2,",
        "all,changed,visibility,lag_looks,looks,2,",
    ] {
        assert!(summary.contains(row), "{row}: {summary}");
    }
    assert!(read("scores-prior.csv").lines().any(|line| line.starts_with("people,nook,20001,prior,occupied-now,")));
    assert!(read("summary.md").contains("## What becomes of what moves"));
    // Beside the same worlds at rest, on the same cells.
    assert!(out.contains("Static accuracy among people and in the same worlds at rest"), "{out}");
    let rested = read("at-rest.csv");
    let mut reader = csv::Reader::from_reader(rested.as_bytes());
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    assert_eq!(rows.iter().map(|row| &row[0]).collect::<Vec<_>>(), ["visibility", "prior"]);
    for row in &rows {
        let [moving, rest, less, low, high] = [2, 3, 4, 5, 6].map(|k| row[k].parse::<f64>().expect("a number"));
        assert!((less - 100.0 * (rest - moving)).abs() < 1e-3 && low <= less && less <= high, "{row:?}");
        // The prior says the same of every cell, whoever walks by.
        assert!(&row[0] != "prior" || less.abs() < 1e-9, "{row:?}");
        assert!(less.abs() < 5.0, "{row:?}");
    }
    run(folder.path(), 0, &["report", "o", "--out", "again.html"]);
}

#[test]
fn score_says_that_a_truth_which_moves_is_taken_at_rest() {
    let folder = tempfile::tempdir().expect("temporary folder");
    put_scenes(folder.path());
    run(folder.path(), 0, &["room", "--scene", "moving.toml", "--mappers", "visibility", "--out", "o"]);
    let (_, err) = run(folder.path(), 0, &["score", "o/visibility-back.npy", "--truth", "moving.toml"]);
    assert!(err.contains("moving.toml: things move in it"), "{err}");
}
