//! Scans, and the sensor models that explain them.
//!
//! A [`Scan`] is a plain value: where the sensor stood, in which directions it looked, and what it
//! read. It can come from the simulator, from a file or from a robot. A [`SensorModel`] says how
//! likely a reading is when cell `k` of the ray is the first occupied one, `P(o | F_k)`: all a
//! mapper needs to know of a sensor. [`Stereo`] is the stereo camera of the paper, Eq. (21), and
//! [`Matcher`] samples the disparities that such a camera would measure, with the paper's
//! independent mismatches or with [`Clustering`] as measured on real pairs. [`Laser`] is a laser
//! range finder, with what it measures and how it is sampled.

mod camera;
mod clustering;
pub mod lanes;
mod laser;
mod matcher;
mod normal;
mod scan;
mod stereo;

use lanes::{Beams, Lanes};

pub use camera::Camera;
pub use clustering::{Clustering, Mismatches};
pub use laser::{Laser, LaserError};
pub use matcher::{Matcher, Surface};
pub use scan::{Pose, Ray, Scan};
pub use stereo::Stereo;

/// Where a chord lies with respect to a reading, for rules that look at one cell at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Placement {
    /// Nearer than the reading: the ray was seen to pass through.
    Nearer,
    /// Where the reading lies.
    Within,
    /// Behind the reading: nothing was seen of it.
    Behind,
}

/// How a sensor's readings come about: the sensor kernel `P(o | F_k)` of Eq. (21) and what the
/// conventional rule needs of it.
///
/// `reading` is in the sensor's own unit (px for disparity, m for range); `bearing` is the angle between the
/// ray and the optical axis in radians; ranges are in metres along the ray. `f64::INFINITY` is the reading of
/// a sensor that says that nothing came back: an event of its own, for which likelihoods are probabilities.
pub trait SensorModel: Send + Sync {
    /// Writes `P(o | F_k)`, per unit of the reading, for every chord `ranges[k] ..= ranges[k + 1]`.
    ///
    /// `ranges` never decreases and is one longer than `likelihood`.
    fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]);

    /// The same for several rays at once, in single precision: `likelihood[k][l]` is that of lane `l` in the chord
    /// `ranges[k][l] ..= ranges[k + 1][l]`. It may differ from [`likelihood`](Self::likelihood) by 5e-6 of its value.
    fn likelihood_lanes(&self, beams: &Beams, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        lanes::one_by_one(self, beams, ranges, likelihood);
    }

    /// `P(o | a surface at range r)` and its derivative with respect to the range, per m, for ranges (m) of every
    /// lane, both as accurate as [`likelihood_lanes`](Self::likelihood_lanes); false where the sensor cannot say.
    fn point_lanes(
        &self,
        _beams: &Beams,
        _ranges: &[Lanes<f64>],
        _likelihood: &mut [Lanes<f32>],
        _slope: &mut [Lanes<f32>],
    ) -> bool {
        false
    }

    /// Range (m) from which on a chord of the given length (m) is so short that the likelihood is nearly constant
    /// over it, to one part in four; infinite where the sensor cannot say.
    fn smooth_from(&self, _bearing: f64, _chord_m: f64) -> f64 {
        f64::INFINITY
    }

    /// Range (m) along the ray from which on `P(o | F_k)` no longer changes, so that a chain need not be
    /// followed further; infinite where it always does.
    fn settled_from(&self, _reading: f64, _bearing: f64) -> f64 {
        f64::INFINITY
    }

    /// At most so much, per unit of the reading, do the likelihoods of two cells from `range` (m) on differ, however far
    /// they are; infinite where the sensor cannot say.
    fn spread_from(&self, _reading: f64, _bearing: f64, _range: f64) -> f64 {
        f64::INFINITY
    }

    /// Ranges (m) between which all chords have the same likelihood, so that they need not be asked about one by one;
    /// twice the same where the sensor cannot say.
    fn steady(&self, _reading: f64, _bearing: f64) -> [f64; 2] {
        [0.0; 2]
    }

    /// `P(T)`: the probability that a reading comes from the first occupied cell at all.
    fn correct_match(&self) -> f64;

    /// Where the chord `enter ..= exit` lies with respect to `reading` +- `half_width`.
    fn placement(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> Placement;

    /// Probability that a reading of an obstacle in the chord `enter ..= exit` falls into the bin
    /// `reading` +- `half_width`, if it is a correct match: `P(o | F_k, T)` as a probability.
    fn bin_probability(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> f64;

    /// Range (m) up to which a chord is [`Nearer`](Placement::Nearer) than `reading` +- `half_width` and its
    /// [`bin_probability`](Self::bin_probability) is 0, so that no chord need be asked about; 0 where the sensor cannot say.
    fn clear_until(&self, _reading: f64, _half_width: f64, _bearing: f64) -> f64 {
        0.0
    }

    /// Range (m) such that every chord that begins beyond it is [`Behind`](Placement::Behind) `reading` +-
    /// `half_width`; infinite where the sensor cannot say.
    fn behind_from(&self, _reading: f64, _half_width: f64, _bearing: f64) -> f64 {
        f64::INFINITY
    }

    /// Probability that a false match falls into the bin `reading` +- `half_width`:
    /// `P(o | F_k, not T)` as a probability. Times `1 - P(T)` it is, for a bin of width 1, the least that the
    /// likelihood of the reading can be.
    fn false_match_probability(&self, reading: f64, half_width: f64) -> f64;

    /// Half the bin, in the unit of the reading, that stands for one reading in rules that look at one cell of side
    /// `cell_m` (m) at a time; above 0.
    fn half_bin(&self, cell_m: f64) -> f64;

    /// Range (m) along the ray at which a point gives this reading without noise, for rules that take a
    /// reading for a point; none where no finite range does (disparity 0, a ray behind the image plane, no echo).
    fn range_of(&self, reading: f64, bearing: f64) -> Option<f64>;
}
