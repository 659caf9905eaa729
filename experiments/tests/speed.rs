//! `speed` as a user meets it: its forms, the cells that it counts, and files that it refuses. Nothing here depends on
//! how fast anything is.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use experiments::commands::speed::file;
use experiments::commands::speed::growth::{self, Against, Sizes};
use experiments::commands::speed::scans::{Kernel, ScanSet};
use mapper::catalogue::find;
use serde_json::{Value, json};
use tempfile::TempDir;

use crate::checked::checked;

const HEAD: &str = "scan,x_m,y_m,theta_rad,bearing_rad,range_m\n";

/// Two scans, with rays that have no reading: no range, too near, and behind the camera.
const SCANS: &str = "scan,x_m,y_m,theta_rad,bearing_rad,range_m
0,0.3,0.4,0.1,-0.5,1.37
0,0.3,0.4,0.1,0.0,2.2
0,0.3,0.4,0.1,0.3,
0,0.3,0.4,0.1,0.5,3.71
3,0.93,1.12,-2.0,-0.4,0.1
3,0.93,1.12,-2.0,0.2,0.83
3,0.93,1.12,-2.0,3.0,1.0
3,0.93,1.12,-2.0,0.6,2.46
";

fn speed(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("experiments").expect("built");
    command.current_dir(folder).arg("speed").args(arguments).output().expect("starts")
}

/// A folder with a file of scans.
fn with(text: &str) -> TempDir {
    let folder = TempDir::new().expect("temporary folder");
    fs::write(folder.path().join("scans.csv"), text).expect("writable");
    folder
}

fn json(folder: &Path, arguments: &[&str]) -> Value {
    let (out, _) = checked(0, &arguments, &speed(folder, arguments));
    serde_json::from_str(&out).expect("JSON")
}

/// Cells from the sensor to the end of a ray, by the grid lines between them: one more than there are.
fn crossed(origin: [f64; 2], end: [f64; 2], low: [f64; 2], cell_m: f64) -> u64 {
    let line = |v: f64, k: usize| ((v - low[k]) / cell_m).floor();
    1 + (0..2).map(|k| (line(end[k], k) - line(origin[k], k)).abs() as u64).sum::<u64>()
}

#[test]
fn cells_visited_are_those_of_a_count_by_hand() {
    let rows: Vec<Vec<f64>> = SCANS
        .lines()
        .skip(1)
        .filter(|line| !line.ends_with(','))
        .map(|line| line.split(',').map(|field| field.parse().expect("number")).collect())
        .collect();
    let end = |row: &[f64]| [row[1] + row[5] * (row[3] + row[4]).cos(), row[2] + row[5] * (row[3] + row[4]).sin()];
    let all = || rows.iter().flat_map(|row| [[row[1], row[2]], end(row)]);
    let low = [0, 1].map(|k| all().map(|point| point[k]).fold(f64::INFINITY, f64::min) - 1.0);
    let seen = || rows.iter().filter(|row| (0.25..f64::INFINITY).contains(&(row[5] * row[4].cos())));
    let folder = with(SCANS);
    for cell_m in [0.05, 0.07, 0.3] {
        let expected: u64 = seen().map(|row| crossed([row[1], row[2]], end(row), low, cell_m)).sum();
        let text = cell_m.to_string();
        let arguments = ["--scans", "scans.csv", "--grid", &text, "--repeats", "2", "--format", "json"];
        let found = json(folder.path(), &arguments);
        for row in found["rows"].as_array().expect("rows") {
            assert_eq!(row["cells_visited"], expected, "{cell_m}: {row}");
            assert_eq!((&row["rays"], &row["scans"]), (&json!(5), &json!(2)));
            let updated = row["cells_updated"].as_u64().expect("all of these count");
            let exact = row["mapper"].as_str().is_some_and(|name| name.starts_with("log-odds"));
            // A range that ends on a grid line, as the farthest do, may end on either side of it.
            assert!(updated + 1 >= expected && (!exact || updated <= expected + 1), "{row}");
        }
    }
}

