//! `replay` as a user meets it: logs that were simulated, so that the truth is known, and logs that are damaged.

use crate::recorded;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Output;

use assert_cmd::Command;
use experiments::page::decoded;
use experiments::worlds::ground::Ground;
use flate2::Compression;
use flate2::write::GzEncoder;
use grid::{GridSpec, Raster, npy};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Laser, Pose, Sonar};
use serde_json::Value;
use tempfile::TempDir;

use crate::checked::checked;
use crate::recorded::{BEAMS, recorded, room};

fn replay(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::cargo_bin("experiments").expect("built");
    command.current_dir(folder).arg("replay").args(arguments).output().expect("starts")
}

/// Mean of -ln p(truth) over the cells that were seen.
fn log_loss(map: &Path, spec: &GridSpec, truth: &Raster<Option<bool>>, seen: &Raster<bool>) -> f64 {
    let array = npy::read(map).expect("a map");
    let (mut sum, mut cells) = (0.0, 0);
    for cell in (0..truth.spec().cells()).filter(|cell| seen[*cell]) {
        let Some(occupied) = truth[cell] else { continue };
        let there = spec.locate(truth.spec().centre(cell)).expect("the map holds all that was seen");
        // A beam may end short of what it could have seen: the map then says nothing, and the prior holds.
        let p = array.occupancy[there].map_or(0.1, f64::from).clamp(1e-4, 1.0 - 1e-4);
        sum -= if occupied { p.ln() } else { (1.0 - p).ln() };
        cells += 1;
    }
    sum / f64::from(cells)
}

fn rows(out: &str) -> Vec<(String, f64, f64, f64)> {
    let mut table = csv::Reader::from_reader(out.as_bytes());
    let heads: Vec<&str> = table.headers().expect("heads").iter().take(6).collect();
    assert_eq!(heads, ["mapper", "readings", "predictive_log_loss", "low", "high", "recalibrated_log_loss"]);
    let row = |row: csv::StringRecord| {
        let number = |k: usize| row[k].parse().expect("a number");
        (row[0].to_owned(), number(2), number(3), number(4))
    };
    table.records().map(|record| row(record.expect("a row"))).collect()
}

fn spec_of(folder: &Path) -> GridSpec {
    let record: Value = serde_json::from_slice(&fs::read(folder.join("run.json")).expect("written")).expect("JSON");
    serde_json::from_value(record["grid"].clone()).expect("a grid")
}

/// A folder with the recorded log, packed, and what was seen.
fn with_log(ground: &Ground) -> (TempDir, String, Raster<bool>) {
    let (log, seen) = recorded(ground, &Laser { max_range_m: 20.0, ..Laser::default() }, 2);
    let folder = TempDir::new().expect("temporary folder");
    let file = fs::File::create(folder.path().join("room.log.gz")).expect("writable");
    let mut gz = GzEncoder::new(file, Compression::fast());
    gz.write_all(log.as_bytes()).and_then(|()| gz.finish()).expect("written");
    (folder, log, seen)
}

