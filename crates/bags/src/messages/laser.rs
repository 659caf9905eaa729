//! `sensor_msgs/LaserScan`.

use super::fields::Fields;
use super::header::Header;
use crate::record::Encoding;

/// A scan of a laser: beam k goes to `first_rad + k step_rad`, counter-clockwise about the z axis of its frame, from the x axis on.
#[derive(Debug, Clone, PartialEq)]
pub struct LaserScan {
    /// When the first beam was sent, and from which frame.
    pub header: Header,
    /// Bearing of the first beam, rad.
    pub first_rad: f64,
    /// Bearing of the last beam, rad, as the message claims.
    pub last_rad: f64,
    /// From one beam to the next, rad; negative clockwise.
    pub step_rad: f64,
    /// The least range that is measured, m.
    pub min_m: f64,
    /// The longest range that is measured, m.
    pub max_m: f64,
    /// m; by REP 117, `inf` where nothing was hit, `-inf` where it is too near, NaN where the reading failed.
    pub ranges_m: Vec<f64>,
}

impl LaserScan {
    /// Its type.
    pub const KIND: &str = "sensor_msgs/LaserScan";

    /// Reads a message.
    ///
    /// # Errors
    /// A message that is too short.
    pub fn read(encoding: Encoding, bytes: &[u8]) -> Result<Self, String> {
        let mut fields = Fields::of(encoding, bytes)?;
        let header = Header::of(&mut fields)?;
        let [first_rad, last_rad, step_rad] = [fields.f32()?, fields.f32()?, fields.f32()?];
        let _ = [fields.f32()?, fields.f32()?]; // time from beam to beam, and from scan to scan
        let [min_m, max_m] = [fields.f32()?, fields.f32()?];
        Ok(Self { header, first_rad, last_rad, step_rad, min_m, max_m, ranges_m: fields.f32_list()? })
    }
}
