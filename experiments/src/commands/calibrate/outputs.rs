//! What `calibrate` writes and says.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;

use serde_json::json;

use super::calibration::Calibration;
use super::options::CalibrateOptions;
use super::search::Found;
use crate::failure::Failure;
use crate::output::folder::{RECORD, Staging};
use crate::output::record::versions;
use crate::output::table::{self, Table, rounded};

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
    let mut table = Table::new(&["parameter", "value", "low", "high", "unit", "identified", "remark"]);
    for Found { parameter, value, interval, unidentified, .. } in &calibration.fit.found {
        table.push(vec![
            json!(parameter.name),
            rounded(*value),
            rounded(interval.low),
            rounded(interval.high),
            json!(parameter.unit),
            json!(unidentified.is_none()),
            json!(unidentified.unwrap_or_default()),
        ]);
    }
    table
}

/// Writes everything.
pub(super) fn write(
    mut staging: Staging,
    options: &CalibrateOptions,
    calibration: &Calibration,
) -> Result<(), Failure> {
    let csv = |staging: &mut Staging, name: &str, table: &Table| {
        staging.write(name, |out| table.write_csv(out).map_err(io::Error::other))
    };
    csv(&mut staging, "calibration.csv", &table(calibration))?;
    let mut profile = Table::new(&["parameter", "value", "loss_above_least"]);
    for found in &calibration.fit.found {
        for (value, more) in &found.profile {
            profile.push(vec![json!(found.parameter.name), rounded(*value), rounded(*more)]);
        }
    }
    csv(&mut staging, "profile.csv", &profile)?;
    if let Some(picture) = &calibration.picture {
        staging.write("fit.png", |out| out.write_all(picture))?;
    }
    let files = staging.files_and(&[RECORD]);
    let record = json!({
        "schema_version": 1,
        "command": "calibrate",
        "configuration": {
            "file": name(&options.file),
            "consistent": options.consistent,
            "max_disparity": options.max_disparity,
            "focal_baseline": options.focal_baseline,
            "scans": options.scans,
            "beams": options.beams,
            "cell_m": options.grid,
            "max_range_m": options.max_range,
        },
        "readings": calibration.readings,
        "loss": rounded(calibration.fit.loss.mean),
        "versions": versions(),
        "files": files,
    });
    staging.record(&record)?;
    staging.publish()
}

/// What the terminal shows.
pub(super) fn text(calibration: &Calibration) -> String {
    let Calibration { about, measure, fit, notes, advice, .. } = calibration;
    let mut text = String::new();
    for line in wrapped(&format!("calibration by {about}")) {
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
    for paragraph in why.iter().chain([&loss]).chain(notes).chain([&format!("To use it: {advice}")]) {
        for line in wrapped(paragraph) {
            let _ = writeln!(text, "{line}");
        }
    }
    text
}

/// Lines of at most 80 characters.
fn wrapped(text: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        if lines[last].is_empty() {
            lines[last] = word.to_owned();
        } else if lines[last].chars().count() + 1 + word.chars().count() <= 80 {
            lines[last] = format!("{} {word}", lines[last]);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
}
