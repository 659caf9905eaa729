//! What the rays of a drive could see so far, in a world at rest or in one that moves.

use grid::Raster;
use scene::SimulatedScan;
use score::{Moving, NEAR_LOOK_M, Region, ScoreError, Sight, Sightings};

use super::run::Ground;

/// The sightings of a drive, scan by scan.
#[derive(Debug, Clone)]
pub struct Witness {
    /// What all scans so far could see.
    pub seen: Sightings,
    /// What has moved meanwhile; none where nothing does.
    pub movement: Option<Movement>,
}

/// How things have moved so far, as maps are judged by it.
#[derive(Debug, Clone)]
pub struct Movement {
    /// The truth of the moment, and the regions.
    pub moving: Moving,
    /// The cells that things cover now.
    pub covered: Raster<bool>,
    /// The cells that the last scan has looked at from near.
    pub near: Raster<bool>,
}

impl Witness {
    /// Before the first scan.
    pub fn new(ground: &Ground) -> Self {
        let still = ground.still();
        let none = || still.map(|_| false);
        let movement = ground.moves().then(|| Movement { moving: Moving::new(still), covered: none(), near: none() });
        Self { seen: Sightings::new(still), movement }
    }

    /// Takes in what the rays of a scan could see, without the noise of its readings; `scan` is its number from 0. Scans come in order.
    ///
    /// # Errors
    /// Readings of another world.
    pub fn look(&mut self, ground: &Ground, scan: usize, simulated: &SimulatedScan) -> Result<(), ScoreError> {
        if let Some(movement) = &mut self.movement {
            movement.covered = ground.covered_at(scan);
            movement.moving.moved(&movement.covered)?;
            self.seen.set_truth(movement.moving.truth())?;
            let mut alone = Sightings::new(movement.moving.truth());
            sights(simulated).for_each(|sight| alone.add(&sight));
            movement.moving.looked(&alone.mask(Region::Observable))?;
            movement.near = alone.seen_within(NEAR_LOOK_M);
        }
        sights(simulated).for_each(|sight| self.seen.add(&sight));
        Ok(())
    }

    /// The truth of the moment.
    pub fn truth<'a>(&'a self, ground: &'a Ground) -> &'a Raster<Option<bool>> {
        self.movement.as_ref().map_or_else(|| ground.still(), |movement| movement.moving.truth())
    }
}

/// The rays of a scan without its noise.
fn sights(simulated: &SimulatedScan) -> impl Iterator<Item = Sight> + '_ {
    let rays = simulated.scan.rays().zip(&simulated.true_ranges_m);
    rays.map(|(ray, &range_m)| Sight { origin_m: ray.origin_m, direction: ray.direction, range_m })
}
