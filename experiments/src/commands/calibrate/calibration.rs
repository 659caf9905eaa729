//! What a calibration is.

use super::search::Fit;
use crate::figures::Drawing;

/// What was fitted to what.
pub(super) struct Calibration {
    /// Which sensor of a log of several; the first, of sonars that are mounted together.
    pub(super) sensor: Option<usize>,
    /// What it was fitted to, in words.
    pub(super) about: String,
    /// What is maximised, in words, with its unit.
    pub(super) measure: &'static str,
    /// Number of readings.
    pub(super) readings: u64,
    pub(super) fit: Fit,
    /// The picture of the fit against the readings, if there is one.
    pub(super) picture: Option<Drawing>,
    /// What is to be known besides.
    pub(super) notes: Vec<String>,
    /// How to use what was found, where something is identified.
    pub(super) advice: Option<Advice>,
}

/// What to paste as it stands.
pub(super) struct Advice {
    /// Where it goes.
    pub(super) to: &'static str,
    pub(super) lines: Vec<String>,
}

/// What a run found: of a log of several sensors, of each.
pub(super) struct Found {
    pub(super) all: Vec<Calibration>,
    /// Sensors that were not fitted, and why: a line each.
    pub(super) left_out: Vec<String>,
    /// How to use all of it at once, beside what is of each.
    pub(super) advice: Option<Advice>,
}

impl Found {
    /// One sensor, which says how to use it.
    pub(super) fn of(calibration: Calibration) -> Self {
        Self { all: vec![calibration], left_out: Vec::new(), advice: None }
    }

    /// Whether sensors are told apart.
    pub(super) fn is_of_several(&self) -> bool {
        self.all.iter().any(|calibration| calibration.sensor.is_some())
    }
}
