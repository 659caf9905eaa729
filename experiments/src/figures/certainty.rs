//! How certain an obstacle must be before a reading from behind it changes nothing.

use plotters::prelude::*;

use super::chart::{self, Axis, Chart, Mark, Series};
use super::ink::{FAINT, LINES};
use crate::commands::ray::certainty::{IN_FRONT, Point};
use crate::failure::Failure;

const SIZE: (u32, u32) = (1000, 640);

/// Draws the curve, with the change that still counts as none.
///
/// # Errors
/// A drawing that fails.
pub fn draw(curve: &[Point], unchanged: f64) -> Result<Vec<u8>, Failure> {
    let of = |in_front: f64, value: fn(&Point) -> f64| -> Vec<(f64, Option<f64>)> {
        let kept = curve.iter().filter(|p| p.in_front.to_bits() == in_front.to_bits());
        kept.map(|p| (1.0 - p.certainty, Some(value(p)))).collect()
    };
    let [unseen, cleared] = IN_FRONT;
    let named = |name: &str, mark, colour, points| Series { name: name.to_owned(), points, mark, colour };
    let chart = Chart {
        title: "largest change of a posterior by a reading from behind the obstacle".to_owned(),
        x: Axis::logarithmic("doubt: 1 - prior of the obstacle's cells", 1e-5..1.0),
        y: Axis::logarithmic("largest change of a posterior", 1e-6..1.0),
        bands: Vec::new(),
        series: vec![
            named("counts as unchanged", Mark::Dashes, FAINT, vec![(1e-5, Some(unchanged)), (1.0, Some(unchanged))]),
            named("obstacle; unseen in front", Mark::Ring, LINES[0], of(unseen, |p| p.obstacle)),
            named("obstacle; seen free in front", Mark::Triangle, LINES[0], of(cleared, |p| p.obstacle)),
            named("cells 200-560; unseen in front", Mark::Ring, LINES[2], of(unseen, |p| p.behind)),
            named("cells 200-560; seen free in front", Mark::Triangle, LINES[2], of(cleared, |p| p.behind)),
        ],
        legend: SeriesLabelPosition::UpperLeft,
    };
    chart::draw(&[chart], SIZE)
}
