//! The numbers of the mapper with a fixed lag.

use crate::fit::{Setting, numbers};

/// How the last scans are solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FixedLag {
    /// Number of scans that are solved together, at least 1.
    pub scans: usize,
    /// Sweeps over the cells in doubt of all drawn maps after every scan.
    pub sweeps: usize,
    /// Share of the drawn maps in the mean, 0 to 1; the rest is that of the pairs.
    pub share: f64,
    /// A cell's probability is the mean over about so many draws of all maps, at least 1.
    pub draws: f64,
    /// Weight of a reading's log likelihood, above 0, as [`crate::Sampling::weight`].
    pub weight: f64,
    /// Share of rays that pass the first occupied cell, as [`crate::Sampling::leak`].
    pub leak: f64,
    /// Times that the log weights of the prior field count, as [`crate::Sampling::strength`].
    pub strength: f64,
    /// Shift of every cell's log odds, nats, as [`crate::Sampling::shift`].
    pub shift: f64,
    /// What all draws follow from.
    pub seed: u64,
}

impl FixedLag {
    /// Chosen on tuning worlds: `cargo run -p experiments --features fitting --example window_parameters`.
    pub const TUNED: Self = Self {
        scans: 12,
        sweeps: 1,
        share: 0.4,
        draws: 12.0,
        weight: 0.5,
        leak: 0.0,
        strength: 0.5,
        shift: 0.0,
        seed: 1,
    };
}

impl FixedLag {
    /// The numbers by name.
    pub(super) fn named(&self) -> Vec<(&'static str, Setting)> {
        let Self { scans, sweeps, share, draws, weight, leak, strength, shift, .. } = *self;
        let (scans, sweeps) = (scans as f64, sweeps as f64);
        numbers([
            ("scans", scans),
            ("sweeps", sweeps),
            ("share", share),
            ("draws", draws),
            ("weight", weight),
            ("leak", leak),
            ("strength", strength),
            ("shift", shift),
        ])
    }

    /// The same in a few words.
    pub(super) fn words(&self) -> String {
        let Self { scans, sweeps, share, draws, weight, leak, strength, shift, .. } = self;
        format!(
            "{scans} scans, {sweeps} sweeps, share {share}, {draws} draws, weight {weight}, leak {leak}, strength {strength}, shift {shift}"
        )
    }
}
