//! Past the last cell of a ray the world goes on.

use grid::DigitalLine;
use sensor::SensorModel;

/// The chain past the end of a ray: cells of one chord length, each of which begins an obstacle
/// with the same probability.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PastTheMap {
    /// Range at which the ray leaves its last cell, m.
    pub from_m: f64,
    /// Length of the ray in each further cell, m; above 0.
    pub chord_m: f64,
    /// `u0 = P(E_{j+1} | not E_j)` of an unseen world.
    pub onset: f64,
}

/// Probability mass down to which cells are taken one by one ...
const FINE: f64 = 1e-9;

/// ... and that is left to the last chord looked at.
const REST: f64 = 1e-15;

/// At most so many cells are taken one by one: more than the 1,600 that the paper's prior needs at 5 cm.
const ONE_BY_ONE: usize = 4096;

/// After that, a chord may be this share of its range: the sensor can hardly tell its ends apart,
/// and a world with next to no obstacles still comes to an end.
const COARSE: f64 = 0.002;

/// Chords per call of the sensor model.
const BLOCK: usize = 64;

/// Chords after which the range has grown a millionfold and the likelihood no longer changes.
const MOST: usize = ONE_BY_ONE + 108 * BLOCK;

/// `P(o | no cell of the ray is occupied)`, per unit of the reading: the hit lies in the m-th further
/// cell with probability `u0 (1 - u0)^m`. It closes the sum to infinity in Eq. (7).
///
/// Cells that are all alike to the sensor are taken at once. Through the others the chain is followed cell by cell
/// until a mass of 1e-9 is left, and in longer steps after that; not past where the likelihood no longer changes,
/// whoever is hit there.
pub fn likelihood(sensor: &(impl SensorModel + ?Sized), reading: f64, bearing: f64, past: &PastTheMap) -> f64 {
    let mut ranges = [past.from_m; BLOCK + 1];
    let mut hits = [0.0; BLOCK];
    let mut likelihood = [0.0; BLOCK];
    let constant_m = sensor.constant_from(reading, bearing);
    let between_m = sensor.constant_between(reading, bearing);
    if past.onset <= 0.0 {
        // Nothing is ever hit: as far as the sensor can tell, where it can.
        let far_m = if constant_m.is_finite() { constant_m.max(past.from_m) } else { past.from_m };
        sensor.likelihood(reading, bearing, &[far_m, far_m + past.chord_m], &mut likelihood[..1]);
        return likelihood[0];
    }
    let (mut ahead, mut mass, mut sum) = (1.0, 1.0, 0.0);
    for block in (0..MOST).step_by(BLOCK) {
        ranges[0] = if block == 0 { past.from_m } else { ranges[BLOCK] };
        let alike = libm::floor((between_m[1] - ranges[0]) / past.chord_m);
        if ranges[0] >= between_m[0] && alike >= 1.0 {
            sensor.likelihood(reading, bearing, &[ranges[0], ranges[0] + past.chord_m], &mut likelihood[..1]);
            sum += mass * past.hit(alike) * likelihood[0];
            mass *= past.pass(alike);
            ranges[0] += alike * past.chord_m;
        }
        for k in 0..BLOCK {
            let fine = block + k < ONE_BY_ONE && ahead > FINE;
            let cells = if fine { 1.0 } else { libm::ceil(COARSE * ranges[k] / past.chord_m) };
            ranges[k + 1] = ranges[k] + cells * past.chord_m;
            hits[k] = past.hit(cells);
            ahead *= 1.0 - hits[k];
        }
        if ranges[0] > constant_m {
            sensor.likelihood(reading, bearing, &ranges[..2], &mut likelihood[..1]);
            return sum + mass * likelihood[0];
        }
        sensor.likelihood(reading, bearing, &ranges, &mut likelihood);
        for (hit, l) in hits.iter().zip(likelihood) {
            if mass < REST {
                return sum + mass * l;
            }
            sum += mass * hit * l;
            mass *= 1.0 - hit;
        }
    }
    sum + mass * likelihood[BLOCK - 1]
}

impl PastTheMap {
    /// What follows the last cell of a line traced along the unit vector `direction` over cells of
    /// side `cell_m` (m), in a world where obstacles begin with probability `onset`.
    pub fn after(line: &DigitalLine, direction: [f64; 2], cell_m: f64, onset: f64) -> Self {
        Self::at(line.ranges().last().copied().unwrap_or(0.0), direction, cell_m, onset)
    }

    /// The same from the given range (m) on.
    pub fn at(from_m: f64, direction: [f64; 2], cell_m: f64, onset: f64) -> Self {
        // A 4-connected line crosses |cos| + |sin| cells per cell side.
        Self { from_m, chord_m: cell_m / (direction[0].abs() + direction[1].abs()), onset }
    }

