//! Which trajectories cannot be scored.

use thiserror::Error;

/// Why a trajectory cannot be scored.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TrajectoryError {
    /// A pose, time or covariance that is no number, or that is beyond any place on earth.
    #[error("pose {index}, {name}: {value} must be a number from -1e12 to 1e12")]
    Value {
        /// Which pose, from 0.
        index: usize,
        /// What of it.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// Times that do not rise.
    #[error(
        "{whose} pose {index}: time {time_s} s does not come after {before_s} s: sort the poses, one for each time"
    )]
    Order {
        /// Whose: the estimate's or the reference's.
        whose: &'static str,
        /// Which pose, from 0.
        index: usize,
        /// Its time, s.
        time_s: f64,
        /// The time before it, s.
        before_s: f64,
    },
    /// A largest difference or a step that is none.
    #[error("{name}: {value} must be {bound}")]
    Bound {
        /// Which.
        name: &'static str,
        /// The value.
        value: f64,
        /// What it must be.
        bound: &'static str,
    },
    /// No pose has a partner.
    #[error(
        "none of {estimated} estimated poses ({:.3} to {:.3} s) lies within {most_s} s of one of {given} of the reference ({:.3} to \
         {:.3} s): is it the same clock?",
        estimate_s[0],
        estimate_s[1],
        reference_s[0],
        reference_s[1]
    )]
    Apart {
        /// Number of estimated poses.
        estimated: usize,
        /// Number of poses of the reference.
        given: usize,
        /// The largest difference, s.
        most_s: f64,
        /// First and last time of the estimate, s.
        estimate_s: [f64; 2],
        /// First and last time of the reference, s.
        reference_s: [f64; 2],
    },
    /// Too few poses.
    #[error("{found} {what}: {needed} are needed")]
    TooFew {
        /// How many there are.
        found: usize,
        /// Of what.
        what: &'static str,
        /// How many are needed.
        needed: usize,
    },
    /// No rotation fits better than the others.
    #[error(
        "no turn aligns the trajectories better than any other, since one of them stays where it is: score them without alignment"
    )]
    Still,
    /// No step is so long.
    #[error("no step of {value} {unit} within {pairs} poses: give a shorter one")]
    Step {
        /// The step.
        value: f64,
        /// Of what.
        unit: &'static str,
        /// Number of paired poses.
        pairs: usize,
    },
    /// A matrix that is no covariance.
    #[error("pose {index}: its covariance {covariance:?} is not symmetric and positive definite")]
    Covariance {
        /// Which pose, from 0.
        index: usize,
        /// The matrix: x (m), y (m), heading (rad).
        covariance: [[f64; 3]; 3],
    },
    /// A matrix that is no covariance of a place.
    #[error("landmark {index}: its covariance {covariance:?} is not symmetric and positive definite")]
    LandmarkCovariance {
        /// Which landmark, from 0.
        index: usize,
        /// The matrix: x and y (m).
        covariance: [[f64; 2]; 2],
    },
    /// A landmark that is nowhere.
    #[error("landmark {index}, {name}: {value} must be a number from -1e12 to 1e12")]
    Landmark {
        /// Which landmark, from 0.
        index: usize,
        /// What of it.
        name: &'static str,
        /// The value.
        value: f64,
    },
}

/// Beyond any place on earth and any time since 1970, m and s: squares stay finite.
const FARTHEST: f64 = 1e12;

/// What is refused where poses are paired.
pub(super) const DIFFERENCE: &str = "largest difference in time, s";

/// Refuses what is no number.
pub(super) fn number(index: usize, name: &'static str, value: f64) -> Result<(), TrajectoryError> {
    if value.abs() <= FARTHEST { Ok(()) } else { Err(TrajectoryError::Value { index, name, value }) }
}

/// Refuses what is no length of time.
pub(super) fn duration(name: &'static str, value: f64) -> Result<(), TrajectoryError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(TrajectoryError::Bound { name, value, bound: "0 or more, and finite" })
}
