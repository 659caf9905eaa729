//! All metrics of a map over a region.

use serde::Serialize;

use crate::Metric;

/// The metrics of one map over one region. The README has the table of definitions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scores {
    /// Mean of `-ln p(truth)`, nats per cell; see [`log_loss`](crate::log_loss).
    pub log_loss: Metric,
    /// Mean squared difference of probability and truth. Brier (1950).
    pub brier: Metric,
    /// Expected calibration error; see [`reliability`](crate::reliability).
    pub ece: Metric,
    /// Probability that a random occupied cell ranks above a random free one, ties one half.
    pub auc: Metric,
    /// Intersection over union of the cells held occupied and those that are. Support: the union.
    pub iou: Metric,
    /// Share of the cells for which the map has decided: p < 0.2 or p > 0.8.
    pub decided: Metric,
    /// Share truly free of the cells with p < 0.2.
    pub free_agreement: Metric,
    /// Share truly occupied of the cells with p > 0.8.
    pub occupied_agreement: Metric,
    /// Area of the truly free cells with p > 0.5, m²: obstacles that are not there.
    pub phantom_area: Metric,
    /// Area of the truly occupied surface cells with p < 0.2, m²: a robot would drive into them.
    pub missed_area: Metric,
    /// Share of the truly free cells with p < 0.2.
    pub free_known: Metric,
    /// Share of the truly free cells with p > 0.5.
    pub free_lost: Metric,
    /// Share of the truly occupied surface cells with p > 0.5: what a planner finds that takes the map at its word.
    pub recall_50: Metric,
    /// Share of the truly occupied surface cells with p > 0.65: what is left of them in a saved ROS map.
    pub recall_65: Metric,
}

impl Scores {
    /// Number of metrics.
    pub const COUNT: usize = 14;

    /// Every metric, in the order of tables.
    pub fn metrics(&self) -> [Metric; Self::COUNT] {
        let s = *self;
        [
            s.log_loss,
            s.brier,
            s.ece,
            s.auc,
            s.iou,
            s.decided,
            s.free_agreement,
            s.occupied_agreement,
            s.phantom_area,
            s.missed_area,
            s.free_known,
            s.free_lost,
            s.recall_50,
            s.recall_65,
        ]
    }
}
