//! The messages that are decoded, of ROS 1 and ROS 2 alike.
//!
//! | type | here |
//! |---|---|
//! | `sensor_msgs/LaserScan` | [`LaserScan`] |
//! | `sensor_msgs/Image`, of depths | [`Image`] with [`Image::depths_m`] |
//! | `sensor_msgs/CameraInfo` | [`CameraInfo`] |
//! | `stereo_msgs/DisparityImage` | [`DisparityImage`] |
//! | `nav_msgs/Odometry` | [`Odometry`] |
//! | `geometry_msgs/PoseStamped`, `PoseWithCovarianceStamped` | [`PoseStamped`] |
//! | `tf2_msgs/TFMessage`, `tf/tfMessage` | [`Transforms`] |
//!
//! Fields behind those that are needed are not read, so that later versions of a type may have more of them. A message that is too
//! short for what it claims is an error that says so, as a line without the place.

mod fields;
mod header;
mod image;
mod laser;
mod pose;

pub use header::Header;
pub use image::{CameraInfo, DisparityImage, Image};
pub use laser::LaserScan;
pub use pose::{Odometry, PoseStamped, Rigid, Transform, Transforms};
