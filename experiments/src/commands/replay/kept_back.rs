//! The scans of a log that the maps have not seen.

use rayon::prelude::*;
use sensor::Scan;

use super::recording::{self, Recording};
use crate::failure::Failure;

/// Scans that are read before they are worked on, each on a thread.
pub(super) const BATCH: usize = 64;

/// Whether a scan is kept back: the last of every so many.
pub(super) fn is_one(number: u64, hold_out: u64) -> bool {
    (number + 1).is_multiple_of(hold_out)
}

/// What becomes of every scan that is kept back, in their order. `of` is given the number of the scan among those kept back.
///
/// # Errors
/// A log that is refused.
pub(super) fn each<T: Send>(
    recording: &Recording,
    hold_out: u64,
    of: &(impl Fn(usize, &Scan) -> T + Sync),
) -> Result<Vec<T>, Failure> {
    let mut all: Vec<T> = Vec::new();
    let mut batch = Vec::with_capacity(BATCH);
    let mut work = |batch: &mut Vec<Scan>| {
        let first = all.len();
        all.par_extend(batch.par_drain(..).enumerate().map(|(k, scan)| of(first + k, &scan)));
    };
    for (number, scan) in (0..).zip(recording.scans()?) {
        let scan = scan.map_err(recording::refused)?;
        if is_one(number, hold_out) {
            batch.push(scan);
            if batch.len() == BATCH {
                work(&mut batch);
            }
        }
    }
    work(&mut batch);
    Ok(all)
}
