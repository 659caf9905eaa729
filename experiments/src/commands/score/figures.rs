//! Pictures: where maps err, and whether they can be taken at their word.

use grid::Raster;
use score::{Bin, reliability};

use super::scored::{Scored, ScoredMap};
use super::truth::Truth;
use crate::failure::Failure;
use crate::figures::chart::{Axis, Chart, Series, sheet};
use crate::figures::drawing::Anchor;
use crate::figures::ink::{self, Colour, FAINT, INK, LABEL, SMALL};
use crate::figures::key;
use crate::figures::panel::Panel;
use crate::figures::profiles::{self, Line};
use crate::figures::style::{self, Style};
use crate::figures::{Drawing, Paper, letters};
use crate::worlds::estimate::Estimate;

/// Captions, by file name, in the order of the page.
pub(super) const CAPTIONS: [(&str, &str); 3] = [
    (
        "errors.png",
        "The truth, and every map in its cells with its error. Maps: white is free, black occupied, grey unknown. Errors: \
         red where an obstacle is imagined, blue where one is missed, the stronger the surer the map; light grey is not scored.",
    ),
    (
        "reliability.png",
        "Reliability over the first region: of the cells held occupied with probability p, the share that is. A map that can be \
         taken at its word lies on the diagonal; below it obstacles are imagined, above it missed.",
    ),
    ("profiles.png", profiles::CAPTION),
];

/// Width of the picture, and room about panels.
const WIDTH: f64 = 1400.0;
const GAP: f64 = 14.0;
const HEAD: f64 = 34.0;

/// Colours of a sure error: an obstacle imagined, and one missed.
const IMAGINED: Colour = Colour(200, 40, 20);
const MISSED: Colour = Colour(0, 80, 190);

/// The truth with the key, then a map and its error for each; two maps to a row where there is room.
pub(super) fn errors(scored: &Scored, truth: &Truth, prior: f64, paper: &Paper) -> Drawing {
    let whole = paper.width(WIDTH);
    let room = |columns: f64| ((whole - GAP) / columns - GAP).min(440.0);
    let panel = |columns: f64| Panel::whole(truth.frame.spec, room(columns), paper);
    // Two to a row unless cells would be much smaller for it.
    let beside_each_other = scored.maps.len() > 1 && whole >= 1000.0 && panel(4.0).size().0 > 0.75 * room(4.0);
    let (pairs, columns) = if beside_each_other { (2, 4.0) } else { (1, 2.0) };
    let panel = panel(columns);
    let (width, height) = panel.size();
    let rows = scored.maps.len().div_ceil(pairs) as f64;
    let beside = (columns - 1.0) * (width + GAP) - 4.0 * GAP;
    let fits = beside >= 320.0 && height >= key::HEIGHT + 40.0;
    let first = GAP + HEAD + height + if fits { GAP } else { 2.0 * GAP + key::HEIGHT + 44.0 };
    let mut drawing = Drawing::new(GAP + columns * (width + GAP), first + rows * (height + HEAD + GAP));
    let d = &mut drawing;
    let titled = |d: &mut Drawing, title: &str, x: f64, y: f64| {
        d.text(&letters::cut(title, LABEL, width), (x, y + 0.5 * HEAD), LABEL, INK, Anchor::Start);
        panel.at(x, y + HEAD)
    };
    titled(d, "truth", GAP, GAP).fill(d, |cell| ink::truth(truth.cells[cell]));
    let (x, y) = if fits { (width + 5.0 * GAP, GAP + HEAD) } else { (GAP, 2.0 * GAP + HEAD + height) };
    let room = if fits { beside } else { d.width - 2.0 * GAP };
    let unknown = truth.cells.values().iter().any(Option::is_none).then_some(key::Sign::UnknownTruth);
    key::draw(d, (x, y), room, &panel, prior, unknown.as_slice());
    error_key(d, (x, y + 172.0), x + room);
    for (k, map) in scored.maps.iter().enumerate() {
        let at = GAP + (k % pairs) as f64 * 2.0 * (width + GAP);
        let y = first + (k / pairs) as f64 * (height + HEAD + GAP);
        titled(d, &map.name, at, y).fill(d, |cell| shade(map, cell, prior));
        titled(d, "its error", at + width + GAP, y).fill(d, |cell| error(map, truth, cell));
    }
    drawing
}

