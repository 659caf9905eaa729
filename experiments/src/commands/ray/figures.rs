//! One viewing ray by every rule: the paper's Figures 8, 9 and 10.

use super::answer::{Answer, Answers};
use super::certainty::{IN_FRONT, Point};
use super::viewing_ray::ViewingRay;
use crate::figures::chart::{Axis, Chart, Series, sheet};
use crate::figures::ink::{Colour, LINES};
use crate::figures::mark::Shape;
use crate::figures::style::{self, Style};
use crate::figures::{Drawing, Paper};

/// Sizes of charts.
const ANSWERS: (f64, f64) = (700.0, 600.0);
const CERTAINTY: (f64, f64) = (1000.0, 600.0);

/// The paper's grey curve.
const PRIOR: Colour = Colour(196, 196, 196);

/// Rules in the order in which they are drawn.
const RULES: [&str; 4] = ["visibility-printed", "independent", "conventional", "visibility"];

/// Draws (a) likelihood ratio and (b) posterior; `bands` are cells to point out.
pub(super) fn answers(ray: &ViewingRay, answers: &Answers, bands: &[((usize, usize), &str)], paper: &Paper) -> Drawing {
    let cells = Axis::linear("cell, counted from the sensor", 0.0..ray.cells().max(2) as f64);
    let series = |value: &dyn Fn(&Answer, usize) -> Option<f64>| -> Vec<Series> {
        let drawn = RULES.iter().zip(style::of_mappers(&RULES)).filter_map(|(name, style)| {
            let (_, answer) = answers.named().into_iter().find(|(mapper, _)| mapper == name)?;
            Some(Series::new(name, style, (0..ray.cells()).map(|k| (k as f64 + 0.5, value(answer, k)))))
        });
        drawn.collect()
    };
    let bands: Vec<_> =
        bands.iter().map(|&((first, last), name)| (first as f64..last as f64 + 1.0, name.to_owned())).collect();
    let shown = ratios_shown(answers);
    let odds = Axis::logarithmic("posterior odds over prior odds", shown);
    let ratios =
        Chart::new("(a) likelihood ratio", cells.clone(), odds, series(&|answer, k| answer.likelihood_ratio[k]));
    let mut posteriors = series(&|answer, k| Some(answer.posterior[k]));
    let prior = ray.prior.iter().enumerate().map(|(k, &p)| (k as f64 + 0.5, Some(p)));
    let wide = Style { stroke: PRIOR.stroke(6.0), ..Style::line(PRIOR) };
    posteriors.insert(0, Series::new("prior", wide, prior));
    let probability = Axis::linear("probability that the cell is occupied", 0.0..1.0);
    let posterior = Chart::new("(b) posterior", cells, probability, posteriors);
    sheet(&[ratios, posterior].map(|chart| Chart { bands: bands.clone(), ..chart }), 2, ANSWERS, paper)
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

/// Draws how certain an obstacle must be before a reading from behind it changes nothing, with the change that still counts as none.
pub(super) fn certainty(curve: &[Point], unchanged: f64, paper: &Paper) -> Drawing {
    let of = |in_front: f64, value: fn(&Point) -> f64| -> Vec<(f64, Option<f64>)> {
        let kept = curve.iter().filter(|p| p.in_front.to_bits() == in_front.to_bits());
        kept.map(|p| (1.0 - p.certainty, Some(value(p)))).collect()
    };
    let [unseen, cleared] = IN_FRONT;
    let styles = [(1, Shape::Circle), (1, Shape::Triangle), (2, Shape::Square), (2, Shape::Diamond)];
    let [near, near_cleared, far, far_cleared] = styles.map(|(k, shape)| Style::marked(LINES[k], shape));
    let chart = Chart::new(
        "largest change of a posterior by a reading from behind the obstacle",
        Axis::logarithmic("doubt: 1 − prior of the obstacle's cells", 1e-5..1.0),
        Axis::logarithmic("largest change of a posterior", 1e-6..1.0),
        vec![
            Series::new("counts as unchanged", Style::guide(), [(1e-5, Some(unchanged)), (1.0, Some(unchanged))]),
            Series::new("obstacle; unseen in front", near, of(unseen, |p| p.obstacle)),
            Series::new("obstacle; seen free in front", near_cleared, of(cleared, |p| p.obstacle)),
            Series::new("cells 200-560; unseen in front", far, of(unseen, |p| p.behind)),
            Series::new("cells 200-560; seen free in front", far_cleared, of(cleared, |p| p.behind)),
        ],
    );
    sheet(&[chart], 1, CERTAINTY, paper)
}
