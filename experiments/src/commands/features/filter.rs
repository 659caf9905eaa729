//! What finds the landmarks.

use clap::ValueEnum;

/// What finds the landmarks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Filter {
    /// poses are taken for true
    KnownPoses,
    /// FastSLAM 1.0: poses are drawn from the odometry
    #[value(name = "fastslam1")]
    Fastslam1,
    /// FastSLAM 2.0: poses are drawn from the odometry and the latest readings
    #[value(name = "fastslam2")]
    Fastslam2,
}

impl Filter {
    /// Its name as it is typed.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::KnownPoses => "known-poses",
            Self::Fastslam1 => "fastslam1",
            Self::Fastslam2 => "fastslam2",
        }
    }
}
