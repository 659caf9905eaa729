//! Density of the disparity read of one obstacle: the paper's Figure 6.

use plotters::prelude::*;

use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::LINES;

const SIZE: (u32, u32) = (720, 520);

/// Draws the density (1/px) over the search range, and again with a logarithmic axis that shows the false matches.
///
/// # Errors
/// A drawing that fails.
pub(super) fn draw(title: &str, max_disparity: f64, density: &[(f64, f64)]) -> Result<Vec<u8>, Failure> {
    let values = || density.iter().map(|(_, l)| *l).filter(|l| *l > 0.0);
    let top = values().fold(f64::MIN_POSITIVE, f64::max);
    let bottom = values().fold(top, f64::min).max(1e-6 * top);
    let decade = |value: f64| libm::pow(10.0, libm::floor(libm::log10(value)));
    let axes = [
        Axis::linear("density, 1/px", 0.0..1.1 * top),
        Axis::logarithmic("density, 1/px", decade(bottom)..10.0 * decade(top)),
    ];
    let charts = axes.map(|y| Chart {
        title: title.to_owned(),
        x: Axis::linear("disparity read, px", 0.0..max_disparity),
        y,
        bands: Vec::new(),
        series: vec![Series {
            name: "P(o | F)".to_owned(),
            points: density.iter().map(|&(o, l)| (o, Some(l))).collect(),
            mark: Mark::Line,
            colour: LINES[0],
        }],
        legend: SeriesLabelPosition::UpperRight,
    });
    chart::draw(&charts, SIZE)
}
