//! What a scan is to the filter: its readings, where they ended, and the few that the map is asked about.

use sensor::{Pose, Scan, SensorModel};

use crate::options::{Options, Weight};

/// Rays about which the map is asked to tell whether it still knows where it is.
const ASKED: usize = 60;

/// Readings that are worth less than this share of one without noise are not matched: nobody knows which surface they ended on.
const LEAST: f64 = 0.1;

/// Where a reading ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    /// The place in the sensor's frame, m.
    pub(crate) at: [f64; 2],
    /// What the reading is worth of one without noise, 0 to 1: `s^2 / (s^2 + r^2)`, where `s` is the standard deviation of matching and `r`
    /// that of the reading's range.
    pub(crate) share: f64,
}

/// A scan without its pose.
pub(crate) struct Sight {
    pub(crate) scan: Scan,
    /// Readings that lie within reach and say where a surface is.
    pub(crate) ends: Vec<End>,
    /// The rays about which the map is asked.
    asked: Scan,
}

impl Sight {
    pub(crate) fn new(scan: &Scan, sensor: &dyn SensorModel, options: &Options) -> Self {
        let end = |(bearing, reading): (&f64, &Option<f64>)| {
            let range_m = sensor.range_of((*reading)?, *bearing).filter(|range| *range <= options.reach_m)?;
            let (sin, cos) = libm::sincos(*bearing);
            let off = sensor.range_sigma((*reading)?, *bearing) / options.sharpness.sigma_m;
            let share = 1.0 / (1.0 + off * off);
            (share >= LEAST).then_some(End { at: [range_m * cos, range_m * sin], share })
        };
        let ends = scan.bearings_rad.iter().zip(&scan.readings).filter_map(end).collect();
        let beams = match options.weight {
            Weight::Evidence { beams, .. } => beams,
            Weight::Field { .. } => ASKED,
        };
        Self { scan: scan.clone(), ends, asked: thinned(scan, beams) }
    }

    /// The scan from a pose.
    pub(crate) fn from(&self, pose: Pose) -> Scan {
        Scan { pose, ..self.scan.clone() }
    }

    /// The rays about which the map is asked, from a pose.
    pub(crate) fn asked_from(&self, pose: Pose) -> Scan {
        Scan { pose, ..self.asked.clone() }
    }

    /// How many of these have a reading.
    pub(crate) fn asked(&self) -> usize {
        self.asked.readings.iter().flatten().count()
    }
}

/// A scan of so many of its rays with readings at most, evenly spread.
fn thinned(scan: &Scan, beams: usize) -> Scan {
    let read: Vec<usize> = (0..scan.readings.len()).filter(|k| scan.readings[*k].is_some()).collect();
    let taken = beams.min(read.len());
    let chosen: Vec<usize> = (0..taken).map(|k| read[(2 * k + 1) * read.len() / (2 * taken)]).collect();
    Scan {
        bearings_rad: chosen.iter().map(|k| scan.bearings_rad[*k]).collect(),
        readings: chosen.iter().map(|k| scan.readings[*k]).collect(),
        ..*scan
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_are_thinned_evenly_and_none_is_taken_twice() {
        let readings: Vec<Option<f64>> = (0..90).map(|k| (k % 3 > 0).then_some(f64::from(k))).collect();
        let scan = Scan { bearings_rad: (0..90).map(f64::from).collect(), readings, ..Scan::default() };
        for beams in [1, 7, 30, 59, 60, 200] {
            let few = thinned(&scan, beams);
            assert_eq!(few.readings.len(), beams.min(60));
            assert!(few.bearings_rad.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(few.bearings_rad.iter().zip(&few.readings).all(|(b, r)| *r == Some(*b)));
            let middle = few.bearings_rad.iter().sum::<f64>() / few.readings.len() as f64;
            assert!((middle - 45.0).abs() < 2.0, "{beams}: {middle}");
        }
    }
}