/// What maps that hold free cells to be at most as free as their clamps say is left out: after some ten of them a ray is
/// thought to have ended, whatever the rest of the map is like, and they rank among each other by chance.
#[test]
fn a_simulated_log_ranks_mappers_as_the_truth_does() {
    let ground = room();
    let (folder, _, seen) = with_log(&ground);
    let mappers = "visibility,independent,conventional,log-odds-octomap,log-odds-cartographer,prior";
    let arguments = ["room.log.gz", "--mappers", mappers, "--out", "o", "--format", "csv"];
    let (out, _) = checked(0, &arguments, &replay(folder.path(), &arguments));
    let (spec, rows) = (spec_of(&folder.path().join("o")), rows(&out));
    let by_truth = |name: &str| {
        let map = folder.path().join("o").join(format!("{name}.npy"));
        log_loss(&map, &spec, &ground.truth, &seen)
    };
    let row = |name: &str| rows.iter().find(|row| row.0 == name).expect("a row");
    for worse in ["conventional", "log-odds-octomap", "log-odds-cartographer", "prior"] {
        for better in ["visibility", "independent", "conventional"] {
            if worse != better {
                assert!(by_truth(better) < by_truth(worse), "{better} {worse}");
                assert!(row(better).1 < row(worse).1, "{better} {worse}: {rows:?}");
                assert!(row(better).3 < row(worse).2, "{better} {worse}: the intervals lie apart, {rows:?}");
            }
        }
    }
    assert!(row("visibility-chain").1 < row("conventional").2);
    // The page has the maps of the files, and scans that were kept back.
    let html = fs::read_to_string(folder.path().join("o/report.html")).expect("text");
    let world = decoded(&html).expect("a page with a viewer").remove(0);
    assert!(world.truth.is_none() && world.moments.len() > 1, "{:?}", world.moments);
    assert_eq!(world.readings.len(), world.moments.len() * BEAMS);
    let names: Vec<&str> = world.mappers.iter().map(|mapper| mapper.name.as_str()).collect();
    assert_eq!(names, ["visibility", "independent", "conventional", "log-odds-octomap", "log-odds-cartographer"]);
    for mapper in &world.mappers {
        let file = npy::read(&folder.path().join("o").join(format!("{}.npy", mapper.name))).expect("a map");
        for (cell, p) in file.occupancy.iter().enumerate() {
            let near = p.is_none_or(|p| (f64::from(p) - mapper.maps[0][cell]).abs() <= 3e-4);
            assert!(near, "{}: cell {cell} is {p:?} in the file, {} on the page", mapper.name, mapper.maps[0][cell]);
        }
    }
    along_time_adds_up(folder.path(), &rows);
    let mut differences = csv::Reader::from_path(folder.path().join("o/differences.csv")).expect("written");
    let differences: Vec<_> = differences.records().map(|record| record.expect("a row")).collect();
    for record in &differences {
        let (name, score, verdict) = (&record[0], &record[2], &record[6]);
        match verdict {
            "undecided" => {}
            _ if name == "visibility-chain" => assert_eq!(score, "plain"),
            _ => assert_eq!(verdict == "worse", by_truth(name) > by_truth("visibility"), "{record:?}"),
        }
    }
    assert_eq!(differences.iter().filter(|record| &record[2] == "recalibrated").count(), 5);
}

/// The blocks of every map add up to its score, and follow each other in time.
fn along_time_adds_up(folder: &Path, rows: &[(String, f64, f64, f64)]) {
    let mut reader = csv::Reader::from_path(folder.join("o/along-time.csv")).expect("written");
    let along: Vec<_> = reader.records().map(|record| record.expect("a row")).collect();
    let number = |record: &csv::StringRecord, column: usize| record[column].parse::<f64>().expect("a number");
    for (name, whole, ..) in rows {
        let of: Vec<_> = along.iter().filter(|record| &record[0] == name && &record[2] == "plain").collect();
        assert!(of.len() > 1, "{name}: {} blocks", of.len());
        assert!(of.windows(2).all(|pair| number(pair[0], 5) < number(pair[1], 4)), "{name}");
        let readings: f64 = of.iter().map(|record| number(record, 7)).sum();
        let mean = of.iter().map(|record| number(record, 7) * number(record, 8)).sum::<f64>() / readings;
        assert!((mean - whole).abs() < 1e-4, "{name}: {mean}, {whole} in all");
        for record in of {
            assert!(number(record, 12) <= number(record, 11) && number(record, 11) <= number(record, 13), "{record:?}");
            assert!(name != "visibility" || number(record, 11).abs() < 1e-12, "the baseline less itself: {record:?}");
        }
    }
    assert!(folder.join("o/along-time.png").exists());
}

/// Clamps decide no more: maps that have found walls predict better than a map that says the same of every cell it has seen, which the
/// plain scores deny, and none is worse than before.
#[test]
fn recalibrated_a_map_with_clamps_is_better_than_none() {
    let (folder, _, _) = with_log(&room());
    let mappers = "visibility,log-odds-octomap,log-odds-cartographer,prior";
    let arguments = ["room.log.gz", "--mappers", mappers, "--out", "o", "--format", "json"];
    let (out, _) = checked(0, &arguments, &replay(folder.path(), &arguments));
    let document: Value = serde_json::from_str(&out).expect("JSON");
    let row = |name: &str| {
        document["rows"].as_array().expect("rows").iter().find(|row| row["mapper"] == name).expect("a row").clone()
    };
    let of = |name: &str, key: &str| row(name)[key].as_f64().expect("a number");
    for name in ["log-odds-octomap", "log-odds-cartographer"] {
        assert!(of(name, "high") > of("prior", "low"), "the plain score cannot tell it from nothing: {document}");
        assert!(of(name, "recalibrated_high") < of("prior", "recalibrated_low"), "{document}");
        assert!(of(name, "shift") < 0.0 && of(name, "slope") > 0.0, "{document}");
    }
    for name in ["visibility", "log-odds-octomap", "log-odds-cartographer", "prior"] {
        assert!(of(name, "recalibrated_log_loss") < of(name, "predictive_log_loss") + 0.01, "{document}");
    }
    assert!(row("visibility-chain")["recalibrated_log_loss"].is_null());
}

