//! What to read of a log, and how.

use std::ops::Range;

use crate::error::LogError;
use crate::fan::FanOptions;

/// What to read of a log, and how. The default reads everything.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// A laser reading below this is unusable, m; 0 by default. Zero and negative readings always are.
    pub min_range_m: f64,
    /// A laser reading of this or more is a no-return, m. By default what the log gives, else 80 m.
    pub max_range_m: Option<f64>,
    /// A disparity above this is no match, px, and a scan most of whose disparities lie above it is refused. By default there is
    /// no bound.
    pub max_disparity_px: Option<f64>,
    /// Directions of the beams of a laser in a CARMEN log, instead of what the log gives, see [`carmen`](crate::carmen).
    pub fan: FanOptions,
    /// Two poses of a trajectory, or of the odometry of a raw laser, that are more than this apart are not bridged, s; scans in
    /// between are dropped and counted. 1 by default.
    pub max_gap_s: f64,
    /// Every n-th scan alone of each sensor, from the first on, of those within the time window and the trajectory; 1 by default.
    pub every: u64,
    /// Scans of these times alone, s since the first scan of the log; the end is not included.
    pub window_s: Option<Range<f64>>,
    /// A scan is dropped unless the sensor has moved at least so far, m, or turned by [`least_turn_rad`](Self::least_turn_rad),
    /// since its last that was kept.
    pub least_move_m: Option<f64>,
    /// As [`least_move_m`](Self::least_move_m), for turns; rad.
    pub least_turn_rad: Option<f64>,
    /// A log with a larger share of damaged lines is refused at its end, 0 to 1; 0.05 by default. Blank lines do not count,
    /// and a single damaged line is never too many, as the last one of a log often is.
    pub damaged_share: f64,
    /// The report keeps so many problems, the first ones; 20 by default.
    pub problems: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            min_range_m: 0.0,
            max_range_m: None,
            max_disparity_px: None,
            fan: FanOptions::default(),
            max_gap_s: 1.0,
            every: 1,
            window_s: None,
            least_move_m: None,
            least_turn_rad: None,
            damaged_share: 0.05,
            problems: 20,
        }
    }
}

impl Options {
    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// The first such option with its value and bound.
    pub fn check(&self) -> Result<(), LogError> {
        let finite_or_none = |value: Option<f64>| value.is_none_or(|value| value.is_finite() && value >= 0.0);
        let refuse =
            |name: &'static str, value: String, bound: &'static str| Err(LogError::Option { name, value, bound });
        if !(self.min_range_m.is_finite() && self.min_range_m >= 0.0) {
            return refuse("min_range_m", self.min_range_m.to_string(), "a finite number of m, 0 or more");
        }
        if let Some(max) = self.max_range_m.filter(|max| max.is_nan() || *max <= self.min_range_m) {
            return refuse("max_range_m", max.to_string(), "a number of m above min_range_m");
        }
        if let Some(max) = self.max_disparity_px.filter(|max| max.is_nan() || *max <= 0.0) {
            return refuse("max_disparity_px", max.to_string(), "a number of px above 0");
        }
        if let Err(bound) = self.fan.check() {
            return refuse("fan", format!("{:?}", self.fan), bound);
        }
        if self.max_gap_s.is_nan() || self.max_gap_s < 0.0 {
            return refuse("max_gap_s", self.max_gap_s.to_string(), "a number of s, 0 or more");
        }
        if self.every == 0 {
            return refuse("every", "0".to_owned(), "1 or more");
        }
        if let Some(window) = self.window_s.as_ref().filter(|window| window.is_empty()) {
            return refuse("window_s", format!("{window:?}"), "numbers of s that rise");
        }
        if !finite_or_none(self.least_move_m) {
            return refuse("least_move_m", format!("{:?}", self.least_move_m), "a finite number of m, 0 or more");
        }
        if !finite_or_none(self.least_turn_rad) {
            return refuse("least_turn_rad", format!("{:?}", self.least_turn_rad), "a finite number of rad, 0 or more");
        }
        if !(0.0..=1.0).contains(&self.damaged_share) {
            return refuse("damaged_share", self.damaged_share.to_string(), "from 0 to 1");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_without_sense_are_refused_by_name() {
        let fine = Options::default();
        assert!(fine.check().is_ok());
        assert!(Options { max_range_m: Some(f64::INFINITY), ..fine.clone() }.check().is_ok());
        assert!(Options { max_gap_s: f64::INFINITY, ..fine.clone() }.check().is_ok());
        let fan =
            |fov_rad, first_rad, step_rad| Options { fan: FanOptions { fov_rad, first_rad, step_rad }, ..fine.clone() };
        for (name, options) in [
            ("min_range_m", Options { min_range_m: f64::NAN, ..fine.clone() }),
            ("min_range_m", Options { min_range_m: -1.0, ..fine.clone() }),
            ("max_range_m", Options { min_range_m: 2.0, max_range_m: Some(2.0), ..fine.clone() }),
            ("max_range_m", Options { max_range_m: Some(f64::NAN), ..fine.clone() }),
            ("max_disparity_px", Options { max_disparity_px: Some(0.0), ..fine.clone() }),
            ("fan", fan(None, Some(f64::NAN), None)),
            ("fan", fan(Some(7.0), None, None)),
            ("fan", fan(None, None, Some(0.0))),
            ("max_gap_s", Options { max_gap_s: -1.0, ..fine.clone() }),
            ("every", Options { every: 0, ..fine.clone() }),
            ("window_s", Options { window_s: Some(3.0..3.0), ..fine.clone() }),
            ("window_s", Options { window_s: Some(f64::NAN..3.0), ..fine.clone() }),
            ("least_move_m", Options { least_move_m: Some(-1.0), ..fine.clone() }),
            ("least_turn_rad", Options { least_turn_rad: Some(f64::INFINITY), ..fine.clone() }),
            ("damaged_share", Options { damaged_share: 1.1, ..fine.clone() }),
        ] {
            let message = options.check().expect_err(name).to_string();
            assert!(message.starts_with(&format!("option {name}: ")), "{message}");
        }
    }
}
