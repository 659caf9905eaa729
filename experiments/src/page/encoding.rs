//! Worlds as JSON that the page's script decodes.
//!
//! A raster over several moments is a *block*: the difference of every cell from the moment before,
//! bytes of equal weight together, deflated (zlib), as base64. Occupancy is kept as log odds in steps
//! of [`STEP`]; a cell never changes sides of a threshold by that, so that counts of cells are exact.

use std::io::{Read as _, Write as _};

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;
use score::Region;
use serde_json::{Value, json};

use super::viewer::{Mapped, ViewedWorld, Viewer};
use crate::output::table::{optional, rounded};
use crate::worlds::run::Frame;

/// Step of the kept log odds, nats: p is off by at most 0.00025, the log loss of a cell by 0.001.
pub(super) const STEP: f64 = 1e-3;

/// The viewer as JSON of at most `budget` bytes. Where all moments do not fit, every second one
/// between the ends of stages is left out until they do; none if not even those ends fit.
pub(super) fn json(viewer: &Viewer, budget: usize) -> Option<String> {
    let mut worlds = viewer.worlds.clone();
    let mut thinned = false;
    loop {
        let coded: Vec<Value> = worlds.iter().map(world).collect();
        let text = json!({ "step": STEP, "thinned": thinned, "worlds": coded }).to_string();
        // So that no name in it can end the script element that holds it.
        let text = text.replace('<', "\\u003c");
        if text.len() <= budget {
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

/// Leaves out every second moment that is not the end of a stage.
fn thin(world: &mut ViewedWorld) {
    let ends: Vec<usize> = world.stages.iter().map(|stage| stage.scans).collect();
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

fn world(world: &ViewedWorld) -> Value {
    let moments = world.moments.iter().map(|m| {
        let pose = [m.pose.x_m, m.pose.y_m, m.pose.theta_rad].map(rounded);
        json!({ "scans": m.scans, "time_s": rounded(m.time_s), "pose": pose })
    });
    let ends = |scans| world.moments.iter().position(|moment| moment.scans == scans);
    let stages = world.stages.iter().map(|s| json!({ "name": s.name, "label": s.label, "moment": ends(s.scans) }));
    let mask = |cells: &[bool]| block(&[cells.iter().map(|inside| u32::from(*inside)).collect()], 1);
    let regions = world.regions.iter().map(|(name, cells)| json!({ "name": name, "cells": mask(cells.values()) }));
    let truth = world.truth.values().iter().map(|t| t.map_or(2, u32::from)).collect();
    let looks: Vec<Vec<u32>> = world.moments.iter().map(|m| m.looks.values().to_vec()).collect();
    let part = |p: &Option<Region>| p.map_or(0, |part| 1 + Region::ALL.iter().position(|r| *r == part).unwrap_or(0));
    let parts: Vec<Vec<u32>> =
        world.moments.iter().map(|m| m.parts.values().iter().map(|p| part(p) as u32).collect()).collect();
    let route: Vec<_> = world.route_m.iter().map(|at| at.map(|m| json!((m * 1e3).round() / 1e3))).collect();
    let mappers: Vec<Value> = world.mappers.par_iter().map(|mapper| mapped(world, mapper)).collect();
    json!({
        "name": world.name,
        "seed": world.seed,
        "cell_m": world.grid.cell_m,
        "origin_m": world.grid.origin_m,
        "width": world.grid.width,
        "height": world.grid.height,
        "prior": world.prior,
        "radius_m": world.robot_radius_m,
        "scans": world.route_m.len(),
        "route": route,
        "moments": moments.collect::<Vec<_>>(),
        "stages": stages.collect::<Vec<_>>(),
        "regions": regions.collect::<Vec<_>>(),
        "truth": block(&[truth], 1),
        "looks": block(&looks, 4),
        "parts": block(&parts, 1),
        "metrics": world.metrics,
        "mappers": mappers,
    })
}

fn mapped(world: &ViewedWorld, mapper: &Mapped) -> Value {
    let at = |frame: &Frame| world.moments.iter().position(|moment| moment.scans == frame.scans);
    let codes: Vec<Vec<u32>> = mapper
        .frames
        .iter()
        .map(|frame| frame.occupancy.values().iter().map(|p| u32::from(code(*p) as u16)).collect())
        .collect();
    let stage = |regions: &Vec<(String, Vec<Option<f64>>)>| -> Value {
        let scores = regions
            .iter()
            .map(|(name, values)| (name.clone(), values.iter().map(|value| optional(*value)).collect::<Value>()));
        Value::Object(scores.collect())
    };
    json!({
        "name": mapper.name,
        "moments": mapper.frames.iter().map(at).collect::<Vec<_>>(),
        "occupancy": block(&codes, 2),
        "scores": mapper.scores.iter().map(stage).collect::<Vec<_>>(),
    })
}

/// Log odds of `p` in steps, on the same side of 0.2, 0.5 and 0.8 as `p`.
///
/// Compared in f32: a mapper's 0.8 is the nearest f32 to it, which lies above the nearest f64.
fn code(p: f32) -> i16 {
    let odds = f64::from(p) / (1.0 - f64::from(p));
    // ln 4 is 1386.29 steps: 1387 is the first above 0.8, -1387 the first below 0.2.
    let bounds = match p {
        p if p < 0.2 => (-32_767.0, -1387.0),
        p if p <= 0.5 => (-1386.0, 0.0),
        p if p <= 0.8 => (1.0, 1386.0),
        _ => (1387.0, 32_767.0),
    };
    (libm::log(odds) / STEP).round().clamp(bounds.0, bounds.1) as i16
}

/// Differences between frames, as `bytes` planes of one byte, deflated, as base64.
pub(super) fn block(frames: &[Vec<u32>], bytes: usize) -> String {
    let mut planes = ZlibEncoder::new(Vec::new(), Compression::best());
    let mut former = vec![0u32; frames.first().map_or(0, Vec::len)];
    for frame in frames {
        let changes: Vec<u32> = frame.iter().zip(&former).map(|(now, before)| now.wrapping_sub(*before)).collect();
        for plane in 0..bytes {
            let plane: Vec<u8> = changes.iter().map(|change| change.to_le_bytes()[plane]).collect();
            // Writing to memory does not fail.
            let _ = planes.write_all(&plane);
        }
        former.clone_from(frame);
    }
    BASE64_STANDARD.encode(planes.finish().unwrap_or_default())
}

/// The frames of a [`block`] of four bytes a cell; nothing of a text that holds other ones.
pub(super) fn unblocked(text: &str, frames: usize, cells: usize) -> Option<Vec<Vec<u32>>> {
    let compressed = BASE64_STANDARD.decode(text).ok()?;
    let (whole, mut raw) = (4 * cells * frames, Vec::new());
    ZlibDecoder::new(&*compressed).take(whole as u64 + 1).read_to_end(&mut raw).ok()?;
    if raw.len() != whole {
        return None;
    }
    let mut former = vec![0u32; cells];
    let mut next = |planes: &[u8]| {
        for (cell, value) in former.iter_mut().enumerate() {
            let change: u32 = (0..4).map(|plane| u32::from(planes[plane * cells + cell]) << (8 * plane)).sum();
            *value = value.wrapping_add(change);
        }
        former.clone()
    };
    Some(raw.chunks(4 * cells.max(1)).map(&mut next).collect())
}

#[cfg(test)]
mod tests;
