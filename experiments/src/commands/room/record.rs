//! What a run was made from: `run.json`.

use std::collections::BTreeMap;

use grid::GridSpec;
use mapper::catalogue::Entry;
use mapper::{Prior, Reconciliation};
use scene::Scene;
use sensor::Matcher;
use serde::Serialize;

use super::options::RoomOptions;
use crate::output::record::versions;
use crate::worlds::claims::Claim;
use crate::worlds::run::{Ground, Stage};

/// The merged configuration of a run and the versions that its numbers depend on. Nothing in it
/// changes from one run to the next.
#[derive(Debug, Serialize)]
pub(super) struct Record {
    /// Version of this form.
    pub schema_version: u32,
    /// Name of the command.
    pub command: &'static str,
    /// First seed.
    pub seed: u64,
    /// Everything that was set, by default, file or command line.
    pub configuration: Configuration,
    /// The cells of the maps.
    pub grid: GridSpec,
    /// When the maps were looked at.
    pub stages: Vec<Stage>,
    /// What was claimed and found.
    pub claims: Vec<Claim>,
    /// This program and the packages that decide the numbers.
    pub versions: BTreeMap<String, String>,
    /// Every file of the run.
    pub files: Vec<String>,
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
    /// What the mappers believe before the first reading.
    pub prior: Prior,
    /// What becomes of edges on no ray.
    pub reconciliation: Reconciliation,
    /// The simulated sensor, which the mappers know.
    pub sensor: Matcher,
    /// Image columns.
    pub columns: usize,
    /// Field of view, rad.
    pub field_of_view_rad: f64,
    /// The robot.
    pub robot: Robot,
}

/// The robot of the scene.
#[derive(Debug, Serialize)]
pub(super) struct Robot {
    pub radius_m: f64,
    pub speed_m_s: f64,
    pub turn_rate_rad_s: f64,
    pub scan_interval_s: f64,
}

impl Record {
    /// The record of a run of which the files are not known yet.
    pub(super) fn of(
        options: &RoomOptions,
        ground: &Ground,
        mappers: &[&Entry],
        stages: &[Stage],
        claims: &[Claim],
    ) -> Self {
        Self {
            schema_version: 1,
            command: "room",
            seed: options.seed,
            configuration: Configuration {
                scene: options.scene.display().to_string(),
                layout: ground.scene.layout,
                seeds: options.seeds,
                mappers: mappers.iter().map(|entry| entry.name).collect(),
                prior: options.prior.prior(),
                reconciliation: options.prior.reconciliation(),
                sensor: ground.scene.matcher,
                columns: ground.scene.camera.columns,
                field_of_view_rad: ground.scene.camera.field_of_view_rad,
                robot: Robot::of(&ground.scene),
            },
            grid: ground.scene.grid,
            stages: stages.to_vec(),
            claims: claims.to_vec(),
            versions: versions(),
            files: Vec::new(),
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
