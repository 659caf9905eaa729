//! Log loss against the parameters that were fitted.

use plotters::prelude::*;

use super::candidates::{Candidate, Tuned};
use super::fit::TunedFit;
use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::LINES;

const SIZE: (u32, u32) = (800, 560);

/// Draws the half width by the best clamps and by none, and the coupling; nothing if neither was fitted.
///
/// # Errors
/// A drawing that fails.
pub(super) fn draw(fits: &[TunedFit]) -> Result<Option<Vec<u8>>, Failure> {
    let charts: Vec<Chart> = fits.iter().filter_map(chart).collect();
    if charts.is_empty() { Ok(None) } else { chart::draw(&charts, SIZE).map(Some) }
}

/// Numbers of [`Candidate::PARAMETERS`].
const HALF_WIDTH: usize = 0;
const COUPLING: usize = 3;

fn chart(fit: &TunedFit) -> Option<Chart> {
    let (title, label, parameter) = match fit.tuned {
        Tuned::Visibility => return None,
        Tuned::ConventionalTuned => ("conventional: half of the bin", "half width (px)", HALF_WIDTH),
        Tuned::Mrf => ("mrf: coupling", "correlation of neighbours", COUPLING),
    };
    // Candidates that differ in nothing but the parameter.
    let line = |like: Candidate, name: String, mark, colour| {
        let rest = |candidate: Candidate| {
            let mut parameters = candidate.parameters().map(|value| value.map(f64::to_bits));
            parameters[parameter] = None;
            parameters
        };
        let same = fit.candidates.iter().filter(|(candidate, _)| rest(*candidate) == rest(like));
        let points = same.filter_map(|(c, errors)| Some((c.parameters()[parameter]?, Some(errors.log_loss))));
        Series { name, points: points.collect(), mark, colour }
    };
    let best = fit.best();
    let mut series = vec![line(best, named(best), Mark::Ring, LINES[0])];
    let first = fit.candidates[0].0;
    if fit.tuned == Tuned::ConventionalTuned {
        // The grid's first and last clamps are those of every mapper.
        let low = |c: Candidate| c.parameters()[1];
        let (last, _) = *fit.candidates.iter().rfind(|(c, _)| low(*c) == low(first))?;
        series.push(line(last, named(last), Mark::Triangle, LINES[2]));
    }
    let points = || series.iter().flat_map(|s| &s.points);
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let right = most(&mut points().map(|(x, _)| *x));
    let top = most(&mut points().filter_map(|(_, y)| *y));
    Some(Chart {
        title: title.to_owned(),
        x: Axis::linear(label, 0.0..1.05 * right.max(f64::MIN_POSITIVE)),
        y: Axis::linear("log loss (nats per cell)", 0.0..1.1 * top.max(f64::MIN_POSITIVE)),
        bands: Vec::new(),
        series,
        legend: SeriesLabelPosition::UpperLeft,
    })
}

fn named(candidate: Candidate) -> String {
    let [_, low, high, ..] = candidate.parameters();
    match (low, high) {
        (Some(low), Some(high)) => format!("clamped to {low} .. {high}"),
        _ => String::new(),
    }
}
