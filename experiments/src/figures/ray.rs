//! One viewing ray by every rule: the paper's Figures 8, 9 and 10.

use plotters::prelude::*;

use super::chart::{self, Axis, Chart, Mark, Series};
use super::ink::LINES;
use crate::commands::ray::{Answer, Answers, ViewingRay};
use crate::failure::Failure;

const SIZE: (u32, u32) = (760, 640);

/// The paper's grey curve.
const PRIOR: RGBColor = RGBColor(196, 196, 196);

/// Rules in the order in which they are drawn, with the paper's marks for its own two.
const MARKS: [(&str, Mark, RGBColor); 4] = [
    ("visibility-printed", Mark::Triangle, LINES[1]),
    ("independent", Mark::Cross, LINES[3]),
    ("conventional", Mark::Plus, LINES[2]),
    ("visibility", Mark::Ring, LINES[0]),
];

/// Draws (a) likelihood ratio and (b) posterior; `bands` are cells to point out.
///
/// # Errors
/// A drawing that fails.
pub fn draw(ray: &ViewingRay, answers: &Answers, bands: &[((usize, usize), &str)]) -> Result<Vec<u8>, Failure> {
    let cells = Axis::linear("cell", 0.0..ray.cells().max(2) as f64);
    let series = |value: &dyn Fn(&Answer, usize) -> Option<f64>| -> Vec<Series> {
        let drawn = MARKS.iter().filter_map(|&(name, mark, colour)| {
            let (_, answer) = answers.named().into_iter().find(|(mapper, _)| *mapper == name)?;
            let points = (0..ray.cells()).map(|k| (k as f64 + 0.5, value(answer, k))).collect();
            Some(Series { name: name.to_owned(), points, mark, colour })
        });
        drawn.collect()
    };
    let bands: Vec<_> =
        bands.iter().map(|&((first, last), name)| (first as f64..last as f64 + 1.0, name.to_owned())).collect();
    let shown = ratios_shown(answers);
    let ratios = Chart {
        title: "(a) likelihood ratio".to_owned(),
        x: cells.clone(),
        y: Axis::logarithmic("posterior odds over prior odds", shown.clone()),
        bands: bands.clone(),
        series: series(&|answer, k| answer.likelihood_ratio[k].filter(|r| shown.contains(r))),
        legend: SeriesLabelPosition::LowerRight,
    };
    let mut posteriors = series(&|answer, k| Some(answer.posterior[k]));
    let prior = ray.prior.iter().enumerate().map(|(k, &p)| (k as f64 + 0.5, Some(p))).collect();
    posteriors.insert(0, Series { name: "prior".to_owned(), points: prior, mark: Mark::Ground, colour: PRIOR });
    let posterior = Chart {
        title: "(b) posterior".to_owned(),
        x: cells,
        y: Axis::linear("probability that the cell is occupied", 0.0..1.05),
        bands,
        series: posteriors,
        legend: SeriesLabelPosition::UpperRight,
    };
    chart::draw(&[ratios, posterior], SIZE)
}

/// Whole powers of ten around all likelihood ratios, but no more than three on either side of one: what is beyond is as good as certain.
fn ratios_shown(answers: &Answers) -> std::ops::Range<f64> {
    let ratios = answers.named().into_iter().flat_map(|(_, answer)| answer.likelihood_ratio.iter().flatten());
    let (low, high) = ratios.fold((-1.0f64, 1.0f64), |(low, high), ratio| {
        let power = libm::log10(ratio.clamp(1e-3, 1e3));
        (low.min(power), high.max(power))
    });
    libm::pow(10.0, (low - 1e-9).floor())..libm::pow(10.0, (high + 1e-9).ceil())
}
