//! The files that `room` leaves behind.

use std::io::Write as _;

use grid::npy;
use mapper::catalogue::Entry;
use sensor::{Pose, Ray, Scan, SensorKind};
use serde_json::{Value, json};

use super::document;
use super::programs;
use super::record::Parts;
use super::summary::over_seeds;
use crate::failure::Failure;
use crate::figures::{self, Paper};
use crate::output;
use crate::output::folder::Staging;
use crate::output::ledger::RECORD;
use crate::output::record::Record;
use crate::output::table::{Table, optional, rounded};
use crate::page::{self, Picture, ViewedWorld, Viewer};
use crate::worlds::ground::Ground;
use crate::worlds::run::{RegionScore, Stage, Trial};

/// A row of `metrics.csv`.
struct Scored<'a> {
    seed: u64,
    mapper: &'static str,
    stage: &'a str,
    score: &'a RegionScore,
    fault: Option<&'a str>,
}

/// Every metric of every seed, mapper, stage and region.
pub(super) fn metrics(ground: &Ground, trials: &[Trial], stages: &[Stage]) -> Table {
    let mut rows = Vec::new();
    for trial in trials {
        for run in &trial.runs {
            for (stage, map) in stages.iter().zip(&run.stages) {
                let (seed, mapper, stage, fault) = (trial.seed, run.mapper, stage.name.as_str(), map.fault.as_deref());
                rows.extend(map.scores.iter().map(|score| Scored { seed, mapper, stage, score, fault }));
            }
        }
    }
    let table = Table::of(
        &rows,
        &[
            ("scene", &|_| json!(ground.scene.name)),
            ("seed", &|row| json!(row.seed)),
            ("mapper", &|row| json!(row.mapper)),
            ("stage", &|row| json!(row.stage)),
            ("region", &|row| json!(row.score.region)),
            ("metric", &|row| json!(row.score.metric.name)),
            ("value", &|row| optional(row.score.metric.value)),
            ("unit", &|row| json!(row.score.metric.unit)),
            ("support", &|row| json!(row.score.metric.support)),
        ],
    );
    match trials.iter().flat_map(|trial| &trial.runs).any(|run| run.program.is_some()) {
        true => table.and(&rows, &[("error", &|row| json!(row.fault))]),
        false => table,
    }
}

/// Every file that may come of it, beside the record.
pub(super) fn names(ground: &Ground, mappers: &[&Entry], paper: &Paper) -> Vec<String> {
    let tables = ["metrics.csv", "summary.csv", "scans.csv", "timeline.csv", "truth.npy", "report.html"];
    let pictures = document::PICTURES.map(|(name, _)| name);
    let stages = || ground.scene.stages.iter().map(|stage| &stage.name);
    let maps = mappers
        .iter()
        .flat_map(|entry| stages().flat_map(|stage| output::map::names(&format!("{}-{stage}", entry.name))));
    let of_programs =
        mappers.iter().flat_map(|entry| [programs::stderr_file(entry.name), page::kept::name(entry.name)]);
    tables.into_iter().map(str::to_owned).chain(paper.files(&pictures)).chain(maps).chain(of_programs).collect()
}

/// What came of a run.
#[derive(Clone, Copy)]
pub(super) struct Outcome<'a> {
    pub(super) ground: &'a Ground,
    pub(super) trials: &'a [Trial],
    pub(super) stages: &'a [Stage],
    /// Scans after which the page shows maps.
    pub(super) frames: &'a [usize],
}

