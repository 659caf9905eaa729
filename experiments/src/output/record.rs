//! What a run was made from: `run.json`.

use std::collections::BTreeMap;

use grid::GridSpec;
use mapper::Prior;
use mapper::Reconciliation;
use scene::Scene;
use sensor::Matcher;
use serde::Serialize;

use crate::worlds::claims::Claim;

/// The merged configuration of a run and the versions that its numbers depend on. Nothing in it
/// changes from one run to the next.
#[derive(Debug, Serialize)]
pub struct Record {
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
}

/// The merged configuration.
#[derive(Debug, Serialize)]
pub struct Configuration {
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
#[expect(missing_docs, reason = "the names say it, with units")]
pub struct Robot {
    pub radius_m: f64,
    pub speed_m_s: f64,
    pub turn_rate_rad_s: f64,
    pub scan_interval_s: f64,
}

/// A moment at which the maps were looked at.
#[derive(Debug, Clone, Serialize)]
pub struct Stage {
    /// Short name.
    pub name: String,
    /// What figures call it.
    pub label: String,
    /// After so many scans.
    pub scans: usize,
}

impl Robot {
    /// The robot of `scene`.
    pub fn of(scene: &Scene) -> Self {
        let robot = &scene.robot;
        Self {
            radius_m: robot.radius_m,
            speed_m_s: robot.speed_m_s,
            turn_rate_rad_s: robot.turn_rate_rad_s,
            scan_interval_s: robot.scan_interval_s,
        }
    }
}

/// Packages whose version can move a number.
const DECISIVE: [&str; 6] = ["libm", "parry2d-f64", "rand", "rand_chacha", "rand_distr", "rapier2d-f64"];

/// The versions of this program and of the packages that decide its numbers, from the lock file it
/// was built with.
pub fn versions() -> BTreeMap<String, String> {
    let mut versions = BTreeMap::from([("experiments".to_owned(), env!("CARGO_PKG_VERSION").to_owned())]);
    let lock: toml::Table = include_str!("../../../Cargo.lock").parse().unwrap_or_default();
    for package in lock.get("package").and_then(|p| p.as_array()).into_iter().flatten() {
        let text = |key: &str| package.get(key).and_then(toml::Value::as_str);
        if let (Some(name), Some(version)) = (text("name"), text("version"))
            && DECISIVE.contains(&name)
        {
            versions.insert(name.to_owned(), version.to_owned());
        }
    }
    versions
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_lock_file_names_every_decisive_package() {
        assert_eq!(super::versions().len(), super::DECISIVE.len() + 1, "{:?}", super::versions());
    }
}