/// A recalibration takes two scans with readings that are kept back: one to fit to, one to score.
#[test]
fn one_scan_kept_back_is_scored_as_the_maps_are() {
    let (folder, log, _) = with_log(&room());
    let few: Vec<&str> = log.lines().take(12).collect();
    fs::write(folder.path().join("few.log"), few.join("\n") + "\n").expect("writable");
    let arguments = ["few.log", "--mappers", "visibility", "--hold-out", "7", "--out", "o"];
    let (out, _) = checked(0, &arguments, &replay(folder.path(), &arguments));
    assert!(out.contains("nats/reading") && out.contains("too few to recalibrate"), "{out}");
}

/// The drive of `results/room`, whose metrics say which map is closest to the truth. Of the other two `conventional` predicts
/// better, and is farther from the truth: it is sure, and wrong, of cells that few readings depend on.
#[test]
fn the_readings_of_a_camera_prefer_the_map_that_is_closest_to_the_truth() {
    let folder = TempDir::new().expect("temporary folder");
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/room.toml");
    let room = ["room", "--scene", scene, "--mappers", "prior", "--out", "room"];
    let mut command = Command::cargo_bin("experiments").expect("built");
    checked(0, &room, &command.current_dir(folder.path()).args(room).output().expect("starts"));
    let arguments =
        ["room/scans.csv", "--mappers", "visibility,visibility-printed,conventional", "--out", "o", "--format", "csv"];
    let (out, _) = checked(0, &arguments, &replay(folder.path(), &arguments));
    let found: Vec<f64> = rows(&out).into_iter().filter(|row| !row.0.ends_with("-chain")).map(|row| row.1).collect();
    let metrics = concat!(env!("CARGO_MANIFEST_DIR"), "/../results/room/metrics.csv");
    let metrics = fs::read_to_string(metrics).expect("committed");
    let truth = |mapper: &str| -> f64 {
        let start = format!("room,1,{mapper},c,observable,log_loss,");
        let line = metrics.lines().find(|line| line.starts_with(&start)).expect("a row");
        line[start.len()..].split(',').next().expect("a value").parse().expect("a number")
    };
    let truth = ["visibility", "visibility-printed", "conventional"].map(truth);
    for (k, values) in [&found[..], &truth[..]].into_iter().enumerate() {
        assert!(values[0] < values[1].min(values[2]), "{k}: {found:?} {truth:?}");
    }
}

#[test]
fn the_same_bytes_with_any_number_of_threads_and_maps_that_others_read() {
    let (folder, _, _) = with_log(&room());
    let told = |out: &str, options: &[&str]| {
        let arguments = [&["room.log.gz", "--out", out, "--window", "0,20"], options].concat();
        checked(0, &arguments, &replay(folder.path(), &arguments)).1
    };
    assert!(told("a", &["--threads", "1"]).contains(" mappers at once"));
    // Nor does it matter whether mappers take turns.
    let timed = told("b", &["--threads", "2", "--timing"]);
    assert!(timed.contains("visibility: 45 scans mapped in ") && timed.contains(" mappers in turns"), "{timed}");
    let files = |name: &str| {
        let entries = fs::read_dir(folder.path().join(name)).expect("written");
        let mut files: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
        files.sort();
        files
    };
    let (a, b) = (files("a"), files("b"));
    assert!(a.len() == b.len() && a.len() > 15, "{a:?}");
    for (x, y) in a.iter().zip(&b) {
        assert_eq!(fs::read(x).expect("a"), fs::read(y).expect("b"), "{}", x.display());
    }
    let map = grid::ros_map::read(&folder.path().join("a/visibility.yaml")).expect("a map");
    let occupied = map.cells().values().iter().filter(|state| **state == Some(true)).count();
    let unknown = map.cells().values().iter().filter(|state| state.is_none()).count();
    assert!(occupied > 300 && unknown > 300 && map.spec == spec_of(&folder.path().join("a")));
}

