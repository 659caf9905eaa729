//! What a run has found.

use grid::Frame;
use score::{Alignment, Resampling};

use super::candidate::Scorable;
use super::drives::Drives;
use super::profiles::{self, Profiles};
use super::rows::{Difference, Row};

/// What was found of a map.
pub(super) struct ScoredMap {
    pub(super) name: String,
    pub(super) map: Scorable,
    pub(super) how: Resampling,
    /// Whether it has no place of its own.
    pub(super) assumed: bool,
    pub(super) rows: Vec<Row>,
    /// Where it errs, if scans say from where cells were seen.
    pub(super) profiles: Option<Profiles>,
    /// Where its file says that it lies, and how it was moved.
    pub(super) alignment: Option<(Frame, Alignment)>,
    pub(super) warnings: Vec<String>,
}

/// All that was found.
pub(super) struct Scored {
    pub(super) maps: Vec<ScoredMap>,
    pub(super) differences: Vec<Difference>,
    /// The regions that the terminal shows, the first of them of differences too.
    pub(super) shown: Vec<String>,
    /// The drives that were planned on every map, if any.
    pub(super) drives: Option<Drives>,
}

impl Scored {
    /// The rows of all maps.
    pub(super) fn rows(&self) -> Vec<Row> {
        let of = |map: &ScoredMap| {
            let profiles = map.profiles.iter().flat_map(|found| profiles::rows(&map.name, found));
            map.rows.iter().cloned().chain(profiles).collect::<Vec<_>>()
        };
        self.maps.iter().flat_map(of).collect()
    }
}
