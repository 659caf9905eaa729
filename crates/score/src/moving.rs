//! A world that moves: which cells things have covered, which of them looks have found changed.

mod ghost;
mod lag;
mod region;
mod scores;

use grid::Raster;

pub use lag::{LONGEST_LAG, Lag, NEAR_LOOK_M, QUICK_LOOKS};
pub use region::MovingRegion;
pub use scores::MovingScores;

use crate::ScoreError;
use crate::error::same_cells;

/// The truth of the moment and the regions of a world in which things move, followed from scan to scan.
///
/// A cell's *state* is occupied or free: occupied where the static truth is, or where a moving thing covers it now. Things change the
/// state of statically free cells alone: what a wall holds stays occupied, whatever passes in front of it. A *look* at a cell is a scan of which a
/// noise-free ray finds the cell in its state: one that crosses it where it is free, or hits it first where it is occupied
/// ([`Region::Observable`](crate::Region::Observable) of the scan's own [`Sightings`](crate::Sightings)).
#[derive(Debug, Clone)]
pub struct Moving {
    /// The truth without anything that moves.
    still: Raster<Option<bool>>,
    /// The truth of the moment.
    now: Raster<Option<bool>>,
    cells: Raster<Course>,
}

/// What has become of a cell so far.
#[derive(Debug, Clone, Copy, Default)]
struct Course {
    /// Whether a thing has covered it.
    covered: bool,
    /// The state that the last look found, if any.
    found: Option<bool>,
    /// Whether a look has found it since it took on its present state.
    known: bool,
    /// Whether a look has found another state than the look before it.
    changed: bool,
}

impl Moving {
    /// Before the first scan of a world: `Some(true)` statically occupied, `Some(false)` free where nothing that moves stands, `None` not known.
    pub fn new(still: &Raster<Option<bool>>) -> Self {
        Self { still: still.clone(), now: still.clone(), cells: still.map(|_| Course::default()) }
    }

    /// Things have moved, and cover these cells now. Call it once per scan, before [`looked`](Self::looked). Allocates nothing.
    ///
    /// # Errors
    /// A raster of another geometry.
    pub fn moved(&mut self, covered: &Raster<bool>) -> Result<(), ScoreError> {
        same_cells("mask of covered cells", covered.spec(), self.still.spec())?;
        let states = self.now.values_mut().iter_mut().zip(self.still.values());
        for ((cell, (now, still)), &covered) in self.cells.values_mut().iter_mut().zip(states).zip(covered.values()) {
            if *still != Some(false) {
                continue;
            }
            cell.covered |= covered;
            cell.known &= *now == Some(covered);
            *now = Some(covered);
        }
        Ok(())
    }

    /// The rays of a scan have found these cells in the state of the moment. Allocates nothing.
    ///
    /// # Errors
    /// A mask of another geometry.
    pub fn looked(&mut self, seen: &Raster<bool>) -> Result<(), ScoreError> {
        same_cells("mask of seen cells", seen.spec(), self.still.spec())?;
        for ((cell, &now), &seen) in self.cells.values_mut().iter_mut().zip(self.now.values()).zip(seen.values()) {
            if seen && now.is_some() {
                cell.changed |= cell.found.is_some() && cell.found != now;
                cell.found = now;
                cell.known = true;
            }
        }
        Ok(())
    }

    /// The truth of the moment: occupied where something stands, moving or not.
    pub fn truth(&self) -> &Raster<Option<bool>> {
        &self.now
    }

    /// Whether a cell belongs to a region.
    pub fn contains(&self, region: MovingRegion, cell: usize) -> bool {
        let (now, Course { covered, found, known, changed }) = (self.now[cell], self.cells[cell]);
        match region {
            MovingRegion::Static => known && !covered,
            MovingRegion::Swept => found.is_some() && covered && now == Some(false),
            MovingRegion::OccupiedNow => known && covered && now == Some(true),
            MovingRegion::Changed => known && changed,
        }
    }

    /// The cells of a region.
    pub fn mask(&self, region: MovingRegion) -> Raster<bool> {
        let spec = *self.still.spec();
        Raster::new(spec, (0..spec.cells()).map(|cell| self.contains(region, cell)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{drawn, picture};

    /// Steps of a drawing: cells covered (`c`) and looked at (`l`), both (`b`), or neither (`.`).
    fn after(world: &str, scans: &[&str]) -> Moving {
        let truth = drawn(&[world]);
        let mut moving = Moving::new(&truth);
        for scan in scans {
            let of = |letters: &str| Raster::new(*truth.spec(), scan.chars().map(|c| letters.contains(c)).collect());
            moving.moved(&of("cb")).expect("valid");
            moving.looked(&of("lb")).expect("valid");
        }
        moving
    }

    /// One letter per cell: s(tatic), w (swept), o(ccupied now), capitals where it has changed too, `-` none.
    fn regions(moving: &Moving) -> String {
        let parts = [(MovingRegion::Static, 's'), (MovingRegion::Swept, 'w'), (MovingRegion::OccupiedNow, 'o')];
        let letter = |cell| {
            let inside: Vec<char> = parts.iter().filter(|p| moving.contains(p.0, cell)).map(|p| p.1).collect();
            assert!(inside.len() <= 1, "cell {cell} is in {inside:?}");
            let changed = moving.contains(MovingRegion::Changed, cell);
            inside.first().map_or('-', |c| if changed { c.to_ascii_uppercase() } else { *c })
        };
        picture(moving.still.spec(), letter).concat()
    }

    #[test]
    fn histories_of_one_cell() {
        for (history, expected, why) in [
            (&["l"][..], "s", "looked at and never covered"),
            (&["."], "-", "nobody has looked"),
            (&["c"], "-", "nobody has looked at what covers it"),
            (&["b"], "o", "covered and hit"),
            (&["b", "."], "w", "free again, and nobody has looked since"),
            (&["b", "l"], "W", "free again, and looked at since"),
            (&["c", "l"], "w", "no look found it covered: swept, and not changed"),
            (&["c", "."], "-", "no look at all"),
            (&["l", "c", "."], "w", "a look before it came is one"),
            (&["l", "c"], "-", "the look was at the state before"),
            (&["l", "c", "l"], "w", "two looks found the same"),
            (&["l", "b"], "O", "two looks found different states"),
            (&["l", "b", "c"], "O", "what was known stays known while it lasts"),
            (&["l", "b", "l", "l"], "W", "what changed once has changed"),
            (&["b", ".", "c"], "-", "covered anew, and not looked at since"),
        ] {
            assert_eq!(regions(&after(".", history)), expected, "{why}");
        }
    }

    #[test]
    fn a_wall_that_a_thing_touches_stays_a_wall_and_the_unknown_stays_unknown() {
        let moving = after("#?.", &["bbb", "lll"]);
        assert_eq!(regions(&moving), "s-W");
        assert_eq!(moving.truth().values(), [Some(true), None, Some(false)]);
        let moving = after("#?.", &["ccc"]);
        assert_eq!((regions(&moving), moving.truth()[2]), ("---".into(), Some(true)));
    }

    #[test]
    fn other_geometry_is_refused_and_named() {
        let mut moving = Moving::new(&drawn(&[".."]));
        let other = drawn(&["..."]).map(|_| true);
        for (refused, what) in
            [(moving.moved(&other), "mask of covered cells"), (moving.looked(&other), "mask of seen cells")]
        {
            assert!(matches!(refused, Err(ScoreError::Geometry { what: named, .. }) if named == what));
        }
    }
}
