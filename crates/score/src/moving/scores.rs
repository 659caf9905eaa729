//! How right a map is about a world that moves.

use grid::Raster;
use serde::Serialize;

use super::ghost::largest_patch;
use super::{Moving, MovingRegion};
use crate::error::{probabilities, same_cells};
use crate::threshold::HELD_OCCUPIED;
use crate::{Metric, ScoreError};

/// The metrics of one map that only a world that moves has. A map holds a cell right where p > 0.5 and it is occupied, or p < 0.5 and it is
/// free; a map that says 0.5 says nothing, and is right nowhere.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MovingScores {
    /// Share of the static cells that the map holds right.
    pub static_accuracy: Metric,
    /// Share of the swept cells that the map holds free (p < 0.5) again.
    pub dynamic_accuracy: Metric,
    /// Harmonic mean of both, per cell of each; read it beside both, never alone: a map of nothing but the prior has no trail either. No value
    /// where one of them has none. Support: the cells of both.
    pub harmonic_accuracy: Metric,
    /// Area of the swept cells with p > 0.5, m²: what things have left behind in the map.
    pub trail_area: Metric,
    /// Area of the largest patch (4-connected) of cells with p > 0.5 that have changed and are free now, m². Support: the changed cells that are free now.
    pub ghost_area: Metric,
}

impl MovingScores {
    /// Every metric with the name of the region whose row holds it, in the order of tables.
    pub fn by_region(&self) -> [(&'static str, Metric); 5] {
        let s = *self;
        [
            (MovingRegion::Static.name(), s.static_accuracy),
            (MovingRegion::Swept.name(), s.dynamic_accuracy),
            (MovingRegion::Swept.name(), s.harmonic_accuracy),
            (MovingRegion::Swept.name(), s.trail_area),
            (MovingRegion::Changed.name(), s.ghost_area),
        ]
    }
}

impl Moving {
    /// Scores a map of occupancy probabilities against the world of the moment.
    ///
    /// # Errors
    /// A map of another geometry; a cell that holds no probability.
    pub fn scores(&self, map: &Raster<f64>) -> Result<MovingScores, ScoreError> {
        same_cells("map", map.spec(), self.still.spec())?;
        probabilities(map)?;
        let area_m2 = map.spec().cell_area_m2();
        let of_static = self.held(map, MovingRegion::Static);
        let of_swept = self.held(map, MovingRegion::Swept);
        let free = |cell: &usize| self.contains(MovingRegion::Changed, *cell) && self.now[*cell] == Some(false);
        let changed = (0..map.spec().cells()).filter(free).count();
        let ghosts = (0..map.spec().cells()).map(|cell| free(&cell) && map[cell] > HELD_OCCUPIED).collect();
        let ghost = largest_patch(&Raster::new(*map.spec(), ghosts));
        let static_accuracy = Metric::share("static_accuracy", of_static.right, of_static.cells);
        let dynamic_accuracy = Metric::share("dynamic_accuracy", of_swept.right, of_swept.cells);
        Ok(MovingScores {
            static_accuracy,
            dynamic_accuracy,
            harmonic_accuracy: harmonic(static_accuracy, dynamic_accuracy),
            trail_area: Metric::area("trail_area", of_swept.occupied, of_swept.cells, area_m2),
            ghost_area: Metric::area("ghost_area", ghost, changed, area_m2),
        })
    }

    fn held(&self, map: &Raster<f64>, region: MovingRegion) -> Held {
        let mut held = Held::default();
        for (cell, &p) in map.values().iter().enumerate().filter(|(cell, _)| self.contains(region, *cell)) {
            let right = if self.now[cell] == Some(true) { p > HELD_OCCUPIED } else { p < HELD_OCCUPIED };
            held.cells += 1;
            held.right += usize::from(right);
            held.occupied += usize::from(p > HELD_OCCUPIED);
        }
        held
    }
}

/// Cells of a region, and what a map makes of them.
#[derive(Default)]
struct Held {
    cells: usize,
    right: usize,
    occupied: usize,
}

/// `2 a b / (a + b)`; zero where both are.
fn harmonic(a: Metric, b: Metric) -> Metric {
    let mean = |(a, b): (f64, f64)| if a + b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
    Metric {
        name: "harmonic_accuracy",
        value: a.value.zip(b.value).map(mean),
        unit: "1",
        support: a.support + b.support,
    }
}
