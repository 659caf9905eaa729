//! Log loss against the parameters that were fitted.

use mapper::Candidate;

use super::fit::TunedFit;
use crate::figures::chart::{At, Axis, Chart, Series, sheet};
use crate::figures::style::Style;
use crate::figures::{Drawing, Paper};

/// Size of a chart.
const SIZE: (f64, f64) = (700.0, 480.0);

/// Draws the half width by the best clamps and by none, the coupling, and ranges of cuts; nothing if none of these was fitted.
pub(super) fn draw(fits: &[TunedFit], paper: &Paper) -> Option<Drawing> {
    let charts: Vec<Chart> = fits.iter().filter_map(chart).collect();
    (!charts.is_empty()).then(|| sheet(&charts, 2, SIZE, paper))
}

/// Parameters that are drawn, with the title and the label of the axis: of a mapper the first of them that it has.
const DRAWN: [(&str, &str, &str); 3] = [
    ("half_width_px", "half of the bin", "half width, px"),
    ("coupling", "coupling", "correlation of neighbours"),
    ("max_range_m", "readings used", "up to, m"),
];

fn chart(fit: &TunedFit) -> Option<Chart> {
    let best = fit.best();
    let (parameter, title, label) = DRAWN.into_iter().find(|(name, ..)| best.get(name).is_some())?;
    // Candidates that differ in nothing but the parameter.
    let line = |like: &Candidate, name: String, style: Style| {
        let rest = |candidate: &Candidate| {
            let mut parameters = candidate.parameters.clone();
            parameters.retain(|(name, _)| *name != parameter);
            parameters
        };
        let same = fit.candidates.iter().filter(|(candidate, _)| rest(candidate) == rest(like));
        let at = |(candidate, errors): &(Candidate, super::fit::Errors)| {
            Some(At { x: candidate.number(parameter)?, y: errors.log_loss, interval: errors.interval })
        };
        Series { name, points: same.filter_map(at).collect(), style }
    };
    let mut series = vec![line(&best, named(&best), Style::numbered(1))];
    let first = &fit.candidates.first()?.0;
    if parameter == "half_width_px" {
        // The grid's first and last clamps are those of every mapper.
        let low = |c: &Candidate| c.number("clamp_low");
        let (last, _) = fit.candidates.iter().rfind(|(c, _)| low(c) == low(first))?;
        series.push(line(last, named(last), Style::numbered(2)));
    }
    let points = || series.iter().flat_map(|s| &s.points);
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::MIN_POSITIVE, f64::max);
    let right = most(&mut points().map(|at| at.x).filter(|x| x.is_finite()));
    let top = most(&mut points().map(|at| at.interval.map_or(at.y, |(_, high)| high)));
    let all = points().any(|at| at.x.is_infinite()).then(|| (f64::INFINITY, "all".to_owned()));
    let x = Axis { apart: all, ..Axis::linear(label, 0.0..1.05 * right) };
    let y = Axis::linear("log loss, nats/cell", 0.0..1.05 * top);
    Some(Chart::new(&format!("{}: {title}", fit.tuned), x, y, series))
}

fn named(candidate: &Candidate) -> String {
    match (candidate.number("clamp_low"), candidate.number("clamp_high")) {
        (Some(low), Some(high)) => format!("clamped to {low} .. {high}"),
        _ => String::new(),
    }
}
