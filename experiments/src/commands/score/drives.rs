//! Which of the maps may I drive on.

use scene::World;
use score::navigation::{APART_M, Navigation, Planning};
use score::{Metric, Region};

use super::candidate::Scorable;
use super::options::ScoreOptions;
use super::rows::{Difference, Row};
use super::scored::{Scored, ScoredMap};
use super::truth::Truth;
use crate::failure::Failure;
use crate::output::table::{aligned, wrapped};
use crate::page::Sheet;
use crate::worlds::criteria::{Criterion, criterion};
use crate::worlds::drives;

/// What is shown: metrics of drives, and what a threshold finds of surfaces.
const SHOWN: [&str; 5] = ["reached", "colliding", "detour", "recall_50", "recall_65"];

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
    fn worded(&self) -> String {
        let Planning { robot_radius_m, threshold, .. } = self.planning;
        match self.navigation.pairs() {
            0 => format!(
                "No drives: the truth has no two places {APART_M} m apart or more between which a robot of radius {robot_radius_m} m can drive."
            ),
            pairs => format!(
                "{pairs} drives of a robot of radius {robot_radius_m} m, planned where a map has no more than {threshold}, and driven in the truth."
            ),
        }
    }
}

/// How drives are planned: the robot is that of the scene, if there is one.
pub(super) fn planning(truth: &Truth, options: &ScoreOptions) -> Planning {
    let robot_radius_m = truth.scene.as_ref().map_or(Planning::default().robot_radius_m, |scene| scene.robot.radius_m);
    options.drives.planning(robot_radius_m)
}

/// The drives on a map less those on the first: the same pairs, without an interval, since they are all of one world.
pub(super) fn differences([own, first]: [&ScoredMap; 2]) -> Vec<Difference> {
    let region = drives::REGION.name();
    let difference = |metric: &&'static str| {
        let [ours, theirs] = [find(&own.rows, region, metric)?, find(&first.rows, region, metric)?];
        Some(Difference {
            map: own.name.clone(),
            baseline: first.name.clone(),
            region: region.to_owned(),
            metric,
            unit: ours.unit,
            difference: ours.value.zip(theirs.value).map(|(ours, theirs)| ours - theirs),
            interval: None,
            tiles: 0,
            cells: ours.support.min(theirs.support),
        })
    };
    SHOWN[..3].iter().filter_map(difference).collect()
}

/// The table for reading, within eighty columns.
pub(super) fn text(scored: &Scored, drives: &Drives, width: usize) -> String {
    let Sheet { caption, heads, rows, .. } = sheet(scored, drives);
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let rows: Vec<Vec<String>> = rows.iter().map(|row| row.iter().map(|cell| cell.text.clone()).collect()).collect();
    let worded = wrapped(&drives.worded(), width).join("\n");
    format!("\n{caption}\n{}{worded}\n", aligned(&heads, &rows))
}

/// The table for a page.
pub(super) fn sheet(scored: &Scored, drives: &Drives) -> Sheet {
    let shown: Vec<&Criterion> = SHOWN.iter().filter_map(|metric| criterion(metric)).collect();
    let row = |map: &ScoredMap| {
        let value = |c: &&Criterion| {
            let region = c.region.unwrap_or(Region::All).name();
            let value = find(&map.rows, region, c.metric).and_then(|metric| metric.value);
            value.map_or_else(|| "-".to_owned(), |value| format!("{value:.*}", c.decimals)).into()
        };
        [super::text::short(&map.name).into()].into_iter().chain(shown.iter().map(value)).collect()
    };
    Sheet {
        caption: "Which map may I drive on".to_owned(),
        note: drives.worded(),
        heads: ["map"].into_iter().chain(shown.iter().map(|c| c.title)).map(str::to_owned).collect(),
        rows: scored.maps.iter().map(row).collect(),
    }
}

fn find<'a>(rows: &'a [Row], region: &str, metric: &str) -> Option<&'a Metric> {
    rows.iter().find(|row| row.region == region && row.metric.name == metric).map(|row| &row.metric)
}
