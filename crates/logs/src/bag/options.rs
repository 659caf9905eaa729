//! What to read of a bag.

use sensor::{Pose, Stereo};

use crate::trajectory::Body;

/// What to read of a bag. The default takes what there is only one of.
#[derive(Debug, Clone, PartialEq)]
pub struct BagOptions {
    /// Topics of scans, a sensor each; none takes the only one there is.
    pub scans: Vec<String>,
    /// Where poses come from.
    pub pose: PoseSource,
    /// Of images, the nearest of so many rows about the axis of the camera is read; 1 by default.
    pub rows: usize,
    /// Focal length times baseline of the camera that depths are turned into disparities of, px·m; that of [`Stereo::default`] by default.
    pub focal_baseline: f64,
    /// Where sensors stand on the robot that no transform tells of; none refuses them, unless the bag has no transforms at all.
    pub mount: Option<Pose>,
}

/// Where poses come from.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum PoseSource {
    /// From the only source there is.
    #[default]
    Only,
    /// From the only topic of `nav_msgs/Odometry`, else from the transforms below the frame `odom`.
    Odometry,
    /// From a topic of `nav_msgs/Odometry`, `geometry_msgs/PoseStamped` or `PoseWithCovarianceStamped`.
    Topic(String),
    /// From the transforms between this frame and the sensor.
    Frame(String),
    /// From a trajectory of such poses, by [`Log::along`](crate::Log::along).
    Elsewhere(Body),
}

impl PoseSource {
    /// By its name: `odom`, `tf:` and a frame, or a topic.
    pub fn named(name: &str) -> Self {
        match name.strip_prefix("tf:") {
            Some(frame) => Self::Frame(frame.strip_prefix('/').unwrap_or(frame).to_owned()),
            None if name == "odom" => Self::Odometry,
            None => Self::Topic(name.to_owned()),
        }
    }
}

impl Default for BagOptions {
    fn default() -> Self {
        Self {
            scans: Vec::new(),
            pose: PoseSource::Only,
            rows: 1,
            focal_baseline: Stereo::default().focal_baseline,
            mount: None,
        }
    }
}
