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
