//! Poses and transforms: `nav_msgs/Odometry`, `geometry_msgs/PoseStamped` and `tf2_msgs/TFMessage`.

use super::fields::{Fields, Short};
use super::header::{Header, frame};
use crate::record::Encoding;

/// Where a frame stands in another, and how it is turned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rigid {
    /// Position, m.
    pub at_m: [f64; 3],
    /// Quaternion x, y, z, w as it stands in the message; may have any norm.
    pub turn: [f64; 4],
}

/// The pose of a robot by its odometry.
#[derive(Debug, Clone, PartialEq)]
pub struct Odometry {
    /// When, and in which frame.
    pub header: Header,
    /// The frame whose pose it is.
    pub child: String,
    /// Where the child stands in the frame.
    pub pose: Rigid,
}

/// A pose that says nothing of whose it is.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseStamped {
    /// When, and in which frame.
    pub header: Header,
    /// The pose.
    pub pose: Rigid,
}

/// Where a frame stands in another at a time.
#[derive(Debug, Clone, PartialEq)]
pub struct Transform {
    /// When, and in which frame.
    pub header: Header,
    /// The frame that stands in it.
    pub child: String,
    /// Where.
    pub pose: Rigid,
}

/// Transforms of one message.
#[derive(Debug, Clone, PartialEq)]
pub struct Transforms(pub Vec<Transform>);

fn rigid(fields: &mut Fields<'_>) -> Result<Rigid, Short> {
    Ok(Rigid { at_m: fields.f64s()?, turn: fields.f64s()? })
}

impl Odometry {
    /// Its type.
    pub const KIND: &str = "nav_msgs/Odometry";

    /// Reads a message.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &[u8]) -> Result<Self, String> {
        let mut fields = Fields::of(encoding, bytes)?;
        Ok(Self { header: Header::of(&mut fields)?, child: frame(&mut fields)?, pose: rigid(&mut fields)? })
    }
}

impl PoseStamped {
    /// Its type, and the one that has a covariance behind.
    pub const KINDS: [&str; 2] = ["geometry_msgs/PoseStamped", "geometry_msgs/PoseWithCovarianceStamped"];

    /// Reads a message of either type.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &[u8]) -> Result<Self, String> {
        let mut fields = Fields::of(encoding, bytes)?;
        Ok(Self { header: Header::of(&mut fields)?, pose: rigid(&mut fields)? })
    }
}

impl Transforms {
    /// Its type in ROS 2 and ROS 1, and in ROS 1 before.
    pub const KINDS: [&str; 2] = ["tf2_msgs/TFMessage", "tf/tfMessage"];

    /// Reads a message of either type.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &[u8]) -> Result<Self, String> {
        let mut fields = Fields::of(encoding, bytes)?;
        let count = fields.u32()?;
        let mut all = Vec::new(); // the count is a claim
        for _ in 0..count {
            let header = Header::of(&mut fields)?;
            all.push(Transform { header, child: frame(&mut fields)?, pose: rigid(&mut fields)? });
        }
        Ok(Self(all))
    }
}
