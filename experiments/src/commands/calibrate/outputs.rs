//! What `calibrate` writes and prints.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use super::calibration::{Advice, Calibration, Found as Run};
use super::options::CalibrateOptions;
use super::search::Found;
use crate::failure::Failure;
use crate::output::folder::Staging;
use crate::output::record::Record;
use crate::output::table::{self, Table, rounded, wrapped};

/// The name of a file without its folder.
pub(super) fn name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Four digits.
pub(super) fn short(value: f64) -> String {
    let digits = (3 - libm::floor(libm::log10(value.abs().max(1e-9))) as i32).clamp(0, 9) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Everything that was found, with the sensor that it is of.
fn rows(run: &Run) -> Vec<(Option<usize>, &Found)> {
    run.all.iter().flat_map(|one| one.fit.found.iter().map(|found| (one.sensor, found))).collect()
}

/// As printed for programs.
pub(super) fn table(run: &Run) -> Table {
    let rows = rows(run);
    let table = Table::of(
        &rows,
        &[
            ("parameter", &|(_, found)| json!(found.parameter.name)),
            ("value", &|(_, found)| rounded(found.value)),
            ("low", &|(_, found)| rounded(found.interval.low)),
            ("high", &|(_, found)| rounded(found.interval.high)),
            ("unit", &|(_, found)| json!(found.parameter.unit)),
            ("identified", &|(_, found)| json!(found.unidentified.is_none())),
            ("remark", &|(_, found)| json!(found.unidentified.unwrap_or_default())),
        ],
    );
    if run.is_of_several() { table.and(&rows, &[("sensor", &|(sensor, _)| json!(sensor))]) } else { table }
}

/// The files, beside the record.
pub(super) const FILES: [&str; 3] = ["calibration.csv", "profile.csv", "fit.png"];

/// Writes everything.
pub(super) fn write(mut staging: Staging, options: &CalibrateOptions, run: &Run) -> Result<(), Failure> {
    table(run).save(&mut staging, "calibration.csv")?;
    let mut profile = Vec::new();
    for (sensor, Found { parameter, profile: tried, .. }) in rows(run) {
        profile.extend(tried.iter().map(|(value, more)| (parameter.name, *value, *more, sensor)));
    }
    let table = Table::of(
        &profile,
        &[
            ("parameter", &|row| json!(row.0)),
            ("value", &|row| rounded(row.1)),
            ("loss_above_least", &|row| rounded(row.2)),
        ],
    );
    let table = if run.is_of_several() { table.and(&profile, &[("sensor", &|row| json!(row.3))]) } else { table };
    table.save(&mut staging, "profile.csv")?;
    if let Some(picture) = run.all.iter().find_map(|calibration| calibration.picture.as_ref()) {
        options.paper.save(&mut staging, "fit.png", picture)?;
    }
    let mut configuration = json!({
        "file": name(&options.file),
        "consistent": options.consistent,
        "max_disparity": options.max_disparity,
        "focal_baseline": options.focal_baseline,
        "scans": options.scans,
        "beams": options.beams,
        "cell_m": options.grid,
        "max_range_m": options.max_range,
    });
    // What is seldom asked for stands there where it was.
    for (key, value) in [("sonar_range_m", options.sonar_range), ("sonar_width_deg", options.sonar_width)] {
        if let Some(value) = value {
            configuration[key] = json!(value);
        }
    }
    if !options.depth.is_empty() {
        configuration["depth"] = json!(options.depth);
    }
    let told = |one: &Calibration| json!({ "readings": one.readings, "loss": rounded(one.fit.loss.mean) });
    let mut parts = json!({ "configuration": configuration });
    if run.is_of_several() {
        let of = |one: &Calibration| Some((one.sensor?.to_string(), told(one)));
        parts["sensors"] = Value::Object(run.all.iter().filter_map(of).collect());
    } else if let Some(one) = run.all.first() {
        (parts["readings"], parts["loss"]) = (json!(one.readings), rounded(one.fit.loss.mean));
    }
    staging.record(&Record::new("calibrate", parts))?;
    staging.publish()
}

/// What the terminal shows.
pub(super) fn text(run: &Run) -> String {
    let all: Vec<String> = run.all.iter().map(of_one).collect();
    let mut text = all.join("\n");
    if let Some(advice) = &run.advice {
        text += &if run.all.len() > 1 { "\n".to_owned() } else { String::new() };
        text += &advised(advice);
    }
    text
}

/// Where what is to be pasted goes, and that.
fn advised(advice: &Advice) -> String {
    let to = wrapped(advice.to, 80);
    to.iter().chain(&advice.lines).map(|line| format!("{line}\n")).collect()
}

/// What was found of one sensor.
fn of_one(calibration: &Calibration) -> String {
    let Calibration { about, measure, fit, notes, advice, .. } = calibration;
    let mut text = String::new();
    for line in wrapped(&format!("calibration by {about}"), 80) {
        let _ = writeln!(text, "{line}");
    }
    text.push('\n');
    let line = |Found { parameter, value, interval, unidentified, .. }: &Found| {
        vec![
            parameter.name.to_owned(),
            short(*value),
            format!("{} .. {}", short(interval.low), short(interval.high)),
            parameter.unit.to_owned(),
            unidentified.map(|_| "not identified".to_owned()).unwrap_or_default(),
        ]
    };
    text += &table::aligned(
        &["parameter", "value", "95 % interval", "unit", ""],
        &fit.found.iter().map(line).collect::<Vec<_>>(),
    );
    text.push('\n');
    let loss = format!(
        "{:.4} nats per reading at the best of {} settings: the mean of -ln of the {measure}.",
        fit.loss.mean, fit.tried
    );
    let why =
        |found: &Found| found.unidentified.map(|why| format!("{} is not identified: {why}.", found.parameter.name));
    let why: Vec<String> = fit.found.iter().filter_map(why).collect();
    for paragraph in why.iter().chain([&loss]).chain(notes) {
        for line in wrapped(paragraph, 80) {
            let _ = writeln!(text, "{line}");
        }
    }
    text + &advice.as_ref().map_or_else(String::new, advised)
}