#[test]
fn poses_of_a_trajectory_replace_those_of_the_log() {
    let ground = room();
    let (folder, log, _) = with_log(&ground);
    let mut trajectory = "# shifted by 100 m and turned by a quarter\n".to_owned();
    for line in log.lines().filter(|line| line.starts_with("FLASER")) {
        let fields: Vec<f64> = line.split(' ').skip(2 + BEAMS).filter_map(|field| field.parse().ok()).collect();
        let half = 0.5 * (fields[2] + std::f64::consts::FRAC_PI_2);
        let _ = writeln!(
            trajectory,
            "{} {} {} 0 0 0 {} {}",
            fields[6],
            100.0 - fields[1],
            fields[0],
            half.sin(),
            half.cos()
        );
    }
    fs::write(folder.path().join("t.txt"), trajectory).expect("writable");
    let arguments = ["room.log.gz", "--mappers", "log-odds-octomap", "--out", "o"];
    checked(0, &arguments, &replay(folder.path(), &arguments));
    let by_log = spec_of(&folder.path().join("o"));
    let arguments = ["room.log.gz", "--mappers", "log-odds-octomap", "--trajectory", "t.txt", "--out", "o"];
    checked(0, &arguments, &replay(folder.path(), &arguments));
    let turned = spec_of(&folder.path().join("o"));
    assert!(
        turned.width.abs_diff(by_log.height) <= 2 && turned.height.abs_diff(by_log.width) <= 2,
        "{by_log:?} {turned:?}"
    );
    assert!(
        turned.origin_m[0] > 80.0 && (turned.origin_m[1] - by_log.origin_m[0]).abs() < 0.2,
        "{by_log:?} {turned:?}"
    );
}

#[test]
fn damaged_lines_are_named_and_skipped_and_too_many_refuse_the_log() {
    let (folder, log, _) = with_log(&room());
    let lines: Vec<&str> = log.lines().take(60).collect();
    let write = |name: &str, every: usize| {
        let damaged = |(k, line): (usize, &&str)| match k % every {
            7 => line[..line.len() / 2].to_owned(),
            _ => (*line).to_owned(),
        };
        let text: Vec<String> = lines.iter().enumerate().map(damaged).collect();
        fs::write(folder.path().join(name), text.join("\r\n")).expect("writable");
    };
    write("few.log", 60);
    let arguments = ["few.log", "--mappers", "prior", "--out", "few"];
    let (out, _) = checked(0, &arguments, &replay(folder.path(), &arguments));
    assert!(out.contains("1 damaged lines were skipped") && out.contains("line 8: "), "{out}");
    assert!(out.lines().all(|line| line.chars().count() <= 80), "{out}");
    write("many.log", 8);
    let arguments = ["many.log", "--out", "many"];
    let (_, err) = checked(2, &arguments, &replay(folder.path(), &arguments));
    assert!(err.starts_with("error: many.log:8: ") && err.lines().count() == 1, "{err}");
    assert!(!folder.path().join("many").exists());
}

