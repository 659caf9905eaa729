//! The files that `features` leaves behind, and what it prints.

use serde_json::{Value, json};

use super::figure;
use super::filter::Filter;
use super::options::{Asked, FeaturesOptions};
use super::scores::Scores;
use super::source::Recording;
use super::track::Found;
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::folder::Staging;
use crate::output::record::Record;
use crate::output::table::{Table, aligned, optional, rounded};
use crate::worlds::landmarks;

/// All that there is to tell.
pub(super) struct Told<'a> {
    pub(super) options: &'a FeaturesOptions,
    pub(super) place: &'a str,
    pub(super) filters: &'a [Filter],
    /// Of the first run.
    pub(super) recording: &'a Recording,
    /// By the first filter.
    pub(super) found: &'a Found,
    pub(super) scores: &'a Scores,
}

/// Every file that may come of it, beside the record.
pub(super) fn names(paper: &Paper) -> Vec<String> {
    let fixed = ["trajectory.txt", landmarks::FILE, "features.csv", "metrics.csv", "updates.csv"].map(str::to_owned);
    fixed.into_iter().chain(paper.files(&["features.png"])).collect()
}

/// Writes everything.
pub(super) fn write(staging: &mut Staging, told: &Told) -> Result<(), Failure> {
    staging.write("trajectory.txt", |out| trajectory(told, out))?;
    landmarks::table(&told.found.landmarks, &told.recording.camera).save(staging, landmarks::FILE)?;
    readings(told.recording).save(staging, "features.csv")?;
    told.scores.runs().save(staging, "metrics.csv")?;
    if !told.found.beliefs.is_empty() {
        updates(told).save(staging, "updates.csv")?;
    }
    let drawing = figure::draw(told.recording, told.found, told.filters[0].name(), &told.options.paper);
    told.options.paper.save(staging, "features.png", &drawing)?;
    let mut parts = json!({ "configuration": configuration(told) });
    if let Some(pictures) = told.options.paper.asked() {
        parts["pictures"] = json!(pictures);
    }
    staging.record(&Record::new("features", parts))
}

/// A row for every scan: time, s, place, m, and a quaternion.
fn trajectory(told: &Told, out: &mut impl std::io::Write) -> std::io::Result<()> {
    for (scan, pose) in told.recording.scans.iter().zip(&told.found.way) {
        let (sin, cos) = libm::sincos(0.5 * pose.theta_rad);
        writeln!(out, "{:.6} {:.6} {:.6} 0 0 0 {sin:.9} {cos:.9}", scan.time_s, pose.x_m, pose.y_m)?;
    }
    Ok(())
}

/// A reading, or a scan without any.
#[derive(Clone, Copy)]
struct Reading {
    scan: usize,
    number: Option<usize>,
}

/// The table that `features` reads.
fn readings(recording: &Recording) -> Table {
    let of = |(scan, taken): (usize, &sensor::FeatureScan)| -> Vec<Reading> {
        match taken.readings.len() {
            0 => vec![Reading { scan, number: None }],
            n => (0..n).map(|number| Reading { scan, number: Some(number) }).collect(),
        }
    };
    let rows: Vec<Reading> = recording.scans.iter().enumerate().flat_map(of).collect();
    let reading = |row: &Reading| row.number.map(|number| &recording.scans[row.scan].readings[number]);
    let known = |row: &Reading| row.number.and_then(|number| recording.known[row.scan][number]);
    let mut table = Table::of(
        &rows,
        &[
            ("scan", &|row| json!(row.scan)),
            ("time_s", &|row| exact(Some(recording.scans[row.scan].time_s))),
            ("bearing_rad", &|row| exact(reading(row).map(|r| r.bearing_rad))),
            ("disparity_px", &|row| exact(reading(row).map(|r| r.disparity_px))),
        ],
    );
    let pose = |row: &Reading| recording.scans[row.scan].pose;
    if recording.scans.iter().any(|scan| scan.pose.is_some()) {
        table = table.and(
            &rows,
            &[
                ("x_m", &|row| exact(pose(row).map(|p| p.x_m))),
                ("y_m", &|row| exact(pose(row).map(|p| p.y_m))),
                ("theta_rad", &|row| exact(pose(row).map(|p| p.theta_rad))),
            ],
        );
    }
    let odometry = |row: &Reading| recording.scans[row.scan].odometry;
    if recording.scans.iter().any(|scan| scan.odometry.is_some()) {
        table = table.and(
            &rows,
            &[
                ("odom_x_m", &|row| exact(odometry(row).map(|p| p.x_m))),
                ("odom_y_m", &|row| exact(odometry(row).map(|p| p.y_m))),
                ("odom_theta_rad", &|row| exact(odometry(row).map(|p| p.theta_rad))),
            ],
        );
    }
    table.and(
        &rows,
        &[
            ("feature", &|row| json!(reading(row).and_then(|r| r.identity))),
            ("matched", &|row| json!(known(row).map(|known| u8::from(known.matched)))),
        ],
    )
}

