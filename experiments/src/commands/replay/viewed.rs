//! The maps to look into on the page, with the scans that were kept back.

use logs::Sensor;

use super::kept_back;
use super::outputs::Told;
use super::recording::Recording;
use crate::failure::Failure;
use crate::page::scans::{ReadingUnit, Scans};
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
    let stride = told.predictions.scans.div_ceil(MOST_SCANS).max(1);
    // Readings of one unit: those of the sensors that are what the first is, but not sonars beside others, whose echoes are of no place.
    let is_sonar = |kind: &Sensor| matches!(kind, Sensor::Sonar { .. });
    let kinds = || told.survey.sensors.values().map(|known| known.kind);
    let first = match is_sonar(&told.survey.sensor) {
        true => kinds().find(|kind| !is_sonar(kind)).unwrap_or(told.survey.sensor),
        false => told.survey.sensor,
    };
    let kind = std::mem::discriminant(&first);
    let shown = |scan: &sensor::Scan| std::mem::discriminant(&told.survey.kind(scan)) == kind;
    let of = |number: usize, scan: &sensor::Scan| (number.is_multiple_of(stride) && shown(scan)).then(|| scan.clone());
    let mut scans: Vec<sensor::Scan> =
        kept_back::each(recording, told.options.hold_out, &of)?.into_iter().flatten().collect();
    // The page knows disparities of depths alone; those of a camera that looks all round are of ranges.
    let is_all_round = first == Sensor::Stereo && scans.iter().any(kernels::is_all_round);
    if is_all_round {
        for scan in &mut scans {
            let sensor = told.setup.sensors.of(scan).clone();
            let rays = scan.readings.iter_mut().zip(&scan.bearings_rad);
            rays.for_each(|(reading, bearing)| *reading = reading.and_then(|read| sensor.range_of(read, *bearing)));
        }
    }
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
        moments: (1..=scans.len()).map(|scans| Moment { scans, parts: None, scenery: None }).collect(),
        stages: Vec::new(),
        regions: Vec::new(),
        metrics: Vec::new(),
        mappers: mapped.collect(),
        scans: Some(Scans {
            unit: match first {
                _ if is_all_round => ReadingUnit::Range,
                Sensor::Laser { .. } | Sensor::Sonar { .. } => ReadingUnit::Range,
                Sensor::Stereo => ReadingUnit::Disparity(told.options.stereo.focal_baseline),
            },
            scans,
            truth: None,
        }),
    })
}
