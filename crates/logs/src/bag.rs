//! Bags of ROS 1 and ROS 2 as logs: scans of lasers and cameras, placed by odometry, poses or transforms of the same bag.
//!
//! A bag is read twice. [`Drive::open`] reads all but the readings: topics, poses and transforms, and decides which are used, by
//! [`BagOptions`], or by itself where there is no choice. Scans are then read one by one, as those of any log, by
//! [`Log::of_drive`](crate::Log::of_drive).
//!
//! | message | scan |
//! |---|---|
//! | `sensor_msgs/LaserScan` | of a laser: `inf`, and a range of [`Options::max_range_m`](crate::Options::max_range_m) or more, is no echo; NaN, `-inf`, and what lies outside the message's `range_min` and `range_max`, says nothing (REP 117) |
//! | `stereo_msgs/DisparityImage` | of a stereo camera, a beam per column: of [`BagOptions::rows`] rows about the axis of the camera, the largest disparity |
//! | `sensor_msgs/Image` of depths | of a stereo camera whose focal length times baseline is [`BagOptions::focal_baseline`]: of these rows, the disparity of the least depth |
//!
//! One row is the usual choice: a reading is then what one pixel measured, as kernels take it. The nearest of several rows also sees what
//! stands above or below that row, as `depthimage_to_laserscan` does, is biased towards the camera by the noise of all of them, and
//! takes the floor for an obstacle where rows reach down to it.
//!
//! The sensor stands in the map where the source of poses and the transforms between put it, each interpolated between the two stamps about
//! the time of the scan; what is not known before and after is not guessed: such scans are left out and counted. A mirrored scan, of a laser
//! that hangs upside down, is turned over. The z coordinate is left out.

mod beams;
mod clock;
mod contents;
mod drive;
mod finding;
mod frames;
mod listing;
mod options;
mod plan;
mod scans;
mod seat;
mod survey;
mod turn;

pub use contents::{Contents, PoseCandidate, TopicSummary};
pub use drive::{Camera, Drive};
pub use finding::BagFinding;
pub use options::{BagOptions, PoseSource};

pub(crate) use scans::Scans;
