//! What a comparison looks like: differences with their intervals, reliability, and error against what is known
//! of a cell.

use std::collections::BTreeMap;

use score::PROBABILITY_EDGES;

use super::findings::Findings;
use super::judgement::Scope;
use super::repeats::Readings;
use super::rows::{Repeat, Rows};
use super::sheets::repeat_counts;
use super::tables::{COVARIATES, maps};
use super::world::MapScores;
use crate::figures::chart::{At, Axis, Chart, Series, sheet};
use crate::figures::profiles;
use crate::figures::style::{self, Style};
use crate::figures::{Drawing, Paper};
use crate::worlds::estimate::{Estimate, Moments};

/// Captions, by file name, in the order of the page.
pub const CAPTIONS: [(&str, &str); 4] = [
    (
        "differences.png",
        "Mapper minus visibility over all worlds, in all that could be seen, with 95 % intervals, from the least log loss to \
         the largest: to the right of zero a mapper is worse. The band is the margin within which a mapper counts as equivalent.",
    ),
    (
        "reliability.png",
        "Reliability over all worlds, in all that could be seen: of the cells held occupied with probability p, the share \
         that is, with 95 % intervals over worlds. A map that can be taken at its word lies on the diagonal; below it \
         obstacles are imagined, above it missed.",
    ),
    ("profiles.png", profiles::CAPTION),
    (
        "repeats.png",
        "The same scan again and again: what a robot that stands still makes of noise that does not change. Means over \
         worlds and scans with 95 % intervals, in all that the scan could see.",
    ),
];

/// Mappers of ours of which the lines are drawn where all would be too many; those of the user's own are always.
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

/// The mappers that are drawn, with their styles.
fn lines<'a>(mappers: &'a [&'a str]) -> Vec<(&'a str, Style)> {
    let ours = |name: &str| mapper::catalogue::MAPPERS.iter().any(|entry| entry.name == name);
    let drawn: Vec<&str> = mappers.iter().copied().filter(|name| LINES.contains(name) || !ours(name)).collect();
    let styles = style::of_mappers(&drawn);
    drawn.into_iter().zip(styles).collect()
}

/// A mean over worlds, from what each world's map adds to it: a total and a number.
fn over_worlds<'a>(
    maps: impl Iterator<Item = &'a MapScores>,
    of: impl Fn(&MapScores) -> Option<(f64, f64)>,
) -> Moments {
    Moments::of(maps.filter_map(of))
}

/// One panel per mapper.
pub fn reliability(findings: &Findings, scope: &Scope, mappers: &[&str], paper: &Paper) -> Drawing {
    let panel = |(mapper, style): (&&str, Style)| {
        let of = |bin: usize| {
            let maps = || maps(&findings.worlds, scope, mapper);
            let cells = |map: &MapScores| Some(map.reliability.get(bin)?.cells as f64);
            let x = over_worlds(maps(), |map| Some((map.reliability.get(bin)?.probability_sum, cells(map)?)));
            let y = over_worlds(maps(), |map| Some((map.reliability.get(bin)?.occupied as f64, cells(map)?)));
            let (x, y) = (x.estimate()?, y.estimate()?);
            Some(At { x: x.value, y: y.value, interval: y.interval })
        };
        let points = (0..PROBABILITY_EDGES.len() - 1).filter_map(of).collect();
        let diagonal = Series::new("", Style::guide(), [(0.0, Some(0.0)), (1.0, Some(1.0))]);
        let style = Style { labelled: false, ..style };
        Chart::new(
            mapper,
            Axis::linear("probability of a cell", 0.0..1.0),
            Axis::linear("share occupied", 0.0..1.0),
            vec![diagonal, Series { name: String::new(), points, style }],
        )
    };
    // A panel holds one line: all may have their colour.
    let styles = mappers.iter().map(|mapper| style::of_mappers(&[mapper])[0]);
    sheet(&mappers.iter().zip(styles).map(panel).collect::<Vec<_>>(), 4, (350.0, 340.0), paper)
}

/// Error against range and against looks.
pub fn profiles(findings: &Findings, scope: &Scope, mappers: &[&str], paper: &Paper) -> Drawing {
    let line = |(mapper, style): (&str, Style)| {
        let losses = COVARIATES.map(|(_, edges, of)| {
            let bin = |k: usize| {
                let part = |map: &MapScores| Some((of(map).get(k)?.log_loss, of(map).get(k)?.cells as f64));
                over_worlds(maps(&findings.worlds, scope, mapper), part).estimate()
            };
            (0..edges.len() - 1).map(bin).collect()
        });
        profiles::Line { name: mapper.to_owned(), style, losses }
    };
    let lines: Vec<_> = lines(mappers).into_iter().map(line).collect();
    profiles::draw(&lines, f64::INFINITY, paper)
}

/// Log loss, and free space held free, against the number of repeats.
pub fn repeats(rows: &Rows, mappers: &[&str], paper: &Paper) -> Drawing {
    let counts = repeat_counts(rows, Readings::Same);
    let most = counts.last().copied().unwrap_or(1) as f64;
    let drawn: Vec<_> =
        lines(mappers).into_iter().filter(|(mapper, _)| rows.repeats.iter().any(|r| r.mapper == *mapper)).collect();
    let panel = |title: &str, y: Axis, of: fn(&Repeat) -> Option<f64>| {
        let logarithmic = y.logarithmic;
        let series = drawn.iter().map(|&(mapper, style)| {
            let at = |&n: &usize| {
                let estimate = repeated(rows, mapper, n, of)?;
                let Estimate { value, interval } = if logarithmic { estimate.on_logarithm() } else { estimate };
                Some(At { x: n as f64, y: value, interval })
            };
            Series { name: mapper.to_owned(), points: counts.iter().filter_map(at).collect(), style }
        });
        Chart::new(
            title,
            Axis::logarithmic("times that the scan is in the map", 0.9..1.1 * most.max(10.0)),
            y,
            series.collect(),
        )
    };
    let losses =
        drawn.iter().flat_map(|(mapper, _)| counts.iter().filter_map(|n| repeated(rows, mapper, *n, |r| r.log_loss)));
    let (least, largest) = losses.fold((1.0f64, 0.1f64), |(a, b), loss| (a.min(loss.value), b.max(loss.value)));
    let charts = [
        panel("Log loss", Axis::logarithmic("log loss, nats/cell", 0.7 * least.max(1e-3)..1.4 * largest), |r| {
            r.log_loss
        }),
        panel("Free space held free", Axis::linear("share of the free cells", 0.0..1.0), |r| r.free_known),
    ];
    sheet(&charts, 2, (700.0, 560.0), paper)
}

/// The mean after so many repeats; the scans of a world are one draw.
fn repeated(rows: &Rows, mapper: &str, count: usize, of: fn(&Repeat) -> Option<f64>) -> Option<Estimate> {
    let mut worlds: BTreeMap<(&str, u64), (f64, f64)> = BTreeMap::new();
    for row in
        rows.repeats.iter().filter(|row| row.readings == Readings::Same && row.mapper == mapper && row.repeats == count)
    {
        if let Some(value) = of(row) {
            let world = worlds.entry((&row.family, row.seed)).or_default();
            *world = (world.0 + value, world.1 + 1.0);
        }
    }
    Moments::of(worlds.into_values()).estimate()
}
