//! The scans of a log that the maps have not seen.

use rayon::prelude::*;
use sensor::Scan;

use super::recording::{self, Recording};
use crate::failure::Failure;

/// Scans that are read before they are worked on, each on a thread.
pub(super) const BATCH: usize = 64;

/// Which scans are kept back: of every sensor, the last of so many of its scans, so that no sensor is judged by itself alone.
#[derive(Debug)]
pub(super) struct KeptBack {
    hold_out: u64,
    /// Scans of each sensor so far.
    scans: Vec<u64>,
}

impl KeptBack {
    /// The last of every `hold_out` scans.
    pub(super) fn new(hold_out: u64) -> Self {
        Self { hold_out, scans: Vec::new() }
    }

    /// Whether the next scan of the log is kept back.
    pub(super) fn has(&mut self, scan: &Scan) -> bool {
        if self.scans.len() <= scan.sensor {
            self.scans.resize(scan.sensor + 1, 0);
        }
        let scans = &mut self.scans[scan.sensor];
        *scans += 1;
        scans.is_multiple_of(self.hold_out)
    }
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
    let mut kept_back = KeptBack::new(hold_out);
    for scan in recording.scans()? {
        let scan = scan.map_err(recording::refused)?;
        if kept_back.has(&scan) {
            batch.push(scan);
            if batch.len() == BATCH {
                work(&mut batch);
            }
        }
    }
    work(&mut batch);
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sensor_keeps_back_its_own() {
        let of = |sensors: &[usize]| {
            let mut kept_back = KeptBack::new(2);
            let has = |sensor: &usize| kept_back.has(&Scan { sensor: *sensor, ..Scan::default() });
            sensors.iter().map(has).collect::<Vec<_>>()
        };
        assert_eq!(of(&[0, 0, 0, 0]), [false, true, false, true]);
        assert_eq!(of(&[0, 1, 0, 1]), [false, false, true, true], "in turns");
        assert_eq!(of(&[1, 1, 0, 0]), [false, true, false, true], "one after the other");
    }
}
