//! Hit counting: of the rays that reached a cell, how many ended in it?
//!
//! The reflection map of Hähnel, Burgard, Wegbreit and Thrun ("Towards lazy data association in SLAM", ISRR 2003), which two
//! programs that many robots run share. What they publish has three values: occupied, free, unknown.
//!
//! - GMapping (Grisetti, Stachniss and Burgard, "Improved techniques for grid mapping with Rao-Blackwellized particle filters",
//!   IEEE Transactions on Robotics 23, 2007): `scanmatcher/smmap.h` and `scanmatcher.cpp` of openslam_gmapping 0.2.1,
//!   thresholds of `slam_gmapping` 1.4.2 (`occ_thresh` 0.25).
//! - Karto (Konolige et al., "Efficient sparse pose adjustment for 2D mapping", IROS 2010), as in slam_toolbox 2.8: `karto::OccupancyGrid`
//!   in `karto_sdk/Karto.h` (`MinPassThrough` 2, `OccupancyThreshold` 0.1).

use std::cell::OnceCell;

use grid::{DigitalLine, GridSpec, Raster};
use sensor::Scan;

use crate::belief::probability::bounded;
use crate::fit::{Candidate, Fit, Fitted, Setting, numbers};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::{Model, Sensors};
use crate::ray::predictive::evidence_of_cells;
use crate::tuning::Tuning;

/// What hits and visits say of a cell.
///
/// A cell before the end of a ray is visited once, that of its end hit once and visited [`visits_of_a_hit`](Self::visits_of_a_hit)
/// times. Of its visits, hits are a share; above [`threshold`](Self::threshold) the cell is called occupied, otherwise free; and unknown
/// with at most [`too_few`](Self::too_few) visits, where it reports the prior.
///
/// Three values are no probabilities. They are read as fairly as can be: occupied and free stand for how often a cell that is called so is
/// occupied on the tuning scenes ([`shares`](Self::shares)), by which each program has the least log loss that it can have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HitCount {
    /// 1, or 2 where a program counts the cell of the end as passed and as hit.
    pub visits_of_a_hit: u32,
    /// So many visits say nothing yet.
    pub too_few: u32,
    /// Share of hits above which a cell is occupied, 0 to 1.
    pub threshold: f64,
    /// Probability of a cell that is called free, and of one that is called occupied.
    pub shares: [f64; 2],
}

impl HitCount {
    /// GMapping: a hit is one visit, one visit suffices, a quarter of hits is occupied.
    pub const GMAPPING: Self = Self { visits_of_a_hit: 1, too_few: 0, threshold: 0.25, shares: [0.03, 0.6] };

    /// Karto and slam_toolbox: the cell of the end is on the line that passes and is then passed and hit once more.
    pub const KARTO: Self = Self { visits_of_a_hit: 2, too_few: 2, threshold: 0.1, shares: [0.02, 0.4] };

    /// What the `tune` command finds best on the tuning scenes, which are not the scenes that results are reported on.
    pub const TUNED: Self = Self { visits_of_a_hit: 1, too_few: 10, threshold: 0.1, shares: [0.005, 0.5] };

    /// The rule with the values given: the clamps are the two probabilities.
    pub fn tuned(self, tuning: &Tuning) -> Self {
        Self { shares: tuning.clamp(self.shares), ..self }
    }

    /// What is made of counts; none where they are too few.
    pub fn occupancy(&self, hits: u32, misses: u32) -> Option<f64> {
        let visits = u64::from(misses) + u64::from(self.visits_of_a_hit) * u64::from(hits);
        let share = || f64::from(hits) / visits as f64;
        (visits > u64::from(self.too_few)).then(|| self.shares[usize::from(share() > self.threshold)])
    }

    /// Rules to choose from: what the words of each of some rules stand for.
    fn tried(rules: &[Self], free: &[f64], occupied: &[f64]) -> Vec<Candidate> {
        let shares = || free.iter().flat_map(|free| occupied.iter().map(move |occupied| [*free, *occupied]));
        Candidate::all(rules.iter().flat_map(|rule| shares().map(move |shares| Self { shares, ..*rule })))
    }

