//! What a planner can do with landmarks, and with the grid that is made of the same drive from the same poses.

use grid::Raster;
use mapper::catalogue;
use scene::SimulatedScan;
use score::Metric;
use score::navigation::Navigation;
use sensor::Pose;

use crate::failure::Failure;
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::drives::{self, DriveOptions};
use crate::worlds::seen::{Reach, Seen};
use crate::worlds::site::{Assumptions, Site};

/// Something stands within so much of a landmark, m.
const HALF_M: f64 = 0.15;

/// The rule that makes the grid.
const MAPPER: &str = "visibility";

/// Names of the metrics of landmarks, and of the grid.
pub(super) const NAMES: [[&str; 3]; 2] =
    [["reached", "colliding", "detour"], ["grid_reached", "grid_colliding", "grid_detour"]];

/// The world that was driven in, with the scans of the same drive.
pub(super) struct Yard {
    site: Site,
    navigation: Navigation,
    /// In the order of the scans of features, of all sensors.
    scans: Vec<SimulatedScan>,
}

impl Yard {
    /// The world of a scene, driven with a seed.
    pub(super) fn of(scene: &scene::Scene, seed: u64) -> Result<Self, Failure> {
        let site = Site::of(scene.clone(), &AS_BELIEVED, &Assumptions::default())?;
        let ground = &site.ground;
        let navigation = Navigation::new(&ground.truth, DriveOptions::default().planning(ground.scene.robot.radius_m));
        let simulated = scene::simulate(&ground.scene, &ground.world, &ground.drive, seed).scans;
        let mut scans: Vec<SimulatedScan> = Vec::new();
        for simulated in simulated {
            if scans.last().is_none_or(|last| simulated.scan.time_s > last.scan.time_s) {
                scans.push(simulated);
            }
        }
        Ok(Self { site, navigation, scans })
    }

    /// Shares of the drives that are planned and driven without a collision, and of those driven into something, and the detours: by
    /// landmarks, m, with all between them taken for free, and by a grid of the scans from `poses`; both in the frame of the world.
    pub(super) fn metrics(&self, landmarks_m: &[[f64; 2]], poses: &[Pose]) -> Result<[Vec<Metric>; 2], Failure> {
        let Site { ground, setup } = &self.site;
        let spec = *ground.truth.spec();
        let near = |cell: usize| {
            let centre = spec.centre(cell);
            landmarks_m.iter().any(|at| (at[0] - centre[0]).hypot(at[1] - centre[1]) <= HALF_M)
        };
        let stands = Raster::new(spec, (0..spec.cells()).map(|cell| if near(cell) { 1.0 } else { 0.0 }).collect());
        let by_landmarks = drives::metrics(&self.navigation, &ground.world, &stands, None, &stands.map(|_| true));

        let no_mapper = || Failure::Internal(format!("there is no {MAPPER}"));
        let mut mapper = catalogue::find(MAPPER).ok_or_else(no_mapper)?.mapper(setup);
        let mut seen = Seen::new(spec);
        for (simulated, pose) in self.scans.iter().zip(poses) {
            let mut moved = simulated.clone();
            moved.move_to(*pose);
            let scans = moved.together();
            scans.iter().for_each(|scan| seen.add(scan, &**setup.sensors.of(scan), Reach::Median));
            mapper.integrate_together(&scans);
        }
        mapper.settle();
        let by_grid = drives::metrics(&self.navigation, &ground.world, mapper.occupancy(), None, &seen.cells);
        let [by_landmarks, by_grid] = [by_landmarks, by_grid].map(|found| found.map_err(Failure::internal));
        Ok([by_landmarks?, by_grid?])
    }
}
