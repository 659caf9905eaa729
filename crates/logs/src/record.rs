//! What a parser makes of a log: scans with what else is known of them.

use sensor::{Pose, Scan};

use crate::report::Report;

/// What took the scans of a log, and so the unit of their readings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sensor {
    /// A laser scanner: readings are ranges in m.
    Laser {
        /// Readings from here on are no-returns, m.
        max_range_m: f64,
        /// Number of beams of a scan.
        beams: usize,
    },
    /// A stereo camera: readings are disparities in px.
    Stereo,
}

/// One scan of a log, before any choice.
pub(crate) struct Recorded {
    /// The scan; its time is that of the log's own clock, s.
    pub(crate) scan: Scan,
    pub(crate) sensor: Sensor,
    /// Where the sensor stands on the robot.
    pub(crate) mount: Pose,
    /// The line it begins on.
    pub(crate) line: u64,
    /// What makes its ranges unbelievable.
    pub(crate) unit: Result<(), String>,
    /// Number of the scan, where the log has one.
    pub(crate) number: Option<u64>,
}

/// Turns lines into scans.
pub(crate) trait Parser: Send {
    /// Takes one line; gives the scan that it completes, or what is wrong with the line.
    fn line(&mut self, text: &[u8], number: u64, report: &mut Report) -> Result<Option<Recorded>, String>;

    /// The scan that the end of the log completes.
    fn end(&mut self) -> Option<Recorded>;

    /// Whether scans have times of a clock.
    fn timed(&self) -> bool;
}
