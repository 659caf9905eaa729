//! What the viewer of a page shows, against the tables beside it, without a browser.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use assert_cmd::Command;
use experiments::page::{DecodedWorld, decoded};
use grid::Raster;
use score::{Region, Scorer};

const MAPPERS: [&str; 3] = ["visibility", "visibility-printed", "conventional"];

/// A folder with the results of a small room, and the worlds of its page.
fn room(folder: &Path) -> DecodedWorld {
    fs::write(folder.join("closet.toml"), include_str!("browser/closet.toml")).expect("writable");
    let mut command = Command::cargo_bin("experiments").expect("built");
    let mappers = MAPPERS.join(",");
    command.current_dir(folder).args(["room", "--scene", "closet.toml", "--mappers", &mappers, "--out", "o"]);
    command.assert().success();
    let html = fs::read_to_string(folder.join("o/report.html")).expect("readable");
    decoded(&html).expect("a page with a viewer").remove(0)
}

fn rows(path: &Path) -> Vec<csv::StringRecord> {
    csv::Reader::from_path(path).expect("readable").records().map(|row| row.expect("a row")).collect()
}

/// The cells of a region at a moment.
fn mask(world: &DecodedWorld, region: &str, moment: usize) -> Raster<bool> {
    let parts = &world.parts[moment];
    let by_rays = |part: &Option<Region>| match (region, *part) {
        ("all", part) => part.is_some(),
        ("observable", part) => matches!(part, Some(Region::Visible | Region::Surface)),
        (name, part) => part.is_some_and(|part| part.name() == name),
    };
    match world.regions.iter().find(|(name, _)| name == region) {
        Some((_, cells)) => cells.clone(),
        None => parts.map(by_rays),
    }
}

#[test]
fn the_maps_of_a_page_have_the_metrics_of_the_tables() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let world = room(folder.path());
    let truth = world.truth.as_ref().expect("known");
    let table: HashMap<[String; 4], Option<f64>> = rows(&folder.path().join("o/metrics.csv"))
        .iter()
        .map(|row| ([2, 3, 4, 5].map(|column| row[column].to_owned()), row[6].parse().ok()))
        .collect();
    let mut compared = 0;
    for (stage, moment) in &world.stages {
        let surface = mask(&world, "surface", *moment);
        let scorer = Scorer::new(truth, &surface).expect("one grid");
        for mapper in &world.mappers {
            let place = mapper.moments.iter().position(|at| at == moment).expect("a map at the end of a stage");
            for region in ["observable", "X", "visible", "surface", "shell", "hidden", "all"] {
                let scores = scorer.scores(&mapper.maps[place], &mask(&world, region, *moment)).expect("probabilities");
                // Bins and ranks hang on ties, which steps of any size change: the page has them from the tables alone.
                for metric in scores.metrics().into_iter().filter(|metric| !["auc", "ece"].contains(&metric.name)) {
                    let key = [mapper.name.as_str(), stage, region, metric.name].map(str::to_owned);
                    let bound = match metric.name {
                        "log_loss" | "brier" => 1e-3,
                        _ => 1e-5,
                    };
                    let agrees = match (metric.value, table[&key]) {
                        (Some(page), Some(csv)) => (page - csv).abs() <= bound * csv.max(1.0),
                        (page, csv) => page.is_none() && csv.is_none(),
                    };
                    assert!(agrees, "{key:?}: {:?} on the page, {:?} in the table", metric.value, table[&key]);
                    compared += 1;
                }
                for metric in ["log_loss", "brier", "retention"] {
                    let exact = mapper.exact[&(region.to_owned(), metric.to_owned())][place];
                    let key = [mapper.name.as_str(), stage, region, metric].map(str::to_owned);
                    let agrees = match (exact, table[&key]) {
                        (Some(page), Some(csv)) => (page - csv).abs() <= 1e-5,
                        (page, csv) => page.is_none() && csv.is_none(),
                    };
                    assert!(agrees, "{key:?}: {exact:?} on the page, {:?} in the table", table[&key]);
                }
            }
        }
    }
    assert_eq!(compared, 2 * 3 * 7 * 12);
}

