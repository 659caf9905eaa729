//! Ray files: TOML, read as strictly as a scene.

use std::fmt::Write as _;
use std::path::Path;

use scene::reader::stereo;
use strict::{Error, Limit, Table, Value, number, open, read};

use super::viewing_ray::{MOST_CELLS, ViewingRay};

const KEYS: [&str; 7] = ["cells", "cell_size", "observation", "prior", "correlation", "no_hit_likelihood", "sensor"];

const fn limit(min: f64, max: f64, bound: &'static str, remedy: &'static str) -> Limit {
    Limit { min, max, bound, remedy }
}

const CELLS: Limit =
    limit(1.0, MOST_CELLS as f64, "a whole number from 1 to 100000", "give the number of cells, such as 60");
const CELL_SIZE: Limit =
    limit(1e-4, 1e3, "a cell size in m, 0.0001 to 1000", "give the length of the ray in a cell, such as 0.05");
const OBSERVATION: Limit = limit(0.0, 1e6, "a disparity in px, 0 to 1000000", "give the reading, such as 10.0");
const NO_HIT: Limit = limit(
    0.0,
    1e6,
    "a density in 1/px, 0 to 1000000",
    "give the likelihood of the reading if no cell is occupied, or leave it out to let the prior go on past the last cell",
);
const PRIOR: Limit =
    limit(0.0, 1.0, "a probability, 0 to 1", "give one number such as 0.1, or a list with one per cell");
const CORRELATION: Limit = limit(
    -1.0,
    1.0,
    "a correlation, -1 to 1",
    "give one number such as 0.871, or a list with one per pair of neighbouring cells",
);

/// Reads a ray file.
///
/// # Errors
/// The first problem, with line and column.
pub fn load(path: &Path) -> Result<ViewingRay, Error> {
    parse(&read(path)?, &path.display().to_string())
}

/// Checks the text of a ray file; `file` is what messages call it.
///
/// # Errors
/// The first problem, with line and column.
pub fn parse(text: &str, file: &str) -> Result<ViewingRay, Error> {
    let (source, document) = open(text, file)?;
    let root = Table::new(&source, "the ray", 0, document.get_ref());
    root.only(&KEYS)?;
    let cells = cells(&root)?;
    let cell_size_m = root.number("cell_size", &CELL_SIZE)?;
    let stereo = stereo(&root)?;
    let observation_px = root.number("observation", &OBSERVATION)?;
    if let Some(value) = root.get("observation").filter(|_| observation_px > stereo.max_disparity) {
        let bound = format!("at most max_disparity = {} px", stereo.max_disparity);
        let remedy = "the matcher searches no further; lower the reading, or raise max_disparity in [sensor]";
        return Err(root.refuse("observation", value, &bound, remedy));
    }
    let (prior, _) = numbers(&root, "prior", cells, "one per cell", &PRIOR)?;
    let (correlation, one) = numbers(&root, "correlation", cells - 1, "one per pair of neighbours", &CORRELATION)?;
    let no_hit_likelihood = root.optional_number("no_hit_likelihood", &NO_HIT)?;
    let onward = correlation.last().copied().or(one).unwrap_or(0.0);
    Ok(ViewingRay { cell_size_m, observation_px, prior, correlation, onward, no_hit_likelihood, stereo })
}

fn cells(root: &Table) -> Result<usize, Error> {
    let cells = root.number("cells", &CELLS)?;
    match root.get("cells").filter(|_| cells.fract() > 0.0) {
        Some(value) => Err(root.refuse("cells", value, CELLS.bound, CELLS.remedy)),
        None => Ok(cells as usize),
    }
}

/// One number for all, which is given too, or a list of `count`.
fn numbers(root: &Table, key: &str, count: usize, each: &str, limit: &Limit) -> Result<(Vec<f64>, Option<f64>), Error> {
    let missing = || root.missing(key, &format!("`{key} = ...`, {}", limit.bound));
    let value = root.get(key).ok_or_else(missing)?;
    let one = |value: &Value| {
        let allowed = number(value).filter(|&v| limit.allows(v));
        allowed.ok_or_else(|| root.refuse(key, value, limit.bound, limit.remedy))
    };
    let Some(items) = value.get_ref().as_array() else {
        let all = one(value)?;
        return Ok((vec![all; count], Some(all)));
    };
    if items.len() != count {
        let bound = format!("one number, or a list of {count}, {each}; this list has {}", items.len());
        return Err(root.refuse(key, value, &bound, limit.remedy));
    }
    Ok((items.iter().map(one).collect::<Result<_, _>>()?, None))
}

/// The ray as a file that reads back as the same ray.
pub fn text(ray: &ViewingRay, comment: &str) -> String {
    let mut text = String::new();
    for line in comment.lines() {
        let _ = writeln!(text, "# {line}");
    }
    let _ = writeln!(text, "cells = {}\ncell_size = {:?}  # m", ray.cells(), ray.cell_size_m);
    let _ = writeln!(text, "observation = {:?}  # px", ray.observation_px);
    let _ = writeln!(text, "prior = {}", listed(&ray.prior, None));
    let _ = writeln!(text, "correlation = {}", listed(&ray.correlation, Some(ray.onward)));
    if let Some(no_hit) = ray.no_hit_likelihood {
        let _ = writeln!(text, "no_hit_likelihood = {no_hit:?}  # 1/px");
    }
    let s = &ray.stereo;
    let _ = writeln!(text, "\n[sensor]\nfocal_baseline = {:?}  # px·m", s.focal_baseline);
    let _ = writeln!(text, "disparity_sigma = {:?}  # px\ncorrect_match = {:?}", s.disparity_sigma, s.correct_match);
    let _ = writeln!(text, "max_disparity = {:?}  # px", s.max_disparity);
    text
}

/// One number where all are the same, or a list, twelve to a line.
fn listed(values: &[f64], all: Option<f64>) -> String {
    let all = all.or(values.first().copied()).unwrap_or_default();
    if values.iter().all(|v| v.to_bits() == all.to_bits()) {
        return format!("{all:?}");
    }
    let line = |values: &[f64]| values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ");
    format!("[\n    {},\n]", values.chunks(12).map(line).collect::<Vec<_>>().join(",\n    "))
}

#[cfg(test)]
mod tests;
