//! What a user must know of a log that was read.

mod text;

use crate::bag::BagFinding;
use crate::fan::Fan;
use crate::motion::Step;

/// Something to know of a log or a trajectory that was read; [`Display`](std::fmt::Display) is a line that gives value, bound and remedy;
/// of a bag, [`text`](Self::text) counts in messages.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// The directions of a laser's beams were taken from their number.
    GuessedFan {
        /// Name of its messages.
        sensor: String,
        /// Line of its first scan of so many beams.
        line: u64,
        /// Number of beams.
        beams: usize,
        /// The guess.
        fan: Fan,
        /// Whether usual scanners have so many beams.
        usual: bool,
    },
    /// Field of view and resolution of the log's parameters do not fit the number of beams.
    UnevenFan {
        /// Name of its messages.
        sensor: String,
        /// Line of its first scan of so many beams.
        line: u64,
        /// Number of beams.
        beams: usize,
        /// What is used.
        fan: Fan,
    },
    /// All poses are those of the odometry.
    OdometryPoses {
        /// Name of its messages.
        sensor: String,
        /// Number of scans.
        scans: u64,
    },
    /// A sensor moves farther from one scan to the next than a robot can.
    Jump {
        /// The worst.
        step: Step,
        /// How many there are.
        count: u64,
    },
    /// A sensor turns more from one scan to the next than a robot can.
    Twist {
        /// The worst.
        step: Step,
        /// How many there are.
        count: u64,
    },
    /// Scans of one sensor are not in the order of their times or numbers.
    StepsBack {
        /// How many steps go back.
        count: u64,
        /// The largest, s.
        largest_s: f64,
        /// Its line.
        line: u64,
        /// Whether a time window was asked for, which then takes scans of several parts of the log.
        window: bool,
    },
    /// Poses far from all others; their scans were left out.
    Strays {
        /// How many.
        count: u64,
        /// Line of the first.
        line: u64,
        /// How far away it is, m.
        away_m: f64,
    },
    /// Scans in gaps of the trajectory, or of the odometry, were left out.
    Gaps {
        /// How many scans.
        scans: u64,
        /// The longest gap with a scan in it, s.
        longest_s: f64,
        /// Time at which it begins, s by the log's clock.
        from_s: f64,
        /// The longest gap that is bridged, s.
        most_s: f64,
    },
    /// Scans that stand in the log as messages of two names were used once.
    SaidAgain {
        /// How many.
        scans: u64,
    },
    /// Scans of raw lasers and sonars without poses of the robot around them, or of a bag without poses around them, were left out.
    Unplaced {
        /// How many.
        scans: u64,
        /// Where the poses of a bag come from.
        poses: Option<String>,
    },
    /// Ranges of a bag beyond the maximum that its messages state say nothing.
    BeyondMaximum {
        /// How many.
        count: u64,
        /// Of so many beams.
        beams: u64,
    },
    /// What is to be known of a bag.
    Bag(BagFinding),
    /// Disparities of exactly 0 were taken for no match.
    ZeroDisparities {
        /// How many.
        count: u64,
        /// Of so many beams.
        beams: u64,
    },
    /// Infinite disparities were taken for no match.
    InfiniteDisparities {
        /// How many.
        count: u64,
    },
    /// Disparities above the largest that is searched were taken for no match.
    LargeDisparities {
        /// How many.
        count: u64,
        /// Of so many beams.
        beams: u64,
        /// The bound, px.
        most_px: f64,
    },
    /// Every scan has a single beam.
    OneBeam {
        /// How many scans.
        scans: u64,
    },
    /// Rows of a table that belong together did not follow each other, and were put together.
    Regrouped {
        /// Number of scans that they make.
        scans: u64,
    },
    /// Scans of a table whose rows stand apart, and became more than one.
    Split {
        /// How often.
        count: u64,
        /// Line of the first row that stands apart.
        line: u64,
    },
    /// Where a laser stands on the robot is not in the log.
    GuessedMount {
        /// Name of its messages.
        sensor: String,
        /// What was taken.
        taken: &'static str,
    },
    /// How far the sonars of a CARMEN log hear was taken from nowhere.
    GuessedSonarRange {
        /// Line of the first message.
        line: u64,
        /// What was taken, m.
        taken_m: f64,
    },
    /// Many readings of sonars have exactly the longest range.
    SonarMaximum {
        /// The range, m.
        range_m: f64,
        /// How many.
        count: u64,
    },
    /// All sonars of a message stand at one place and look the same way.
    SonarsAlike {
        /// Line of the first message.
        line: u64,
        /// How many sonars.
        count: usize,
    },
    /// Messages of sonars that do not say where these stand were skipped.
    WithoutMounts {
        /// How many.
        lines: u64,
        /// The first of them.
        line: u64,
    },
    /// Times of a trajectory were taken for another unit than seconds.
    TrajectoryUnit {
        /// Name of the unit.
        unit: &'static str,
    },
    /// Poses of a trajectory were sorted by their times.
    TrajectorySorted {
        /// How often the time went back.
        steps_back: u64,
    },
    /// Poses of a trajectory that come twice, with the same time, were used once.
    TrajectoryDoubled {
        /// How many.
        count: u64,
    },
    /// Quaternions of a trajectory have the scalar first.
    ScalarFirst {
        /// Whether the names of the columns give it; otherwise it is taken from the numbers.
        named: bool,
    },
    /// Quaternions of a trajectory were normalised.
    Normalised {
        /// How many differ from 1 by more than 0.001.
        count: u64,
    },
    /// Poses of a trajectory far from all others were left out.
    TrajectoryStrays {
        /// How many.
        count: u64,
        /// Line of the first.
        line: u64,
        /// How far away it is from the pose before, m.
        away_m: f64,
    },
}

impl Finding {
    /// Whether it makes results doubtful. Everything else is to be known and can be fine.
    pub fn is_warning(&self) -> bool {
        match self {
            Self::GuessedFan { usual, .. } => !usual,
            Self::StepsBack { count, .. } => *count > 0,
            Self::Bag(finding) => finding.is_warning(),
            Self::BeyondMaximum { count, beams } | Self::LargeDisparities { count, beams, .. } => count * 20 > *beams,
            Self::UnevenFan { .. }
            | Self::Jump { .. }
            | Self::Twist { .. }
            | Self::Strays { .. }
            | Self::OneBeam { .. }
            | Self::Split { .. }
            | Self::InfiniteDisparities { .. }
            | Self::GuessedMount { .. }
            | Self::SonarMaximum { .. }
            | Self::SonarsAlike { .. }
            | Self::WithoutMounts { .. }
            | Self::TrajectoryStrays { .. } => true,
            Self::OdometryPoses { .. }
            | Self::Gaps { .. }
            | Self::SaidAgain { .. }
            | Self::Unplaced { .. }
            | Self::ZeroDisparities { .. }
            | Self::Regrouped { .. }
            | Self::GuessedSonarRange { .. }
            | Self::TrajectoryUnit { .. }
            | Self::TrajectorySorted { .. }
            | Self::TrajectoryDoubled { .. }
            | Self::ScalarFirst { .. }
            | Self::Normalised { .. } => false,
        }
    }
}
