//! What a run was made from: `run.json`.

use std::collections::BTreeMap;

use grid::GridSpec;
use mapper::catalogue::Entry;
use mapper::{Prior, Reconciliation};
use scene::{Mounted, Scene};
use sensor::Matcher;
use serde::Serialize;

use super::options::RoomOptions;
use crate::figures::Paper;
use crate::programs::options::ProgramRecord;
use crate::worlds::claims::Claim;
use crate::worlds::drives::DriveOptions;
use crate::worlds::ground::Ground;
use crate::worlds::run::Stage;

/// What the record of a room holds.
#[derive(Debug, Serialize)]
pub(super) struct Parts {
    /// First seed.
    seed: u64,
    /// Everything that was set, by default, file or command line.
    pub(super) configuration: Configuration,
    /// The cells of the maps.
    grid: GridSpec,
    /// When the maps were looked at.
    stages: Vec<Stage>,
    /// What was claimed and found.
    claims: Vec<Claim>,
    /// How pictures were made, where that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pictures: Option<Paper>,
}

/// The merged configuration.
#[derive(Debug, Serialize)]
pub(super) struct Configuration {
    /// Scene file.
    pub scene: String,
    /// Which scene of it, where it is a family of scenes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layout: Option<u64>,
    /// Number of consecutive seeds.
    pub seeds: u32,
    /// Mappers in order.
    pub mappers: Vec<&'static str>,
    /// The programs among them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub programs: Vec<ProgramRecord>,
    /// What the mappers assume before the first reading.
    pub prior: Prior,
    /// What becomes of edges on no ray.
    pub reconciliation: Reconciliation,
    /// Readings beyond this were thrown away, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_range_m: Option<f64>,
    /// The simulated sensor, which the mappers know.
    pub sensor: Matcher,
    /// Image columns.
    pub columns: usize,
    /// Field of view, rad.
    pub field_of_view_rad: f64,
    /// The sensors beside the camera, in the order of their numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<Carried>,
    /// The robot.
    pub robot: Robot,
    /// How drives are planned on the maps.
    pub drives: DriveOptions,
}

/// A sensor beside the camera, which the mappers know.
#[derive(Debug, Serialize)]
pub(super) struct Carried {
    pub name: String,
    pub kind: &'static str,
    /// Where it stands on the robot: m, m, degrees.
    pub mount: [f64; 3],
    pub rays: usize,
    pub every: usize,
    /// Its parameters by name.
    pub noise: BTreeMap<&'static str, f64>,
}

impl Carried {
    fn of(sensor: &Mounted) -> Self {
        let parameters = sensor.device.model().parameters();
        Self {
            name: sensor.name.clone(),
            kind: sensor.device.kind().name(),
            mount: [sensor.mount.x_m, sensor.mount.y_m, sensor.mount.theta_rad.to_degrees()],
            rays: sensor.bearings_rad.len(),
            every: sensor.every,
            noise: parameters.into_iter().flat_map(|parameters| parameters.noise).collect(),
        }
    }
}

/// The robot of the scene.
#[derive(Debug, Serialize)]
pub(super) struct Robot {
    pub radius_m: f64,
    pub speed_m_s: f64,
    pub turn_rate_rad_s: f64,
    pub scan_interval_s: f64,
}

impl Parts {
    /// What a run was made from and what it found.
    pub(super) fn of(
        options: &RoomOptions,
        ground: &Ground,
        mappers: &[&Entry],
        stages: &[Stage],
        claims: &[Claim],
    ) -> Self {
        Self {
            seed: options.seed,
            configuration: Configuration {
                scene: options.scene.display().to_string(),
                layout: ground.scene.layout,
                seeds: options.seeds,
                mappers: mappers.iter().map(|entry| entry.name).collect(),
                programs: options.programs.record(),
                prior: options.prior.prior(),
                reconciliation: options.prior.reconciliation(),
                max_range_m: options.cut.max_range_m,
                sensor: ground.scene.matcher,
                columns: ground.scene.camera.columns,
                field_of_view_rad: ground.scene.camera.field_of_view_rad,
                sensors: ground.scene.sensors.iter().map(Carried::of).collect(),
                robot: Robot::of(&ground.scene),
                drives: options.drives,
            },
            grid: ground.scene.grid,
            stages: stages.to_vec(),
            claims: claims.to_vec(),
            pictures: options.paper.asked(),
        }
    }
}

impl Robot {
    /// The robot of `scene`.
    pub(super) fn of(scene: &Scene) -> Self {
        let robot = &scene.robot;
        Self {
            radius_m: robot.radius_m,
            speed_m_s: robot.speed_m_s,
            turn_rate_rad_s: robot.turn_rate_rad_s,
            scan_interval_s: robot.scan_interval_s,
        }
    }
}
