//! Worlds as JSON that the page's script decodes.
//!
//! Rasters are films ([`film`]), numbers are series ([`number`]), both range-coded ([`coder`]) and as base64. Occupancy
//! is kept in [`levels`], which never change sides of a threshold, so that counts of cells are exact; at the ends of stages
//! also in fine steps of log odds. What levels are too coarse for is there in numbers.

mod coder;
mod decoded;
mod film;
mod number;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use grid::Raster;
use rayon::prelude::*;
use score::{MovingRegion, Region};
use sensor::Scan;
use serde_json::{Value, json};

use self::coder::{Decoder, Encoder};
pub use self::decoded::{DecodedMapper, DecodedWorld, decoded};
use self::film::Shape;
use self::number::{Numbers, Series};
use super::scans::{ReadingUnit, Scans, SensorScans};
use super::viewer::{Mapped, Scenery, ViewedWorld, Viewer};
use crate::output::table::{optional, rounded};
use crate::worlds::film::{EXACT, Frame, PARTS};
use crate::worlds::levels::{FINE, levels};

/// Step of the metrics that frames hold.
const EXACT_STEP: f64 = 1e-5;

/// Steps of readings, px and m, and of true ranges, m.
const DISPARITY_STEP: f64 = 0.02;
const RANGE_STEP: f64 = 0.01;

/// The viewer as JSON within its budget. Where all moments do not fit, every second one
/// between the ends of stages is left out until they do; none if not even those ends fit.
pub(super) fn json(viewer: &Viewer) -> Option<String> {
    let mut worlds = viewer.worlds.clone();
    let mut thinned = false;
    loop {
        let coded: Vec<Value> = worlds.iter().map(world).collect();
        let scale = json!({ "levels": levels().log_odds, "fine": FINE, "exact": EXACT, "exact_step": EXACT_STEP });
        let text = json!({ "scale": scale, "thinned": thinned, "worlds": coded }).to_string();
        // So that no name in it can end the script element that holds it.
        let text = text.replace('<', "\\u003c");
        if text.len() <= viewer.budget {
            return Some(text);
        }
        thinned = true;
        let before: usize = worlds.iter().map(|world| world.moments.len()).sum();
        worlds.iter_mut().for_each(thin);
        if worlds.iter().map(|world| world.moments.len()).sum::<usize>() == before {
            return None;
        }
    }
}

/// Whether a viewer's JSON has worlds with several sensors. No text of it can hold these letters but as a key, since quotes in texts are
/// escaped.
pub(super) fn has_sensors(json: &str) -> bool {
    json.contains("\"sensors\":[")
}

/// Leaves out every second moment that is not the end of a stage.
fn thin(world: &mut ViewedWorld) {
    let mut ends: Vec<usize> = world.stages.iter().map(|stage| stage.scans).collect();
    if world.stages.is_empty() {
        ends.extend(world.moments.first().map(|moment| moment.scans)); // where its maps stand
    }
    let mut between = 0;
    world.moments.retain(|moment| {
        let end = ends.contains(&moment.scans);
        between += usize::from(!end);
        end || between % 2 == 0
    });
    let kept: Vec<usize> = world.moments.iter().map(|moment| moment.scans).collect();
    for mapper in &mut world.mappers {
        mapper.frames.retain(|frame| kept.contains(&frame.scans));
    }
}

/// Names of the regions of [`Frame::exact`], in its order.
pub(super) fn region_names(world: &ViewedWorld) -> Vec<&str> {
    let by_rays = Region::ALL.iter().map(|region| region.name());
    let moves = world.moments.iter().any(|moment| moment.scenery.is_some());
    let of_movement = MovingRegion::ALL.iter().map(|region| region.name()).filter(|_| moves);
    by_rays.chain(world.regions.iter().map(|(name, _)| name.as_str())).chain(of_movement).collect()
}

