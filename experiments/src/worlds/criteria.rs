//! What is compared, which way is better, and which differences do not matter.

use score::Better::{self, Higher, Lower};
use score::MovingRegion;

use super::drives;

/// A metric as comparisons treat it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Criterion {
    /// Its name in crate `score` and in every file.
    pub metric: &'static str,
    /// What tables for reading call it.
    pub title: &'static str,
    /// Its unit; `1` for a share.
    pub unit: &'static str,
    /// Decimals in tables for reading.
    pub decimals: usize,
    /// Which way is better, and the largest difference that does not matter, in the metric's unit. None of a
    /// metric that describes a map without judging it.
    pub judged: Option<(Better, f64)>,
    /// Name of the one region that it is of; none of a metric of every region.
    pub region: Option<&'static str>,
}

impl Criterion {
    /// Whether maps have this metric in a region of the given name.
    pub fn is_of(&self, region: &str) -> bool {
        self.region.is_none_or(|own| own == region)
    }
}

/// Every metric, in the order of [`score::Scores::metrics`], then retention, then those of drives.
///
/// The margins were set before any comparison was run: half a percent of probability for log loss,
/// half a cell in a hundred for shares, 20 cells of 5 cm for areas, two surface cells in a hundred for recall, two drives in
/// a hundred.
pub const CRITERIA: [Criterion; 21] = [
    judged("log_loss", "log loss", "nats/cell", 3, Lower, 0.005),
    judged("brier", "Brier", "1", 4, Lower, 0.002),
    judged("ece", "ECE", "1", 3, Lower, 0.005),
    judged("auc", "AUC", "1", 3, Higher, 0.005),
    judged("iou", "IoU", "1", 3, Higher, 0.02),
    Criterion { metric: "decided", title: "decided", unit: "1", decimals: 3, judged: None, region: None },
    judged("free_agreement", "free agreement", "1", 3, Higher, 0.005),
    judged("occupied_agreement", "occupied agreement", "1", 3, Higher, 0.02),
    judged("phantom_area", "phantom", "m²", 2, Lower, 0.05),
    judged("missed_area", "missed", "m²", 2, Lower, 0.05),
    judged("free_known", "held free", "1", 3, Higher, 0.005),
    judged("free_lost", "free lost", "1", 3, Lower, 0.005),
    judged("recall_50", "recall > 0.5", "1", 3, Higher, 0.02),
    judged("recall_65", "recall > 0.65", "1", 3, Higher, 0.02),
    judged("retention", "retention", "1", 3, Higher, 0.005),
    of_drives("reached", "reached", Some((Higher, 0.02))),
    of_drives("colliding", "colliding", Some((Lower, 0.02))),
    // Maps reach different pairs: one that reaches the near ones alone has the least.
    of_drives("detour", "detour", None),
    of_drives("footprint_reached", "reached", Some((Higher, 0.02))),
    of_drives("footprint_colliding", "colliding", Some((Lower, 0.02))),
    of_drives("footprint_detour", "detour", None),
];

const fn of_drives(metric: &'static str, title: &'static str, judged: Option<(Better, f64)>) -> Criterion {
    Criterion { metric, title, unit: "1", decimals: 3, judged, region: Some(drives::REGION.name()) }
}

const fn judged(
    metric: &'static str,
    title: &'static str,
    unit: &'static str,
    decimals: usize,
    better: Better,
    margin: f64,
) -> Criterion {
    Criterion { metric, title, unit, decimals, judged: Some((better, margin)), region: None }
}

