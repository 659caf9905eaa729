//! Drives, planned on a map and judged.

use grid::{GridSpec, Lattice, ROUNDING, Raster, clear};

use super::errands::{COSTS, Errand, Goal, draw};
use super::planning::{NeverSeen, Planning};
use crate::error::{probabilities, same_cells};
use crate::{Metric, ScoreError};

/// The drives that every map of a world is asked for.
#[derive(Debug, Clone)]
pub struct Navigation {
    planning: Planning,
    spec: GridSpec,
    /// Where the truth is not known: nobody can judge a drive there, so that none is planned.
    unjudged: Raster<bool>,
    errands: Vec<Errand>,
}

/// A way from one place of a pair to the other over what a map takes for free.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Its straight legs: centres of cells, m.
    pub path_m: Vec<[f64; 2]>,
    /// Its length over that of a shortest way of the same search over the truth.
    pub detour: f64,
}

impl Navigation {
    /// Names of [`Self::metrics`].
    pub const METRICS: [&'static str; 3] = ["reached", "colliding", "detour"];

    /// Names of [`Self::metrics_by_footprint`].
    pub const FOOTPRINT_METRICS: [&'static str; 3] = ["footprint_reached", "footprint_colliding", "footprint_detour"];

    /// Draws the pairs from the truth (`None` is not known).
    pub fn new(truth: &Raster<Option<bool>>, planning: Planning) -> Self {
        let free = if planning.pairs > 0 {
            clear(&truth.map(|cell| *cell != Some(false)), planning.robot_radius_m)
        } else {
            truth.map(|_| false)
        };
        let errands = draw(&Lattice::new(free, COSTS), planning.pairs);
        Self { planning, spec: *truth.spec(), unjudged: truth.map(Option::is_none), errands }
    }

    /// Number of pairs, at most as many as were asked for.
    pub fn pairs(&self) -> usize {
        self.errands.iter().map(|errand| errand.goals.len()).sum()
    }

    /// The pairs, m: from where, and to where.
    pub fn places(&self) -> Vec<[[f64; 2]; 2]> {
        let pair = |errand: &Errand, goal: &Goal| [errand.start, goal.cell].map(|cell| self.spec.centre(cell));
        self.errands.iter().flat_map(|errand| errand.goals.iter().map(move |goal| pair(errand, goal))).collect()
    }

    /// Radius of the robot's disc, m.
    pub fn robot_radius_m(&self) -> f64 {
        self.planning.robot_radius_m
    }

    /// What a drive keeps clear of obstacles, m: the robot's radius but for the rounding of the search.
    pub fn clearance_m(&self) -> f64 {
        self.planning.robot_radius_m - 2.0 * ROUNDING * self.spec.cell_m
    }

    /// Plans every pair on a map of probabilities, of which it knows the cells of `known`; none where the map has no way.
    ///
    /// # Errors
    /// Rasters of another geometry than the truth; a cell that holds no probability.
    pub fn plans(&self, map: &Raster<f64>, known: &Raster<bool>) -> Result<Vec<Option<Plan>>, ScoreError> {
        let free = self.clear(map, known, |p| p > self.planning.threshold)?;
        Ok(self.planned(&Lattice::new(free, COSTS)))
    }

    /// Plans every pair by the probability that an obstacle stands under the robot: `footprint` holds it for the robot's disc about every
    /// cell. A place is an obstacle above the threshold, and else costs more the more probable one is, up to
    /// [`Planning::most_costly`] times as much as a free place, as in a costmap.
    ///
    /// # Errors
    /// As [`Self::plans`].
    pub fn plans_by_footprint(
        &self,
        footprint: &Raster<f64>,
        known: &Raster<bool>,
    ) -> Result<Vec<Option<Plan>>, ScoreError> {
        let Planning { threshold, most_costly, .. } = self.planning;
        let mut fits = self.clear(footprint, known, |_| false)?;
        fits.values_mut().iter_mut().zip(footprint.values()).for_each(|(fits, p)| *fits &= *p <= threshold);
        let more = f64::from(most_costly.max(1) - 1);
        let weights = footprint.map(|p| 1 + (more * (p / threshold).min(1.0)).round() as u8);
        Ok(self.planned(&Lattice::new(fits, COSTS).weighted(weights)))
    }

    /// Where the robot's disc clears what is an obstacle by its probability, what the planner takes unknown cells for, and cells of which the
    /// truth is not known.
    fn clear(
        &self,
        map: &Raster<f64>,
        known: &Raster<bool>,
        is_obstacle: impl Fn(f64) -> bool,
    ) -> Result<Raster<bool>, ScoreError> {
        same_cells("map", map.spec(), &self.spec)?;
        same_cells("mask of known cells", known.spec(), &self.spec)?;
        probabilities(map)?;
        let obstacle = |cell: usize| match known[cell] {
            true => is_obstacle(map[cell]),
            false => self.planning.never_seen == NeverSeen::Occupied,
        };
        let solid = (0..self.spec.cells()).map(|cell| self.unjudged[cell] || obstacle(cell)).collect();
        Ok(clear(&Raster::new(self.spec, solid), self.planning.robot_radius_m))
    }

    fn planned(&self, ways: &Lattice) -> Vec<Option<Plan>> {
        self.errands.iter().flat_map(|errand| planned(ways, errand)).collect()
    }

    /// Plans every pair on a map and drives the plans: `is_clear` says whether a disc of [`Self::clearance_m`] can
    /// really be driven along a path (m).
    ///
    /// The metrics: `reached`, the share of pairs that were planned and driven without a collision; `colliding`, the
    /// share that were planned and collide; `detour`, the mean over those reached of the plan's length over the
    /// shortest. A pair that is not planned is neither reached nor colliding.
    ///
    /// # Errors
    /// As [`Self::plans`].
    pub fn metrics(
        &self,
        map: &Raster<f64>,
        known: &Raster<bool>,
        is_clear: impl Fn(&[[f64; 2]]) -> bool,
    ) -> Result<[Metric; 3], ScoreError> {
        Ok(self.driven(Self::METRICS, self.plans(map, known)?, is_clear))
    }

    /// The same of plans by footprint ([`Self::plans_by_footprint`]): `footprint_reached`, `footprint_colliding`, `footprint_detour`.
    ///
    /// # Errors
    /// As [`Self::plans`].
    pub fn metrics_by_footprint(
        &self,
        footprint: &Raster<f64>,
        known: &Raster<bool>,
        is_clear: impl Fn(&[[f64; 2]]) -> bool,
    ) -> Result<[Metric; 3], ScoreError> {
        Ok(self.driven(Self::FOOTPRINT_METRICS, self.plans_by_footprint(footprint, known)?, is_clear))
    }

    fn driven(
        &self,
        [reached_name, colliding_name, detour_name]: [&'static str; 3],
        plans: Vec<Option<Plan>>,
        is_clear: impl Fn(&[[f64; 2]]) -> bool,
    ) -> [Metric; 3] {
        let (mut reached, mut colliding, mut detours) = (0, 0, 0.0);
        for plan in plans.into_iter().flatten() {
            if is_clear(&plan.path_m) {
                reached += 1;
                detours += plan.detour;
            } else {
                colliding += 1;
            }
        }
        [
            Metric::share(reached_name, reached, self.pairs()),
            Metric::share(colliding_name, colliding, self.pairs()),
            Metric::mean(detour_name, "1", detours, reached),
        ]
    }
}

/// The plans of an errand, by one search.
fn planned(ways: &Lattice, errand: &Errand) -> Vec<Option<Plan>> {
    let goals: Vec<usize> = errand.goals.iter().map(|goal| goal.cell).filter(|&cell| ways.holds(cell)).collect();
    if goals.is_empty() || !ways.holds(errand.start) {
        return vec![None; errand.goals.len()];
    }
    let costs = ways.costs(errand.start, &goals);
    let plan = |goal: &Goal| {
        let way = ways.way_back(&costs, goal.cell).filter(|_| ways.holds(goal.cell))?;
        let detour = f64::from(ways.length(&way)) / f64::from(goal.shortest);
        Some(Plan { path_m: legs(ways.spec(), &way), detour })
    };
    errand.goals.iter().map(plan).collect()
}

/// A way as straight legs: the cells at which it begins, turns and ends.
fn legs(spec: &GridSpec, way: &[usize]) -> Vec<[f64; 2]> {
    let step = |k: usize| way[k].wrapping_sub(way[k - 1]);
    let stays = |k: &usize| *k == 0 || k + 1 == way.len() || step(*k) != step(k + 1);
    (0..way.len()).filter(stays).map(|k| spec.centre(way[k])).collect()
}