/// A number to its last digit, so that what is read again is the same.
fn exact(value: Option<f64>) -> Value {
    value.map_or(Value::Null, |value| json!(value))
}

fn updates(told: &Told) -> Table {
    let rows: Vec<_> = told.recording.scans.iter().zip(&told.found.beliefs).collect();
    let sigma = |row: &(&sensor::FeatureScan, &slam::features::PoseBelief), k: usize| row.1.covariance[k][k].sqrt();
    Table::of(
        &rows,
        &[
            ("time_s", &|row| rounded(row.0.time_s)),
            ("readings", &|row| json!(row.0.readings.len())),
            ("effective", &|row| rounded(row.1.effective)),
            ("resampled", &|row| json!(row.1.resampled)),
            ("sigma_x_m", &|row| optional(Some(sigma(row, 0)))),
            ("sigma_y_m", &|row| optional(Some(sigma(row, 1)))),
            ("sigma_theta_deg", &|row| optional(Some(sigma(row, 2).to_degrees()))),
            ("landmarks", &|row| json!(row.1.landmarks)),
        ],
    )
}

/// What the results were made from.
fn configuration(told: &Told) -> Value {
    let (options, camera) = (told.options, &told.recording.camera);
    let rules = options.association();
    let identity = match options.identity {
        Asked::Unknown => "unknown",
        Asked::Known => "known",
    };
    json!({
        "source": options.source.as_ref().map(|_| told.place),
        "posts": options.posts,
        "filters": told.filters.iter().map(|filter| filter.name()).collect::<Vec<_>>(),
        "particles": options.particles,
        "seed": options.seed,
        "runs": options.runs,
        "identity": identity,
        "negative_evidence": rules.negative_evidence,
        "vantage_m": if rules.vantage_m.is_finite() { json!(rules.vantage_m) } else { json!("inf") },
        "association_gate": rules.gate,
        "occluder_m": rules.occluder_m,
        "noise": options.noise(),
        "gate_m": options.gate,
        "drives": options.drives,
        "layout": options.layout,
        "camera": {
            "focal_baseline": camera.stereo.focal_baseline,
            "disparity_sigma": camera.stereo.disparity_sigma,
            "correct_match": camera.stereo.correct_match,
            "max_disparity": camera.stereo.max_disparity,
            "bearing_sigma_rad": camera.bearing_sigma_rad,
            "field_of_view_rad": camera.field_of_view_rad,
            "depth_m": camera.most_depth_m,
            "detection": camera.detection,
        },
    })
}

/// What the terminal shows.
pub(super) fn text(told: &Told) -> String {
    let recording = told.recording;
    let readings: usize = recording.scans.iter().map(|scan| scan.readings.len()).sum();
    let mut text = format!("features of {}\n{} scans with {readings} readings", told.place, recording.scans.len());
    if told.options.runs > 1 {
        text.push_str(&format!(" in the first of {} runs", told.options.runs));
    }
    if told.filters.iter().any(|filter| *filter != Filter::KnownPoses) {
        text.push_str(&format!("; {} particles", told.options.particles));
    }
    text.push_str("\n\n");
    let table = told.scores.table(told.filters);
    text.push_str(&aligned(table.columns(), &table.fields()));
    for (other, mean, [low, high]) in told.scores.differences(told.filters) {
        let verdict = match (low > 0.0, high < 0.0) {
            (true, _) => "worse",
            (_, true) => "better",
            _ => "undecided",
        };
        text.push_str(&format!(
            "\nATE of {} less that of {other}: {mean:.3} m ({low:.3} to {high:.3}): {verdict}\n",
            told.filters[0].name()
        ));
    }
    text
}
