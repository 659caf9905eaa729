//! Error against what is known of a cell: the range from which it was seen best, and the number of looks at it.

use score::{LOOK_EDGES, RANGE_EDGES_M};

use super::axis::short;
use super::chart::{At, Axis, Chart, Series, sheet};
use super::drawing::Drawing;
use super::paper::Paper;
use super::style::Style;
use crate::worlds::estimate::Estimate;

/// What the picture shows.
pub const CAPTION: &str = "Log loss against the range from which a cell was seen best, and against the number of rays that looked at \
    it; bars are 95 % intervals over worlds. The last bin is open, and stands apart.";

/// The errors of one map, or of several pooled.
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Its colour and shape.
    pub style: Style,
    /// Log loss, nats per cell, in every bin of [`RANGE_EDGES_M`] and of [`LOOK_EDGES`]; none of an empty one.
    pub losses: [Vec<Option<Estimate>>; 2],
}

/// Size of a chart.
const SIZE: (f64, f64) = (700.0, 600.0);

/// Losses below this are as good as none: an axis goes no further down.
const LEAST: f64 = 1e-3;

/// A chart for either covariate, with ranges up to `range_m`.
pub fn draw(lines: &[Line], range_m: f64, paper: &Paper) -> Drawing {
    let [nearest, looks] = [range_m.max(RANGE_EDGES_M[1]), 1.0];
    let covariates: [(&str, &[f64], Axis); 2] = [
        (
            "Error against range",
            &RANGE_EDGES_M,
            Axis::logarithmic("range from which a cell was seen best, m", 0.1..nearest.min(RANGE_EDGES_M[9])),
        ),
        ("Error against looks", &LOOK_EDGES, Axis::logarithmic("rays that looked at a cell", looks..LOOK_EDGES[10])),
    ];
    let losses = || lines.iter().flat_map(|line| line.losses.iter().flatten().flatten());
    let least = losses().map(|loss| loss.value).filter(|v| *v > 0.0).fold(1.0, f64::min).max(LEAST);
    let most = losses().map(|loss| loss.value).fold(least, f64::max);
    let charts = covariates.into_iter().enumerate().map(|(covariate, (title, edges, mut x))| {
        let last = edges[edges.len() - 2];
        let open = lines.iter().any(|line| line.losses[covariate].get(edges.len() - 2).is_some_and(Option::is_some));
        if open {
            x.apart = Some((last, format!("≥ {}", short(last))));
        }
        let series = |line: &Line| {
            let bins = edges.windows(2).zip(&line.losses[covariate]);
            let at = |(edge, loss): (&[f64], &Option<Estimate>)| {
                let loss = (*loss)?;
                Some(At { x: middle(edge), y: loss.value, interval: loss.on_logarithm().interval })
            };
            Series { name: line.name.clone(), points: bins.filter_map(at).collect(), style: line.style }
        };
        let y = Axis::logarithmic("log loss, nats/cell", 0.8 * least..1.25 * most);
        Chart::new(title, x.clone(), y, lines.iter().map(series).collect())
    });
    sheet(&charts.collect::<Vec<_>>(), 2, SIZE, paper)
}

/// Where the point of a bin is drawn: in its middle; an open bin is where it begins.
fn middle(edge: &[f64]) -> f64 {
    if edge[1].is_finite() { 0.5 * (edge[0] + edge[1]) } else { edge[0] }
}
