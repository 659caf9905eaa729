//! Where maps are made: the one way from a scene, a condition and a seed to a ground and a set-up.

use std::fmt;
use std::sync::Arc;

use mapper::{Model, Prior, Reconciliation, Sensors, Tuning};
use scene::{Family, Scene, Variation};
use sensor::{Device, SensorModel, Stereo};
use serde::{Deserialize, Serialize};

use super::condition::{Condition, condition};
use super::ground::Ground;
use super::suites;
use crate::failure::Failure;
use crate::output::args::PriorOptions;

/// Micrometres in a metre.
pub const MICROMETRES: f64 = 1e6;

/// Names a world: all that its readings follow from.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct WorldId {
    /// Name of the family, or of the scene.
    pub family: String,
    /// Name of the condition, see [`super::condition`].
    pub condition: String,
    /// Side of a cell in µm, where it is not the scene's own.
    pub cell_um: Option<u32>,
    /// Seed of the readings; of a family, its layout too.
    pub seed: u64,
}

/// What mappers assume of the world.
#[derive(Debug, Clone, Default)]
pub struct Assumptions {
    /// Occupancy and continuity.
    pub prior: Prior,
    /// What becomes of edges on no ray.
    pub reconciliation: Reconciliation,
    /// Parameters of rules other than the paper's.
    pub tuning: Tuning,
    /// Readings beyond this are thrown away, m; none where all are used.
    pub max_range_m: Option<f64>,
    /// The camera; none is that of the scene's file, whatever the condition makes of it.
    pub camera: Option<Stereo>,
}

/// A world ready to be mapped.
pub struct Site {
    /// What is mapped.
    pub ground: Ground,
    /// What the mappers start from.
    pub setup: Model,
}

impl WorldId {
    /// Side of a cell in m, where it is not the scene's own.
    pub fn cell_m(&self) -> Option<f64> {
        self.cell_um.map(|cell_um| f64::from(cell_um) / MICROMETRES)
    }

    /// The condition of the world.
    ///
    /// # Errors
    /// A condition that does not exist.
    pub fn condition(&self) -> Result<&'static Condition, Failure> {
        condition(&self.condition)
            .ok_or_else(|| Failure::Internal(format!("there is no condition {:?}", self.condition)))
    }
}

impl fmt::Display for WorldId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} seed {}", self.family, self.condition, self.seed)?;
        self.cell_m().map_or(Ok(()), |cell_m| write!(f, ", cells of {cell_m} m"))
    }
}

impl Assumptions {
    /// Those that the command line asks for.
    pub fn of(options: &PriorOptions) -> Self {
        Self { prior: options.prior(), reconciliation: options.reconciliation(), ..Self::default() }
    }
}

impl Site {
    /// Builds a scene under a condition, which changes the simulated camera, what is known of poses, or what the robot carries.
    ///
    /// # Errors
    /// A route that is blocked.
    pub fn of(mut scene: Scene, condition: &Condition, assumed: &Assumptions) -> Result<Self, Failure> {
        let sensed = condition.suite.map(|suite| {
            let camera = scene.camera;
            let furnished = suites::equip(&mut scene, suite);
            suites::sensed(&scene, &furnished, camera, assumed.prior.occupancy)
        });
        let Assumptions { prior, reconciliation, tuning, max_range_m, camera } = assumed.clone();
        let camera = Arc::new(camera.unwrap_or(scene.matcher.stereo));
        let max_range_m = max_range_m.unwrap_or(f64::INFINITY);
        let sensors = sensors(camera.clone(), &scene, |device| *device);
        let setup = Model { sensors, prior, reconciliation, tuning, max_range_m, ..Model::new(scene.grid, camera) };
        (condition.camera)(&mut scene.matcher);
        let mut ground = Ground::new(scene, prior.occupancy)?;
        ground.sensed = sensed.transpose()?;
        Ok(Self { ground: ground.with_poses(condition.poses), setup })
    }

    /// Builds a world of a family: the layout of its seed, under its condition.
    ///
    /// # Errors
    /// A condition that does not exist; a layout that cannot be made; a route that is blocked.
    pub fn of_family(family: &Family, world: &WorldId, assumed: &Assumptions) -> Result<Self, Failure> {
        let condition = world.condition()?;
        let variation = Variation { size_factor: condition.size_factor };
        let crowded = condition.people_per_100_m2.map(|people| family.clone().with_people(people));
        let family = crowded.as_ref().unwrap_or(family);
        Self::of(family.scene(world.seed, world.cell_m(), &variation)?, condition, assumed)
    }
}

/// The sensors of a scene, as mappers assume them: the camera's model, and those that are made of the devices beside it.
pub fn sensors(camera: Arc<dyn SensorModel>, scene: &Scene, assumed: impl Fn(&Device) -> Device) -> Sensors {
    let beside = scene.sensors.iter().map(|sensor| assumed(&sensor.device).model());
    Sensors::new([camera].into_iter().chain(beside).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_size_is_the_number_that_was_given() {
        let world = |cell_um| WorldId { family: "f".to_owned(), condition: "as-believed".to_owned(), cell_um, seed: 3 };
        for cell_m in [0.05, 0.1, 0.2, 0.0375] {
            let cell_um = Some((cell_m * MICROMETRES).round() as u32);
            assert_eq!(world(cell_um).cell_m().map(f64::to_bits), Some(f64::to_bits(cell_m)));
        }
        assert_eq!(world(Some(200_000)).to_string(), "f as-believed seed 3, cells of 0.2 m");
    }
}