/// The metrics that only a world that moves has, each of one region, in the order of [`score::MovingScores::by_region`] and then of [`score::Lag::metrics`].
///
/// The margins were set before any comparison was run: half a static cell in a hundred, one swept cell in a hundred, eight cells of 5 cm of trail or ghost,
/// half a look, two changes in a hundred.
pub const MOVING: [Criterion; 9] = [
    of_movement("static_accuracy", "static", "1", 3, Some((Higher, 0.005)), MovingRegion::Static.name()),
    of_movement("dynamic_accuracy", "dynamic", "1", 3, Some((Higher, 0.01)), MovingRegion::Swept.name()),
    of_movement("harmonic_accuracy", "harmonic", "1", 3, Some((Higher, 0.005)), MovingRegion::Swept.name()),
    of_movement("trail_area", "trail", "m²", 2, Some((Lower, 0.02)), MovingRegion::Swept.name()),
    of_movement("ghost_area", "ghost", "m²", 2, Some((Lower, 0.02)), MovingRegion::Changed.name()),
    of_movement("lag_looks", "lag", "looks", 2, Some((Lower, 0.5)), MovingRegion::Changed.name()),
    of_movement("lag_open", "lag open", "1", 3, None, MovingRegion::Changed.name()),
    of_movement("followed_3", "followed", "1", 3, Some((Higher, 0.02)), MovingRegion::Changed.name()),
    of_movement("cleared_3", "cleared", "1", 3, Some((Higher, 0.02)), MovingRegion::Changed.name()),
];

const fn of_movement(
    metric: &'static str,
    title: &'static str,
    unit: &'static str,
    decimals: usize,
    judged: Option<(Better, f64)>,
    region: &'static str,
) -> Criterion {
    Criterion { metric, title, unit, decimals, judged, region: Some(region) }
}

/// Every metric there is: those of any world, and those of worlds that move.
pub fn criteria() -> impl Iterator<Item = &'static Criterion> {
    CRITERIA.iter().chain(&MOVING)
}

/// The criterion of the given metric.
pub fn criterion(metric: &str) -> Option<&'static Criterion> {
    criteria().find(|criterion| criterion.metric == metric)
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::{GridSpec, Raster};
    use score::navigation::{Navigation, Planning};
    use score::{Lag, Margin, Moving, Retention, Scorer};

    #[test]
    fn the_list_is_what_a_map_is_scored_by() {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 2, height: 1 };
        let truth = Raster::new(spec, vec![Some(true), Some(false)]);
        let surface = Raster::filled(spec, true);
        let scores = Scorer::new(&truth, &surface).and_then(|s| s.scores(&Raster::filled(spec, 0.5), &surface));
        let mut scored = scores.expect("valid").metrics().to_vec();
        scored.push(Retention::new(&truth).metric(None).expect("valid"));
        let (map, known) = (Raster::filled(spec, 0.5), Raster::filled(spec, true));
        let navigation = Navigation::new(&truth, Planning::default());
        scored.extend(navigation.metrics(&map, &known, |_| true).expect("valid"));
        scored.extend(navigation.metrics_by_footprint(&map, &known, |_| true).expect("valid"));
        let listed: Vec<_> = CRITERIA.iter().map(|c| (c.metric, c.unit)).collect();
        assert_eq!(listed, scored.iter().map(|m| (m.name, m.unit)).collect::<Vec<_>>());
    }

    #[test]
    fn the_list_of_movement_is_what_a_map_of_a_world_that_moves_is_scored_by() {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 2, height: 1 };
        let truth = Raster::filled(spec, Some(false));
        let mut scored = Moving::new(&truth).scores(&Raster::filled(spec, 0.5)).expect("valid").by_region().to_vec();
        scored.extend(Lag::new(&truth).metrics().map(|metric| (MovingRegion::Changed.name(), metric)));
        let listed: Vec<_> = MOVING.iter().map(|c| (c.region.expect("one region"), c.metric, c.unit)).collect();
        assert_eq!(listed, scored.iter().map(|(region, m)| (*region, m.name, m.unit)).collect::<Vec<_>>());
    }

    #[test]
    fn metrics_of_drives_are_of_the_whole_world() {
        let of = |metric: &str| criterion(metric).expect("listed");
        assert!(of("reached").is_of("all") && !of("reached").is_of("observable"));
        assert!(of("brier").is_of("all") && of("brier").is_of("X"));
    }

    #[test]
    fn every_margin_is_one() {
        assert!(criteria().filter_map(|c| c.judged).all(|(_, margin)| Margin::new(margin).is_ok()));
    }
}
