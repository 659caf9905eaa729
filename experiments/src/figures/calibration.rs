//! The errors of disparities as a histogram, and the kernel that was fitted to them.

use super::chart::{Axis, Chart, Series, sheet};
use super::drawing::Drawing;
use super::ink::{FAINT, LINES};
use super::paper::Paper;
use super::style::Style;

/// What the picture shows.
pub const CAPTION: &str = "Density of the error of a disparity: counted in bins (bars' tops), and as fitted.";

/// Size of a chart.
const SIZE: (f64, f64) = (700.0, 520.0);

/// Draws the core of the errors (px) and, with a logarithmic axis, all that lies within 20 px; `density` is the fit, 1/px.
pub fn draw(errors: &[f64], sigma: f64, density: impl Fn(f64) -> f64, paper: &Paper) -> Drawing {
    let core = (8.0 * sigma).min(20.0);
    let charts = [(core, 64, false), (20.0, 80, true)].map(|(reach, bins, logarithmic)| {
        let width = 2.0 * reach / f64::from(bins);
        let bin = |k: i32| {
            let low = -reach + width * f64::from(k);
            let count = errors.iter().filter(|error| (low..low + width).contains(*error)).count();
            [(low, count), (low + width, count)].map(|(at, count)| (at, count as f64 / (errors.len() as f64 * width)))
        };
        let counted: Vec<(f64, f64)> = (0..bins).flat_map(bin).collect();
        let fitted: Vec<(f64, f64)> =
            (0..=400).map(|k| -reach + 2.0 * reach * f64::from(k) / 400.0).map(|at| (at, density(at))).collect();
        let top = 1.1 * counted.iter().chain(&fitted).map(|(_, d)| *d).fold(f64::MIN_POSITIVE, f64::max);
        let bottom = 0.5 / (errors.len() as f64 * width);
        let series = |name: &str, points: &[(f64, f64)], style: Style| {
            let shown = points.iter().map(|&(x, y)| (x, Some(y).filter(|y| !logarithmic || *y > bottom)));
            Series::new(name, style, shown)
        };
        Chart::new(
            if logarithmic { "all errors" } else { "the core" },
            Axis::linear("disparity read minus true, px", -reach..reach),
            match logarithmic {
                true => Axis::logarithmic("density, 1/px", bottom..top),
                false => Axis::linear("density, 1/px", 0.0..top),
            },
            vec![series("counted", &counted, Style::line(FAINT)), series("fitted", &fitted, Style::line(LINES[2]))],
        )
    });
    sheet(&charts, 2, SIZE, paper)
}
