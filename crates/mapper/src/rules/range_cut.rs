//! The range cut: what engineers do about far readings whatever the rule, which is to throw them away.
//!
//! There is no publication to cite: it is a setting of nearly every mapping program (`max_range` of a sensor plugin,
//! `laser_max_range`, a pass-through filter on a point cloud).

use sensor::{Scan, SensorModel};

use crate::fit::{Candidate, Fit, Fitted, Setting, numbers};
use crate::mapper::Mapper;
use crate::model::Model;
use crate::rules::conventional::Conventional;
use crate::rules::shown::{Choice, Shown};

/// Any mapper, shown only readings up to a range. O(rays) per scan besides what the mapper does.
///
/// A reading beyond the range is no reading: its ray neither clears nor fills. The range is what the sensor itself measures: of a camera
/// the depth, so that a cut is the same disparity in every column, of a laser the range ([`sensor::InverseModel::range_of`] on the axis).
/// A reading without one (disparity 0, a beam without echo) lies beyond every range. Programs differ in this: OctoMap, GMapping, Karto and MRPT clear such a ray up to the cut instead,
/// which [`crate::LogOdds::max_range_m`] does.
pub type RangeCut = Shown<UpTo>;

/// Readings up to a range.
#[derive(Debug, Clone, Copy)]
pub struct UpTo {
    max_range_m: f64,
}

impl RangeCut {
    /// A mapper of the model's sensors, shown readings up to `max_range_m` (m).
    pub fn new(inner: Box<dyn Mapper>, model: &Model, max_range_m: f64) -> Self {
        Self::of(inner, model, UpTo { max_range_m })
    }
}

impl Choice for UpTo {
    fn choose(&mut self, sensor: &dyn SensorModel, scan: &Scan, readings: &mut Vec<Option<f64>>) {
        let near = |reading: &f64| within(sensor, *reading, self.max_range_m);
        readings.extend(scan.readings.iter().map(|reading| reading.filter(near)));
    }

    fn leaves_out(&self) -> bool {
        true
    }
}

/// Whether what a reading stands for lies within a range (m).
fn within(sensor: &dyn SensorModel, reading: f64, max_range_m: f64) -> bool {
    sensor.range_of(reading, 0.0).is_some_and(|range| range <= max_range_m)
}

/// The conventional rule of the paper with readings up to a range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConventionalCut {
    /// Readings beyond this are thrown away, m; infinite where none is.
    pub max_range_m: f64,
}

impl ConventionalCut {
    /// The range that the `tune` command finds best on the tuning scenes, which are not the scenes that results are
    /// reported on.
    pub const TUNED: Self = Self { max_range_m: 1.75 };

    /// Ranges to choose from.
    pub(crate) const FIT: Fit = Fit {
        mapper: "conventional-cut",
        built_in: || Candidate::of(Self::TUNED),
        tried: || Candidate::all(RANGES_M.map(|max_range_m| Self { max_range_m })),
    };
}

/// Ranges of cuts to choose from, m; the last is none.
pub(crate) const RANGES_M: [f64; 11] = [0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 6.0, f64::INFINITY];

/// A cut in a few words.
pub(crate) fn label(max_range_m: f64) -> String {
    if max_range_m.is_finite() { format!("up to {max_range_m} m") } else { "all readings".to_owned() }
}

impl Fitted for ConventionalCut {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        numbers([("max_range_m", self.max_range_m)])
    }

    fn label(&self) -> String {
        label(self.max_range_m)
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(RangeCut::new(Box::new(Conventional::new(model)), model, self.max_range_m))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Sensors;
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::{Laser, Pose, Stereo};
    use std::sync::Arc;

    fn model() -> Model {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 60, height: 40 };
        let sensors: Vec<Arc<dyn SensorModel>> = vec![Arc::new(Stereo::default()), Arc::new(Laser::default())];
        Model { sensors: Sensors::new(sensors), ..Model::new(grid, Arc::new(Stereo::default())) }
    }

    #[test]
    fn a_reading_at_the_range_counts_and_one_without_range_does_not() {
        let stereo = Stereo::default();
        assert!(within(&stereo, 10.0, 1.5) && !within(&stereo, 9.99, 1.5));
        assert!(!within(&stereo, 0.0, f64::INFINITY), "no parallax: it has no range");
        assert!(!within(&Laser::default(), f64::INFINITY, f64::INFINITY));
        assert!(within(&Laser::default(), 2.0, 2.0) && !within(&Laser::default(), 2.01, 2.0));
    }

    proptest! {
        /// The map is that of the mapper alone, shown scans from which somebody has taken the far readings by hand.
        #[test]
        fn is_the_mapper_that_never_saw_far_readings(
            sensor in 0usize..2, max_range_m in 0.3f64..3.0,
            rays in prop::collection::vec((-0.7f64..0.7, prop::option::of(0.3f64..40.0)), 1..20),
        ) {
            let model = model();
            let pose = Pose { x_m: 0.7, y_m: 1.0, theta_rad: 0.4 };
            let (bearings_rad, readings): (Vec<f64>, Vec<Option<f64>>) = rays.into_iter().unzip();
            let scan = Scan { sensor, time_s: 0.0, pose, bearings_rad, readings };
            let measured = |reading: f64| if sensor == 0 { 15.0 / reading } else { reading };
            let near = scan.readings.iter().map(|r| r.filter(|r| measured(*r) <= max_range_m));
            let near = Scan { readings: near.collect(), ..scan.clone() };
            prop_assume!(scan.readings.iter().flatten().all(|r| (measured(*r) - max_range_m).abs() > 1e-9));
            for entry in crate::catalogue::MAPPERS.iter().filter(|entry| entry.kind != crate::catalogue::Kind::Batch) {
                let mut cut = RangeCut::new((entry.build)(&model), &model, max_range_m);
                let mut plain = (entry.build)(&model);
                cut.integrate(&scan);
                plain.integrate(&near);
                prop_assert_eq!(cut.occupancy(), plain.occupancy(), "{}", entry.name);
                prop_assert_eq!(cut.work().cells, plain.work().cells, "{}", entry.name);
                let fork = cut.fork().expect("all can be copied");
                prop_assert_eq!(fork.occupancy(), cut.occupancy());
            }
        }
    }
}
