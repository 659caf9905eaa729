//! What the numbers of a laser may be.

use std::fmt;

use super::Laser;

/// A number that no laser has.
#[derive(Debug, Clone, PartialEq)]
pub struct LaserError {
    /// Name of the field.
    pub field: &'static str,
    /// What it is.
    pub value: f64,
    /// What it must be.
    pub bound: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

impl fmt::Display for LaserError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Self { field, value, bound, remedy } = self;
        write!(f, "{field} = {value}: must be {bound}; {remedy}")
    }
}

impl std::error::Error for LaserError {}

/// Shares that add up to one may do so but for rounding.
const ROUNDING: f64 = 1e-9;

impl Laser {
    /// Verifies that every number is one that a laser can have.
    ///
    /// # Errors
    /// The first that is not, with its bound.
    pub fn validate(&self) -> Result<(), LaserError> {
        let probability = ("a probability, 0 to 1", "give a number such as 0.9");
        let range = ("a positive length in m, 0.001 to 1000000", "give the largest range measured, such as 80");
        let sigma = ("a positive length in m, 0.000001 to 1000", "give a standard deviation such as 0.025");
        let rate = ("a rate in 1/m, 0 to 1000", "give how many people stand in a metre of beam, such as 0.002");
        let fields = [
            ("range_sigma_m", self.range_sigma_m, 1e-6..=1e3, sigma),
            ("max_range_m", self.max_range_m, 1e-3..=1e6, range),
            ("hit", self.hit, 0.0..=1.0, probability),
            ("no_echo", self.no_echo, 0.0..=1.0, probability),
            ("early_per_m", self.early_per_m, 0.0..=1e3, rate),
        ];
        for (field, value, limits, (bound, remedy)) in fields {
            if !limits.contains(&value) {
                return Err(LaserError { field, value, bound, remedy });
            }
        }
        if self.hit + self.no_echo > 1.0 + ROUNDING {
            let bound = "such that hit and no_echo add up to at most 1";
            let remedy = "the rest of the pulses are outliers; lower one of them";
            return Err(LaserError { field: "no_echo", value: self.no_echo, bound, remedy });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_default_is_a_laser() {
        assert_eq!(Laser::default().validate(), Ok(()));
        let sure = Laser { hit: 0.9, no_echo: 0.1, early_per_m: 0.0, ..Laser::default() };
        assert_eq!(sure.validate(), Ok(()), "no outliers");
    }

    #[test]
    fn every_number_has_bounds() {
        let laser = Laser::default();
        let wrong = [
            (Laser { range_sigma_m: 0.0, ..laser }, "range_sigma_m = 0: must be a positive length in m"),
            (Laser { max_range_m: f64::INFINITY, ..laser }, "max_range_m = inf: must be a positive length in m"),
            (Laser { hit: 1.1, ..laser }, "hit = 1.1: must be a probability, 0 to 1"),
            (Laser { no_echo: f64::NAN, ..laser }, "no_echo = NaN: must be a probability, 0 to 1"),
            (Laser { early_per_m: -1.0, ..laser }, "early_per_m = -1: must be a rate in 1/m"),
            (Laser { no_echo: 0.2, ..laser }, "no_echo = 0.2: must be such that hit and no_echo add up to at most 1"),
        ];
        for (laser, start) in wrong {
            let message = laser.validate().expect_err(start).to_string();
            assert!(message.starts_with(start), "{message}");
        }
    }

    #[test]
    fn unknown_keys_are_refused_and_missing_ones_are_the_default() {
        let laser: Laser = serde_json::from_str(r#"{"max_range_m": 8.0}"#).expect("valid");
        assert_eq!(laser, Laser { max_range_m: 8.0, ..Laser::default() });
        let error = serde_json::from_str::<Laser>(r#"{"max_range": 8.0}"#).expect_err("no such key").to_string();
        assert!(error.contains("unknown field `max_range`"), "{error}");
    }
}