#[test]
fn what_is_no_log_is_refused_before_anything_is_written() {
    let (folder, log, _) = with_log(&room());
    fs::write(folder.path().join("binary"), (0..=255u8).cycle().take(5000).collect::<Vec<_>>()).expect("writable");
    fs::write(folder.path().join("empty"), "").expect("writable");
    fs::write(folder.path().join("one.log"), log.lines().take(3).collect::<Vec<_>>().join("\n")).expect("writable");
    let far = log.lines().nth(4).expect("a scan").replace(" 100.", " 1e7.");
    let far = far.rsplitn(10, ' ').last().expect("beams").to_owned() + " 9e6 9e6 0 9e6 9e6 0 101 robot 101";
    // The drive goes on 9,000 km away.
    fs::write(folder.path().join("far.log"), format!("{log}{}", format!("{far}\n").repeat(20))).expect("writable");
    fs::write(folder.path().join("stray.log"), format!("{log}{far}\n")).expect("writable");
    for (arguments, said) in [
        (vec!["no.log"], "no.log: "),
        (vec!["binary"], "binary: "),
        (vec!["empty"], "empty: no scan in 0 lines"),
        (vec!["."], ".: is a folder"),
        (vec!["one.log"], "--hold-out 10: "),
        (vec!["far.log"], "the longest move between two scans is 12727"),
        (vec!["room.log.gz", "--hold-out", "1"], "--hold-out"),
        (vec!["room.log.gz", "--window", "20,10"], "--window"),
        (vec!["room.log.gz", "--window", "1e9,2e9"], "outside the time window"),
        (vec!["room.log.gz", "--hit", "0.9", "--no-echo", "0.2"], "hit"),
        (vec!["room.log.gz", "--mappers", "visbility"], "the nearest is 'visibility'"),
        (vec!["room.log.gz", "--trajectory", "binary"], "binary:1: "),
    ] {
        let arguments: Vec<&str> = arguments.into_iter().chain(["--out", "o"]).collect();
        let (out, err) = checked(2, &arguments, &replay(folder.path(), &arguments));
        assert!(out.is_empty() && err.contains(said) && !err.contains("panicked"), "{arguments:?}: {err}");
        assert!(!folder.path().join("o").exists(), "{arguments:?}");
    }
    let arguments = ["stray.log", "--mappers", "prior", "--out", "o"];
    let (out, err) = checked(0, &arguments, &replay(folder.path(), &arguments));
    assert!(out.contains("\n  1 far from all others\n") && out.contains("largest move between scans: "), "{out}");
    assert!(err.contains("warning: stray.log: line ") && err.contains("km from the drive"), "{err}");
    let record = fs::read_to_string(folder.path().join("o/run.json")).expect("written");
    assert!(record.contains("km from the drive") && record.contains("\"longest_move\""), "{record}");
}

#[test]
fn where_beams_go_and_which_gaps_are_bridged_is_an_option() {
    let (folder, ..) = with_log(&room());
    let width = |arguments: &[&str]| {
        let arguments = [&["room.log.gz", "--mappers", "prior", "--reach", "3", "--out", "o"], arguments].concat();
        let (_, err) = checked(0, &arguments, &replay(folder.path(), &arguments));
        (spec_of(&folder.path().join("o")), err)
    };
    let (_, noted) = width(&[]);
    let (_, given) = width(&["--fov", "90"]);
    assert!(noted.contains("FLASER does not say where its "), "{noted}");
    assert!(!given.contains("does not say where"), "{given}");
    for bad in [["--fov", "361"], ["--increment", "0"], ["--first-bearing", "x"], ["--max-gap", "-1"]] {
        let arguments = ["room.log.gz", bad[0], bad[1], "--out", "p"];
        let (_, err) = checked(2, &arguments, &replay(folder.path(), &arguments));
        assert!(err.contains(bad[0]), "{err}");
    }
}

#[test]
fn options_without_effect_are_warned_of() {
    let (folder, log, _) = with_log(&room());
    let told = |log: &str, arguments: &[&str]| {
        let arguments = [&[log, "--mappers", "prior", "--grid", "0.2", "--out", "o"], arguments].concat();
        checked(0, &arguments, &replay(folder.path(), &arguments)).1
    };
    let camera =
        told("room.log.gz", &["--focal-baseline", "15", "--disparity-sigma=1", "--max-gap", "1", "--hit", "0.9"]);
    let warning =
        "warning: --focal-baseline, --disparity-sigma: have no effect on room.log.gz, a log of a laser; leave out";
    assert!(camera.contains(warning), "{camera}");
    assert!(camera.contains("warning: --max-gap: has no effect on room.log.gz"), "{camera}");
    assert!(!camera.contains("--hit"), "{camera}");
    // The usual value, not given, is not warned of.
    assert!(!told("room.log.gz", &["--hit", "0.9"]).contains("no effect"));

    let mut table = "scan,time_s,x_m,y_m,theta_rad,bearing_rad,disparity_px\n".to_owned();
    for (scan, _) in log.lines().enumerate().take(30) {
        for beam in -5..=5 {
            let bearing = f64::from(beam) * 0.05;
            let _ = writeln!(
                table,
                "{scan},{scan},{},0,0,{bearing},{}",
                scan as f64 * 0.01,
                15.0 / (3.0 - scan as f64 * 0.01)
            );
        }
    }
    fs::write(folder.path().join("camera.csv"), &table).expect("writable");
    let laser = told("camera.csv", &["--hit", "0.9", "--fov", "90", "--correct-match", "0.7"]);
    assert!(laser.contains("warning: --hit, --fov: have no effect on camera.csv, a log of a stereo camera"), "{laser}");
    let ranges = table.replace("disparity_px", "range_m");
    fs::write(folder.path().join("ranges.csv"), ranges).expect("writable");
    let fan = told("ranges.csv", &["--fov", "90"]);
    assert!(
        fan.contains("warning: --fov: has no effect on ranges.csv, a table, which has the bearing of every beam"),
        "{fan}"
    );
}

