//! The drives that are planned on every map.

use scene::World;
use score::navigation::{APART_M, Navigation, NeverSeen, Planning};

use super::candidate::Scorable;
use super::options::ScoreOptions;
use super::rows::Row;
use super::truth::Truth;
use crate::failure::Failure;
use crate::worlds::drives;

/// The drives that are planned on every map, and the world in which they are driven.
pub(super) struct Drives {
    planning: Planning,
    navigation: Navigation,
    world: World,
}

impl Drives {
    /// Draws the drives from the truth; none where none are asked for.
    pub(super) fn of(truth: &Truth, options: &ScoreOptions) -> Option<Self> {
        let planning = planning(truth, options);
        let world = || truth.scene.as_ref().map_or_else(|| World::of_cells(&truth.cells), World::new);
        (planning.pairs > 0).then(|| {
            let navigation = Navigation::new(&truth.cells, planning);
            Self { planning, navigation, world: world() }
        })
    }

    /// Plans them on a map and drives them.
    pub(super) fn rows(&self, name: &str, map: &Scorable) -> Result<Vec<Row>, Failure> {
        let metrics = drives::metrics(&self.navigation, &self.world, &map.occupancy, &map.known)?;
        let region = drives::REGION.name();
        let row = |metric| Row { map: name.to_owned(), region: region.to_owned(), metric };
        Ok(metrics.map(row).to_vec())
    }

    /// What was driven, in words.
    pub(super) fn worded(&self) -> String {
        let Planning { robot_radius_m, threshold, never_seen, .. } = self.planning;
        let unknown = match never_seen {
            NeverSeen::Occupied => "an obstacle",
            NeverSeen::Free => "free",
        };
        match self.navigation.pairs() {
            0 => format!(
                "No drives: the truth has no two places {APART_M} m apart or more between which a robot of radius {robot_radius_m} m can drive."
            ),
            pairs => format!(
                "{pairs} drives of a robot of radius {robot_radius_m} m: planned where a map has no more than {threshold}, what it does not know being {unknown}, and driven in the truth."
            ),
        }
    }
}

/// How drives are planned: the robot is that of the scene, if there is one.
pub(super) fn planning(truth: &Truth, options: &ScoreOptions) -> Planning {
    let robot_radius_m = truth.scene.as_ref().map_or(Planning::default().robot_radius_m, |scene| scene.robot.radius_m);
    options.drives.planning(robot_radius_m)
}