    /// What GMapping's words stand for.
    pub(crate) const GMAPPING_FIT: Fit = Fit {
        mapper: "hit-count-gmapping",
        built_in: || Candidate::of(Self::GMAPPING),
        tried: || Self::tried(&[Self::GMAPPING], &FREE, &OCCUPIED),
    };

    /// What Karto's words stand for.
    pub(crate) const KARTO_FIT: Fit = Fit {
        mapper: "hit-count-karto",
        built_in: || Candidate::of(Self::KARTO),
        tried: || Self::tried(&[Self::KARTO], &FREE, &OCCUPIED),
    };

    /// Thresholds too.
    pub(crate) const FIT: Fit = Fit {
        mapper: "hit-count-tuned",
        built_in: || Candidate::of(Self::TUNED),
        tried: || {
            let thresholds = |too_few| [0.05, 0.1, 0.15].map(|threshold| Self { too_few, threshold, ..Self::GMAPPING });
            let rules: Vec<Self> = [2, 5, 10, 20].into_iter().flat_map(thresholds).collect();
            Self::tried(&rules, &[0.005, 0.01, 0.02], &[0.3, 0.4, 0.5])
        },
    };
}

const FREE: [f64; 4] = [0.01, 0.02, 0.03, 0.05];
const OCCUPIED: [f64; 5] = [0.3, 0.4, 0.5, 0.6, 0.7];

impl Fitted for HitCount {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        let Self { too_few, threshold, shares: [free, occupied], .. } = *self;
        let counts = [("too_few_visits", f64::from(too_few)), ("hit_share", threshold)];
        numbers([counts[0], counts[1], ("clamp_low", free), ("clamp_high", occupied)])
    }

    fn label(&self) -> String {
        let Self { too_few, threshold, shares: [free, occupied], .. } = self;
        format!("{too_few} visits, {threshold}: {free}/{occupied}")
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(HitCounter::new(model, *self))
    }
}

/// The mapper with this rule. O(cells up to the reading) per ray, two counts to each.
///
/// A reading is a point ([`sensor::InverseModel::range_of`]); one outside the map visits the cells up to the border. A reading
/// without a range, and a beam without echo, which both programs leave out, count for nothing. Lines are 4-connected as those of every
/// mapper here; those of the programs are 8-connected, and visit three cells where ours visits four.
#[derive(Clone)]
pub struct HitCounter {
    rule: HitCount,
    prior: f64,
    onset: f64,
    spec: GridSpec,
    /// Hits and misses of every cell.
    counts: Vec<[u32; 2]>,
    sensors: Sensors,
    line: DigitalLine,
    cells: u64,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
}

impl HitCounter {
    /// The unseen map.
    pub fn new(model: &Model, rule: HitCount) -> Self {
        Self {
            rule,
            prior: model.prior.marginal(),
            onset: model.prior.onset(model.grid.cell_m),
            spec: model.grid,
            counts: vec![[0; 2]; model.grid.cells()],
            sensors: model.sensors.clone(),
            line: DigitalLine::default(),
            cells: 0,
            occupancy: OnceCell::new(),
        }
    }
}

