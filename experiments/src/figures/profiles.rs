//! Error against what is known of a cell: the range from which it was seen best, and the number of looks at it.

use std::ops::Range;

use plotters::prelude::*;
use score::{LOOK_EDGES, RANGE_EDGES_M};

use super::chart::{self, Axis, Chart, Mark, Series};
use crate::failure::Failure;

/// What the picture shows.
pub const CAPTION: &str =
    "Log loss against the range from which a cell was seen best, and against the number of rays that looked at it.";

/// The errors of one map, or of several pooled.
pub struct Line {
    /// Name in the legend.
    pub name: String,
    /// Its colour.
    pub colour: RGBColor,
    /// Its line.
    pub mark: Mark,
    /// Log loss, nats per cell, in every bin of [`RANGE_EDGES_M`] and of [`LOOK_EDGES`]; none of an empty one.
    pub losses: [Vec<Option<f64>>; 2],
}

/// How much the charts show.
pub struct Bounds {
    /// Ranges up to here, m.
    pub range_m: f64,
    /// Losses, nats per cell; those beyond lie on the border.
    pub losses: Range<f64>,
    /// Size of a chart, px.
    pub size: (u32, u32),
}

/// A chart for either covariate.
///
/// # Errors
/// A drawing that fails.
pub fn draw(lines: &[Line], bounds: &Bounds) -> Result<Vec<u8>, Failure> {
    let covariates: [(&str, &[f64], Axis, SeriesLabelPosition); 2] = [
        (
            "Error against range",
            &RANGE_EDGES_M,
            Axis::linear("range from which a cell was seen best, m", 0.0..bounds.range_m),
            SeriesLabelPosition::LowerRight,
        ),
        (
            "Error against looks",
            &LOOK_EDGES,
            Axis::logarithmic("rays that looked at a cell", 1.0..1000.0),
            SeriesLabelPosition::LowerLeft,
        ),
    ];
    let charts = covariates.into_iter().enumerate().map(|(covariate, (title, edges, x, legend))| {
        let series = |line: &Line| {
            let bins = edges.windows(2).zip(&line.losses[covariate]);
            let points = bins.map(|(edge, loss)| (middle(edge, &x), *loss)).collect();
            Series { name: line.name.clone(), points, mark: line.mark, colour: line.colour }
        };
        Chart {
            title: title.to_owned(),
            y: Axis::logarithmic("log loss, nats/cell", bounds.losses.clone()),
            bands: Vec::new(),
            series: lines.iter().map(series).collect(),
            x,
            legend,
        }
    });
    chart::draw(&charts.collect::<Vec<_>>(), bounds.size)
}

/// Where the point of a bin is drawn; an open bin is drawn as wide as the one before it would go on.
fn middle(edge: &[f64], axis: &Axis) -> f64 {
    let to = if edge[1].is_finite() { edge[1] } else { (1.5 * edge[0]).min(axis.range.end) };
    if axis.logarithmic { libm::sqrt(edge[0].max(0.5) * to) } else { 0.5 * (edge[0] + to) }
}
