//! The sensor kernel: what every mapper needs of a sensor.

/// The sensor kernel `P(o | F_k)` of Eq. (21): how likely a reading is where cell `k` of its ray is the first occupied one.
///
/// `reading` is in the sensor's own unit (px for disparity, m for range); `bearing` is the angle between the
/// ray and the optical axis in radians; ranges are in metres along the ray. `f64::INFINITY` is the reading of
/// a sensor that measures that nothing came back: an event of its own, for which likelihoods are probabilities.
pub trait Kernel: Send + Sync {
    /// Writes `P(o | F_k)`, per unit of the reading, for every chord `ranges[k] ..= ranges[k + 1]`.
    ///
    /// `ranges` never decreases and is one longer than `likelihood`.
    fn likelihood(&self, reading: f64, bearing: f64, ranges: &[f64], likelihood: &mut [f64]);

    /// Angle between the edges of the cone that a reading comes from, rad: the nearest surface in it is the one that is measured. 0 of a
    /// sensor that looks along a ray.
    fn width_rad(&self) -> f64 {
        0.0
    }

    /// The sensor by its parameters, for whoever cannot call its functions; none of a kernel that has no such form.
    fn parameters(&self) -> Option<Parameters> {
        None
    }
}

/// A sensor by its parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameters {
    /// Name of the kernel.
    pub kernel: &'static str,
    /// What its readings are, with their unit: the name of a column in a table of scans.
    pub reading: &'static str,
    /// The parameters by name, with their units.
    pub noise: Vec<(&'static str, f64)>,
}
