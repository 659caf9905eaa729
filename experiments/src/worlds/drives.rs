//! Which map may I drive on: drives planned on maps, and driven in the world.

use clap::{Args, ValueEnum};
use grid::Raster;
use mapper::{Belief, PairwiseGrid, footprint};
use scene::World;
use score::navigation::{Navigation, NeverSeen, Planning};
use score::{Metric, Region, ScoreError};
use serde::{Deserialize, Serialize};

use crate::output::args::{number, probability};

/// The region that drives lead through.
pub const REGION: Region = Region::All;

/// Drives that are planned on every map.
#[derive(Debug, Clone, Copy, PartialEq, Args, Serialize, Deserialize)]
pub struct DriveOptions {
    /// Pairs of places to drive between, drawn from the truth and the same for every map; 0 for no drives
    #[arg(long, help_heading = "Drives planned on the maps (reached, colliding, detour)", value_name = "N", default_value_t = Planning::default().pairs as u32, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(0..=10_000))]
    #[serde(rename = "pairs")]
    pub plan_pairs: u32,
    /// Radius of the robot's disc in metres [default: that of the scene's robot; 0.2 where the truth is a map]
    #[arg(long, help_heading = "Drives planned on the maps (reached, colliding, detour)", value_name = "M", allow_negative_numbers = true, value_parser = radius)]
    #[serde(rename = "robot_radius_m")]
    pub robot_radius: Option<f64>,
    /// A cell with a greater probability is an obstacle to the planner
    #[arg(long, help_heading = "Drives planned on the maps (reached, colliding, detour)", value_name = "P", default_value_t = Planning::default().threshold, allow_negative_numbers = true, value_parser = probability)]
    #[serde(rename = "threshold")]
    pub plan_threshold: f64,
    /// What a cell is to the planner of which a map knows nothing
    #[arg(long, help_heading = "Drives planned on the maps (reached, colliding, detour)", value_enum, default_value_t)]
    #[serde(rename = "unknown")]
    pub plan_unknown: PlanUnknown,
}

/// Names of [`NeverSeen`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlanUnknown {
    /// an obstacle: collisions then tell of the map, and not of what nobody has seen
    #[default]
    Occupied,
    /// it may be driven on, as planners of Nav2 take it unless told otherwise
    Free,
}

/// As in scene files.
fn radius(text: &str) -> Result<f64, String> {
    number(text, "of metres from 0.001 to 1000", |value| (0.001..=1000.0).contains(&value))
}

impl Default for DriveOptions {
    fn default() -> Self {
        let Planning { pairs, threshold, .. } = Planning::default();
        Self {
            plan_pairs: pairs as u32,
            robot_radius: None,
            plan_threshold: threshold,
            plan_unknown: PlanUnknown::default(),
        }
    }
}

impl DriveOptions {
    /// How drives of a robot are planned, if the options name no other radius.
    pub fn planning(&self, robot_radius_m: f64) -> Planning {
        let never_seen = match self.plan_unknown {
            PlanUnknown::Free => NeverSeen::Free,
            PlanUnknown::Occupied => NeverSeen::Occupied,
        };
        Planning {
            pairs: self.plan_pairs as usize,
            robot_radius_m: self.robot_radius.unwrap_or(robot_radius_m),
            threshold: self.plan_threshold,
            never_seen,
            ..Planning::default()
        }
    }
}

/// The metrics of drives on a map, of which it knows the cells of `known`; none where no drives are asked for. Plans are made twice: on the
/// cells of the map, and by the probability that an obstacle stands under the robot ([`footprint`]), which takes the joint probabilities
/// of a map that holds them.
///
/// # Errors
/// As [`Navigation::metrics`].
pub fn metrics(
    navigation: &Navigation,
    world: &World,
    map: &Raster<f64>,
    pairs: Option<&PairwiseGrid>,
    known: &Raster<bool>,
) -> Result<Vec<Metric>, ScoreError> {
    let radius_m = navigation.clearance_m();
    let is_clear = |path_m: &[[f64; 2]]| world.collision(path_m, radius_m).is_none();
    let by_cells = navigation.metrics(map, known, is_clear)?;
    let belief = pairs.map_or(Belief::Cells(map), Belief::Chain);
    let footprint = footprint::occupied(belief, navigation.robot_radius_m());
    let by_footprint = navigation.metrics_by_footprint(&footprint, known, is_clear)?;
    Ok(by_cells.into_iter().chain(by_footprint).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::scenes::path_of;

    /// A map that is the truth, in the shipped worlds: their walls and furniture stand off the grid.
    #[test]
    fn the_truth_reaches_all_an_empty_map_collides_and_a_full_one_reaches_nothing() {
        for name in ["room", "clutter", "halls", "uma"] {
            let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path_of(name));
            let scene = scene::load(&path, None, None).expect("a scene");
            let (world, truth) = (World::new(&scene), scene::truth(&scene));
            let planning = DriveOptions::default().planning(scene.robot.radius_m);
            let navigation = Navigation::new(&truth, planning);
            assert_eq!(navigation.pairs(), 200, "{name}");
            for at in navigation.places().iter().flatten() {
                assert_eq!(world.collision(&[*at], planning.robot_radius_m - 1e-6), None, "{name}: {at:?} is free");
            }
            let of = |map: Raster<f64>| {
                let found = metrics(&navigation, &world, &map, None, &map.map(|_| true)).expect("a map");
                <[Option<f64>; 6]>::try_from(found.iter().map(|metric| metric.value).collect::<Vec<_>>()).expect("six")
            };
            let certain = truth.map(|cell| if *cell == Some(true) { 1.0 } else { 0.0 });
            assert_eq!(of(certain), [Some(1.0), Some(0.0), Some(1.0), Some(1.0), Some(0.0), Some(1.0)], "{name}");
            assert_eq!(of(truth.map(|_| 1.0)), [Some(0.0), Some(0.0), None, Some(0.0), Some(0.0), None], "{name}");
            let [reached, colliding, _, again, collide, _] = of(truth.map(|_| 0.0)).map(|value| value.unwrap_or(0.0));
            assert!(colliding > 0.3 && (reached + colliding - 1.0).abs() < 1e-12, "{name}: {reached} {colliding}");
            assert!(
                (again - reached).abs() < 1e-12 && (collide - colliding).abs() < 1e-12,
                "{name}: {again} {collide}"
            );
        }
    }
}
