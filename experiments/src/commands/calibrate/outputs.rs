//! What `calibrate` writes and prints.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::json;

use super::calibration::Calibration;
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

/// As printed for programs.
pub(super) fn table(calibration: &Calibration) -> Table {
    Table::of(
        &calibration.fit.found,
        &[
            ("parameter", &|found| json!(found.parameter.name)),
            ("value", &|found| rounded(found.value)),
            ("low", &|found| rounded(found.interval.low)),
            ("high", &|found| rounded(found.interval.high)),
            ("unit", &|found| json!(found.parameter.unit)),
            ("identified", &|found| json!(found.unidentified.is_none())),
            ("remark", &|found| json!(found.unidentified.unwrap_or_default())),
        ],
    )
}

/// The files, beside the record.
pub(super) const FILES: [&str; 3] = ["calibration.csv", "profile.csv", "fit.png"];

/// Writes everything.
pub(super) fn write(
    mut staging: Staging,
    options: &CalibrateOptions,
    calibration: &Calibration,
) -> Result<(), Failure> {
    table(calibration).save(&mut staging, "calibration.csv")?;
    let mut profile = Vec::new();
    for Found { parameter, profile: tried, .. } in &calibration.fit.found {
        profile.extend(tried.iter().map(|(value, more)| (parameter.name, *value, *more)));
    }
    let profile = Table::of(
        &profile,
        &[
            ("parameter", &|row| json!(row.0)),
            ("value", &|row| rounded(row.1)),
            ("loss_above_least", &|row| rounded(row.2)),
        ],
    );
    profile.save(&mut staging, "profile.csv")?;
    if let Some(picture) = &calibration.picture {
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
    if let Some(sensor) = options.sensor {
        configuration["sensor"] = json!(sensor);
    }
    let loss = rounded(calibration.fit.loss.mean);
    let parts = json!({ "configuration": configuration, "readings": calibration.readings, "loss": loss });
    staging.record(&Record::new("calibrate", parts))?;
    staging.publish()
}

/// What the terminal shows.
pub(super) fn text(calibration: &Calibration) -> String {
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
    for paragraph in
        why.iter().chain([&loss]).chain(notes).map(String::as_str).chain(advice.as_ref().map(|advice| advice.to))
    {
        for line in wrapped(paragraph, 80) {
            let _ = writeln!(text, "{line}");
        }
    }
    if let Some(advice) = advice {
        let _ = writeln!(text, "{}", advice.line);
    }
    text
}
