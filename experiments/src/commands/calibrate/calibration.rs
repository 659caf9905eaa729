//! What a calibration is.

use super::search::Fit;
use crate::figures::Drawing;

/// What was fitted to what.
pub(super) struct Calibration {
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

/// A line to be pasted as it stands.
pub(super) struct Advice {
    /// Where it goes.
    pub(super) to: &'static str,
    pub(super) line: String,
}