/// Writes everything; readings, maps and pictures are those of the first seed.
pub(super) fn write(
    staging: &mut Staging,
    Outcome { ground, trials, stages, frames }: Outcome,
    metrics: &Table,
    record: &Record<Parts>,
    paper: &Paper,
) -> Result<(), Failure> {
    let first = &trials[0];
    metrics.save(staging, "metrics.csv")?;
    if trials.len() > 1 {
        summary(ground, trials, stages).save(staging, "summary.csv")?;
    }
    scans(ground, first).save(staging, "scans.csv")?;
    timeline(first).save(staging, "timeline.csv")?;
    let truth = ground.truth.map(|cell| cell.map_or(f32::NAN, |occupied| f32::from(u8::from(occupied))));
    staging.write("truth.npy", |out| npy::write(&truth, out))?;
    for run in &first.runs {
        for ((stage, map), reached) in stages.iter().zip(&run.stages).zip(&first.reached) {
            if map.fault.is_some() {
                continue;
            }
            output::map::write(staging, &format!("{}-{}", run.mapper, stage.name), &map.occupancy, reached)?;
        }
    }
    programs::save_stderr(staging, trials, stages)?;
    let pictures = pictures(staging, ground, first, stages, paper)?;
    let rows = document::rows(&metrics.csv()?).map_err(Failure::internal)?;
    let viewer = Viewer { worlds: vec![ViewedWorld::new(ground, first, stages, frames)?], budget: page::WORLD_BYTES };
    let programs = first.runs.iter().filter(|run| run.program.is_some());
    programs.map(|run| run.mapper).try_for_each(|program| page::kept::save(staging, &viewer, program))?;
    let json = record.json(&staging.files_and(&["report.html", RECORD]))?;
    let html = page::page(&document::page(ground, stages, &json, &rows, pictures, viewer)?)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    staging.record(record)
}

/// Mean and spread over the seeds of every metric.
fn summary(ground: &Ground, trials: &[Trial], stages: &[Stage]) -> Table {
    let mut rows = Vec::new();
    for run in &trials[0].runs {
        for (i, (stage, map)) in stages.iter().zip(&run.stages).enumerate() {
            for score in &map.scores {
                let spread = over_seeds(trials, run.mapper, i, &score.region, score.metric.name);
                let scored =
                    Scored { seed: trials[0].seed, mapper: run.mapper, stage: &stage.name, score, fault: None };
                rows.push((scored, spread));
            }
        }
    }
    Table::of(
        &rows,
        &[
            ("scene", &|_| json!(ground.scene.name)),
            ("mapper", &|(row, _)| json!(row.mapper)),
            ("stage", &|(row, _)| json!(row.stage)),
            ("region", &|(row, _)| json!(row.score.region)),
            ("metric", &|(row, _)| json!(row.score.metric.name)),
            ("mean", &|(_, spread)| optional(spread.map(|s| s.mean))),
            ("standard_deviation", &|(_, spread)| optional(spread.and_then(|s| s.standard_deviation))),
            ("minimum", &|(_, spread)| optional(spread.map(|s| s.minimum))),
            ("maximum", &|(_, spread)| optional(spread.map(|s| s.maximum))),
            ("seeds", &|(_, spread)| json!(spread.map_or(0, |s| s.count))),
            ("unit", &|(row, _)| json!(row.score.metric.unit)),
        ],
    )
}

/// A ray of a scan, for a row of `scans.csv`.
struct Beam<'a> {
    number: usize,
    scan: &'a Scan,
    ray: Ray,
    true_range_m: Option<f64>,
    odometry: Option<Pose>,
}

