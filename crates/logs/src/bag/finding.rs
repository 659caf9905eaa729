//! What is to be known of a bag that was read.

use std::fmt;

/// Something to know of a bag.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum BagFinding {
    /// What was taken, where options left it open.
    Taken {
        /// Topics of scans.
        scans: Vec<String>,
        /// The source of poses.
        poses: String,
    },
    /// Chunks, pages or the rest of a file that cannot be read.
    Damaged {
        /// How many.
        count: u64,
        /// The first, in words: file, offset, reason.
        first: String,
    },
    /// A bag without its index or end mark, which was read all the same.
    Unfinished {
        /// What is missing, in words: file, offset, reason.
        what: String,
    },
    /// Messages of poses, transforms or cameras that cannot be read.
    Undecodable {
        /// Their topic.
        topic: String,
        /// How many.
        count: u64,
        /// What is wrong with the first.
        first: String,
    },
    /// Stamps that cannot be: the time of recording was taken.
    Stamps {
        /// Topic of the messages.
        topic: String,
        /// Number of its messages.
        messages: u64,
        /// Stamps of 0.
        zero: u64,
        /// Stamps far from when the message was recorded.
        off: u64,
    },
    /// A sensor of which no transform says where it stands on the robot.
    Unmounted {
        /// Its topic.
        topic: String,
        /// Its frame.
        frame: String,
    },
    /// A sensor whose plane is not level.
    Tilted {
        /// Its topic.
        topic: String,
        /// By how much, rad.
        by_rad: f64,
    },
    /// A camera whose frame is not that of a camera.
    BodyAxes {
        /// Its topic.
        topic: String,
        /// Its frame.
        frame: String,
    },
    /// Beams whose first, last, step and number do not fit each other.
    Angles {
        /// Topic of the scan.
        topic: String,
        /// Number of beams.
        beams: usize,
        /// Bearing of the last beam, by first and step, rad.
        last_rad: f64,
        /// Bearing of the last beam as the message claims, rad.
        claimed_rad: f64,
    },
    /// A camera of which no message says where its axis is.
    NoCentre {
        /// Its topic.
        topic: String,
    },
}

impl BagFinding {
    /// Whether it makes results doubtful.
    pub fn is_warning(&self) -> bool {
        !matches!(self, Self::Taken { .. })
    }
}

impl fmt::Display for BagFinding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Taken { scans, poses } => {
                write!(
                    f,
                    "scans are those of {}, poses come from {poses}: there is no other source of them",
                    scans.join(", ")
                )
            }
            Self::Damaged { count, first } => {
                let more = if *count > 1 { format!(" ({count} such places)") } else { String::new() };
                write!(f, "{first}{more}: get a whole copy of the bag if there is one")
            }
            Self::Unfinished { what } => write!(f, "{what}"),
            Self::Undecodable { topic, count, first } => {
                write!(f, "{count} messages of {topic} cannot be read and are left out; the first: {first}")
            }
            Self::Stamps { topic, messages, zero, off } => {
                let zero = (*zero > 0).then(|| format!("{zero} have no stamp"));
                let off = (*off > 0).then(|| format!("{off} have a stamp that is far from when they were recorded"));
                let what: Vec<String> = zero.into_iter().chain(off).collect();
                write!(
                    f,
                    "of {messages} messages of {topic}, {}: the time of recording is taken for theirs",
                    what.join(", and ")
                )
            }
            Self::Unmounted { topic, frame } => write!(
                f,
                "no transform says where the frame {frame:?} of {topic} stands on the robot; it is taken to be the robot's own: record \
                 /tf_static, or give --mount X,Y,DEGREES"
            ),
            Self::Tilted { topic, by_rad } => write!(
                f,
                "the plane of {topic} is tilted by {:.0} degrees against the robot's, and is taken for level: far readings lie above or \
                 below the map",
                by_rad.to_degrees()
            ),
            Self::BodyAxes { topic, frame } => write!(
                f,
                "the frame {frame:?} of {topic} is none of a camera (z forward, x to the right, REP 103), which would look up or down; it is \
                 taken to look along x"
            ),
            Self::Angles { topic, beams, last_rad, claimed_rad } => write!(
                f,
                "by angle_min and angle_increment, the last of {beams} beams of {topic} goes to {:.2} degrees, and angle_max is {:.2}: the \
                 former is taken; is the driver set up for another resolution?",
                last_rad.to_degrees(),
                claimed_rad.to_degrees()
            ),
            Self::NoCentre { topic } => write!(
                f,
                "no CameraInfo belongs to {topic}; its axis is taken to be in the middle of the image: record the camera_info beside it"
            ),
        }
    }
}
