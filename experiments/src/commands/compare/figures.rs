//! What a comparison looks like: differences with their intervals, reliability, and error against what is known
//! of a cell.

use plotters::prelude::*;

use super::findings::Findings;
use super::judgement::Scope;
use super::rows::{Repeat, Rows};
use super::sheets::{repeat_counts, repeated_mean};
use super::tables::{COVARIATES, pooled_errors, pooled_reliability};
use super::world::ErrorSum;
use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::{self, FAINT};
use crate::figures::profiles;

/// Captions, by file name, in the order of the page.
pub const CAPTIONS: [(&str, &str); 4] = [
    (
        "differences.png",
        "Mapper minus visibility over all worlds, in all that could be seen, with 95 % intervals: to the right of zero a \
         mapper is worse. Green is better, red worse, grey equivalent or undecided.",
    ),
    (
        "reliability.png",
        "Reliability over all worlds, in all that could be seen: of the cells held occupied with probability p, the share \
         that is. A map that can be taken at its word lies on the diagonal; below it obstacles are imagined, above it missed.",
    ),
    ("profiles.png", profiles::CAPTION),
    (
        "repeats.png",
        "The same scan again and again: what a robot that stands still makes of noise that does not change. Means over \
         worlds and scans, in all that the scan could see.",
    ),
];

/// Mappers of which the lines are drawn where all would be too many.
const LINES: [&str; 9] = [
    "visibility",
    "independent",
    "conventional",
    "conventional-tuned",
    "log-odds-octomap",
    "log-odds-cartographer",
    "no-occlusion",
    "forward-em",
    "mrf",
];

/// Colour and line of a mapper: the same in every picture, whichever mappers are shown.
fn style(mapper: &str) -> (RGBColor, Mark) {
    let place = LINES.iter().position(|name| *name == mapper).unwrap_or(LINES.len());
    let mark = if place < ink::LINES.len() { Mark::Line } else { Mark::Dashes };
    (ink::LINES[place % ink::LINES.len()], mark)
}

fn lines<'a>(mappers: &'a [&'a str]) -> impl Iterator<Item = &'a str> {
    mappers.iter().copied().filter(|mapper| LINES.contains(mapper))
}

/// One panel per mapper.
///
/// # Errors
/// A drawing that fails.
pub fn reliability(findings: &Findings, scope: &Scope, mappers: &[&str]) -> Result<Vec<u8>, Failure> {
    let panel = |mapper: &&str| {
        let bins = pooled_reliability(&findings.worlds, scope, mapper);
        let points = bins.iter().filter_map(|bin| Some((bin.mean_probability()?, bin.observed_share())));
        let diagonal = vec![(0.0, Some(0.0)), (1.0, Some(1.0))];
        Chart {
            title: (*mapper).to_owned(),
            x: Axis::linear("probability", 0.0..1.0),
            y: Axis::linear("share occupied", 0.0..1.0),
            bands: Vec::new(),
            series: vec![
                Series { name: String::new(), points: diagonal, mark: Mark::Dashes, colour: FAINT },
                Series {
                    name: (*mapper).to_owned(),
                    points: points.collect(),
                    mark: Mark::Ring,
                    colour: ink::LINES[0],
                },
            ],
            legend: SeriesLabelPosition::UpperLeft,
        }
    };
    chart::sheet(&mappers.iter().map(panel).collect::<Vec<_>>(), 4, (400, 380))
}

/// Error against range and against looks.
///
/// # Errors
/// A drawing that fails.
pub fn profiles(findings: &Findings, scope: &Scope, mappers: &[&str]) -> Result<Vec<u8>, Failure> {
    let line = |mapper: &str| {
        let losses = COVARIATES.map(|(_, _, of)| {
            pooled_errors(&findings.worlds, scope, mapper, of).iter().map(ErrorSum::mean_log_loss).collect()
        });
        let (colour, mark) = style(mapper);
        profiles::Line { name: mapper.to_owned(), colour, mark, losses }
    };
    let bounds = profiles::Bounds { range_m: 10.0, losses: 0.003..3.0, size: (880, 640) };
    profiles::draw(&lines(mappers).map(line).collect::<Vec<_>>(), &bounds)
}

/// Log loss, and free space held free, against the number of repeats.
///
/// # Errors
/// A drawing that fails.
pub fn repeats(rows: &Rows, mappers: &[&str]) -> Result<Vec<u8>, Failure> {
    let counts = repeat_counts(rows);
    let most = counts.last().copied().unwrap_or(1) as f64;
    let panel = |title: &str, y: Axis, of: fn(&Repeat) -> Option<f64>, legend| Chart {
        title: title.to_owned(),
        x: Axis::logarithmic("times that the scan is in the map", 1.0..most.max(10.0)),
        y,
        bands: Vec::new(),
        series: lines(mappers)
            .filter(|mapper| rows.repeats.iter().any(|r| r.mapper == *mapper))
            .map(|mapper| {
                let points = counts.iter().map(|&n| (n as f64, repeated_mean(rows, mapper, n, of)));
                let (colour, mark) = style(mapper);
                Series { name: mapper.to_owned(), points: points.collect(), mark, colour }
            })
            .collect(),
        legend,
    };
    let charts = [
        panel("Log loss", Axis::logarithmic("nats/cell", 0.03..4.0), |r| r.log_loss, SeriesLabelPosition::LowerRight),
        panel(
            "Free space held free",
            Axis::linear("share", 0.0..1.0),
            |r| r.free_known,
            SeriesLabelPosition::LowerRight,
        ),
    ];
    chart::draw(&charts, (880, 640))
}