#[test]
fn scans_that_do_not_fit_together_are_warned_of_and_others_are_not() {
    let (folder, log, _) = with_log(&room());
    let edited = |name: &str, pose: &dyn Fn(f64, [f64; 3]) -> [f64; 3]| {
        let line = |(number, line): (usize, &str)| {
            let Some(scan) = line.strip_prefix("FLASER ") else { return format!("{line}\n") };
            let mut fields: Vec<String> = scan.split(' ').map(str::to_owned).collect();
            let at = 1 + BEAMS;
            let read = [0, 1, 2].map(|k| fields[at + k].parse().expect("a number"));
            let written = pose(number as f64, read).map(|value| format!("{value:.5}"));
            (0..6).for_each(|k| fields[at + k].clone_from(&written[k % 3]));
            format!("FLASER {}\n", fields.join(" "))
        };
        fs::write(folder.path().join(name), log.lines().enumerate().map(line).collect::<String>()).expect("writable");
    };
    edited("good.log", &|_, pose| pose);
    edited("drift.log", &|k, [x, y, turn]| [x + 0.01 * k, y - 0.005 * k, turn + 0.01 * k]);
    edited("degrees.log", &|_, [x, y, turn]| [x, y, turn.to_degrees()]);
    let told = |arguments: &[&str]| {
        let arguments = [arguments, &["--mappers", "visibility", "--grid", "0.1", "--out", "o"]].concat();
        let (out, err) = checked(0, &arguments, &replay(folder.path(), &arguments));
        let record = fs::read(folder.path().join("o/run.json")).expect("written");
        let record: Value = serde_json::from_slice(&record).expect("JSON");
        assert!(out.contains("readings kept back end near surfaces\nof the map of visibility"), "{out}");
        (err, record["findings"].clone())
    };
    let odometry = "the pose equals the odometry in all";
    let (err, findings) = told(&["good.log"]);
    assert!(!err.contains("warning: ") && err.contains(&format!("note: good.log: {odometry}")), "{err}");
    assert!(findings["agreement"]["near_surfaces"].as_f64().expect("a share") > 0.9, "{findings}");
    assert_eq!(findings["agreement"]["fails"], false);
    for arguments in [&["drift.log"][..], &["degrees.log"], &["good.log", "--fov", "90"]] {
        let (err, findings) = told(arguments);
        assert!(err.contains("near surfaces of the map of visibility; at least 67 % should"), "{arguments:?}: {err}");
        assert!(
            err.contains("raw odometry") && err.contains(&format!("warning: {}: {odometry}", arguments[0])),
            "{err}"
        );
        assert_eq!(findings["agreement"]["fails"], true, "{findings}");
    }
}

/// A wall that the map knows to a few cells is an obstacle to a costmap: read back, it has the walls of the room in it, and free floor.
#[test]
fn costmaps_hold_obstacles_where_the_robot_does_not_fit() {
    let ground = room();
    let (folder, _, seen) = with_log(&ground);
    let arguments = ["room.log.gz", "--mappers", "visibility,conventional", "--footprint", "0.2", "--out", "o"];
    checked(0, &arguments, &replay(folder.path(), &arguments));
    let read = |name: &str| {
        let out = folder.path().join("o");
        let text = fs::read_to_string(out.join(format!("{name}-footprint.yaml"))).expect("written");
        assert!(text.contains("mode: raw") && text.contains(&format!("image: {name}-footprint.pgm")), "{text}");
        grid::ros_map::read(&out.join(format!("{name}-footprint.yaml"))).expect("readable").occupancy
    };
    let truth = grid::clear(&ground.truth.map(|cell| *cell != Some(false)), 0.2);
    for name in ["visibility", "conventional"] {
        let cost = read(name);
        let here = |cell: usize| seen.spec().locate(cost.spec().centre(cell)).filter(|there| seen[*there]);
        let known = (0..cost.values().len()).filter_map(|cell| Some((cost[cell]?, truth[here(cell)?])));
        let right = known.clone().filter(|(p, fits)| (*p <= 0.5) == *fits).count();
        let known = known.count();
        assert!(known > 1000 && right as f64 > 0.9 * known as f64, "{name}: {right} of {known}");
    }
}

