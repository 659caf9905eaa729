//! Scans, and the sensor models that explain them.
//!
//! A [`Scan`] is a plain value: where the sensor stood, in which directions it looked, and what it
//! read. It can come from the simulator, from a file or from a robot. A [`SensorModel`] gives how
//! likely a reading is when cell `k` of the ray is the first occupied one, `P(o | F_k)`: all a
//! mapper needs to know of a sensor. [`Stereo`] is the stereo camera of the paper, Eq. (21), and
//! [`Matcher`] samples the disparities that such a camera would measure, with the paper's
//! independent mismatches or with [`Clustering`] as measured on real pairs. [`Laser`] is a laser
//! range finder, with what it measures and how it is sampled; [`Sonar`] hears the nearest thing in
//! a cone; [`Depth`] is a depth camera and [`Omnidirectional`] a stereo camera that looks all round.
//! A [`Device`] is any of them, as a robot that is simulated carries it. [`FeatureCamera`] finds
//! point features instead of columns. [`OdometryNoise`] is how far odometry may be off in a
//! [`Step`] from one pose to the next.

mod camera;
mod clustering;
mod depth;
mod device;
mod fast_kernel;
mod features;
mod gaussian;
mod inverse_model;
mod kernel;
pub mod lanes;
mod laser;
mod matcher;
mod normal;
mod odometry;
mod omnidirectional;
mod scan;
mod sensor_model;
mod sonar;
mod stereo;

pub use camera::Camera;
pub use clustering::{Clustering, Mismatches};
pub use depth::Depth;
pub use device::{Device, SensorKind};
pub use fast_kernel::{FastKernel, ReadingKernel};
pub use features::{FeatureCamera, FeatureCameraError, FeatureReading, FeatureScan};
pub use gaussian::exp_minus;
pub use inverse_model::{InverseModel, Placement};
pub use kernel::{Kernel, Parameters};
pub use laser::Laser;
pub use laser::check::LaserError;
pub use matcher::{Matcher, Surface};
pub use odometry::{OdometryNoise, OdometryNoiseError, Step, wrapped_rad};
pub use omnidirectional::Omnidirectional;
pub use scan::{Pose, Ray, Scan};
pub use sensor_model::SensorModel;
pub use sonar::Sonar;
pub use stereo::Stereo;