/// All scans of the camera, or of all sensors: then with a column that names the sensor and one for the readings of each unit.
fn scans(ground: &Ground, trial: &Trial) -> Table {
    let mut rows: Vec<Beam> = Vec::new();
    for (number, simulated) in trial.simulation.scans.iter().enumerate() {
        let odometry = simulated.odometry;
        let mut add = |scan, true_ranges_m: &[Option<f64>]| {
            let rays = Scan::rays(scan).zip(true_ranges_m.iter().copied());
            rows.extend(rays.map(|(ray, true_range_m)| Beam { number, scan, ray, true_range_m, odometry }));
        };
        add(&simulated.scan, &simulated.true_ranges_m);
        simulated.beside.iter().for_each(|beside| add(&beside.scan, &beside.true_ranges_m));
    }
    let devices = &ground.scene.sensors;
    let is_of = |row: &Beam, kinds: &[SensorKind]| match row.scan.sensor {
        0 => kinds.contains(&SensorKind::Stereo),
        sensor => kinds.contains(&devices[sensor - 1].device.kind()),
    };
    // No echo has no number in JSON; tables have the word for it.
    let reading = |row: &Beam, kinds: &[SensorKind]| match row.ray.reading.filter(|_| is_of(row, kinds)) {
        Some(reading) if reading.is_infinite() => json!("inf"),
        reading => optional(reading),
    };
    let place: [Column; 6] = [
        ("scan", &|row| json!(row.number)),
        ("time_s", &|row| rounded(row.scan.time_s)),
        ("x_m", &|row| rounded(row.scan.pose.x_m)),
        ("y_m", &|row| rounded(row.scan.pose.y_m)),
        ("theta_rad", &|row| rounded(row.scan.pose.theta_rad)),
        ("bearing_rad", &|row| rounded(row.ray.bearing_rad)),
    ];
    let disparity: Column = ("disparity_px", &|row| reading(row, &[SensorKind::Stereo]));
    let range: Column = ("range_m", &|row| reading(row, &[SensorKind::Laser, SensorKind::Depth]));
    let sonar: Column = ("sonar_m", &|row| reading(row, &[SensorKind::Sonar]));
    let sensor: Column = ("sensor", &|row| json!(row.scan.sensor));
    let has = |kinds: &[SensorKind]| rows.iter().any(|row| is_of(row, kinds));
    let mut columns = place.to_vec();
    if devices.is_empty() {
        columns.push(disparity);
    } else {
        columns.push(sensor);
        columns.extend(has(&[SensorKind::Stereo]).then_some(disparity));
        columns.extend(has(&[SensorKind::Laser, SensorKind::Depth]).then_some(range));
        columns.extend(has(&[SensorKind::Sonar]).then_some(sonar));
    }
    columns.push(("true_range_m", &|row| optional(row.true_range_m)));
    let table = Table::of(&rows, &columns);
    if trial.simulation.scans.iter().all(|simulated| simulated.odometry.is_none()) {
        return table;
    }
    table.and(
        &rows,
        &[
            ("odom_x_m", &|row| optional(row.odometry.map(|pose| pose.x_m))),
            ("odom_y_m", &|row| optional(row.odometry.map(|pose| pose.y_m))),
            ("odom_theta_rad", &|row| optional(row.odometry.map(|pose| pose.theta_rad))),
        ],
    )
}

/// A column of `scans.csv`.
type Column<'a> = (&'static str, &'a dyn Fn(&Beam) -> Value);

fn timeline(trial: &Trial) -> Table {
    let mut rows = Vec::new();
    for run in &trial.runs {
        rows.extend(run.timeline.iter().enumerate().map(|(scan, moment)| (run.mapper, scan, moment)));
    }
    Table::of(
        &rows,
        &[
            ("mapper", &|row| json!(row.0)),
            ("scan", &|row| json!(row.1)),
            ("time_s", &|row| rounded(row.2.time_s)),
            ("log_loss", &|row| optional(row.2.log_loss)),
            ("retention", &|row| optional(row.2.retention)),
        ],
    )
}

/// Draws every picture and hands them on for the report.
fn pictures(
    staging: &mut Staging,
    ground: &Ground,
    trial: &Trial,
    stages: &[Stage],
    paper: &Paper,
) -> Result<Vec<Picture>, Failure> {
    let mut pictures = Vec::new();
    for (name, caption) in document::PICTURES {
        let drawing = match name {
            "scene.png" => figures::scene::draw(ground, paper),
            "maps.png" => figures::maps::draw(ground, trial, stages, paper),
            "regions.png" if ground.scene.regions.is_empty() => continue,
            "movement.png" if trial.moving.is_empty() => continue,
            "movement.png" => figures::movement::draw(ground, trial, stages, paper),
            "regions.png" => figures::regions::draw(ground, trial, stages, paper),
            _ => figures::timeline::draw(trial, stages, paper),
        };
        let bytes = paper.save(staging, name, &drawing)?;
        pictures.push(Picture { name: name.to_owned(), caption: caption.to_owned(), bytes });
    }
    Ok(pictures)
}