/// The readings of a camera and a laser as one table, and what is said of a laser that has no echo any more.
#[test]
fn several_sensors_are_mapped_together_and_one_that_is_wrong_is_named() {
    let folder = TempDir::new().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let mut room = Command::cargo_bin("experiments").expect("built");
    let words = ["room", "--scene", "office-glass", "--mappers", "visibility", "--out", "room"];
    assert!(room.current_dir(folder.path()).args(words).output().expect("starts").status.success());
    let table = fs::read_to_string(at("room/scans.csv")).expect("written");
    assert!(table.starts_with("scan,time_s,x_m,y_m,theta_rad,bearing_rad,sensor,disparity_px,range_m,true_range_m\n"));
    let dead = |line: &str| {
        let mut cells: Vec<&str> = line.split(',').collect();
        if cells[6] == "1" {
            cells[8] = "inf";
        }
        cells.join(",") + "\n"
    };
    fs::write(at("dead.csv"), table.lines().map(dead).collect::<String>()).expect("written");
    for (log, named) in [("room/scans.csv", None), ("dead.csv", Some("sensor 1 (a laser)"))] {
        let words = [log, "--mappers", "visibility", "--max-range", "30", "--out", "out", "--format", "csv"];
        let done = replay(folder.path(), &words);
        let said = String::from_utf8(done.stderr).expect("text");
        assert!(done.status.success(), "{said}");
        let warned: Vec<&str> = said.lines().filter(|line| line.starts_with("warning: ")).collect();
        match named {
            None => assert_eq!(warned, [""; 0]),
            Some(named) => assert!(warned.len() == 1 && warned[0].contains(named), "{said}"),
        }
        let by_sensor = fs::read_to_string(at("out/by-sensor.csv")).expect("written");
        let heads = "mapper,sensor,kind,readings,predictive_log_loss,low,high,gain_over_unseen,";
        assert!(by_sensor.starts_with(heads), "{by_sensor}");
        let (together, apart) = (rows(&String::from_utf8(done.stdout).expect("text")), by_sensor.lines().skip(1));
        let cells = |row: &str| row.split(',').map(str::to_owned).collect::<Vec<_>>();
        let own: Vec<Vec<String>> = apart.map(cells).filter(|row| row[0] == "visibility").collect();
        let numbers = own.iter().map(|row| [&row[3], &row[4]].map(|cell| cell.parse::<f64>().expect("a number")));
        let [readings, sum] = numbers.fold([0.0; 2], |[n, sum], [of, loss]| [n + of, sum + of * loss]);
        assert_eq!(own.len(), 2);
        assert!((sum / readings - together[0].1).abs() < 1e-4, "the readings of all are those of each");
    }
    // The page shows what both read at the scans kept back.
    let page = fs::read_to_string(at("out/report.html")).expect("written");
    let world = decoded(&page).expect("a page with a viewer").remove(0);
    let names: Vec<&str> = world.sensors.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["0 stereo", "1 laser"]);
    assert!(
        world
            .sensors
            .iter()
            .all(|(_, readings)| readings.iter().flatten().count() > 100 || readings.iter().all(Option::is_none))
    );
}