#[test]
fn every_scan_has_its_maps_and_metrics_and_its_readings() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let world = room(folder.path());
    let timeline = rows(&folder.path().join("o/timeline.csv"));
    let scans = timeline.len() / MAPPERS.len();
    assert_eq!(world.moments, (1..=scans).collect::<Vec<_>>(), "every scan can be stepped to");
    for row in &timeline {
        let mapper = world.mappers.iter().find(|mapper| mapper.name == row[0]).expect("on the page");
        let scan: usize = row[1].parse().expect("a number");
        for (region, metric, value) in [("observable", "log_loss", &row[3]), ("all", "retention", &row[4])] {
            let page = mapper.exact[&(region.to_owned(), metric.to_owned())][scan];
            let agrees = match (page, value.parse::<f64>().ok()) {
                (Some(page), Some(csv)) => (page - csv).abs() <= 1e-5,
                (page, csv) => page.is_none() && csv.is_none(),
            };
            assert!(agrees, "{} after scan {scan}: {metric} {page:?} on the page, {value} in the table", mapper.name);
        }
    }
    let readings = rows(&folder.path().join("o/scans.csv"));
    assert_eq!(world.readings.len(), readings.len());
    for (page, row) in world.readings.iter().zip(&readings) {
        let agrees = match (page, row[6].parse::<f64>().ok()) {
            (Some(page), Some(csv)) => (page - csv).abs() <= 0.0101,
            (page, csv) => page.is_none() && csv.is_none(),
        };
        assert!(agrees, "{page:?} {row:?}");
    }
}

#[test]
fn a_world_of_several_sensors_shows_each_and_one_of_a_camera_stays_as_it_is() {
    let folder = tempfile::tempdir().expect("temporary folder");
    let laser = "[[sensor]]\nkind = \"laser\"\nname = \"beam\"\nbeams = 20\nmax_range = 8.0\n";
    let ring = "[[sensor]]\nkind = \"sonar\"\nname = \"ring\"\ncones = 6\nfield_of_view_deg = 360.0\nmax_range = 3.0\nevery = 2\n";
    let page = |name: &str, scene: String| {
        fs::write(folder.path().join(name), scene).expect("writable");
        let mut command = Command::cargo_bin("experiments").expect("built");
        command.current_dir(folder.path()).args(["room", "--scene", name, "--mappers", "visibility", "--out", "o"]);
        command.assert().success();
        fs::read_to_string(folder.path().join("o/report.html")).expect("readable")
    };
    let camera = include_str!("browser/closet.toml").to_owned();
    let one = page("camera.toml", camera.clone());
    assert!(!one.contains("viewer-sensors") && !one.contains("\"sensors\""), "the page of a camera is what it was");
    assert!(decoded(&one).expect("a viewer")[0].sensors.is_empty());
    let all = page("all.toml", format!("{camera}{laser}{ring}"));
    assert!(all.contains("viewer-sensors"));
    let world = decoded(&all).expect("a viewer").remove(0);
    let names: Vec<&str> = world.sensors.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["beam", "ring"], "the camera is the robot's own scan");
    let table = rows(&folder.path().join("o/scans.csv"));
    let of = |sensor: &str| table.iter().filter(|row| &row[6] == sensor).count();
    assert_eq!([of("1"), of("2")], [world.sensors[0].1.len(), world.sensors[1].1.len()], "a place for every beam");
    // Readings as the table has them, to the step of the page.
    let range = |row: &csv::StringRecord| row[8].parse::<f64>().ok().filter(|range| range.is_finite());
    let (read, shown) = (table.iter().filter(|row| &row[6] == "1").map(range), &world.sensors[0].1);
    for (expected, shown) in read.zip(shown) {
        assert_eq!(expected.is_some(), shown.is_some());
        assert!(expected.zip(*shown).is_none_or(|(a, b)| (a - b).abs() < 0.006), "{expected:?} {shown:?}");
    }
}