impl Mapper for HitCounter {
    fn integrate(&mut self, scan: &Scan) {
        let sensor = &**self.sensors.of(scan);
        for ray in scan.rays() {
            let point = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad));
            let Some(point_m) = point else { continue };
            self.line.trace(&self.spec, ray.origin_m, ray.direction, point_m);
            for (&cell, &exit) in self.line.cells().iter().zip(&self.line.ranges()[1..]) {
                let count = &mut self.counts[cell][usize::from(exit < point_m)];
                *count = count.saturating_add(1);
            }
            self.cells += self.line.len() as u64;
        }
        self.occupancy.take();
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.occupancy
            .get_or_init(|| Raster::new(self.spec, (0..self.counts.len()).map(|cell| self.occupied(cell)).collect()))
    }

    fn occupied(&self, cell: usize) -> f64 {
        let [hits, misses] = self.counts[cell];
        self.rule.occupancy(hits, misses).map_or(self.prior, bounded)
    }

    fn evidence(&self, scan: &Scan) -> Option<f64> {
        let known = (&**self.sensors.of(scan), self.onset);
        evidence_of_cells(scan, self.spec, known, |cell| self.occupied(cell))
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.counts.held() + self.line.held() + self.occupancy.held() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sensor::{Laser, Pose};
    use std::sync::Arc;

    fn near(a: Option<f64>, b: Option<f64>) {
        assert!(a.zip(b).map_or(a == b, |(a, b)| (a - b).abs() < 1e-15), "{a:?} {b:?}");
    }

    /// `PointAccumulator` (n / visits, -1 unseen) against `occ_thresh`.
    #[test]
    fn gmapping_by_hand() {
        let rule = HitCount { shares: [0.1, 0.9], ..HitCount::GMAPPING };
        near(rule.occupancy(0, 0), None);
        near(rule.occupancy(1, 0), Some(0.9));
        near(rule.occupancy(0, 1), Some(0.1));
        near(rule.occupancy(1, 3), Some(0.1)); // 1 of 4 is not more than a quarter
        near(rule.occupancy(2, 5), Some(0.9)); // 2 of 7
    }

    /// `UpdateCell`: passes above 2, then hits over passes above 0.1; a hit is two passes.
    #[test]
    fn karto_by_hand() {
        let rule = HitCount { shares: [0.1, 0.9], ..HitCount::KARTO };
        near(rule.occupancy(0, 2), None);
        near(rule.occupancy(1, 0), None); // 2 passes
        near(rule.occupancy(1, 1), Some(0.9)); // 1 of 3
        near(rule.occupancy(0, 3), Some(0.1));
        near(rule.occupancy(1, 8), Some(0.1)); // 1 of 10 is not more
        near(rule.occupancy(1, 7), Some(0.9)); // 1 of 9
        near(rule.occupancy(u32::MAX, u32::MAX), Some(0.9));
    }

    proptest! {
        /// Every ray cell by cell in small steps, counted anew for every cell of the map.
        #[test]
        fn counts_are_those_of_small_steps(
            at in prop::array::uniform2(0.06f64..1.94), theta_rad in -4.0f64..4.0,
            rays in prop::collection::vec((-1.0f64..1.0, prop::option::of(0.1f64..3.0)), 1..8),
        ) {
            let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 20, height: 20 };
            let model = Model::new(spec, Arc::new(Laser::default()));
            let pose = Pose { x_m: at[0], y_m: at[1], theta_rad };
            let (bearings_rad, readings): (Vec<f64>, Vec<Option<f64>>) = rays.into_iter().unzip();
            let scan = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings };
            let mut mapper = HitCounter::new(&model, HitCount::KARTO);
            mapper.integrate(&scan);
            let mut counts = vec![[0u32; 2]; spec.cells()];
            for ray in scan.rays() {
                let Some(range) = ray.reading else { continue };
                let point = |r: f64| [0, 1].map(|a| ray.origin_m[a] + r * ray.direction[a]);
                let end = spec.locate(point(range));
                let steps = (range / 1e-4) as usize;
                let mut seen: Vec<usize> = (0..steps).filter_map(|k| spec.locate(point(k as f64 * 1e-4))).collect();
                seen.sort_unstable();
                seen.dedup();
                for cell in seen.into_iter().filter(|cell| Some(*cell) != end) {
                    counts[cell][1] += 1;
                }
                if let Some(end) = end {
                    counts[end][0] += 1;
                }
            }
            // Cells that a ray only clips may be stepped over.
            let differ = |(a, b): &(&[u32; 2], &[u32; 2])| a[0] != b[0] || a[1].abs_diff(b[1]) > 1;
            prop_assert!(!mapper.counts.iter().zip(&counts).any(|pair| differ(&pair)));
            let clipped = mapper.counts.iter().zip(&counts).filter(|(a, b)| a != b).count();
            prop_assert!(clipped <= 2, "{clipped}");
            for (cell, [hits, misses]) in counts.iter().enumerate().filter(|(cell, c)| mapper.counts[*cell] == **c) {
                let passes = misses + 2 * hits;
                let share = f64::from(*hits) / f64::from(passes);
                let expected = match passes {
                    0..=2 => 0.1,
                    _ if share > 0.1 => HitCount::KARTO.shares[1],
                    _ => HitCount::KARTO.shares[0],
                };
                prop_assert!((mapper.occupancy()[cell] - expected).abs() < 1e-15);
            }
        }
    }
}
