//! How much is said on stderr: of the whole process, set once at its start.

use std::sync::atomic::{AtomicU8, Ordering};

/// How much is said.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Loudness {
    /// Warnings and errors.
    Quiet,
    /// Notes and progress too.
    Usual,
    /// What is read and written too.
    Verbose,
}

static LOUDNESS: AtomicU8 = AtomicU8::new(Loudness::Usual as u8);

/// From now on, so much is said.
pub fn set(loudness: Loudness) {
    LOUDNESS.store(loudness as u8, Ordering::Relaxed);
}

/// Whether what is said from this loudness on is said.
pub fn says(from: Loudness) -> bool {
    LOUDNESS.load(Ordering::Relaxed) >= from as u8
}
