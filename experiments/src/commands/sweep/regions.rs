//! The regions that a sweep scores maps in.

use grid::Raster;
use score::{LOOK_EDGES, MovingRegion, RANGE_EDGES_M, Region, error_profile};

use crate::failure::Failure;
use crate::worlds::aligned::ALIGNED;
use crate::worlds::bins::ends;
use crate::worlds::ground::Ground;
use crate::worlds::run::Trial;

/// What stands for a region per bin of range and number of looks.
pub const RANGE_BY_LOOKS: &str = "range-by-looks";

/// The names that a sweep file may give.
pub fn known() -> Vec<&'static str> {
    let moving = MovingRegion::ALL.iter().map(|region| region.name());
    Region::ALL.iter().map(|region| region.name()).chain([RANGE_BY_LOOKS, ALIGNED]).chain(moving).collect()
}

/// Whether regions of worlds that move are among them: tables then have the metrics of such worlds too.
pub fn of_movement(regions: &[String]) -> bool {
    regions.iter().any(|name| MovingRegion::ALL.iter().any(|region| region.name() == name))
}

/// Errors over the cells in a bin of range and looks.
pub struct Bin {
    /// Such as `range 1-1.5 looks 4-8`: metres and rays, the upper ends not included.
    pub name: String,
    /// Number of cells.
    pub cells: usize,
    /// Log loss, nats per cell, and Brier score; none of an empty bin.
    pub errors: [Option<f64>; 2],
}

/// The errors of the last map of a mapper, by the range from which cells were seen best and the number of rays that
/// looked at them. Empty bins are left out.
///
/// # Errors
/// A map that holds something else than probabilities.
pub fn range_by_looks(ground: &Ground, trial: &Trial, map: &Raster<f64>) -> Result<Vec<Bin>, Failure> {
    let observable = trial.seen.mask(Region::Observable);
    let looks = trial.seen.looks().map(|&looks| f64::from(looks));
    let nearest = trial.seen.nearest_m();
    let mut bins = Vec::new();
    for range in RANGE_EDGES_M.windows(2) {
        let within = nearest.values().iter().map(|r| (range[0]..range[1]).contains(r));
        let mask = observable.values().iter().zip(within).map(|(seen, within)| *seen && within).collect();
        let profile = error_profile(map, &ground.truth, &Raster::new(*observable.spec(), mask), &looks, &LOOK_EDGES)?;
        for (bin, looks) in profile.bins.iter().zip(LOOK_EDGES.windows(2)) {
            if bin.log_loss.support > 0 {
                bins.push(Bin {
                    name: format!("range {} looks {}", ends([range[0], range[1]]), ends([looks[0], looks[1]])),
                    cells: bin.log_loss.support,
                    errors: [bin.log_loss.value, bin.brier.value],
                });
            }
        }
    }
    Ok(bins)
}
