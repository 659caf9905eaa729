//! The files that `room` leaves behind.

use std::io::{self, Write as _};

use grid::{Raster, npy};
use serde_json::{Value, json};

use super::document;
use super::record::Record;
use super::summary::over_seeds;
use crate::failure::Failure;
use crate::figures;
use crate::output::folder::{RECORD, Staging};
use crate::output::table::{Table, optional, rounded};
use crate::page::{self, Picture, Viewer, World};
use crate::worlds::run::{Ground, RegionScore, Stage, Trial};

/// Every metric of every seed, mapper, stage and region.
pub(super) fn metrics(ground: &Ground, trials: &[Trial], stages: &[Stage]) -> Table {
    let mut table = Table::new(&["scene", "seed", "mapper", "stage", "region", "metric", "value", "unit", "support"]);
    for trial in trials {
        for run in &trial.runs {
            for (stage, map) in stages.iter().zip(&run.stages) {
                for score in &map.scores {
                    let metric = &score.metric;
                    table.push(vec![
                        json!(ground.scene.name),
                        json!(trial.seed),
                        json!(run.mapper),
                        json!(stage.name),
                        json!(score.region),
                        json!(metric.name),
                        optional(metric.value),
                        json!(metric.unit),
                        json!(metric.support),
                    ]);
                }
            }
        }
    }
    table
}

/// Writes everything; readings, maps and pictures are those of the first seed.
pub(super) fn write(
    staging: &mut Staging,
    ground: &Ground,
    trials: &[Trial],
    stages: &[Stage],
    frames: &[usize],
    metrics: &Table,
    record: &mut Record,
) -> Result<(), Failure> {
    let first = &trials[0];
    csv(staging, "metrics.csv", metrics)?;
    if trials.len() > 1 {
        csv(staging, "summary.csv", &summary(ground, trials, stages))?;
    }
    csv(staging, "scans.csv", &scans(first))?;
    csv(staging, "timeline.csv", &timeline(first))?;
    let truth = ground.truth.map(|cell| cell.map_or(f32::NAN, |occupied| f32::from(u8::from(occupied))));
    staging.write("truth.npy", |out| npy::write(&truth, out))?;
    for run in &first.runs {
        for (stage, map) in stages.iter().zip(&run.stages) {
            let name = format!("{}-{}.npy", run.mapper, stage.name);
            staging.write(&name, |out| npy::write(&six_decimals(&map.occupancy), out))?;
        }
    }
    let pictures = pictures(staging, ground, first, stages)?;
    record.files = staging.files_and(&["report.html", RECORD]);
    let mut csv = Vec::new();
    metrics.write_csv(&mut csv).map_err(Failure::internal)?;
    let rows = document::rows(&csv).map_err(Failure::internal)?;
    let json = serde_json::to_value(&*record).map_err(Failure::internal)?;
    let viewer = Viewer { worlds: vec![World::new(ground, first, stages, frames)] };
    let html = page::page(&document::page(ground, stages, &json, &rows, pictures, viewer)?)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    staging.record(record)
}

/// Mean and spread over the seeds of every metric.
fn summary(ground: &Ground, trials: &[Trial], stages: &[Stage]) -> Table {
    let mut table = Table::new(&[
        "scene",
        "mapper",
        "stage",
        "region",
        "metric",
        "mean",
        "standard_deviation",
        "minimum",
        "maximum",
        "seeds",
        "unit",
    ]);
    for run in &trials[0].runs {
        for (i, (stage, map)) in stages.iter().zip(&run.stages).enumerate() {
            for RegionScore { region, metric } in &map.scores {
                let spread = over_seeds(trials, run.mapper, i, region, metric.name);
                let value = |of: fn(&score::Summary) -> Option<f64>| optional(spread.as_ref().and_then(of));
                table.push(vec![
                    json!(ground.scene.name),
                    json!(run.mapper),
                    json!(stage.name),
                    json!(region),
                    json!(metric.name),
                    value(|s| Some(s.mean)),
                    value(|s| s.standard_deviation),
                    value(|s| Some(s.minimum)),
                    value(|s| Some(s.maximum)),
                    json!(spread.map_or(0, |s| s.count)),
                    json!(metric.unit),
                ]);
            }
        }
    }
    table
}

fn csv(staging: &mut Staging, name: &str, table: &Table) -> Result<(), Failure> {
    staging.write(name, |out| table.write_csv(out).map_err(io::Error::other))
}

fn scans(trial: &Trial) -> Table {
    let mut table =
        Table::new(&["scan", "time_s", "x_m", "y_m", "theta_rad", "bearing_rad", "disparity_px", "true_range_m"]);
    for (i, simulated) in trial.simulation.scans.iter().enumerate() {
        let scan = &simulated.scan;
        let pose = [scan.time_s, scan.pose.x_m, scan.pose.y_m, scan.pose.theta_rad].map(rounded);
        for (ray, range) in scan.rays().zip(&simulated.true_ranges_m) {
            let mut row = vec![json!(i)];
            row.extend(pose.iter().cloned());
            row.extend([rounded(ray.bearing_rad), optional(ray.reading), optional(*range)]);
            table.push(row);
        }
    }
    table
}

fn timeline(trial: &Trial) -> Table {
    let mut table = Table::new(&["mapper", "scan", "time_s", "log_loss", "retention"]);
    for run in &trial.runs {
        for (i, moment) in run.timeline.iter().enumerate() {
            let values = [rounded(moment.time_s), optional(moment.log_loss), optional(moment.retention)];
            table.push([json!(run.mapper), json!(i)].into_iter().chain(values).collect::<Vec<Value>>());
        }
    }
    table
}

/// Rounded, so that committed maps survive another machine.
fn six_decimals(map: &Raster<f64>) -> Raster<f32> {
    map.map(|p| ((p * 1e6).round() / 1e6) as f32)
}

/// Draws every picture and hands them on for the report.
fn pictures(staging: &mut Staging, ground: &Ground, trial: &Trial, stages: &[Stage]) -> Result<Vec<Picture>, Failure> {
    let mut pictures = Vec::new();
    for (name, caption) in document::PICTURES {
        let bytes = match name {
            "scene.png" => figures::scene::draw(ground)?,
            "maps.png" => figures::maps::draw(ground, trial, stages)?,
            "regions.png" if ground.scene.regions.is_empty() => continue,
            "regions.png" => figures::regions::draw(ground, trial, stages)?,
            _ => figures::timeline::draw(trial, stages)?,
        };
        staging.write(name, |out| out.write_all(&bytes))?;
        pictures.push(Picture { name: name.to_owned(), caption: caption.to_owned(), bytes });
    }
    Ok(pictures)
}
