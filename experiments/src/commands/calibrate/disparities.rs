//! Disparities whose truth is known: the camera's kernel, Eq. (21), fitted to their errors.

use std::path::Path;

use super::calibration::{Advice, Calibration};
use super::options::CalibrateOptions;
use super::outputs;
use super::search::{self, Fit, Found, Parameter, Scale};
use crate::failure::Failure;
use crate::figures;

/// Standard normal density at 0.
const AT_ZERO: f64 = 0.398_942_280_401_432_7;

/// Disparities reach so far, px: 256 times those of a wide image.
const MOST_PX: f64 = 1e6;

/// A disparity, and what it should have been.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Match {
    /// Row of the image; the number of the line where there is none.
    row: u64,
    read_px: f64,
    true_px: f64,
    consistent: Option<bool>,
}

/// Disparities of a file, and how many were no match.
pub(super) struct Table {
    matches: Vec<Match>,
    /// Rows without a match: empty, NaN, negative, infinite; 0, where more than a few are so.
    no_match: usize,
}

/// More than this share of disparities of exactly 0 are a code for no match. Some are false matches at the end of the search.
const ZEROS: f64 = 0.05;

/// Scales that matchers write: sixteenths of a pixel (OpenCV), 256ths (KITTI).
const SCALES: [f64; 2] = [16.0, 256.0];

/// Reads the matches of a file; none where the file is no such table.
pub(super) fn load(path: &Path) -> Result<Option<Table>, Failure> {
    let place = path.display();
    let bad = |what: String| Failure::BadInput(format!("{place}{what}"));
    if path.is_dir() {
        return Err(bad(": is a folder; give a log, or a table of disparities".to_owned()));
    }
    let file = strict::opened(path)
        .map_err(|error| bad(format!(": cannot be opened: {error}; check the path and the permissions")))?;
    let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(file);
    let Ok(heads) = table.headers().cloned() else { return Ok(None) };
    let column = |name: &str| heads.iter().position(|head| head.trim_start_matches('\u{feff}') == name);
    let (Some(read), Some(truth)) = (column("disparity_px"), column("true_disparity_px")) else { return Ok(None) };
    let (row, consistent) = (column("row"), column("left_right_consistent"));
    let (mut matches, mut no_match) = (Vec::new(), 0);
    for record in table.into_records() {
        let record = record.map_err(|error| bad(format!(": {error}; every row has as many fields as the head")))?;
        let line = record.position().map_or(0, csv::Position::line);
        let number = |k: usize| -> Result<f64, Failure> {
            let (text, name) = (&record[k], &heads[k]);
            let value = text.parse().ok().filter(|value: &f64| (0.0..=MOST_PX).contains(value));
            value.ok_or_else(|| {
                bad(format!(
                    ":{line}: {name} = {text:?}: must be a disparity in px, 0 to 1000000; leave rows without one out"
                ))
            })
        };
        let consistent = match consistent.map(|k| &record[k]) {
            None => None,
            Some("0") => Some(false),
            Some("1") => Some(true),
            Some(other) => return Err(bad(format!(":{line}: left_right_consistent = {other:?}: must be 0 or 1"))),
        };
        let row = row.and_then(|k| record[k].parse().ok()).unwrap_or(line);
        let text = &record[read];
        if text.is_empty() || text.parse().is_ok_and(|value: f64| !(0.0..=f64::MAX).contains(&value)) {
            no_match += 1;
            continue;
        }
        matches.push(Match { row, read_px: number(read)?, true_px: number(truth)?, consistent });
    }
    let zeros = matches.iter().filter(|m| m.read_px <= 0.0).count();
    if zeros as f64 > ZEROS * matches.len() as f64 {
        matches.retain(|m| m.read_px > 0.0);
        no_match += zeros;
    }
    check_scale(&matches).map_err(|what| bad(format!(": {what}")))?;
    Ok(Some(Table { matches, no_match }))
}

/// Refuses disparities that are a multiple of their truth in the median.
fn check_scale(matches: &[Match]) -> Result<(), String> {
    let mut ratios: Vec<f64> = matches.iter().filter(|m| m.true_px > 0.0).map(|m| m.read_px / m.true_px).collect();
    if ratios.is_empty() {
        return Ok(());
    }
    let middle = ratios.len() / 2;
    let median = *ratios.select_nth_unstable_by(middle, f64::total_cmp).1;
    let Some(scale) = SCALES.into_iter().find(|scale| (0.8..1.25).contains(&(median / scale))) else { return Ok(()) };
    let who = if scale < 100.0 {
        "sixteenths of a pixel, as OpenCV writes them"
    } else {
        "256ths of a pixel, as KITTI has them"
    };
    Err(format!("disparity_px is {scale} times true_disparity_px in the median ({who}): divide it by {scale}"))
}

