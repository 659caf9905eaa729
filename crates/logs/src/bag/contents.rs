//! What a bag holds.

use bags::Encoding;

/// What a bag holds, and what of it can be used.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contents {
    /// All topics, by their names.
    pub topics: Vec<TopicSummary>,
    /// Topics whose messages are scans that can be read.
    pub scans: Vec<String>,
    /// Sources of poses for them, the topics before the frames.
    pub poses: Vec<PoseCandidate>,
    /// From the first to the last message, s.
    pub long_s: f64,
}

/// A topic of a bag.
#[derive(Debug, Clone, PartialEq)]
pub struct TopicSummary {
    /// Its name.
    pub name: String,
    /// Type of its messages, such as `sensor_msgs/LaserScan`.
    pub kind: String,
    /// How they are written.
    pub encoding: Encoding,
    /// Number of messages.
    pub messages: u64,
    /// When the first and the last were recorded, s since the first message of the bag.
    pub span_s: [f64; 2],
}

/// A source of poses.
#[derive(Debug, Clone, PartialEq)]
pub struct PoseCandidate {
    /// What names it: `odom`, a topic, or `tf:` and a frame.
    pub option: String,
    /// What it is, in a few words.
    pub about: String,
}
