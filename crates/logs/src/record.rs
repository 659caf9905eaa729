//! What a parser makes of a log: scans with what else is known of them.

use std::collections::VecDeque;

use sensor::{Pose, Scan};

use crate::report::{Gap, Report};

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
    /// Sonars: readings are ranges in m of the nearest thing in a cone.
    Sonar {
        /// Readings from here on are no echo, m; none where the log does not say.
        max_range_m: Option<f64>,
        /// Angle between the edges of the cone, rad; none where the log does not say.
        width_rad: Option<f64>,
    },
}

/// A scan with what a log tells of it beside.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// The scan; its time is s since the first scan of the log.
    pub scan: Scan,
    /// Which sensor took it: a key of [`Report::sensors`]; the scan has the same number.
    pub sensor: usize,
    /// What that is.
    pub kind: Sensor,
    /// Where the sensor stands on the robot, as far as the log tells: of a bag by its transforms or options, of a CARMEN log by its
    /// parameters, its lines of sonars, or as is usual for the laser; none of a table.
    pub mount: Option<Pose>,
    /// Pose of the robot by its odometry, where the log has one; of a bag, that of the sensor on it.
    pub odometry: Option<Pose>,
    /// The line it begins on, from 1.
    pub line: u64,
}

/// One scan of a log, before any choice.
pub(crate) struct Recorded {
    /// The scan; its time is that of the log's own clock, s.
    pub(crate) scan: Scan,
    pub(crate) sensor: usize,
    pub(crate) kind: Sensor,
    /// Where the sensor stands on the robot; none where the log does not tell, and it is taken to stand in the middle.
    pub(crate) mount: Option<Pose>,
    /// The sensor, seen from the one whose poses a trajectory of [`Body::Sensor`](crate::Body::Sensor) has: from itself, but for sonars beside a laser.
    pub(crate) from_reference: Pose,
    pub(crate) odometry: Option<Pose>,
    /// Whether the log gives the scan a pose.
    pub(crate) placed: bool,
    /// Why it has none, if it lies in a gap of the odometry.
    pub(crate) gap: Option<Gap>,
    /// The line it begins on.
    pub(crate) line: u64,
    /// What makes its readings implausible.
    pub(crate) unit: Result<(), String>,
    /// Number of the scan, where the log has one.
    pub(crate) number: Option<u64>,
    /// Whether it is of the message that the scan before is of.
    pub(crate) follows: bool,
}

impl Recorded {
    /// A scan of which nothing is known but what took it, and where it stands in the log.
    pub(crate) fn of(sensor: usize, kind: Sensor, line: u64) -> Self {
        Self {
            scan: Scan::default(),
            sensor,
            kind,
            mount: None,
            from_reference: Pose::default(),
            odometry: None,
            placed: false,
            gap: None,
            line,
            unit: Ok(()),
            number: None,
            follows: false,
        }
    }
}

/// What is wrong with a line.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// The line is damaged, and is skipped.
    Damage(String),
    /// The log cannot be read at all.
    Refusal(String),
}

impl From<String> for Fault {
    fn from(reason: String) -> Self {
        Self::Damage(reason)
    }
}

/// Turns lines into scans.
pub(crate) trait Parser: Send {
    /// Takes one line; adds the scans that it completes.
    fn line(
        &mut self,
        text: &[u8],
        number: u64,
        report: &mut Report,
        out: &mut VecDeque<Recorded>,
    ) -> Result<(), Fault>;

    /// Adds the scans that the end of the log completes.
    fn end(&mut self, report: &mut Report, out: &mut VecDeque<Recorded>);

    /// Whether scans have times of a clock.
    fn timed(&self) -> bool;
}