fn world(world: &ViewedWorld) -> Value {
    let ends = |scans| world.moments.iter().position(|moment| moment.scans == scans);
    let stages = world.stages.iter().map(|s| json!({ "name": s.name, "label": s.label, "moment": ends(s.scans) }));
    let regions = world.regions.iter().map(|(name, cells)| json!({ "name": name, "cells": mask(cells) }));
    let truth = world.truth.as_ref().map(|truth| raster(&codes(truth), TRUTHS));
    let part = |p: &Option<Region>| p.map_or(0, |part| 1 + PARTS.iter().position(|r| *r == part).unwrap_or(0) as u8);
    let parts: Vec<Vec<u8>> =
        world.moments.iter().filter_map(|m| Some(m.parts.as_ref()?.map(part).values().to_vec())).collect();
    let millimetres = |at: &[f64; 2]| at.map(|m| json!((m * 1e3).round() / 1e3));
    let mappers: Vec<Value> = world.mappers.par_iter().map(|mapper| mapped(world, mapper)).collect();
    let mut coded = json!({
        "name": world.name,
        "seed": world.seed,
        "cell_m": world.grid.cell_m,
        "origin_m": world.grid.origin_m,
        "width": world.grid.width,
        "height": world.grid.height,
        "prior": world.prior,
        "radius_m": world.robot_radius_m,
        "route": world.route_m.iter().map(millimetres).collect::<Vec<_>>(),
        "scans": world.scans.as_ref().map(scans),
        "moments": world.moments.iter().map(|moment| moment.scans).collect::<Vec<_>>(),
        "stages": stages.collect::<Vec<_>>(),
        "regions": regions.collect::<Vec<_>>(),
        "region_names": region_names(world),
        "truth": truth,
        "parts": base64(&film::packed(&parts, shape(world, 1 + PARTS.len(), 0))),
        "metrics": world.metrics,
        "mappers": mappers,
    });
    if !world.sensors.is_empty() {
        coded["sensors"] = world.sensors.iter().map(sensor).collect();
    }
    let sceneries: Vec<&Scenery> = world.moments.iter().filter_map(|moment| moment.scenery.as_ref()).collect();
    if !sceneries.is_empty() {
        let truths: Vec<Vec<u8>> = sceneries.iter().map(|scenery| codes(&scenery.truth).values().to_vec()).collect();
        coded["truths"] = json!(base64(&film::packed(&truths, shape(world, TRUTHS, 0))));
        coded["things"] = things(&sceneries);
        let regions: Vec<Vec<u8>> = sceneries.iter().map(|scenery| scenery.regions.values().to_vec()).collect();
        coded["moving"] = json!(base64(&film::packed(&regions, shape(world, MOVING, 0))));
    }
    coded
}

/// Number of sets of regions of a world that moves.
const MOVING: usize = 1 << MovingRegion::ALL.len();

/// Number of codes of a truth: free, occupied, not known.
const TRUTHS: usize = 3;

fn codes(truth: &Raster<Option<bool>>) -> Raster<u8> {
    truth.map(|cell| cell.map_or(2, u8::from))
}

/// What everything that moves covers, in whole millimetres, a list per moment: `[x, y, radius]` of a disc, else the corners `[x, y, x, y, ...]`, and 0 of what
/// has not moved since the moment before.
fn things(sceneries: &[&Scenery]) -> Value {
    let millimetres = |m: &f64| (m * 1e3).round() as i64;
    let outline = |shape: &::scene::Shape| -> Vec<i64> {
        match shape {
            ::scene::Shape::Disc { center_m: [x, y], radius_m } => [x, y, radius_m].map(millimetres).to_vec(),
            other => other.corners_m().iter().flatten().map(millimetres).collect(),
        }
    };
    let mut former: Vec<Vec<i64>> = Vec::new();
    let mut moments = Vec::with_capacity(sceneries.len());
    for scenery in sceneries {
        let now: Vec<Vec<i64>> = scenery.things.iter().map(outline).collect();
        let coded = now.iter().enumerate().map(|(thing, at)| match former.get(thing) == Some(at) {
            true => json!(0),
            false => json!(at),
        });
        moments.push(coded.collect::<Value>());
        former = now;
    }
    Value::Array(moments)
}

