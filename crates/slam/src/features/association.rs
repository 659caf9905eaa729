//! Which landmark a reading is of.

use nalgebra::Matrix2;
use sensor::{FeatureCamera, FeatureReading, Pose};

use super::landmark::{Expected, Landmark, gaussian, vector};

/// A landmark that may be meant by a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Candidate {
    pub(crate) slot: usize,
    pub(crate) landmark: Landmark,
    pub(crate) expected: Expected,
    /// Covariance of a reading where the pose is known.
    pub(crate) innovation: Matrix2<f64>,
}

impl Candidate {
    /// Of a landmark as seen from a pose; none of one behind the camera.
    pub(crate) fn of(slot: usize, landmark: &Landmark, camera: &FeatureCamera, pose: Pose) -> Option<Self> {
        let expected = landmark.expected(camera, pose)?;
        let innovation = expected.innovation(camera, landmark);
        Some(Self { slot, landmark: *landmark, expected, innovation })
    }
}

/// A reading and a landmark that may be its.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pair {
    pub(crate) reading: usize,
    pub(crate) candidate: usize,
    /// Logarithm of the reading's density, times the probability that the landmark exists.
    log: f64,
}

/// Readings and landmarks within the gate of each other, the likeliest first; equal ones in the order of readings, then of landmarks.
pub(crate) fn pairs(
    readings: &[FeatureReading],
    candidates: &[Candidate],
    gate: f64,
    covariance: impl Fn(&Candidate) -> Matrix2<f64>,
) -> Vec<Pair> {
    let covariances: Vec<Matrix2<f64>> = candidates.iter().map(covariance).collect();
    let mut found = Vec::new();
    for (reading, read) in readings.iter().enumerate() {
        for (candidate, (expected, covariance)) in candidates.iter().zip(&covariances).enumerate() {
            let off = vector(read) - expected.expected.reading;
            // Most are far off in bearing.
            if off.x * off.x > gate * covariance[(0, 0)] {
                continue;
            }
            if let Some([square, log]) = gaussian(off, covariance)
                && square <= gate
            {
                found.push(Pair { reading, candidate, log: log + libm::log(expected.landmark.existence()) });
            }
        }
    }
    found.sort_by(|a, b| b.log.total_cmp(&a.log));
    found
}

/// For each reading its landmark, an index into `candidates`: the likeliest pair first, and each landmark at most once.
pub(crate) fn likeliest(
    readings: &[FeatureReading],
    candidates: &[Candidate],
    gate: f64,
    covariance: impl Fn(&Candidate) -> Matrix2<f64>,
) -> Vec<Option<usize>> {
    let mut meant = vec![None; readings.len()];
    let mut used = vec![false; candidates.len()];
    for pair in pairs(readings, candidates, gate, covariance) {
        if meant[pair.reading].is_none() && !used[pair.candidate] {
            meant[pair.reading] = Some(pair.candidate);
            used[pair.candidate] = true;
        }
    }
    meant
}