#[test]
fn every_form_has_the_same_rows() {
    let folder = with(SCANS);
    let base =
        ["--scans", "scans.csv", "--grid", "0.1", "--repeats", "1", "--mappers", "conventional,prior", "--format"];
    let form = |name: &'static str| [&base[..], &[name]].concat();
    let found = json(folder.path(), &form("json"));
    assert_eq!(found["schema_version"], 1);
    let rows = found["rows"].as_array().expect("rows");
    assert_eq!(
        rows.iter().map(|row| row["mapper"].as_str()).collect::<Vec<_>>(),
        [Some("conventional"), Some("prior")]
    );
    let promised = ["mapper", "cells_visited", "ns_per_cell", "rays_per_s", "scans_per_s", "bytes_per_cell"];
    for row in rows {
        assert!(promised.iter().skip(1).all(|key| row[key].as_f64().is_some_and(|value| value > 0.0)), "{row}");
    }
    assert!(rows[0]["cells_updated"].is_u64() && rows[1]["cells_updated"].is_null(), "prior does not count");

    let (csv, _) = checked(0, &"csv", &speed(folder.path(), &form("csv")));
    let heads: Vec<&str> = csv.lines().next().expect("a head").split(',').collect();
    assert_eq!(heads[..6], promised);
    let keys = rows[0].as_object().expect("object").keys().map(String::as_str).collect::<BTreeSet<_>>();
    assert_eq!(heads.iter().copied().collect::<BTreeSet<_>>(), keys);

    let (text, _) = checked(0, &"text", &speed(folder.path(), &form("text")));
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    for part in ["One thread of ", "A cell visited lies between", "conventional", "5 rays with a reading"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

/// Independent cells stop a ray on an unseen map before the end of a long range: the mapper does what its rule asks for.
#[test]
fn one_scan_of_long_ranges_is_measured() {
    let mut text = HEAD.to_owned();
    for k in 0..361 {
        let bearing = f64::from(k - 180).to_radians() / 2.0;
        let _ = writeln!(text, "0,-1.9509,-1.5504,-0.642976,{bearing:.6},{:.3}", 6.0 + 3.0 * f64::from(k) / 361.0);
    }
    let folder = with(&text);
    let mappers = "visibility,independent,conventional,log-odds-octomap";
    let found =
        json(folder.path(), &["--scans", "scans.csv", "--mappers", mappers, "--repeats", "1", "--format", "json"]);
    assert_eq!(found["rows"].as_array().expect("rows").len(), 4, "{found}");
}

#[test]
fn a_folder_has_table_and_record() {
    let folder = with(SCANS);
    let arguments = ["--scans", "scans.csv", "--grid", "0.2", "--repeats", "1", "--out", "out"];
    let (_, err) = checked(0, &arguments, &speed(folder.path(), &arguments));
    assert!(err.contains("speed.csv"), "{err}");
    let table = fs::read_to_string(folder.path().join("out/speed.csv")).expect("written");
    assert_eq!(table.lines().count(), 1 + 6, "{table}");
    let record: Value =
        serde_json::from_slice(&fs::read(folder.path().join("out/run.json")).expect("written")).expect("JSON");
    let names: Vec<&Value> = record["files"].as_array().into_iter().flatten().map(|file| &file["name"]).collect();
    assert_eq!(names, ["speed.csv"]);
    assert_eq!(record["configuration"]["scans"], "scans.csv");
}

#[test]
fn files_with_a_mistake_are_refused_where_it_is() {
    let row = "0,1,2,0,0,3\n";
    let cases = [
        (
            "",
            "scans.csv: no scan in 0 lines: it is empty; give a CARMEN log with FLASER, RLASER, ROBOTLASER1 or SONAR, or a table of scans",
        ),
        (HEAD, "scans.csv: no scan in 1 lines"),
        (
            "scan,x_m,y_m,theta_rad,bearing,range_m\n",
            "scans.csv:1: column bearing_rad: is missing; the first line has scan,x_m,y_m,theta_rad,bearing,range_m, and must have",
        ),
        ("scan,x_m,x_m,y_m,theta_rad,bearing_rad,range_m\n", "scans.csv:1: column x_m: is there twice"),
        ("HR0,1,2,0,0\n", "scans.csv:3: 5 fields; must be 6"),
        ("HR0,1,2,0,0,3,4\n", "scans.csv:3: 7 fields; must be 6"),
        ("HR0.5,1,2,0,0,3\n", "scans.csv:3: column scan: \"0.5\" must be a whole number, 0 or more"),
        ("HRR1,nan,2,0,0,3\n", "scans.csv:4: column x_m: \"nan\" must be a number from -"),
        ("HR0,,2,0,0,3\n", "scans.csv:3: column x_m: \"\" must be a number from -"),
        ("HR0,1,2,0,45,3\n", "scans.csv:3: column bearing_rad: \"45\" must be a number from -6."),
        ("HR0,1,2,0,0,far\nR", "scans.csv:3: column range_m: \"far\" must be a number or empty"),
        ("HR\n0,1,2,0,x,3\r\n", "scans.csv:4: column bearing_rad: \"x\" must be a number"),
        ("H0,1,2,0,0,\n", "scans.csv: column range_m: none of 1 rays has a range that the sensor can see"),
        ("H0,1,2,0,0,0.2\n", "scans.csv: column range_m: none of 1 rays"),
        ("H0,1,2,0,0,inf\n", "scans.csv: column range_m: none of 1 rays"),
        ("HR1,9e5,9e5,0,0,3\n", "scans.csv: poses and ranges with 1 m around them are 18000"),
    ];
    for (text, expected) in cases {
        let folder = with(&text.replace('H', HEAD).replace('R', row));
        let (out, err) = checked(2, &text, &speed(folder.path(), &["--scans", "scans.csv", "--repeats", "1"]));
        assert!(out.is_empty() && err.starts_with("error: ") && err.contains(expected), "{text:?}: {err}");
        assert_eq!(err.lines().count(), 1, "{text:?}: {err}");
    }
    let folder = TempDir::new().expect("temporary folder");
    for (path, expected) in [("none.csv", "none.csv: cannot be opened: "), (".", ".: is a folder; give one log")] {
        let (_, err) = checked(2, &path, &speed(folder.path(), &["--scans", path]));
        assert!(err.contains(expected), "{err}");
    }
}

fn load(text: &str, kernel: Kernel) -> Result<ScanSet, String> {
    file::load(&with(text).path().join("scans.csv"), kernel, None).map_err(|failure| failure.to_string())
}

#[test]
fn columns_stand_in_any_order_among_others() {
    let text = "range_m,time_s,scan, bearing_rad,y_m,x_m,theta_rad\n1.5,99,7,0.0,2,1,0\n,99,7,0.1,2,1,-0\n";
    let set = load(text, Kernel::Stereo).expect("valid");
    assert_eq!((set.scans.len(), set.rays()), (1, 2));
    assert_eq!((set.scans[0].pose.x_m, set.scans[0].pose.y_m, set.scans[0].bearings_rad[1]), (1.0, 2.0, 0.1));
    let readings = &set.scans[0].readings;
    assert!((readings[0].expect("seen") - 10.0).abs() < 1e-12 && readings[1].is_none());
}

#[test]
fn a_kernel_takes_readings_for_what_it_reads() {
    let ranges = HEAD.to_owned() + "0,1,2,0,0,3\n0,1,2,0,0.1,81\n0,1,2,0,0.2,inf\n";
    let laser = load(&ranges, Kernel::Laser).expect("valid");
    assert_eq!(laser.scans[0].readings, [Some(3.0), Some(f64::INFINITY), Some(f64::INFINITY)]);
    let stereo = load(&ranges, Kernel::Stereo).expect("valid");
    let seen: Vec<bool> = stereo.scans[0].readings.iter().map(Option::is_some).collect();
    assert_eq!(seen, [true, true, false], "a camera has no maximum range");
    let disparities = ranges.replace("range_m", "disparity_px").replace("inf", "");
    let stereo = load(&disparities, Kernel::Stereo).expect("valid");
    assert_eq!(stereo.scans[0].readings, [Some(3.0), None, None], "60 px are searched");
    let refused = load(&disparities, Kernel::Laser).expect_err("no ranges");
    assert!(refused.ends_with("holds disparities, which no laser reads; leave out --sensor laser"), "{refused}");
}

#[test]
fn a_carmen_log_is_mapped_too() {
    let line = "FLASER 3 2.0 81.91 1.5  1.0 2.0 0.5  1.0 2.0 0.5  10.25 robot 0.25\n";
    let folder = with(line);
    let arguments =
        ["--scans", "scans.csv", "--sensor", "laser", "--repeats", "1", "--grid", "0.1", "--format", "json"];
    let found = json(folder.path(), &arguments);
    assert_eq!((&found["rows"][0]["scans"], &found["rows"][0]["rays"]), (&json!(1), &json!(2)));
}

#[test]
fn a_long_file_is_read_row_by_row() {
    let mut text = HEAD.to_owned();
    for row in 0..200_000 {
        let _ = writeln!(text, "{},{},2,0,{},3", row / 100, row / 100 % 7, f64::from(row % 100) * 0.01 - 0.5);
    }
    let set = load(&text, Kernel::Stereo).expect("valid");
    assert_eq!((set.scans.len(), set.rays()), (2000, 200_000));
}

#[test]
fn usage_that_cannot_work_is_refused_before_any_work() {
    let folder = with(SCANS);
    for (arguments, expected) in [
        (&["--mappers", "visibilty"][..], "the nearest is 'visibility'"),
        (&["--mappers", "mrf", "--growth"], "--growth: 'mrf' solves for all scans at once"),
        (&["--mappers", "mrf", "--world", "settled"], "--world settled: 'mrf' solves for all scans at once"),
        (&["--mapper", "own=true", "--world", "unknown"], "--world unknown: 'own' works in a process of its own"),
        (&["--growth", "--format", "csv"], "name a folder for both with --out"),
        (&["--repeats", "0"], "0 is not in 1..=1000"),
        (&["--grid", "-1"], "above 0"),
        (&["--grid", "0.0001"], "must be at most 25000000 cells; use larger cells with --grid"),
    ] {
        let arguments = [arguments, &["--scans", "scans.csv"]].concat();
        let (out, err) = checked(2, &arguments, &speed(folder.path(), &arguments));
        assert!(out.is_empty() && err.contains(expected), "{arguments:?}: {err}");
    }
}

#[test]
fn batch_mappers_are_measured_where_they_are_asked_for() {
    let folder = with(SCANS);
    let arguments =
        ["--scans", "scans.csv", "--grid", "0.2", "--repeats", "1", "--mappers", "mrf,forward-em", "--format", "json"];
    let found = json(folder.path(), &arguments);
    assert_eq!(found["rows"].as_array().map(Vec::len), Some(2));
    let arguments = ["--scans", "scans.csv", "--grid", "0.2", "--repeats", "1", "--format", "csv"];
    let (csv, _) = checked(0, &arguments, &speed(folder.path(), &arguments));
    assert!(!csv.contains("mrf") && !csv.contains("printed"), "{csv}");
}

/// A wall that is looked at from a drive along it, again and again: once the floor before it is settled, rays leap.
#[test]
fn what_is_known_before_decides_what_rays_leap_over() {
    let ray = |number: usize, k: i32| {
        let bearing = 0.01 * f64::from(k);
        format!("{number},0.5,{:.3},0,{bearing},{:.4}\n", 0.1 * number as f64, 4.0 / bearing.cos())
    };
    let rays = (0..12).flat_map(|number| (-40..=40).map(move |k| ray(number, k)));
    let folder = with(&(HEAD.to_owned() + &rays.collect::<String>()));
    let sensor = ["--scans", "scans.csv", "--sensor", "laser", "--mappers", "visibility", "--repeats", "1"];
    let arguments = |world: &'static str| [&sensor[..], &["--world", world]].concat();
    let row = |world: &'static str| {
        let found = json(folder.path(), &[&arguments(world)[..], &["--format", "json"]].concat())["rows"][0].clone();
        assert_eq!(found["world"], world);
        found
    };
    let [unknown, mixed, settled] =
        ["unknown", "mixed", "settled"].map(|world| row(world)["cells_skipped"].as_u64().expect("counted"));
    assert_eq!(unknown, 0);
    assert!(mixed < settled, "{mixed} {settled}");
    let arguments = arguments("settled");
    let (text, _) = checked(0, &arguments, &speed(folder.path(), &arguments));
    assert!(text.contains("visibility leapt over") && text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn growth_has_a_time_for_every_size_of_every_mapper() {
    let entries = ["log-odds-octomap", "visibility"].map(|name| find(name).expect("in the catalogue"));
    let sizes = Sizes {
        cells_per_ray: vec![10, 30],
        rays_per_scan: vec![5, 9],
        map_cells: vec![10_000, 12_100],
        scans: vec![1, 2, 3],
    };
    let seen = std::cell::Cell::new(0);
    let curves = growth::measure(&entries, &sizes, 1, || seen.set(seen.get() + 1)).expect("measured");
    assert_eq!(seen.get(), growth::steps(&sizes, 2, 1));
    assert_eq!(curves.len(), 2 * Against::ALL.len());
    for curve in &curves {
        let expected: &[f64] = match curve.against {
            Against::CellsPerRay => &[10.0, 30.0],
            Against::RaysPerScan => &[5.0, 9.0],
            Against::MapCells => &[10_000.0, 12_100.0],
            Against::Scans => &[1.0, 2.0, 3.0],
        };
        assert_eq!(curve.points.iter().map(|(size, _)| *size).collect::<Vec<_>>(), expected);
        assert!(curve.points.iter().all(|(_, seconds)| *seconds > 0.0 && seconds.is_finite()), "{curve:?}");
        assert!(curve.exponent().is_some_and(f64::is_finite), "{curve:?}");
    }
    assert_eq!(growth::table(&curves).rows().len(), 2 * (2 + 2 + 2 + 3));
    let paper = experiments::figures::Paper::default();
    assert!(paper.png(&growth::draw(&curves, &paper)).expect("drawn").starts_with(b"\x89PNG"));
}

/// Two times at which a camera, a laser and a sonar read, the laser at one of them alone.
const KINDS: &str = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,sensor,disparity_px,range_m,sonar_m
0,0.0,0.5,0.5,0.0,-0.2,0,10.0,,
0,0.0,0.5,0.5,0.0,0.2,0,7.5,,
0,0.0,0.6,0.5,0.0,0.0,4,,2.0,
0,0.0,0.6,0.5,0.0,0.5,4,,inf,
0,0.0,0.5,0.5,0.0,1.0,5,,,1.5
1,0.5,0.7,0.5,0.0,-0.2,0,11.0,,
1,0.5,0.7,0.5,0.0,0.2,0,,,
1,0.5,0.7,0.5,0.0,1.0,5,,,1.5
";

#[test]
fn sensors_of_several_kinds_are_measured_together_and_apart() {
    let folder = with(KINDS);
    let base = ["--scans", "scans.csv", "--grid", "0.1", "--repeats", "1", "--mappers", "visibility,log-odds-octomap"];
    let found = json(folder.path(), &[&base[..], &["--format", "json", "--out", "o"]].concat());
    let rows = found["rows"].as_array().expect("rows");
    assert_eq!(rows.len(), 2, "a row of all sensors for every mapper");
    assert_eq!((&rows[0]["rays"], &rows[0]["scans"]), (&json!(6), &json!(5)));
    let apart = found["by_sensor"].as_array().expect("rows");
    let of = |row: &Value| (row["sensor"].clone(), row["mapper"].clone(), row["rays"].clone(), row["scans"].clone());
    let expected: Vec<_> = [("0 stereo", 3, 2), ("4 laser", 1, 1), ("5 sonar", 2, 2)]
        .into_iter()
        .flat_map(|(sensor, rays, scans)| {
            let row = move |mapper: &str| (json!(sensor), json!(mapper), json!(rays), json!(scans));
            ["visibility", "log-odds-octomap"].map(row)
        })
        .collect();
    assert_eq!(apart.iter().map(of).collect::<Vec<_>>(), expected);
    let visited = |rows: &[Value]| rows.iter().filter_map(|row| row["cells_visited"].as_u64()).sum::<u64>();
    assert_eq!(visited(rows), visited(apart), "the cells of all are those of each");
    assert!(apart.iter().all(|row| row["ns_per_cell"].as_f64().is_some_and(|ns| ns > 0.0)), "{found}");
    let table = fs::read_to_string(folder.path().join("o/by-sensor.csv")).expect("written");
    assert_eq!(table.lines().count(), 1 + 6, "{table}");
    let (text, _) = checked(0, &"text", &speed(folder.path(), &base));
    assert!(text.contains("The scans of each sensor without the others") && text.contains("5 sonar"), "{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
}

#[test]
fn scans_of_several_kinds_stand_together_and_are_what_they_are() {
    let set = load(KINDS, Kernel::Stereo).expect("three sensors");
    let found: Vec<_> = set.scans.iter().map(|scan| (scan.sensor, scan.readings.clone())).collect();
    let infinite = f64::INFINITY;
    assert_eq!(
        found,
        [
            (0, vec![Some(10.0), Some(7.5)]),
            (1, vec![Some(2.0), Some(infinite)]),
            (2, vec![Some(1.5)]),
            (0, vec![Some(11.0), None]),
            (2, vec![Some(1.5)]),
        ]
    );
    assert_eq!(mapper::moments(&set.scans).map(<[_]>::len).collect::<Vec<_>>(), [3, 2]);
    assert_eq!(set.called().collect::<Vec<_>>(), ["0 stereo", "4 laser", "5 sonar"]);
    // Of a laser and a camera `--sensor laser` changes nothing.
    let laser = load(KINDS, Kernel::Laser).expect("three sensors");
    assert_eq!(laser.scans, set.scans);
}

#[test]
fn a_scene_is_driven_through_with_all_of_its_sensors() {
    let folder = TempDir::new().expect("temporary folder");
    let scene = include_str!("browser/closet.toml").to_owned()
        + "[[sensor]]\nkind = \"laser\"\nname = \"beam\"\nbeams = 20\nmax_range = 8.0\n";
    fs::write(folder.path().join("closet.toml"), scene).expect("writable");
    let arguments = [
        "--scans",
        "closet.toml",
        "--grid",
        "0.1",
        "--repeats",
        "1",
        "--mappers",
        "log-odds-octomap",
        "--format",
        "json",
    ];
    let found = json(folder.path(), &arguments);
    let sensors: Vec<&str> =
        found["by_sensor"].as_array().expect("rows").iter().filter_map(|row| row["sensor"].as_str()).collect();
    assert_eq!(sensors, ["camera", "beam"]);
}

/// A camera's false match of next to no disparity would say kilometres.
#[test]
fn what_a_scene_reads_counts_on_its_map_alone() {
    let arguments =
        ["--scans", "room", "--grid", "0.2", "--repeats", "1", "--mappers", "log-odds-octomap", "--format", "json"];
    let arguments = [&arguments[..], &["--reach", "3"]].concat();
    let folder = TempDir::new().expect("temporary folder");
    let (out, err) = checked(0, &arguments, &speed(folder.path(), &arguments));
    let found: Value = serde_json::from_str(&out).expect("JSON");
    // 10 m by 8 m, and a metre around them.
    assert_eq!(found["rows"][0]["map_cells"], 60 * 50);
    assert!(
        err.contains("warning: --reach: has no effect on ") && err.contains("which has sensors and a map"),
        "{err}"
    );
}

/// So would that of a log: its map reaches as far as 99 in 100 readings say, or as far as it is told.
#[test]
fn a_disparity_of_next_to_none_does_not_make_the_map_large() {
    let mut text = HEAD.replace("range_m", "disparity_px");
    for ray in 0..200 {
        let _ = writeln!(text, "0,0,0,0,{},{}", f64::from(ray) * 0.001, if ray == 7 { 1e-6 } else { 5.0 });
    }
    let folder = with(&text);
    let of = |options: &[&str]| {
        let usual =
            ["--scans", "scans.csv", "--grid", "0.1", "--repeats", "1", "--mappers", "visibility", "--format", "json"];
        let found = json(folder.path(), &[&usual, options].concat());
        ["rays", "cells_visited", "map_cells"].map(|column| found["rows"][0][column].as_u64().expect("a number"))
    };
    // The camera looks along x: 3 m of range, 0.6 m to the left, and a metre around; a ray crosses some 30 cells, that of the false match
    // 40 up to the border.
    let [rays, visited, cells] = of(&[]);
    assert!(rays == 200 && (50 * 25..=51 * 27).contains(&cells) && visited < 200 * 45, "{rays} {visited} {cells}");
    assert_eq!(of(&["--reach", "2"])[2], 20 * 20, "poses alone, since all that was read lies beyond");
    let arguments = ["--scans", "scans.csv", "--reach", "1e9"];
    let (_, err) = checked(2, &arguments, &speed(folder.path(), &arguments));
    assert!(err.contains("leave what is far away off the map with --reach"), "{err}");
}
