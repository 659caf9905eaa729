//! Scans, and the sensor models that explain them.
//!
//! A [`Scan`] is a plain value: where the sensor stood, in which directions it looked, and what it
//! read. It can come from the simulator, from a file or from a robot. A [`SensorModel`] says how
//! likely a reading is when cell `k` of the ray is the first occupied one, `P(o | F_k)`: all a
//! mapper needs to know of a sensor. [`Stereo`] is the stereo camera of the paper, Eq. (21), and
//! [`Matcher`] samples the disparities that such a camera would measure, with the paper's
//! independent mismatches or with [`Clustering`] as measured on real pairs.

mod camera;
mod clustering;
mod matcher;
mod normal;
mod scan;
mod stereo;

pub use camera::Camera;
pub use clustering::{Clustering, Mismatches};
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
/// `reading` is in the sensor's own unit (px for disparity); `bearing` is the angle between the
/// ray and the optical axis in radians; ranges are in metres along the ray.
pub trait SensorModel: Send + Sync {
    /// Writes `P(o | F_k)`, per unit of the reading, for every chord `ranges[k] ..= ranges[k + 1]`.
    ///
    /// `ranges` never decreases and is one longer than `likelihood`.
    fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]);

    /// Range (m) along the ray from which on `P(o | F_k)` no longer changes, so that a chain need not be
    /// followed further; infinite where it always does.
    fn settled_from(&self, _reading: f64, _bearing: f64) -> f64 {
        f64::INFINITY
    }

    /// `P(T)`: the probability that a reading comes from the first occupied cell at all.
    fn correct_match(&self) -> f64;

    /// Where the chord `enter ..= exit` lies with respect to `reading` +- `half_width`.
    fn placement(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> Placement;

    /// Probability that a reading of an obstacle in the chord `enter ..= exit` falls into the bin
    /// `reading` +- `half_width`, if it is a correct match: `P(o | F_k, T)` as a probability.
    fn bin_probability(&self, reading: f64, half_width: f64, bearing: f64, enter: f64, exit: f64) -> f64;

    /// Probability that a false match falls into a bin of the given half width:
    /// `P(o | F_k, not T)` as a probability.
    fn false_match_probability(&self, half_width: f64) -> f64;

    /// Range (m) along the ray at which a point gives this reading without noise, for rules that take a
    /// reading for a point; none where no finite range does (disparity 0, a ray behind the image plane).
    fn range_of(&self, reading: f64, bearing: f64) -> Option<f64>;
}
