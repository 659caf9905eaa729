//! Density of the disparity read of one obstacle: the paper's Figure 6.

use crate::figures::chart::{Axis, Chart, Series, sheet};
use crate::figures::ink::LINES;
use crate::figures::style::Style;
use crate::figures::{Drawing, Paper};

/// Size of a chart.
const SIZE: (f64, f64) = (700.0, 500.0);

/// Draws the density (1/px) over the search range, and again with a logarithmic axis that shows the false matches.
pub(super) fn draw(title: &str, max_disparity: f64, density: &[(f64, f64)], paper: &Paper) -> Drawing {
    let values = || density.iter().map(|(_, l)| *l).filter(|l| *l > 0.0);
    let top = values().fold(f64::MIN_POSITIVE, f64::max);
    let bottom = values().fold(top, f64::min).max(1e-6 * top);
    let axes = [
        Axis::linear("density P(o | F), 1/px", 0.0..1.1 * top),
        Axis::logarithmic("density P(o | F), 1/px", 0.5 * bottom..2.0 * top),
    ];
    let charts = axes.map(|y| {
        let points = density.iter().map(|&(o, l)| (o, Some(l)));
        let series = vec![Series::new("", Style::line(LINES[1]), points)];
        Chart::new(title, Axis::linear("disparity read, px", 0.0..max_disparity), y, series)
    });
    sheet(&charts, 2, SIZE, paper)
}
