//! Free space that a map once knew and then lost: Figures 13 and 14 of the paper as a number.

use grid::Raster;

use crate::error::{probabilities, same_cells};
use crate::threshold::{HELD_FREE, HELD_OCCUPIED};
use crate::{Metric, ScoreError};

/// How a truly free cell has fared so far.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Free {
    /// Not truly free, or not known: never counted.
    Not,
    /// No ray has crossed it: whatever the map says of it is no knowledge.
    Unseen,
    /// Seen, but not yet held free.
    Seen,
    /// Held free (p < 0.2) after some scan, and never held occupied (p > 0.5) after a later one.
    Held,
    /// Held free once and held occupied later. A cell once lost stays lost.
    Lost,
}

/// Free-space retention: of the truly free cells that were seen and then held free (p < 0.2 after a
/// scan, the one that first saw them or a later one), the share never held occupied (p > 0.5) after
/// a later scan.
///
/// That a cell was seen matters: a prior of 0.1 is below 0.2 too, and is not knowledge.
#[derive(Debug, Clone)]
pub struct Retention {
    cells: Raster<Free>,
}

impl Retention {
    /// Before the first scan of a world: `Some(true)` occupied, `Some(false)` free, `None` not known.
    pub fn new(truth: &Raster<Option<bool>>) -> Self {
        Self { cells: truth.map(|t| if *t == Some(false) { Free::Unseen } else { Free::Not }) }
    }

    /// Takes note of the map at the end of a scan; call it once per scan, in order. `seen` holds the
    /// cells visible to this scan or to any scan so far, as [`Sightings::visible`] gives them.
    /// Allocates nothing.
    ///
    /// [`Sightings::visible`]: crate::Sightings::visible
    ///
    /// # Errors
    /// Rasters of different geometry; a cell that holds no probability. The scan then leaves no
    /// trace.
    pub fn observe(&mut self, seen: &Raster<bool>, map: &Raster<f64>) -> Result<(), ScoreError> {
        same_cells("mask of seen cells", seen.spec(), self.cells.spec())?;
        same_cells("map", map.spec(), self.cells.spec())?;
        probabilities(map)?;
        for ((cell, &seen), &p) in self.cells.values_mut().iter_mut().zip(seen.values()).zip(map.values()) {
            *cell = match *cell {
                Free::Unseen if seen && p < HELD_FREE => Free::Held,
                Free::Unseen if seen => Free::Seen,
                Free::Seen if p < HELD_FREE => Free::Held,
                Free::Held if p > HELD_OCCUPIED => Free::Lost,
                same => same,
            };
        }
        Ok(())
    }

    /// Things that move cover these cells: from now on they do not count, whether something stands there or not, since a map does well to hold them
    /// occupied for a while. What becomes of them is for [`MovingScores`](crate::MovingScores) to say.
    ///
    /// # Errors
    /// A mask of another geometry.
    pub fn leave_out(&mut self, covered: &Raster<bool>) -> Result<(), ScoreError> {
        same_cells("mask of covered cells", covered.spec(), self.cells.spec())?;
        for (cell, _) in self.cells.values_mut().iter_mut().zip(covered.values()).filter(|(_, covered)| **covered) {
            *cell = Free::Not;
        }
        Ok(())
    }

    /// How a cell that was once held free has fared: true where it was never held occupied since, false where it is
    /// lost; none of a cell that does not count.
    pub fn kept(&self, cell: usize) -> Option<bool> {
        match self.cells[cell] {
            Free::Held => Some(true),
            Free::Lost => Some(false),
            Free::Not | Free::Unseen | Free::Seen => None,
        }
    }

