//! The maps to look into on the page, with the scans that were kept back.

use std::collections::{BTreeMap, HashSet};

use logs::Sensor;
use sensor::Scan;

use super::extent::Known;
use super::kept_back;
use super::outputs::Told;
use super::recording::Recording;
use crate::failure::Failure;
use crate::page::scans::{ReadingUnit, Scans, SensorScans};
use crate::page::{Mapped, Moment, ViewedWorld};
use crate::worlds::film::{Frame, in_fine_steps, in_levels};
use crate::worlds::kernels;

/// Most scans that a page shows, of those kept back.
const MOST_SCANS: usize = 120;

/// Most points of the way.
const MOST_POINTS: usize = 2000;

/// Larger maps have no fine steps, cells.
const MOST_FINE: usize = 200_000;

/// The maps, and scans kept back, evenly over the log.
///
/// # Errors
/// A log that is refused.
pub(super) fn world(name: &str, recording: &Recording, told: &Told) -> Result<ViewedWorld, Failure> {
    let (scans, sensors) = match told.survey.sensors.len() {
        0 | 1 => (of_one(recording, told)?, Vec::new()),
        _ => of_several(recording, told)?,
    };
    let moments = (1..=scans.scans.len()).map(|scans| Moment { scans, parts: None, scenery: None });
    let spec = told.setup.grid;
    let maps = told.maps.maps.iter().filter(|map| map.mapper != "prior");
    let mapped = maps.map(|map| Mapped {
        name: map.mapper.to_owned(),
        frames: vec![Frame {
            scans: 1,
            levels: in_levels(&map.occupancy, None),
            fine: (spec.cells() <= MOST_FINE).then(|| in_fine_steps(&map.occupancy)),
            exact: Vec::new(),
        }],
        scores: Vec::new(),
        known: Some(told.maps.seen.clone()),
    });
    let points = told.survey.path.len().div_ceil(MOST_POINTS).max(1);
    Ok(ViewedWorld {
        name: name.to_owned(),
        seed: None,
        grid: spec,
        prior: told.setup.prior.marginal(),
        robot_radius_m: told.options.footprint.unwrap_or(0.0),
        truth: None,
        route_m: told.survey.path.iter().step_by(points).copied().collect(),
        moments: moments.collect(),
        stages: Vec::new(),
        regions: Vec::new(),
        metrics: Vec::new(),
        mappers: mapped.collect(),
        scans: Some(scans),
        sensors,
    })
}

/// Of a log with one sensor.
fn of_one(recording: &Recording, told: &Told) -> Result<Scans, Failure> {
    let stride = told.predictions.scans.div_ceil(MOST_SCANS).max(1);
    let of = |number: usize, scan: &Scan| number.is_multiple_of(stride).then(|| scan.clone());
    let mut scans: Vec<Scan> = kept_back::each(recording, told.options.hold_out, &of)?.into_iter().flatten().collect();
    // The page knows disparities of depths alone; those of a camera that looks all round are of ranges.
    let is_all_round = told.survey.sensor == Sensor::Stereo && scans.iter().any(kernels::is_all_round);
    if is_all_round {
        for scan in &mut scans {
            let sensor = told.setup.sensors.of(scan).clone();
            let rays = scan.readings.iter_mut().zip(&scan.bearings_rad);
            rays.for_each(|(reading, bearing)| *reading = reading.and_then(|read| sensor.range_of(read, *bearing)));
        }
    }
    let unit = if is_all_round { ReadingUnit::Range } else { unit(told.survey.sensor, told) };
    Ok(Scans { unit, scans, truth: None })
}

/// Of a log with several: where the first sensor of each moment stood, and what each read at it.
fn of_several(recording: &Recording, told: &Told) -> Result<(Scans, Vec<SensorScans>), Failure> {
    let hold_out = told.options.hold_out;
    let mut times = kept_back::each(recording, hold_out, &|_, scan: &Scan| scan.time_s.to_bits())?;
    times.dedup();
    let stride = times.len().div_ceil(MOST_SCANS).max(1);
    let chosen: HashSet<u64> = times.into_iter().step_by(stride).collect();
    let of = |_, scan: &Scan| chosen.contains(&scan.time_s.to_bits()).then(|| scan.clone());
    let scans: Vec<Scan> = kept_back::each(recording, hold_out, &of)?.into_iter().flatten().collect();
    let mut sensors: BTreeMap<usize, SensorScans> =
        told.survey.sensors.iter().map(|(number, known)| (*number, none(*number, known, told))).collect();
    let mut robot = Vec::new();
    for together in scans.chunk_by(|a, b| a.time_s.to_bits() == b.time_s.to_bits()) {
        robot.push(Scan { bearings_rad: Vec::new(), readings: Vec::new(), ..together[0] });
        for scan in together {
            if let Some(sensor) = sensors.get_mut(&scan.sensor) {
                sensor.all_round |=
                    matches!(sensor.scans.unit, ReadingUnit::Disparity(_)) && kernels::is_all_round(scan);
                sensor.after.push(robot.len());
                sensor.scans.scans.push(scan.clone());
            }
        }
    }
    Ok((Scans { unit: ReadingUnit::Range, scans: robot, truth: None }, sensors.into_values().collect()))
}

/// A sensor without scans yet.
fn none(number: usize, known: &Known, told: &Told) -> SensorScans {
    SensorScans {
        name: format!("{number} {}", kernels::kind(known.kind)),
        width_rad: known.model.width_rad(),
        all_round: false,
        after: Vec::new(),
        scans: Scans { unit: unit(known.kind, told), scans: Vec::new(), truth: None },
        most_m: None,
    }
}

fn unit(sensor: Sensor, told: &Told) -> ReadingUnit {
    match sensor {
        Sensor::Laser { .. } | Sensor::Sonar { .. } => ReadingUnit::Range,
        Sensor::Stereo => ReadingUnit::Disparity(told.options.stereo.focal_baseline),
    }
}