fn mapped(world: &ViewedWorld, mapper: &Mapped) -> Value {
    let at = |frame: &Frame| world.moments.iter().position(|moment| moment.scans == frame.scans);
    let films: Vec<Vec<u8>> = mapper.frames.iter().map(|frame| frame.levels.values().to_vec()).collect();
    let stage = |regions: &Vec<(String, Vec<Option<f64>>)>| -> Value {
        let scores = regions
            .iter()
            .map(|(name, values)| (name.clone(), values.iter().map(|value| optional(*value)).collect::<Value>()));
        Value::Object(scores.collect())
    };
    let fine: Vec<&Frame> = mapper.frames.iter().filter(|frame| frame.fine.is_some()).collect();
    json!({
        "name": mapper.name,
        "moments": mapper.frames.iter().map(at).collect::<Vec<_>>(),
        "levels": base64(&film::packed(&films, shape(world, levels().log_odds.len(), levels().of(world.prior, None)))),
        "fine_moments": fine.iter().map(|frame| at(frame)).collect::<Vec<_>>(),
        "fine": base64(&fine_steps(&fine)),
        "exact": exact(&mapper.frames).map(|bytes| base64(&bytes)),
        "scores": mapper.scores.iter().map(stage).collect::<Vec<_>>(),
        "known": mapper.known.as_ref().map(mask),
    })
}

fn shape(world: &ViewedWorld, values: usize, start: u8) -> Shape {
    Shape { width: world.grid.width, cells: world.grid.cells(), values, start }
}

fn base64(bytes: &[u8]) -> String {
    BASE64_STANDARD.encode(bytes)
}

/// One raster of so many values.
fn raster(cells: &Raster<u8>, values: usize) -> String {
    let spec = cells.spec();
    let shape = Shape { width: spec.width, cells: spec.cells(), values, start: 0 };
    base64(&film::packed(&[cells.values().to_vec()], shape))
}

fn mask(cells: &Raster<bool>) -> String {
    raster(&cells.map(|inside| u8::from(*inside)), 2)
}

/// What fine steps differ by from those of the levels, in the order of frames and cells.
fn fine_steps(frames: &[&Frame]) -> Vec<u8> {
    let mut encoder = Encoder::new();
    let mut numbers = Numbers::default();
    for frame in frames {
        for (step, level) in frame.fine.iter().flat_map(Raster::values).zip(frame.levels.values()) {
            numbers.code(&mut encoder, i32::from(*step) - of_level(*level));
        }
    }
    encoder.finish()
}

/// The fine step of a level.
fn of_level(level: u8) -> i32 {
    (levels().log_odds[usize::from(level)] / FINE).round() as i32
}

/// A series per region and metric, over all frames; none where nothing is judged.
fn exact(frames: &[Frame]) -> Option<Vec<u8>> {
    let mut encoder = Encoder::new();
    let regions = frames.first().map(|frame| frame.exact.len()).filter(|regions| *regions > 0)?;
    for region in 0..regions {
        for metric in 0..EXACT.len() {
            let mut series = Series::default();
            for frame in frames {
                series.code(&mut encoder, steps(frame.exact[region][metric], EXACT_STEP));
            }
        }
    }
    Some(encoder.finish())
}

/// A number in steps; none of what is none, or not finite.
fn steps(value: Option<f64>, step: f64) -> Option<i32> {
    value.filter(|value| value.is_finite()).map(|value| (value / step).round() as i32)
}