/// What the colours of errors mean.
fn error_key(drawing: &mut Drawing, (left, mut y): (f64, f64), right: f64) {
    let mut x = left;
    for (colour, text) in [(IMAGINED, "obstacle imagined"), (MISSED, "obstacle missed")] {
        let wide = 70.0 + letters::width(text, SMALL);
        if x + wide > right {
            (x, y) = (left, y + 30.0);
        }
        let shades = (0..32).map(|k| Colour::WHITE.towards(colour, f64::from(k) / 31.0)).collect();
        drawing.cells((x, y - 9.0), (60.0, 18.0), 32, shades);
        drawing.frame((x, y - 9.0), (x + 60.0, y + 9.0), FAINT.stroke(1.0));
        drawing.text(text, (x + 70.0, y), SMALL, INK, Anchor::Start);
        x += wide + 30.0;
    }
}

/// A cell of a map; grey of an unknown one, whatever it counts as.
fn shade(map: &ScoredMap, cell: usize, prior: f64) -> Colour {
    ink::occupancy(if map.map.known[cell] { map.map.occupancy[cell] } else { prior }, prior)
}

/// From white to a colour by the size of the error.
fn error(map: &ScoredMap, truth: &Truth, cell: usize) -> Colour {
    let Some(occupied) = truth.cells[cell] else { return ink::UNKNOWN };
    let p = map.map.occupancy[cell];
    let (size, colour) = if occupied { (1.0 - p, MISSED) } else { (p, IMAGINED) };
    // Sixteen shades make small files.
    Colour::WHITE.towards(colour, (size * 16.0).round() / 16.0)
}

/// One panel per map, over the given cells.
///
/// # Errors
/// Rasters of different geometry: a defect of ours.
pub(super) fn reliabilities(
    scored: &Scored,
    truth: &Truth,
    mask: &Raster<bool>,
    paper: &Paper,
) -> Result<Drawing, Failure> {
    let names: Vec<&str> = scored.maps.iter().map(|map| map.name.as_str()).collect();
    let panel = |(map, style): (&ScoredMap, Style)| {
        let bins = reliability(&map.map.occupancy, &truth.cells, mask)?;
        Ok::<_, Failure>(diagram(&map.name, &bins, style))
    };
    let charts = scored.maps.iter().zip(numbered(&names)).map(panel).collect::<Result<Vec<_>, _>>()?;
    Ok(sheet(&charts, 4, (350.0, 340.0), paper))
}

/// Styles of maps by name: that of a mapper of ours where it bears its name.
fn numbered(names: &[&str]) -> Vec<Style> {
    // A map of `room` is called MAPPER-STAGE.
    let mapper = |name: &&'_ str| {
        let known = |name: &str| mapper::catalogue::find(name).map(|entry| entry.name);
        known(name).or_else(|| known(name.rsplit_once('-')?.0))
    };
    let mappers: Vec<&str> = names.iter().map(|name| mapper(name).unwrap_or(name)).collect();
    let ours = names.iter().filter(|name| mapper(name).is_some()).count();
    let distinct = mappers.iter().collect::<std::collections::BTreeSet<_>>().len();
    match ours + 1 >= names.len() && distinct == names.len() {
        true => style::of_mappers(&mappers),
        false => (0..names.len()).map(Style::numbered).collect(),
    }
}

fn diagram(name: &str, bins: &[Bin], style: Style) -> Chart {
    let points = bins.iter().map(|bin| (bin.mean_probability, Some(bin.observed_share)));
    let diagonal = Series::new("", Style::guide(), [(0.0, Some(0.0)), (1.0, Some(1.0))]);
    let own = Series::new("", Style { labelled: false, ..style }, points);
    let [x, y] = ["probability of a cell", "share occupied"].map(|label| Axis::linear(label, 0.0..1.0));
    Chart::new(name, x, y, vec![diagonal, own])
}

/// Error against range and against looks, a line per map.
pub(super) fn profiles(scored: &Scored, paper: &Paper) -> Drawing {
    let names: Vec<&str> = scored.maps.iter().map(|map| map.name.as_str()).collect();
    let line = |(map, style): (&ScoredMap, Style)| {
        let losses = map.profiles.as_ref()?.each_ref().map(|bins| {
            let loss = |bin: &score::ErrorBin| bin.log_loss.value.map(Estimate::exact);
            bins.iter().map(loss).collect()
        });
        Some(Line { name: map.name.clone(), style, losses })
    };
    let lines: Vec<Line> = scored.maps.iter().zip(numbered(&names)).filter_map(line).collect();
    let seen =
        |map: &ScoredMap| map.profiles.as_ref()?[0].iter().rev().find(|bin| bin.brier.support > 0).map(|bin| bin.to);
    let range_m = scored.maps.iter().filter_map(seen).fold(1.0, f64::max);
    profiles::draw(&lines, range_m, paper)
}
