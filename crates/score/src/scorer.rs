//! Comparing a map with the truth.

use grid::Raster;

use crate::calibration::{BINS, calibration_error_sum, equal_count_bins};
use crate::error::same_cells;
use crate::judged::judged;
use crate::ranking::{auc, ranked};
use crate::tally::Tally;
use crate::{Metric, ScoreError, Scores};

/// What maps are judged by: the truth, and which cells could be seen as surfaces.
#[derive(Debug, Clone, Copy)]
pub struct Scorer<'a> {
    pub(crate) truth: &'a Raster<Option<bool>>,
    pub(crate) surface: &'a Raster<bool>,
}

impl<'a> Scorer<'a> {
    /// Judges by `truth` (`Some(true)` occupied, `Some(false)` free, `None` not known and never
    /// scored) and by the `surface` mask, as [`Sightings::surface`](crate::Sightings::surface)
    /// gives it: an obstacle can only be missed where it could be seen.
    ///
    /// # Errors
    /// A surface mask of another geometry.
    pub fn new(truth: &'a Raster<Option<bool>>, surface: &'a Raster<bool>) -> Result<Self, ScoreError> {
        same_cells("surface mask", surface.spec(), truth.spec())?;
        Ok(Self { truth, surface })
    }

    /// Scores a map of occupancy probabilities over the known cells of `mask`.
    ///
    /// # Errors
    /// Rasters of different geometry; a cell, inside the mask or not, that holds no probability.
    pub fn scores(&self, map: &Raster<f64>, mask: &Raster<bool>) -> Result<Scores, ScoreError> {
        let mut tally = Tally::default();
        for j in judged(map, self.truth, mask)? {
            tally.add(j, self.surface[j.cell]);
        }
        let ties = ranked(judged(map, self.truth, mask)?);
        let error_sum = calibration_error_sum(&equal_count_bins(&ties, BINS));
        let cells = tally.cells();
        let ece = Metric::mean("ece", "1", error_sum, cells);
        let auc = Metric { name: "auc", value: auc(&ties), unit: "1", support: cells };
        Ok(tally.scores(self.truth.spec().cell_area_m2(), ece, auc))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::drawn;

    /// Name, value and support of every metric over the whole drawing; every occupied cell a surface.
    fn score(world: &[&str], map: &[f64]) -> Vec<(&'static str, Option<f64>, usize)> {
        let truth = drawn(world);
        let surface = truth.map(|t| *t == Some(true));
        let map = Raster::new(*truth.spec(), map.to_vec());
        let scores = Scorer::new(&truth, &surface).and_then(|s| s.scores(&map, &truth.map(|_| true))).expect("valid");
        scores.metrics().map(|m| (m.name, m.value, m.support)).to_vec()
    }

    fn check(found: &[(&'static str, Option<f64>, usize)], expected: &[(&'static str, Option<f64>, usize)]) {
        assert_eq!(found.len(), expected.len());
        for (f, e) in found.iter().zip(expected) {
            assert_eq!((f.0, f.2), (e.0, e.2), "{f:?} {e:?}");
            let close = match (f.1, e.1) {
                (Some(f), Some(e)) => (f - e).abs() < 1e-12,
                (f, e) => f.is_none() && e.is_none(),
            };
            assert!(close, "{f:?} {e:?}");
        }
    }

    #[test]
    fn by_hand() {
        let ln = f64::ln;
        let log_loss = -(ln(0.9) + ln(0.9) + ln(0.7) + ln(0.4) + ln(0.7) + ln(0.15) + ln(0.5)) / 7.0;
        check(
            &score(&[".#..##.?"], &[0.1, 0.9, 0.3, 0.6, 0.7, 0.15, 0.5, 0.99]),
            &[
                ("log_loss", Some(log_loss), 7),
                ("brier", Some((0.01 + 0.01 + 0.09 + 0.36 + 0.09 + 0.7225 + 0.25) / 7.0), 7),
                ("ece", Some((0.1 + 0.1 + 0.3 + 0.6 + 0.3 + 0.85 + 0.5) / 7.0), 7),
                ("auc", Some(9.0 / 12.0), 7),
                ("iou", Some(2.0 / 4.0), 4),
                ("decided", Some(3.0 / 7.0), 7),
                ("free_agreement", Some(1.0 / 2.0), 2),
                ("occupied_agreement", Some(1.0), 1),
                ("phantom_area", Some(0.01), 4),
                ("missed_area", Some(0.01), 3),
                ("free_known", Some(1.0 / 4.0), 4),
                ("free_lost", Some(1.0 / 4.0), 4),
                ("recall_50", Some(2.0 / 3.0), 3),
                ("recall_65", Some(2.0 / 3.0), 3),
            ],
        );
    }

    const NAMES: [&str; 14] = [
        "log_loss",
        "brier",
        "ece",
        "auc",
        "iou",
        "decided",
        "free_agreement",
        "occupied_agreement",
        "phantom_area",
        "missed_area",
        "free_known",
        "free_lost",
        "recall_50",
        "recall_65",
    ];

    fn named(values: [Option<f64>; 14], support: [usize; 14]) -> Vec<(&'static str, Option<f64>, usize)> {
        NAMES.iter().zip(values).zip(support).map(|((name, value), support)| (*name, value, support)).collect()
    }

    #[test]
    fn a_perfect_and_an_inverted_map() {
        let certain = -(1.0f64 - 1e-4).ln();
        let wrong = -(1e-4f64).ln();
        check(
            &score(&[".#.#."], &[0.0, 1.0, 0.0, 1.0, 0.0]),
            &named(
                [certain, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 1.0, 1.0].map(Some),
                [5, 5, 5, 5, 2, 5, 3, 2, 3, 2, 3, 3, 2, 2],
            ),
        );
        check(
            &score(&[".#.#."], &[1.0, 0.0, 1.0, 0.0, 1.0]),
            &named(
                [wrong, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.03, 0.02, 0.0, 1.0, 0.0, 0.0].map(Some),
                [5, 5, 5, 5, 5, 5, 2, 3, 3, 2, 3, 3, 2, 2],
            ),
        );
    }

    #[test]
    fn the_prior_map() {
        let log_loss = -(3.0 * 0.9f64.ln() + 2.0 * 0.1f64.ln()) / 5.0;
        let mut values =
            [log_loss, (3.0 * 0.01 + 2.0 * 0.81) / 5.0, 0.3, 0.5, 0.0, 1.0, 0.6, 0.0, 0.0, 0.02, 1.0, 0.0, 0.0, 0.0]
                .map(Some);
        values[7] = None; // Nothing is held occupied, so there is nothing to agree with.
        check(&score(&[".#.#."], &[0.1; 5]), &named(values, [5, 5, 5, 5, 2, 5, 5, 0, 3, 2, 3, 3, 2, 2]));
    }

    #[test]
    fn all_free_all_occupied_and_one_cell() {
        let half = 2.0f64.ln();
        let free = [Some(half), Some(0.25), Some(0.5), None, None, Some(0.0), None, None, Some(0.0), None];
        let free: Vec<_> = free.into_iter().chain([Some(0.0), Some(0.0), None, None]).collect();
        let free: [_; 14] = free.try_into().expect("fourteen");
        check(&score(&["..."], &[0.5; 3]), &named(free, [3, 3, 3, 3, 0, 3, 0, 0, 3, 0, 3, 3, 0, 0]));
        check(&score(&["."], &[0.5]), &named(free, [1, 1, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 0]));
        let mut occupied = free;
        (occupied[4], occupied[8], occupied[9], occupied[10], occupied[11]) = (Some(0.0), None, Some(0.0), None, None);
        (occupied[12], occupied[13]) = (Some(0.0), Some(0.0));
        check(&score(&["###"], &[0.5; 3]), &named(occupied, [3, 3, 3, 3, 3, 3, 0, 0, 0, 3, 0, 0, 3, 3]));
        check(&score(&["#"], &[0.5]), &named(occupied, [1, 1, 1, 1, 1, 1, 0, 0, 0, 1, 0, 0, 1, 1]));
    }

    #[test]
    fn an_empty_region_has_no_values() {
        check(&score(&["??"], &[0.3, 0.9]), &named([None; 14], [0; 14]));
        let truth = drawn(&[".#"]);
        let nothing = truth.map(|_| false);
        let scores = Scorer::new(&truth, &nothing).and_then(|s| s.scores(&truth.map(|_| 0.4), &nothing));
        assert!(scores.expect("valid").metrics().iter().all(|m| m.value.is_none() && m.support == 0));
    }

    #[test]
    fn thresholds_are_strict() {
        let at = score(&["..##"], &[0.2, 0.5, 0.5, 0.8]);
        let at_thresholds = [("decided", 0.0, 4), ("iou", 0.5, 2), ("phantom_area", 0.0, 2), ("recall_50", 0.5, 2)];
        for (name, value, support) in at_thresholds {
            assert!(at.contains(&(name, Some(value), support)), "{name}: {at:?}");
        }
    }

    #[test]
    fn only_surface_cells_can_be_missed() {
        let truth = drawn(&[".###."]);
        // The first mark is on a free cell: it must not count.
        let surface = Raster::new(*truth.spec(), vec![true, true, false, false, false]);
        let missed = |p: f64, mask: [bool; 5]| {
            let mask = Raster::new(*truth.spec(), mask.to_vec());
            let scores = Scorer::new(&truth, &surface).and_then(|s| s.scores(&truth.map(|_| p), &mask)).expect("valid");
            (scores.missed_area.value, scores.missed_area.support)
        };
        assert_eq!(missed(0.5, [true; 5]), (Some(0.0), 1));
        assert_eq!(missed(0.1, [true, false, true, true, true]), (None, 0));
        let (area, support) = missed(0.1, [true; 5]);
        assert!((area.expect("defined") - 0.01).abs() < 1e-15 && support == 1);
    }

    #[test]
    fn what_cannot_be_scored_is_refused() {
        let (truth, other) = (drawn(&[".#.", "..."]), drawn(&[".#."]));
        let mask = truth.map(|_| true);
        let surface = Scorer::new(&truth, &other.map(|_| true)).map(|_| ()).expect_err("refused");
        assert!(surface.to_string().starts_with("the surface mask has 3 x 1 cells"), "{surface}");
        let scorer = Scorer::new(&truth, &mask).expect("valid");
        assert!(matches!(scorer.scores(&other.map(|_| 0.5), &mask), Err(ScoreError::Geometry { what: "map", .. })));
        let mut map = truth.map(|_| 0.5);
        map[4] = f64::NAN;
        // Outside the mask too: whether a map is accepted must not depend on the region.
        let refused = scorer.scores(&map, &truth.map(|_| false)).expect_err("refused").to_string();
        assert!(refused.contains("NaN in cell 4 (column 1, row 1)"), "{refused}");
    }
}
