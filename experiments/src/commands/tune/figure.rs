//! Log loss against the parameters that were fitted.

use mapper::Candidate;
use plotters::prelude::*;

use super::fit::TunedFit;
use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::LINES;

const SIZE: (u32, u32) = (800, 560);

/// Draws the half width by the best clamps and by none, the coupling, and ranges of cuts; nothing if none of these was fitted.
///
/// # Errors
/// A drawing that fails.
pub(super) fn draw(fits: &[TunedFit]) -> Result<Option<Vec<u8>>, Failure> {
    let charts: Vec<Chart> = fits.iter().filter_map(chart).collect();
    if charts.is_empty() { Ok(None) } else { chart::sheet(&charts, 2, SIZE).map(Some) }
}

/// Parameters that are drawn, with the title and the label of the axis: of a mapper the first of them that it has.
const DRAWN: [(&str, &str, &str); 3] = [
    ("half_width_px", "half of the bin", "half width (px)"),
    ("coupling", "coupling", "correlation of neighbours"),
    ("max_range_m", "readings used", "up to (m)"),
];

fn chart(fit: &TunedFit) -> Option<Chart> {
    let best = fit.best();
    let (parameter, title, label) = DRAWN.into_iter().find(|(name, ..)| best.get(name).is_some())?;
    // Candidates that differ in nothing but the parameter.
    let line = |like: &Candidate, name: String, mark, colour| {
        let rest = |candidate: &Candidate| {
            let mut parameters = candidate.parameters.clone();
            parameters.retain(|(name, _)| *name != parameter);
            parameters
        };
        let same = fit.candidates.iter().filter(|(candidate, _)| rest(candidate) == rest(like));
        let points = same.filter_map(|(c, errors)| Some((c.number(parameter)?, Some(errors.log_loss))));
        Series { name, points: points.filter(|(x, _)| x.is_finite()).collect(), mark, colour }
    };
    let mut series = vec![line(&best, named(&best), Mark::Ring, LINES[0])];
    let first = &fit.candidates.first()?.0;
    if parameter == "half_width_px" {
        // The grid's first and last clamps are those of every mapper.
        let low = |c: &Candidate| c.number("clamp_low");
        let (last, _) = fit.candidates.iter().rfind(|(c, _)| low(c) == low(first))?;
        series.push(line(last, named(last), Mark::Triangle, LINES[2]));
    }
    let points = || series.iter().flat_map(|s| &s.points);
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let right = most(&mut points().map(|(x, _)| *x));
    let top = most(&mut points().filter_map(|(_, y)| *y));
    Some(Chart {
        title: format!("{}: {title}", fit.tuned),
        x: Axis::linear(label, 0.0..1.05 * right.max(f64::MIN_POSITIVE)),
        y: Axis::linear("log loss (nats per cell)", 0.0..1.1 * top.max(f64::MIN_POSITIVE)),
        bands: Vec::new(),
        series,
        legend: SeriesLabelPosition::UpperLeft,
    })
}

fn named(candidate: &Candidate) -> String {
    match (candidate.number("clamp_low"), candidate.number("clamp_high")) {
        (Some(low), Some(high)) => format!("clamped to {low} .. {high}"),
        _ => String::new(),
    }
}
