//! `std_msgs/Header`: when and in which frame.

use super::fields::{Fields, Short};
use crate::record::{Encoding, plain};

/// When and in which frame a message holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Header {
    /// ns by the robot's clock; 0 where nothing was filled in.
    pub stamp_ns: i64,
    /// Name of the frame, without the slash before it that ROS 1 once had.
    pub frame: String,
}

impl Header {
    /// The header of any message that begins with one.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &[u8]) -> Result<Self, String> {
        Self::of(&mut Fields::of(encoding, bytes)?)
    }

    pub(super) fn of(fields: &mut Fields<'_>) -> Result<Self, Short> {
        let seconds = if fields.is_ros1() {
            fields.u32()?;
            i64::from(fields.u32()?)
        } else {
            i64::from(fields.i32()?)
        };
        let stamp_ns = seconds * 1_000_000_000 + i64::from(fields.u32()?);
        Ok(Self { stamp_ns, frame: frame(fields)? })
    }
}

/// The name of a frame.
pub(super) fn frame(fields: &mut Fields<'_>) -> Result<String, Short> {
    let name = fields.text()?;
    Ok(plain(name.strip_prefix('/').unwrap_or(&name)))
}
