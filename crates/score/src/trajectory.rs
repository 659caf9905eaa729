//! Trajectories against the truth: where a robot takes itself to be, and where it is.
//!
//! | number | protocol | source |
//! |---|---|---|
//! | absolute error, ATE ([`absolute`]) | distance and turn between paired poses, as they stand or after the rigid motion of least squares ([`alignment`]) | Sturm et al. 2012, Umeyama 1991 |
//! | relative error, RPE ([`relative`]) | the same of the motions over a step ([`Step`]): so many poses, m of the reference's path, or s | Sturm et al. 2012 |
//! | relations ([`related`]) | the same of motions between given times, loops and others apart | Kümmerle et al. 2009 |
//! | NEES ([`nees`]) | squared errors in units of the stated covariances, with the bounds of a chi-squared distribution | Bar-Shalom et al. 2001 |
//!
//! ```
//! use score::trajectory::{Pose, Stamped, absolute, aligned, associated, relative, Step};
//!
//! let pose = |k: i32, turned: bool| {
//!     let along_m = 0.5 * f64::from(k);
//!     let [x_m, y_m] = if turned { [0.0, along_m] } else { [along_m, 0.0] };
//!     Stamped { time_s: f64::from(k), pose: Pose { x_m, y_m, theta_rad: if turned { 1.5707963267948966 } else { 0.0 } } }
//! };
//! let estimate: Vec<Stamped> = (0..9).map(|k| pose(k, true)).collect();
//! let reference: Vec<Stamped> = (0..9).map(|k| pose(k, false)).collect();
//! let pairs = associated(&estimate, &reference, 0.01)?;
//! assert!(absolute(&pairs)?.translation_m.rmse > 2.0); // another frame
//! assert!(absolute(&aligned(&pairs)?)?.translation_m.rmse < 1e-12);
//! assert!(relative(&pairs, Step::Metres(1.0))?.translation_m.max < 1e-12);
//! # Ok::<(), score::trajectory::TrajectoryError>(())
//! ```

mod absolute;
mod alignment;
mod association;
pub(crate) mod chi_squared;
mod error;
mod nees;
mod pose;
mod relations;
mod relative;
mod spread;

pub use absolute::{PoseErrors, absolute};
pub use alignment::{aligned, alignment};
pub use association::{Pair, associated};
pub use error::TrajectoryError;
pub use nees::{Believed, Nees, nees};
pub use pose::{Pose, Stamped};
pub use relations::{LOOP_S, Related, Relation, RelationErrors, related};
pub use relative::{Step, relative};
pub use spread::Spread;

#[cfg(test)]
mod walks;