    /// Probability that an obstacle begins within so many cells, `1 - (1 - u0)^cells`.
    fn hit(&self, cells: f64) -> f64 {
        if cells > 1.0 { -libm::expm1(cells * libm::log1p(-self.onset)) } else { self.onset }
    }

    /// Probability that none does.
    fn pass(&self, cells: f64) -> f64 {
        libm::exp(cells * libm::log1p(-self.onset))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sensor::{Kernel as _, Laser, Stereo};

    /// The sum, cell by cell, until nothing is left.
    fn slow(reading: f64, past: &PastTheMap) -> f64 {
        slow_of(&Stereo::default(), reading, past)
    }

    fn slow_of(sensor: &impl SensorModel, reading: f64, past: &PastTheMap) -> f64 {
        let mut sum = 0.0;
        let mut mass = 1.0;
        let mut range = past.from_m;
        while mass > 1e-14 {
            let mut l = [0.0];
            sensor.likelihood(reading, 0.1, &[range, range + past.chord_m], &mut l);
            sum += mass * past.onset * l[0];
            mass *= 1.0 - past.onset;
            range += past.chord_m;
        }
        sum
    }

    #[test]
    fn equals_the_slow_sum() {
        for reading in [0.0, 0.4, 1.0, 2.5, 10.0, 60.0] {
            for (from_m, onset) in [(0.7, 0.0129), (3.0, 0.1), (8.0, 0.0129), (30.0, 0.5)] {
                let past = PastTheMap { from_m, chord_m: 0.05, onset };
                let fast = likelihood(&Stereo::default(), reading, 0.1, &past);
                assert!((fast / slow(reading, &past) - 1.0).abs() < 2e-9, "{reading} {past:?}");
            }
        }
    }

    #[test]
    fn cells_that_are_alike_are_taken_at_once() {
        let laser = Laser { max_range_m: 20.0, ..Laser::default() };
        for reading in [0.5, 3.0, 12.0, 19.99, 20.0, f64::INFINITY] {
            for (from_m, onset) in [(0.03, 0.0129), (2.98, 0.1), (8.0, 0.0129), (19.9, 0.002), (30.0, 0.5)] {
                for chord_m in [0.01, 0.05, 0.7] {
                    let past = PastTheMap { from_m, chord_m, onset };
                    let fast = likelihood(&laser, reading, 0.1, &past);
                    let error = (fast / slow_of(&laser, reading, &past) - 1.0).abs();
                    assert!(error < 2e-9, "{error}: {reading} {past:?}");
                }
            }
        }
    }

    /// No echo in a world without obstacles: nothing was there.
    #[test]
    fn a_world_without_obstacles_has_no_echoes() {
        let laser = Laser { early_per_m: 0.0, ..Laser::default() };
        for onset in [0.0, 1e-9] {
            let past = PastTheMap { from_m: 5.0, chord_m: 0.05, onset };
            let none = likelihood(&laser, f64::INFINITY, 0.0, &past);
            assert!((none - laser.hit - laser.no_echo).abs() < 1e-5, "{none}");
        }
    }

    #[test]
    fn a_world_without_obstacles_ends_at_once() {
        let past = PastTheMap { from_m: 5.0, chord_m: 0.05, onset: 0.0 };
        assert!(likelihood(&Stereo::default(), 3.0, 0.0, &past) > 0.0);
    }

    #[test]
    fn a_world_with_next_to_no_obstacles_ends_too() {
        let past = PastTheMap { from_m: 5.0, chord_m: 0.05, onset: 1e-12 };
        let l = likelihood(&Stereo::default(), 0.0, 0.0, &past);
        let mut far = [0.0];
        Stereo::default().likelihood(0.0, 0.0, &[1e9, 2e9], &mut far);
        assert!((l / far[0] - 1.0).abs() < 1e-6, "{l} {far:?}");
    }

    #[test]
    fn coarse_chords_are_as_good_as_cells() {
        let past = PastTheMap { from_m: 5.0, chord_m: 0.002, onset: 5e-4 };
        for reading in [0.0, 1.0, 2.5] {
            let l = likelihood(&Stereo::default(), reading, 0.1, &past);
            assert!((l / slow(reading, &past) - 1.0).abs() < 1e-5, "{reading}");
        }
    }

    #[test]
    fn where_only_false_matches_are_left_it_is_their_density() {
        let past = PastTheMap { from_m: 5.0, chord_m: 0.05, onset: 0.0129 };
        let l = likelihood(&Stereo::default(), 40.0, 0.0, &past);
        assert!((l - 0.2 / 60.0).abs() < 1e-15);
    }
}