fn scans(of: &Scans) -> Value {
    let (unit, focal_baseline, step) = match of.unit {
        ReadingUnit::Disparity(focal_baseline) => ("px", Some(focal_baseline), DISPARITY_STEP),
        ReadingUnit::Range => ("m", None, RANGE_STEP),
    };
    let mut fans: Vec<&[f64]> = Vec::new();
    let fan = |scan: &'_ Scan, fans: &[&[f64]]| fans.iter().position(|fan| *fan == scan.bearings_rad.as_slice());
    for scan in &of.scans {
        if fan(scan, &fans).is_none() {
            fans.push(&scan.bearings_rad);
        }
    }
    let readings = of.scans.iter().flat_map(|scan| scan.readings.iter().map(|reading| steps(*reading, step)));
    let truth = of.truth.as_ref().map(|truth| {
        let rays = || truth.iter().flatten();
        let ranges = rays().map(|ray| steps(ray.range_m, RANGE_STEP));
        json!({ "ranges": series(ranges), "reach": series(rays().map(|ray| Some(ray.reach as i32))) })
    });
    json!({
        "unit": unit,
        "focal_baseline": focal_baseline,
        "step": step,
        "range_step": RANGE_STEP,
        "fans": fans,
        "fan": of.scans.iter().map(|scan| fan(scan, &fans)).collect::<Vec<_>>(),
        // In full: rays are traced from them.
        "poses": of.scans.iter().map(|scan| [scan.pose.x_m, scan.pose.y_m, scan.pose.theta_rad]).collect::<Vec<_>>(),
        "times": of.scans.iter().map(|scan| rounded(scan.time_s)).collect::<Vec<_>>(),
        "readings": series(readings),
        "truth": truth,
    })
}

fn sensor(of: &SensorScans) -> Value {
    json!({
        "name": of.name,
        "width": of.width_rad,
        "all_round": of.all_round,
        "after": of.after,
        "scans": scans(&of.scans),
        "most": of.most_m,
    })
}

fn series(values: impl Iterator<Item = Option<i32>>) -> String {
    let (mut encoder, mut series) = (Encoder::new(), Series::default());
    values.for_each(|value| {
        series.code(&mut encoder, value);
    });
    base64(&encoder.finish())
}

/// The frames of a mapper as one text: what [`frames`] reads.
pub(super) fn frames_text(of: &[Frame]) -> [String; 2] {
    let Some(first) = of.first() else { return Default::default() };
    let spec = first.levels.spec();
    let films: Vec<Vec<u8>> = of.iter().map(|frame| frame.levels.values().to_vec()).collect();
    let fine: Vec<&Frame> = of.iter().filter(|frame| frame.fine.is_some()).collect();
    let shape = Shape { width: spec.width, cells: spec.cells(), values: levels().log_odds.len(), start: 0 };
    [base64(&film::packed(&films, shape)), base64(&fine_steps(&fine))]
}

/// The levels and fine steps that [`frames_text`] wrote, of so many frames, those with fine steps marked; nothing of a
/// text that is none, or too short to be that.
pub(super) fn frames(text: &[String; 2], spec: grid::GridSpec, fine: &[bool]) -> Option<Vec<Film>> {
    let [levels_text, fine_text] = text.each_ref().map(|text| BASE64_STANDARD.decode(text).ok());
    let shape = Shape { width: spec.width, cells: spec.cells(), values: levels().log_odds.len(), start: 0 };
    let films = film::unpacked(&levels_text?, fine.len(), shape);
    let fine_text = fine_text?;
    let (mut decoder, mut numbers) = (Decoder::new(&fine_text), Numbers::default());
    let most = levels().log_odds.len();
    films.iter().flatten().all(|level| usize::from(*level) < most).then_some(())?;
    let of_frame = |(film, fine): (Vec<u8>, &bool)| {
        let step = |level: &u8| (of_level(*level) + numbers.code(&mut decoder, 0)) as i16;
        let steps = fine.then(|| Raster::new(spec, film.iter().map(step).collect()));
        (Raster::new(spec, film), steps)
    };
    Some(films.into_iter().zip(fine).map(of_frame).collect())
}

/// Levels, and fine steps where there are any.
pub(super) type Film = (Raster<u8>, Option<Raster<i16>>);

#[cfg(test)]
mod tests;
