//! One viewing ray by every rule: the paper's Figures 8, 9 and 10.

use plotters::prelude::*;

use super::answer::{Answer, Answers};
use super::certainty::{IN_FRONT, Point};
use super::viewing_ray::ViewingRay;
use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::{FAINT, LINES};

const ANSWERS: (u32, u32) = (760, 640);

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
pub(super) fn answers(
    ray: &ViewingRay,
    answers: &Answers,
    bands: &[((usize, usize), &str)],
) -> Result<Vec<u8>, Failure> {
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
    chart::draw(&[ratios, posterior], ANSWERS)
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

const CERTAINTY: (u32, u32) = (1000, 640);

/// Draws how certain an obstacle must be before a reading from behind it changes nothing, with the change that still counts as none.
///
/// # Errors
/// A drawing that fails.
pub(super) fn certainty(curve: &[Point], unchanged: f64) -> Result<Vec<u8>, Failure> {
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
    chart::draw(&[chart], CERTAINTY)
}
