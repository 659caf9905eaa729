//! What the rays of a drive could see so far, in a world at rest or in one that moves.

use grid::Raster;
use scene::SimulatedScan;
use score::{Moving, NEAR_LOOK_M, Region, ScoreError, Sight, Sightings};
use sensor::Pose;

use super::ground::Ground;

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
            sights(ground, scan, simulated).for_each(|(sight, reach_m)| alone.add_within(&sight, reach_m));
            movement.moving.looked(&alone.mask(Region::Observable))?;
            movement.near = alone.seen_within(NEAR_LOOK_M);
        }
        sights(ground, scan, simulated).for_each(|(sight, reach_m)| self.seen.add_within(&sight, reach_m));
        Ok(())
    }

    /// The truth of the moment.
    pub fn truth<'a>(&'a self, ground: &'a Ground) -> &'a Raster<Option<bool>> {
        self.movement.as_ref().map_or_else(|| ground.still(), |movement| movement.moving.truth())
    }
}

/// The rays of all sensors without their noise, and how far they see, m; from where the robot truly stood: the recorded pose may jitter.
fn sights<'a>(
    ground: &Ground,
    scan: usize,
    simulated: &'a SimulatedScan,
) -> impl Iterator<Item = (Sight, f64)> + use<'a> {
    let pose = ground.drive.poses[scan].pose;
    let sight = |pose: Pose, bearing_rad: f64, range_m: Option<f64>| Sight {
        origin_m: pose.position_m(),
        direction: pose.direction(bearing_rad),
        range_m,
    };
    let rays = simulated.scan.bearings_rad.iter().zip(&simulated.true_ranges_m);
    let of_camera = rays.map(move |(&bearing, &range_m)| (sight(pose, bearing, range_m), f64::INFINITY));
    let beside = simulated.beside.iter().flat_map(move |beside| {
        let pose = beside.mounted_on(pose);
        beside.looks.iter().map(move |look| (sight(pose, look.bearing_rad, look.range_m), look.reach_m))
    });
    of_camera.chain(beside)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use scene::Scene;
    use score::MovingRegion;

    /// A room in which somebody walks to and fro before a robot that stands, and whose recorded pose jitters.
    const STANDING: &str = r#"
name = "standing"
[bounds]
min = [0.0, 0.0]
max = [4.0, 3.0]
[grid]
cell = 0.1
[[wall]]
from = [0.05, 0.05]
to = [3.95, 0.05]
thickness = 0.1
[[wall]]
from = [3.95, 0.05]
to = [3.95, 2.95]
thickness = 0.1
[[wall]]
from = [3.95, 2.95]
to = [0.05, 2.95]
thickness = 0.1
[[wall]]
from = [0.05, 2.95]
to = [0.05, 0.05]
thickness = 0.1
[[mover]]
radius = 0.2
route = [[2.5, 0.6], [2.5, 2.4]]
speed_m_s = 0.6
repeat = "back_and_forth"
[waypoints]
A = [0.6, 1.5]
B = [0.9, 1.5]
[route]
stops = ["A", { at = "B", wait_s = 12.0 }]
[camera]
columns = 40
field_of_view_deg = 90.0
[robot]
radius = 0.15
speed = 0.5
jitter_m = 0.01
jitter_deg = 0.5
"#;

    fn ground() -> Ground {
        let scene = Scene::parse(STANDING, Path::new("standing.toml"), None).expect("a scene");
        Ground::new(scene, 0.1).expect("a drive")
    }

    #[test]
    fn what_could_be_seen_does_not_depend_on_recorded_poses() {
        let ground = ground();
        let simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, 1);
        let jitters = simulation.scans.iter().zip(&ground.drive.poses).filter(|(s, timed)| s.scan.pose != timed.pose);
        assert!(jitters.count() > 30, "the recorded pose jitters");
        let mut witness = Witness::new(&ground);
        for (number, scan) in simulation.scans.iter().enumerate() {
            witness.look(&ground, number, scan).expect("of this ground");
            assert_eq!(*witness.truth(&ground), *ground.truth_after(number + 1));
        }
        assert_eq!(witness.seen.hits_without_surface(), 0);
        assert_eq!(*witness.truth(&ground), ground.truth);
        let moving = &witness.movement.as_ref().expect("somebody walks").moving;
        for region in [MovingRegion::Static, MovingRegion::Swept, MovingRegion::Changed] {
            assert!(moving.mask(region).values().iter().any(|inside| *inside), "{region:?}");
        }
        // Nothing of this hangs on the seed of the readings.
        let other = scene::simulate(&ground.scene, &ground.world, &ground.drive, 2);
        let mut again = Witness::new(&ground);
        for (number, scan) in other.scans.iter().enumerate() {
            again.look(&ground, number, scan).expect("of this ground");
        }
        assert_eq!(again.seen.looks(), witness.seen.looks());
    }

    #[test]
    fn fewer_scans_keep_what_moved_at_them() {
        let (all, all_again) = (ground(), ground());
        let kept = [3, 17, 40];
        let few = all_again.with_scans(&kept);
        assert_eq!(few.scans(), 3);
        for (number, scan) in kept.into_iter().enumerate() {
            assert_eq!(few.covered_at(number), all.covered_at(scan));
            assert_eq!(*few.truth_after(number + 1), *all.truth_after(scan + 1));
        }
        assert_eq!(few.truth, *all.truth_after(41));
        assert_eq!(few.still(), all.still());
    }
}