/// A CARMEN log of a laser and of a ring of eight sonars, which stand on a circle of 0.2 m; the ring is turned by so many degrees against what the log says.
fn with_ring(degrees: f64) -> String {
    let ground = recorded::room();
    let (laser, sonar) = (Laser { max_range_m: 20.0, ..Laser::default() }, Sonar::default());
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    let mut log = "PARAM robot_front_laser_max 20.0\nPARAM robot_max_sonar 5.0\n".to_owned();
    let cast =
        |at: Pose, bearing: f64| ground.world.cast(at.position_m(), at.direction(bearing)).map(|hit| hit.range_m);
    for timed in ground.drive.poses.iter().step_by(3) {
        let (robot, time) = (timed.pose, 100.0 + timed.time_s);
        let _ = write!(log, "FLASER 91");
        for beam in 0..91 {
            let reading = laser.sample(cast(robot, (2.0 * f64::from(beam) - 90.0).to_radians()), &mut rng);
            let _ = write!(log, " {:.3}", if reading.is_finite() { reading.min(19.99) } else { 20.0 });
        }
        let place = format!("{:.4} {:.4} {:.5}", robot.x_m, robot.y_m, robot.theta_rad);
        let _ = writeln!(log, " {place} 0 0 0 {time:.3} robot {time:.3}");
        let on_ring = |k: u32, turn_rad: f64| {
            let theta_rad = f64::from(k) * std::f64::consts::FRAC_PI_4 + turn_rad;
            Pose { x_m: 0.2 * theta_rad.cos(), y_m: 0.2 * theta_rad.sin(), theta_rad }
        };
        let (mut ranges, mut mounts) = (String::new(), String::new());
        for k in 0..8 {
            let (told, true_mount) = (on_ring(k, 0.0), on_ring(k, degrees.to_radians()));
            let (sin, cos) = robot.theta_rad.sin_cos();
            let at = Pose {
                x_m: robot.x_m + cos * true_mount.x_m - sin * true_mount.y_m,
                y_m: robot.y_m + sin * true_mount.x_m + cos * true_mount.y_m,
                theta_rad: robot.theta_rad + true_mount.theta_rad,
            };
            let cone = (-20..=20).filter_map(|step| cast(at, f64::from(step) / 40.0 * sonar.width_rad));
            let reading = sonar.sample(cone.reduce(f64::min), &mut rng);
            let _ = write!(ranges, "{:.2} ", reading.min(5.0));
            let _ = write!(mounts, "{:.3} {:.3} {:.6} ", told.x_m, told.y_m, told.theta_rad);
        }
        let _ = writeln!(log, "SONAR {:.6} 8 {ranges}{mounts}{time:.3} robot {time:.3}", sonar.width_rad);
    }
    log
}

#[test]
fn the_sonars_of_a_carmen_log_are_mapped_with_its_laser_and_a_ring_that_is_turned_is_named() {
    let folder = TempDir::new().expect("a folder");
    for (degrees, named) in [(0.0, None), (6.0, Some("sensor 1 (sonars) fits the map of the other sensors"))] {
        fs::write(folder.path().join("ring.log"), with_ring(degrees)).expect("written");
        let words =
            ["ring.log", "--fov", "180", "--mappers", "visibility", "--grid", "0.1", "--out", "out", "--format", "csv"];
        let done = replay(folder.path(), &words);
        let said = String::from_utf8(done.stderr).expect("text");
        assert!(done.status.success(), "{said}");
        let warned: Vec<&str> = said.lines().filter(|line| line.starts_with("warning: ")).collect();
        match named {
            None => assert_eq!(warned, [""; 0]),
            Some(named) => assert!(warned.len() == 1 && warned[0].contains(named), "{said}"),
        }
        // The ring is judged as one.
        let by_sensor = fs::read_to_string(folder.path().join("out/by-sensor.csv")).expect("written");
        let own: Vec<&str> = by_sensor.lines().filter(|row| row.starts_with("visibility,")).collect();
        assert!(
            own.len() == 2 && own[0].starts_with("visibility,0,a laser,") && own[1].starts_with("visibility,1,sonars,"),
            "{by_sensor}"
        );
        let record: serde_json::Value =
            serde_json::from_str(&fs::read_to_string(folder.path().join("out/run.json")).expect("written"))
                .expect("JSON");
        let sensors = &record["configuration"]["sensors"];
        assert_eq!((sensors["1"]["max_range_m"].as_f64(), sensors["2"].is_null()), (Some(5.0), true), "{sensors}");
        assert!((sensors["1"]["width_rad"].as_f64().expect("a cone") - Sonar::default().width_rad).abs() < 1e-5);
    }
}