    /// Retention over the whole map, or over a mask of it. Support: the cells once held free.
    ///
    /// # Errors
    /// A mask of another geometry.
    pub fn metric(&self, mask: Option<&Raster<bool>>) -> Result<Metric, ScoreError> {
        if let Some(mask) = mask {
            same_cells("mask", mask.spec(), self.cells.spec())?;
        }
        let (mut kept, mut lost) = (0, 0);
        for (index, cell) in self.cells.values().iter().enumerate() {
            let inside = mask.is_none_or(|mask| mask[index]);
            kept += usize::from(inside && *cell == Free::Held);
            lost += usize::from(inside && *cell == Free::Lost);
        }
        Ok(Metric::share("retention", kept, kept + lost))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::drawn;
    use proptest::prelude::*;

    /// One cell per history: whether it was seen and its probability, scan by scan.
    fn after(world: &str, histories: &[&[(bool, f64)]]) -> (Option<f64>, usize) {
        let truth = drawn(&[world]);
        let mut retention = Retention::new(&truth);
        for scan in 0..histories[0].len() {
            let seen = Raster::new(*truth.spec(), histories.iter().map(|h| h[scan].0).collect());
            let map = Raster::new(*truth.spec(), histories.iter().map(|h| h[scan].1).collect());
            retention.observe(&seen, &map).expect("valid");
        }
        let metric = retention.metric(None).expect("valid");
        assert_eq!((metric.name, metric.unit), ("retention", "1"));
        (metric.value, metric.support)
    }

    #[test]
    fn histories_of_one_cell() {
        let (kept, lost, never) = ((Some(1.0), 1), (Some(0.0), 1), (None, 0));
        let (no, yes) = (false, true);
        for (history, expected, why) in [
            (&[(yes, 0.1)][..], kept, "free at the end of the scan that first saw it"),
            (&[(no, 0.1)], never, "the prior is not knowledge"),
            (&[(no, 0.1), (no, 0.9)], never, "nor can it be lost"),
            (&[(no, 0.1), (yes, 0.9)], never, "seen only when it was held occupied"),
            (&[(yes, 0.9), (yes, 0.3)], never, "seen, but never held free"),
            (&[(yes, 0.9), (yes, 0.1)], kept, "held occupied before, not later"),
            (&[(yes, 0.4), (no, 0.1)], kept, "seen once is seen, although the mask is of one scan only"),
            (&[(yes, 0.1), (yes, 0.6)], lost, "lost"),
            (&[(yes, 0.1), (no, 0.6)], lost, "lost while no ray crossed it"),
            (&[(yes, 0.1), (yes, 0.6), (yes, 0.1)], lost, "a cell once lost stays lost"),
            (&[(yes, 0.1), (yes, 0.3), (yes, 0.6)], lost, "doubt on the way does not matter"),
            (&[(yes, 0.1), (yes, 0.5)], kept, "0.5 is not occupied"),
            (&[(yes, 0.2), (yes, 0.9)], never, "0.2 is not free"),
        ] {
            assert_eq!(after(".", &[history]), expected, "{why}");
        }
    }

    #[test]
    fn only_truly_free_known_cells_count() {
        let lost: &[_] = &[(true, 0.1), (true, 0.9)];
        let kept: &[_] = &[(true, 0.1), (true, 0.1)];
        assert_eq!(after("..#?.", &[lost, kept, lost, lost, kept]), (Some(2.0 / 3.0), 3));
        assert_eq!(after("#?", &[lost, kept]), (None, 0));
    }

    /// A map that is right, says nothing, or says the opposite, scan after scan; and an all-free world.
    #[test]
    fn perfect_prior_and_inverted_maps() {
        let map = |free: f64, occupied: f64| {
            let (free, occupied): ([_; 2], [_; 2]) = ([(true, free); 2], [(true, occupied); 2]);
            after("..#.", &[&free, &free, &occupied, &free])
        };
        assert_eq!(map(0.0, 1.0), (Some(1.0), 3), "perfect");
        assert_eq!(map(1.0, 0.0), (None, 0), "inverted: nothing is ever held free");
        assert_eq!(map(0.5, 0.5), (None, 0), "says nothing");
        assert_eq!(map(0.1, 0.1), (Some(1.0), 3), "a prior of 0.1 holds free whatever is seen, and loses nothing");
        let turned: &[_] = &[(true, 0.0), (true, 1.0)];
        assert_eq!(after("...", &[turned, turned, turned]), (Some(0.0), 3), "all free, from right to wrong");
    }

    #[test]
    fn a_mask_narrows_the_support() {
        let truth = drawn(&["...."]);
        let mut retention = Retention::new(&truth);
        let seen = truth.map(|_| true);
        for map in [[0.1, 0.1, 0.1, 0.3], [0.9, 0.1, 0.1, 0.9]] {
            retention.observe(&seen, &Raster::new(*truth.spec(), map.to_vec())).expect("valid");
        }
        let within = |mask: [bool; 4]| {
            let metric = retention.metric(Some(&Raster::new(*truth.spec(), mask.to_vec()))).expect("valid");
            (metric.value, metric.support)
        };
        assert_eq!(within([true, true, false, true]), (Some(0.5), 2));
        assert_eq!(within([false, true, true, true]), (Some(1.0), 2));
        assert_eq!(within([false, false, false, true]), (None, 0));
        assert!(retention.metric(Some(&drawn(&["..."]).map(|_| true))).is_err());
    }

    #[test]
    fn what_a_thing_has_covered_counts_no_more() {
        let truth = drawn(&["..."]);
        let mut retention = Retention::new(&truth);
        let seen = truth.map(|_| true);
        retention.observe(&seen, &truth.map(|_| 0.1)).expect("valid");
        retention.leave_out(&Raster::new(*truth.spec(), vec![true, false, false])).expect("valid");
        for map in [[0.9, 0.1, 0.9], [0.1, 0.1, 0.1]] {
            retention.observe(&seen, &Raster::new(*truth.spec(), map.to_vec())).expect("valid");
        }
        assert_eq!(retention.metric(None).map(|metric| (metric.value, metric.support)), Ok((Some(0.5), 2)));
        assert_eq!(retention.kept(0), None);
        assert!(retention.leave_out(&drawn(&["."]).map(|_| true)).is_err());
    }

    #[test]
    fn the_fate_of_every_cell_adds_up_to_the_metric() {
        let truth = drawn(&["....#?"]);
        let mut retention = Retention::new(&truth);
        let seen = Raster::new(*truth.spec(), vec![true, true, true, false, true, true]);
        for map in [[0.1, 0.1, 0.4, 0.1, 0.1, 0.1], [0.9, 0.1, 0.4, 0.9, 0.9, 0.9]] {
            retention.observe(&seen, &Raster::new(*truth.spec(), map.to_vec())).expect("valid");
        }
        let fates: Vec<_> = (0..6).map(|cell| retention.kept(cell)).collect();
        assert_eq!(fates, [Some(false), Some(true), None, None, None, None]);
        assert_eq!(retention.metric(None).map(|metric| metric.value), Ok(Some(0.5)));
    }

    #[test]
    fn a_refused_scan_leaves_no_trace() {
        let truth = drawn(&[".."]);
        let mut retention = Retention::new(&truth);
        let seen = truth.map(|_| true);
        let broken = Raster::new(*truth.spec(), vec![0.1, f64::NAN]);
        assert!(matches!(retention.observe(&seen, &broken), Err(ScoreError::Probability { cell: 1, .. })));
        assert!(retention.observe(&drawn(&["."]).map(|_| true), &truth.map(|_| 0.1)).is_err());
        assert!(retention.observe(&seen, &drawn(&["."]).map(|_| 0.1)).is_err());
        assert_eq!(retention.metric(None).expect("valid").support, 0);
    }

    proptest! {
        #[test]
        fn equals_the_definition_read_from_whole_histories(
            histories in (1usize..8).prop_flat_map(|scans| {
                prop::collection::vec(prop::collection::vec((prop::bool::weighted(0.3), 0.0f64..=1.0), scans), 1..12)
            }),
        ) {
            let fate = |h: &Vec<(bool, f64)>| {
                let first_seen = h.iter().position(|scan| scan.0)?;
                let held = (first_seen..h.len()).find(|&scan| h[scan].1 < 0.2)?;
                Some(h[held + 1..].iter().all(|scan| scan.1 <= 0.5))
            };
            let fates: Vec<bool> = histories.iter().filter_map(fate).collect();
            let kept = fates.iter().filter(|kept| **kept).count();
            let expected = (!fates.is_empty()).then(|| kept as f64 / fates.len() as f64);
            let histories: Vec<&[_]> = histories.iter().map(Vec::as_slice).collect();
            prop_assert_eq!(after(&".".repeat(histories.len()), &histories), (expected, fates.len()));
        }
    }
}
