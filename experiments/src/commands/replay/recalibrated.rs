//! Every map after a monotone recalibration, fitted on scans that are neither mapped nor scored.

use grid::Raster;
use mapper::{FitRay, Model, Predictive, Recalibration};
use rayon::prelude::*;
use sensor::Scan;

use super::kept_back;
use super::mapping::Maps;
use super::recording::Recording;
use crate::failure::Failure;

/// The scans kept back fall into so many parts, one scan to each in turn: a part is scored by maps that are recalibrated on the others.
pub(super) const FOLDS: usize = 2;

/// Rays that a recalibration is fitted to, about; two parameters need no more.
const RAYS: usize = 2000;

/// The maps as they are for every part of the scans.
pub(super) struct Recalibrated {
    folds: [Fold; FOLDS],
}

/// The maps for one part.
struct Fold {
    by: Vec<Recalibration>,
    maps: Vec<Raster<f64>>,
}

impl Recalibrated {
    /// Fits every map of a log with so many scans, every so-many-th of them kept back. None where a part has no reading to fit to.
    ///
    /// # Errors
    /// A log that is refused.
    pub(super) fn of(
        recording: &Recording,
        (hold_out, scans): (u64, u64),
        maps: &Maps,
        setup: &Model,
    ) -> Result<Option<Self>, Failure> {
        let most = (FOLDS * RAYS).div_ceil((scans / hold_out) as usize);
        let onset = setup.prior.onset(setup.grid.cell_m);
        let rays = kept_back::each(recording, hold_out, &|number, scan: &Scan| {
            let mut predictive = Predictive::new(setup.grid, &**setup.sensors.of(scan), onset);
            let every = scan.bearings_rad.len().div_ceil(most).max(1);
            // Another beam first in every scan, so that all are fitted to.
            let some = scan.rays().skip(number / FOLDS % every).step_by(every);
            some.filter_map(|ray| if predictive.take(&ray) { Some(FitRay::of(&predictive)) } else { None })
                .collect::<Vec<_>>()
        })?;
        let parts: [Vec<FitRay>; FOLDS] = std::array::from_fn(|part| {
            let others = rays.iter().enumerate().filter(|(number, _)| number % FOLDS != part);
            others.flat_map(|(_, rays)| rays.iter().cloned()).collect()
        });
        if parts.iter().any(Vec::is_empty) {
            return Ok(None);
        }
        let fold = |rays: &Vec<FitRay>| {
            let fitted = maps.maps.par_iter().map(|map| {
                let by = Recalibration::fit(rays, &map.occupancy, &maps.seen);
                (by, by.map(&map.occupancy, &maps.seen))
            });
            let (by, maps) = fitted.unzip();
            Fold { by, maps }
        };
        Ok(Some(Self { folds: parts.each_ref().map(fold) }))
    }

    /// The maps that score a scan, by its number among those kept back.
    pub(super) fn maps_for(&self, number: usize) -> &[Raster<f64>] {
        &self.folds[number % FOLDS].maps
    }

    /// What a map is recalibrated by, part by part.
    pub(super) fn of_map(&self, map: usize) -> [Recalibration; FOLDS] {
        self.folds.each_ref().map(|fold| fold.by[map])
    }
}
