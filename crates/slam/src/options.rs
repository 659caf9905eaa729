//! How the filter works, and which values make sense.

use std::fmt;

use crate::field::Sharpness;

/// What a scan weighs a pose by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Weight {
    /// The likelihood field of the map's surfaces, as GMapping has it: `power` times the sum over readings of
    /// `ln((1 - e) exp(-d^2 / 2 sigma^2) + e)`, `d` being the distance to the nearest surface and `e` [`NOWHERE`].
    Field {
        /// What the readings of a scan are worth of as many independent ones, above 0 and at most 1. GMapping has 1/3.
        power: f64,
    },
    /// The map's own evidence: `power` times the sum over `beams` rays, evenly thinned, of `ln P(reading | map)`.
    Evidence {
        /// Rays of a scan that are asked about, at most; 1 or more.
        beams: usize,
        /// As that of the field.
        power: f64,
    },
}

/// Share of readings that end on no surface of the map.
pub const NOWHERE: f64 = 0.02;

impl Weight {
    /// The likelihood field, a third as strong as in GMapping: there a reading on no surface costs 0.5 / 3 nats, here 3.9 of the power; and
    /// there are more updates here. Chosen on the raw log ACES.
    pub const FIELD: Self = Self::Field { power: 0.012 };

    /// Rays that the map is asked about.
    pub const BEAMS: usize = 60;

    /// Evidence of thinned beams.
    pub const EVIDENCE: Self = Self::Evidence { beams: Self::BEAMS, power: 0.05 };

    /// What readings are worth of as many independent ones.
    pub const fn power(self) -> f64 {
        match self {
            Self::Field { power } | Self::Evidence { power, .. } => power,
        }
    }
}

/// Where the next pose of a particle comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Proposal {
    /// From the odometry alone; the scan weighs it.
    Odometry,
    /// From the odometry and the scan: a Gaussian round the pose that matches best, from points round it (Grisetti, Stachniss and
    /// Burgard 2007, Section III). A single particle takes the mean.
    Matched,
}

/// How the filter works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Number of particles, 1 to [`MOST_PARTICLES`](Self::MOST_PARTICLES).
    pub particles: usize,
    /// Fixes all random numbers.
    pub seed: u64,
    /// What a scan weighs a pose by.
    pub weight: Weight,
    /// Where the next pose comes from.
    pub proposal: Proposal,
    /// What is worth matching to.
    pub sharpness: Sharpness,
    /// A scan updates the filter once the sensor has moved so far, m, since the last that did; 0 or more ...
    pub update_move_m: f64,
    /// ... or has turned by so much, rad; 0 or more.
    pub update_turn_rad: f64,
    /// Odometry is not taken to be better than this along and across the way, m, and in its heading, rad, where scans are matched; above 0.
    pub least_sigmas: [f64; 3],
    /// Readings that end farther away do not take part in matching, m; above 0.
    pub reach_m: f64,
}

impl Default for Options {
    /// Thirty particles with the map's own evidence, an update every 0.2 m or 10 degrees.
    fn default() -> Self {
        Self {
            particles: 30,
            seed: 0,
            weight: Weight::EVIDENCE,
            proposal: Proposal::Matched,
            sharpness: Sharpness::default(),
            update_move_m: 0.2,
            update_turn_rad: 10.0 * std::f64::consts::PI / 180.0,
            least_sigmas: [0.005, 0.005, 0.0025],
            reach_m: 20.0,
        }
    }
}

/// An option that makes no sense.
#[derive(Debug, Clone, PartialEq)]
pub struct OptionsError {
    /// Which.
    pub name: &'static str,
    /// What it is.
    pub value: String,
    /// What it must be.
    pub bound: &'static str,
}

impl fmt::Display for OptionsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} is {}, and must be {}", self.name, self.value, self.bound)
    }
}

impl std::error::Error for OptionsError {}

impl Options {
    /// [`least_sigmas`](Self::least_sigmas) of raw logs, where the odometry of a scan is that of another moment: a tenth of a second is 4 cm at walking
    /// pace. Chosen on the raw log ACES.
    pub const OF_LOGS: [f64; 3] = [0.02, 0.02, 0.01];

    /// More particles than these are a mistake.
    pub const MOST_PARTICLES: usize = 10_000;

    /// Refuses values that make no sense.
    ///
    /// # Errors
    /// The first such option with its value and bound.
    pub fn check(&self) -> Result<(), OptionsError> {
        let refuse =
            |name, value: &dyn fmt::Display, bound| Err(OptionsError { name, value: value.to_string(), bound });
        if !(1..=Self::MOST_PARTICLES).contains(&self.particles) {
            return refuse("particles", &self.particles, "from 1 to 10000");
        }
        for power in [self.weight.power(), self.sharpness.power] {
            if !(power > 0.0 && power <= 1.0) {
                return refuse("power", &power, "above 0 and at most 1");
            }
        }
        if let Weight::Evidence { beams: 0, .. } = self.weight {
            return refuse("beams", &0, "1 or more");
        }
        let Sharpness { sigma_m, occupied, .. } = self.sharpness;
        for (name, value) in [("sigma_m", sigma_m), ("reach_m", self.reach_m)] {
            if !(value > 0.0 && value.is_finite()) {
                return refuse(name, &value, "a number of m above 0");
            }
        }
        for value in self.least_sigmas {
            if !(value > 0.0 && value.is_finite()) {
                return refuse("least_sigmas", &value, "numbers of m, m and rad above 0");
            }
        }
        if !(0.0..1.0).contains(&occupied) {
            return refuse("occupied", &occupied, "from 0 to less than 1");
        }
        for (name, value) in [("update_move_m", self.update_move_m), ("update_turn_rad", self.update_turn_rad)] {
            if !(value >= 0.0 && value.is_finite()) {
                return refuse(name, &value, "a finite number, 0 or more");
            }
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
        let sharp = |sigma_m, occupied| Options { sharpness: Sharpness { sigma_m, occupied, power: 0.3 }, ..fine };
        for (name, options) in [
            ("particles", Options { particles: 0, ..fine }),
            ("particles", Options { particles: 10_001, ..fine }),
            ("power", Options { weight: Weight::Field { power: 0.0 }, ..fine }),
            ("power", Options { sharpness: Sharpness { power: 1.1, ..Sharpness::default() }, ..fine }),
            ("power", Options { weight: Weight::Evidence { beams: 9, power: f64::NAN }, ..fine }),
            ("beams", Options { weight: Weight::Evidence { beams: 0, power: 1.0 }, ..fine }),
            ("sigma_m", sharp(0.0, 0.3)),
            ("occupied", sharp(0.1, 1.0)),
            ("reach_m", Options { reach_m: f64::INFINITY, ..fine }),
            ("least_sigmas", Options { least_sigmas: [0.01, 0.0, 0.01], ..fine }),
            ("update_move_m", Options { update_move_m: -0.1, ..fine }),
            ("update_turn_rad", Options { update_turn_rad: f64::NAN, ..fine }),
        ] {
            assert_eq!(options.check().map_err(|error| error.name), Err(name));
        }
    }
}
