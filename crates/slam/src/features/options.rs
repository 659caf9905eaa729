//! How features are taken.

use sensor::{FeatureCamera, FeatureCameraError};

/// What is done with features, whatever the poses come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Association {
    /// Squared Mahalanobis distance up to which a reading may be of a landmark. Default 13.8, the 0.1 % point of a chi-squared
    /// distribution of two degrees of freedom.
    pub gate: f64,
    /// Whether readings say which feature they are of.
    pub identity: Identity,
    /// Whether a landmark that should have been seen, and was not, is doubted, and in the end deleted.
    pub negative_evidence: bool,
    /// A landmark should be seen no farther than this from where it was seen last, m: a wall that no feature tells of may hide it
    /// elsewhere. Infinite in the open. Default 0.3.
    pub vantage_m: f64,
    /// Half the width of what stands at a feature, m: what lies behind it is hidden. Default 0.15.
    pub occluder_m: f64,
}

/// Whether readings say which feature they are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Identity {
    /// They do not, or are not asked: the likeliest landmark within the gate.
    #[default]
    Unknown,
    /// They do. A reading outside the gate is of a failed match.
    Known,
}

impl Default for Association {
    fn default() -> Self {
        Self { gate: 13.8, identity: Identity::Unknown, negative_evidence: true, vantage_m: 0.3, occluder_m: 0.15 }
    }
}

/// Where the poses of particles are drawn from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FeatureProposal {
    /// From the odometry alone: FastSLAM 1.0 (Montemerlo et al., AAAI 2002).
    Odometry,
    /// From the odometry and the latest readings: FastSLAM 2.0 (Montemerlo et al., IJCAI 2003).
    #[default]
    Latest,
}

/// How FastSLAM works.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FeatureOptions {
    /// Number of particles, 1 to [`FeatureOptions::MOST_PARTICLES`]. Default 100.
    pub particles: usize,
    /// Seed of all random numbers. Default 1.
    pub seed: u64,
    /// Where poses are drawn from.
    pub proposal: FeatureProposal,
    /// How readings and landmarks find each other.
    pub association: Association,
}

impl Default for FeatureOptions {
    fn default() -> Self {
        let association = Association::default();
        Self { particles: 100, seed: 1, proposal: FeatureProposal::default(), association }
    }
}

/// An option, or a number of the camera, out of its bounds.
#[derive(Debug, Clone, PartialEq)]
pub enum FeatureOptionsError {
    /// A number of the camera.
    Camera(FeatureCameraError),
    /// A number of the odometry.
    Odometry(sensor::OdometryNoiseError),
    /// An option: its name, its value and what it must be.
    Option(&'static str, f64, &'static str),
}

impl std::fmt::Display for FeatureOptionsError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Camera(error) => error.fmt(f),
            Self::Odometry(error) => error.fmt(f),
            Self::Option(name, value, bound) => write!(f, "{name} is {value}; must be {bound}"),
        }
    }
}

impl std::error::Error for FeatureOptionsError {}

impl Association {
    /// Whether all numbers are within their bounds; the first that is not, otherwise.
    ///
    /// # Errors
    /// That number.
    pub fn check(&self, camera: &FeatureCamera) -> Result<(), FeatureOptionsError> {
        camera.check().map_err(FeatureOptionsError::Camera)?;
        let fine = |value: f64| value > 0.0;
        for (name, value) in [("gate", self.gate), ("vantage_m", self.vantage_m)] {
            if !fine(value) {
                return Err(FeatureOptionsError::Option(name, value, "above 0"));
            }
        }
        if !(self.occluder_m >= 0.0 && self.occluder_m.is_finite()) {
            return Err(FeatureOptionsError::Option("occluder_m", self.occluder_m, "finite, 0 or more"));
        }
        Ok(())
    }
}

impl FeatureOptions {
    /// More particles are taken for a mistake.
    pub const MOST_PARTICLES: usize = 100_000;

    /// As [`Association::check`], with the number of particles.
    ///
    /// # Errors
    /// The first number out of its bounds.
    pub fn check(&self, camera: &FeatureCamera) -> Result<(), FeatureOptionsError> {
        if self.particles == 0 || self.particles > Self::MOST_PARTICLES {
            return Err(FeatureOptionsError::Option("particles", self.particles as f64, "1 to 100000"));
        }
        self.association.check(camera)
    }
}
