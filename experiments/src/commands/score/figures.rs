//! Pictures: where maps err, and whether they can be taken at their word.

use grid::Raster;
use plotters::prelude::*;
use score::{Bin, reliability};

use super::scored::{Scored, ScoredMap};
use super::truth::Truth;
use crate::failure::Failure;
use crate::figures::chart::{self, Axis, Chart, Mark, Series};
use crate::figures::ink::{self, FAINT, INK};
use crate::figures::panel::Panel;
use crate::figures::png;
use crate::figures::profiles::{self, Bounds, Line};

/// Captions, by file name, in the order of the page.
pub(super) const CAPTIONS: [(&str, &str); 3] = [
    (
        "errors.png",
        "The truth, every map in the cells of the truth, and its error. Maps: white is free, black occupied, grey unknown. Errors: \
         red where an obstacle is imagined, blue where one is missed, the stronger the surer the map; light grey is not scored.",
    ),
    (
        "reliability.png",
        "Reliability over the first region: of the cells held occupied with probability p, the share that is. A map that can be \
         taken at its word lies on the diagonal; below it obstacles are imagined, above it missed.",
    ),
    ("profiles.png", profiles::CAPTION),
];

const WIDTH: usize = 440;
const GAP: u32 = 14;
const HEAD: u32 = 34;

/// Colours of a sure error: an obstacle imagined, and one missed.
const IMAGINED: RGBColor = RGBColor(200, 40, 20);
const MISSED: RGBColor = RGBColor(0, 80, 190);

/// A row per map: truth, map, error.
///
/// # Errors
/// A drawing that fails.
pub(super) fn errors(scored: &Scored, truth: &Truth, prior: f64) -> Result<Vec<u8>, Failure> {
    let panel = Panel::whole(truth.frame.spec, WIDTH);
    let (width, height) = panel.size();
    let rows = scored.maps.len() as u32;
    let size = (GAP + 3 * (width + GAP), GAP + rows * (height + HEAD + GAP));
    png(size, |area| {
        for (row, map) in scored.maps.iter().enumerate() {
            let y = GAP + row as u32 * (height + HEAD + GAP);
            for (column, title) in ["truth", map.name.as_str(), "error"].into_iter().enumerate() {
                let x = GAP + column as u32 * (width + GAP);
                let text = Text::new(title.to_owned(), (x as i32, y as i32 + 6), ink::letters(ink::TITLE, &INK));
                area.draw(&text).map_err(Failure::internal)?;
                let panel = panel.at(x, y + HEAD);
                match column {
                    0 => panel.fill(area, |cell| ink::truth(truth.cells[cell]))?,
                    1 => panel.fill(area, |cell| shade(map, cell, prior))?,
                    _ => panel.fill(area, |cell| error(map, truth, cell))?,
                }
            }
        }
        Ok(())
    })
}

/// A cell of a map; grey of an unknown one, whatever it counts as.
fn shade(map: &ScoredMap, cell: usize, prior: f64) -> RGBColor {
    ink::occupancy(if map.map.known[cell] { map.map.occupancy[cell] } else { prior }, prior)
}

/// From white to a colour by the size of the error.
fn error(map: &ScoredMap, truth: &Truth, cell: usize) -> RGBColor {
    let Some(occupied) = truth.cells[cell] else { return ink::UNKNOWN };
    let p = map.map.occupancy[cell];
    let (size, RGBColor(r, g, b)) = if occupied { (1.0 - p, MISSED) } else { (p, IMAGINED) };
    let mixed = |to: u8| (255.0 + size * (f64::from(to) - 255.0)).round() as u8;
    RGBColor(mixed(r), mixed(g), mixed(b))
}

/// One panel per map, over the given cells.
///
/// # Errors
/// A drawing that fails.
pub(super) fn reliabilities(scored: &Scored, truth: &Truth, mask: &Raster<bool>) -> Result<Vec<u8>, Failure> {
    let panel = |map: &ScoredMap| {
        let bins = reliability(&map.map.occupancy, &truth.cells, mask)?;
        Ok::<_, Failure>(diagram(&map.name, &bins))
    };
    let charts = scored.maps.iter().map(panel).collect::<Result<Vec<_>, _>>()?;
    chart::sheet(&charts, 4, (400, 380))
}

fn diagram(name: &str, bins: &[Bin]) -> Chart {
    let points = bins.iter().map(|bin| (bin.mean_probability, Some(bin.observed_share))).collect();
    let diagonal = vec![(0.0, Some(0.0)), (1.0, Some(1.0))];
    Chart {
        title: name.to_owned(),
        x: Axis::linear("probability", 0.0..1.0),
        y: Axis::linear("share occupied", 0.0..1.0),
        bands: Vec::new(),
        series: vec![
            Series { name: String::new(), points: diagonal, mark: Mark::Dashes, colour: FAINT },
            Series { name: name.to_owned(), points, mark: Mark::Ring, colour: ink::LINES[0] },
        ],
        legend: SeriesLabelPosition::UpperLeft,
    }
}

/// Error against range and against looks, a line per map.
///
/// # Errors
/// A drawing that fails.
pub(super) fn profiles(scored: &Scored) -> Result<Vec<u8>, Failure> {
    let line = |(number, map): (usize, &ScoredMap)| {
        let losses = map.profiles.as_ref()?.each_ref().map(|bins| bins.iter().map(|bin| bin.log_loss.value).collect());
        let mark = if number < ink::LINES.len() { Mark::Line } else { Mark::Dashes };
        Some(Line { name: map.name.clone(), colour: ink::LINES[number % ink::LINES.len()], mark, losses })
    };
    let lines: Vec<Line> = scored.maps.iter().enumerate().filter_map(line).collect();
    let seen =
        |map: &ScoredMap| map.profiles.as_ref()?[0].iter().rev().find(|bin| bin.brier.support > 0).map(|bin| bin.to);
    let range_m = scored.maps.iter().filter_map(seen).fold(1.0, f64::max).min(10.0);
    // From the loss of a cell held for what it is, as sure as a map may be, to that of one held for the contrary.
    profiles::draw(&lines, &Bounds { range_m, losses: 1e-4..10.0, size: (600, 460) })
}
