//! What metrics are made of: counts and sums that add up over cells.

use crate::judged::Judged;
use crate::log_loss::LogLoss;
use crate::threshold::{DECIDED_OCCUPIED, HELD_FREE, HELD_OCCUPIED, SAVED_OCCUPIED};
use crate::{Metric, Scores};

/// Counts and sums over the judged cells, in index order.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tally {
    log_loss: LogLoss,
    squared_error: f64,
    /// Truly free; truly occupied; of these, surface.
    free: usize,
    occupied: usize,
    surface: usize,
    /// What the map says: p < 0.2; p > 0.5; p > 0.8.
    held_free: usize,
    held_occupied: usize,
    decided_occupied: usize,
    /// Truly free with p < 0.2; truly free with p > 0.5; truly occupied with p > 0.8; surface with p < 0.2,
    /// with p > 0.5 and with p > 0.65.
    free_known: usize,
    free_lost: usize,
    occupied_known: usize,
    missed: usize,
    found: usize,
    saved: usize,
}

impl Tally {
    pub(crate) fn add(&mut self, Judged { p, occupied, .. }: Judged, surface: bool) {
        let held_free = p < HELD_FREE;
        let held_occupied = p > HELD_OCCUPIED;
        let decided_occupied = p > DECIDED_OCCUPIED;
        let error = p - f64::from(u8::from(occupied));
        self.log_loss.add(p, occupied);
        self.squared_error += error * error;
        self.free += usize::from(!occupied);
        self.occupied += usize::from(occupied);
        self.surface += usize::from(occupied && surface);
        self.held_free += usize::from(held_free);
        self.held_occupied += usize::from(held_occupied);
        self.decided_occupied += usize::from(decided_occupied);
        self.free_known += usize::from(!occupied && held_free);
        self.free_lost += usize::from(!occupied && held_occupied);
        self.occupied_known += usize::from(occupied && decided_occupied);
        self.missed += usize::from(occupied && surface && held_free);
        self.found += usize::from(occupied && surface && held_occupied);
        self.saved += usize::from(occupied && surface && p > SAVED_OCCUPIED);
    }

    /// Number of cells.
    pub(crate) fn cells(&self) -> usize {
        self.free + self.occupied
    }

    /// The same, quicker to merge.
    pub(crate) fn settled(&self) -> Self {
        Self { log_loss: self.log_loss.settled(), ..self.clone() }
    }

    /// Takes in other cells.
    pub(crate) fn merge(&mut self, other: &Self) {
        self.log_loss.merge(&other.log_loss);
        self.squared_error += other.squared_error;
        for (own, more) in [
            (&mut self.free, other.free),
            (&mut self.occupied, other.occupied),
            (&mut self.surface, other.surface),
            (&mut self.held_free, other.held_free),
            (&mut self.held_occupied, other.held_occupied),
            (&mut self.decided_occupied, other.decided_occupied),
            (&mut self.free_known, other.free_known),
            (&mut self.free_lost, other.free_lost),
            (&mut self.occupied_known, other.occupied_known),
            (&mut self.missed, other.missed),
            (&mut self.found, other.found),
            (&mut self.saved, other.saved),
        ] {
            *own += more;
        }
    }

    /// The metrics of these cells, each of `cell_area_m2`; what needs them in order is given.
    pub(crate) fn scores(&self, cell_area_m2: f64, ece: Metric, auc: Metric) -> Scores {
        let (t, cells) = (self, self.cells());
        Scores {
            log_loss: t.log_loss.metric(),
            brier: Metric::mean("brier", "1", t.squared_error, cells),
            ece,
            auc,
            iou: Metric::share("iou", t.held_occupied - t.free_lost, t.occupied + t.free_lost),
            decided: Metric::share("decided", t.held_free + t.decided_occupied, cells),
            free_agreement: Metric::share("free_agreement", t.free_known, t.held_free),
            occupied_agreement: Metric::share("occupied_agreement", t.occupied_known, t.decided_occupied),
            phantom_area: Metric::area("phantom_area", t.free_lost, t.free, cell_area_m2),
            missed_area: Metric::area("missed_area", t.missed, t.surface, cell_area_m2),
            free_known: Metric::share("free_known", t.free_known, t.free),
            free_lost: Metric::share("free_lost", t.free_lost, t.free),
            recall_50: Metric::share("recall_50", t.found, t.surface),
            recall_65: Metric::share("recall_65", t.saved, t.surface),
        }
    }
}
