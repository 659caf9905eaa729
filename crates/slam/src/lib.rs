//! Where a robot went and what lies there, found together: a Rao-Blackwellised particle filter over any occupancy mapper.
//!
//! A particle is a way that the robot may have gone, with the map that belongs to it. [`Slam::take`] is given scans with the pose that
//! the odometry has for each; [`Slam::finish`] gives a pose for every scan, and the map. Any [`mapper::Mapper`] that can be copied
//! ([`fork`](mapper::Mapper::fork)) can be the map; one that predicts readings ([`evidence`](mapper::Mapper::evidence)) can weigh
//! particles by that ([`Weight`]). What several sensors read at one time is one scan ([`Slam::take_together`], [`Mounted`]).
//!
//! [`features`] has landmarks in the place of a map: Kalman filters from known poses, and FastSLAM.

pub mod features;
mod field;
mod filter;
mod frame;
mod gaussian;
mod matcher;
mod moments;
mod motion;
mod options;
mod particle;
mod random;
mod resampling;
mod sight;
mod surfaces;
mod trajectory;

pub use field::Sharpness;
pub use filter::{Outcome, Slam, SlamError, Update};
pub use frame::Frame;
pub use moments::Moments;
pub use motion::Motion;
pub use options::{NOWHERE, Options, OptionsError, Proposal, Weight};
pub use resampling::{effective, low_variance, normalised};
pub use sight::Mounted;
pub use surfaces::Surfaces;