/// Fits the kernel.
pub(super) fn calibrate(table: &Table, options: &CalibrateOptions) -> Result<Calibration, Failure> {
    let place = options.file.display();
    let Table { matches, no_match } = table;
    let of_logs = ["focal_baseline", "scans", "beams", "grid", "max_range", "fov", "first_bearing", "increment"];
    options.given.warn(&of_logs, &options.file.display().to_string(), "a table of disparities");
    if options.consistent && matches.iter().any(|m| m.consistent.is_none()) {
        let what = "--consistent: needs a column left_right_consistent; leave it out, or run the check";
        return Err(Failure::BadInput(format!("{place}: {what}")));
    }
    let used: Vec<Match> =
        matches.iter().filter(|m| !options.consistent || m.consistent == Some(true)).copied().collect();
    if used.len() < 30 {
        let what = format!("{} disparities are too few to fit a kernel to; give 30 or more", used.len());
        return Err(Failure::BadInput(format!("{place}: {what}")));
    }
    let largest = used.iter().map(|m| m.read_px).fold(1.0, f64::max).ceil();
    let most = options.max_disparity.unwrap_or(largest);
    if let Some(m) = used.iter().find(|m| m.read_px > most) {
        let what =
            format!("--max-disparity {most}: there is a disparity of {} px; it must hold all of them", m.read_px);
        return Err(Failure::BadInput(format!("{place}: {what}")));
    }
    let parameters = [
        Parameter { name: "correct_match", unit: "1", range: [0.01, 0.9999], start: 0.8, scale: Scale::Odds },
        Parameter { name: "disparity_sigma", unit: "px", range: [0.01, 10.0], start: 0.5, scale: Scale::Ratio },
        Parameter { name: "offset", unit: "px", range: [-2.0, 2.0], start: 0.0, scale: Scale::Difference },
    ];
    let mut rows: Vec<&[Match]> = used.chunk_by(|a, b| a.row == b.row).collect();
    // A table without rows: as many members as a square image has.
    let side = (used.len() as f64).sqrt().ceil() as usize;
    if rows.len() == used.len() {
        rows = used.chunks(side).collect();
    }
    let losses = |p: &[f64]| {
        let (correct, sigma, offset) = (p[0], p[1], p[2]);
        let density = |m: &Match| correct * gaussian(m.read_px - m.true_px - offset, sigma) + (1.0 - correct) / most;
        let loss = |row: &&[Match]| (-row.iter().map(|m| libm::log(density(m))).sum::<f64>(), row.len() as u64);
        Some(rows.iter().map(loss).collect())
    };
    let fit = search::fit(&parameters, None, &losses, &|| ())
        .ok_or_else(|| Failure::internal("no setting could be tried"))?;
    let [correct, sigma, offset] = [0, 1, 2].map(|k| fit.found[k].value);
    let errors: Vec<f64> = used.iter().map(|m| m.read_px - m.true_px).collect();
    let density = |error: f64| correct * gaussian(error - offset, sigma) + (1.0 - correct) / most;
    let picture = figures::calibration::draw(&errors, sigma, density, &options.paper);
    let kind = if options.consistent { "disparities that passed a left-right check" } else { "disparities" };
    let about = format!("{} {kind} of {}, up to {most} px", used.len(), outputs::name(&options.file));
    let centred: Vec<f64> = errors.iter().map(|error| error - offset).collect();
    let mut notes = vec![tails(&centred, correct, sigma, most)];
    if fit.found[2].interval.excludes_zero() {
        notes.push(format!(
            "correct disparities are {offset:+.3} px off on average: subtract that, or sigma must hold it"
        ));
    }
    if *no_match > 0 {
        notes.push(format!(
            "{no_match} rows without a match (empty, NaN, negative, infinite, or 0 where many are) were left out"
        ));
    }
    if used.iter().filter(|m| m.read_px.fract() == 0.0).count() * 2 > used.len() {
        notes.push("most disparities are whole pixels: sigma holds their rounding (0.29 px) too".to_owned());
    }
    Ok(Calibration {
        sensor: None,
        about,
        measure: "density of a disparity given its truth, per px",
        readings: used.len() as u64,
        picture: Some(picture),
        notes,
        advice: advice(&fit, most),
        fit,
    })
}

/// The table of a scene file, on one line, of what is identified.
fn advice(fit: &Fit, most: f64) -> Option<Advice> {
    let known = |found: &&Found| found.unidentified.is_none() && found.parameter.name != "offset";
    let key = |found: &Found| format!("{} = {}, ", found.parameter.name, outputs::short(found.value));
    let keys: String = fit.found.iter().filter(known).map(key).collect();
    (!keys.is_empty()).then(|| Advice {
        to: "To use it, at the top of a scene file, in the place of its [sensor]:",
        lines: vec![format!("sensor = {{ {keys}max_disparity = {most} }}")],
    })
}

fn gaussian(error: f64, sigma: f64) -> f64 {
    let z = error / sigma;
    AT_ZERO / sigma * libm::exp(-0.5 * z * z)
}

/// How many errors lie where neither a Gaussian nor uniform false matches put them.
fn tails(errors: &[f64], correct: f64, sigma: f64, most: f64) -> String {
    let (from, to) = (4.0 * sigma, 3.0f64.max(8.0 * sigma));
    let found = errors.iter().filter(|error| (from..to).contains(&error.abs())).count() as f64 / errors.len() as f64;
    let expected = (1.0 - correct) * 2.0 * (to - from) / most;
    format!(
        "{:.1} % of the errors lie between {from:.2} and {to:.2} px, where the fit has {:.1} %: near misses that it takes for false matches",
        100.0 * found,
        100.0 * expected
    )
}
