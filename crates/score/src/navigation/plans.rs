//! Drives, planned on a map and judged.

use grid::{GridSpec, Lattice, ROUNDING, Raster, StepCosts, clear};

use super::errands::{Errand, Goal, draw};
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
    /// Draws the pairs from the truth (`None` is not known).
    pub fn new(truth: &Raster<Option<bool>>, planning: Planning) -> Self {
        let free = if planning.pairs > 0 {
            clear(&truth.map(|cell| *cell != Some(false)), planning.robot_radius_m)
        } else {
            truth.map(|_| false)
        };
        let errands = draw(&Lattice::new(free, StepCosts::FINE), planning.pairs);
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

    /// What a drive keeps clear of obstacles, m: the robot's radius but for the rounding of the search.
    pub fn clearance_m(&self) -> f64 {
        self.planning.robot_radius_m - 2.0 * ROUNDING * self.spec.cell_m
    }

    /// Plans every pair on a map of probabilities, of which it knows the cells of `known`; none where the map has no way.
    ///
    /// # Errors
    /// Rasters of another geometry than the truth; a cell that holds no probability.
    pub fn plans(&self, map: &Raster<f64>, known: &Raster<bool>) -> Result<Vec<Option<Plan>>, ScoreError> {
        same_cells("map", map.spec(), &self.spec)?;
        same_cells("mask of known cells", known.spec(), &self.spec)?;
        probabilities(map)?;
        let obstacle = |cell: usize| match known[cell] {
            true => map[cell] > self.planning.threshold,
            false => self.planning.never_seen == NeverSeen::Occupied,
        };
        let solid = (0..self.spec.cells()).map(|cell| self.unjudged[cell] || obstacle(cell)).collect();
        let free = clear(&Raster::new(self.spec, solid), self.planning.robot_radius_m);
        let ways = Lattice::new(free, StepCosts::FINE);
        Ok(self.errands.iter().flat_map(|errand| planned(&ways, errand)).collect())
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
        let (mut reached, mut colliding, mut detours) = (0, 0, 0.0);
        for plan in self.plans(map, known)?.into_iter().flatten() {
            if is_clear(&plan.path_m) {
                reached += 1;
                detours += plan.detour;
            } else {
                colliding += 1;
            }
        }
        Ok([
            Metric::share("reached", reached, self.pairs()),
            Metric::share("colliding", colliding, self.pairs()),
            Metric::mean("detour", "1", detours, reached),
        ])
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
        let detour = f64::from(costs[goal.cell]) / f64::from(goal.shortest);
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
