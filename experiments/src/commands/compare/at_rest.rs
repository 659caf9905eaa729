//! What people cost of everything that they do not touch: static accuracy beside that of the same world at rest.

use grid::Raster;
use score::{Comparison, MovingRegion, Region};

use super::plan::Plan;
use super::rows::Rested;
use super::sheets::Width;
use super::world::{AtRest, WorldJob, WorldScores};
use crate::failure::Failure;
use crate::page::{Cell, Sheet};
use crate::worlds::condition::{AS_BELIEVED, PEOPLE};
use crate::worlds::ground::Ground;
use crate::worlds::run::{Keep, Run, Trial};
use crate::worlds::site::{Site, WorldId};

/// Maps the same layout with the same seed and nobody in it, by the mappers of a trial of the condition people; nothing of other conditions. The drive is another one, since
/// nobody is in its way, and so are the readings.
///
/// # Errors
/// A family without such a layout; a mapper that gives something else than probabilities.
pub(super) fn of(plan: &Plan, job: &WorldJob, ground: &Ground, trial: &Trial) -> Result<Vec<AtRest>, Failure> {
    let Some(regions) = trial.moving.last().filter(|_| job.world.condition == PEOPLE.name) else {
        return Ok(Vec::new());
    };
    let world = WorldId { condition: AS_BELIEVED.name.to_owned(), ..job.world.clone() };
    let Site { ground: still, setup } = plan.site(&WorldJob { world, batch: job.batch })?;
    let rested = still.trial(job.world.seed, &job.mappers(&plan.mappers), &setup, &Keep::default(), &|_, _| {})?;
    let place = MovingRegion::ALL.iter().position(|region| *region == MovingRegion::Static).unwrap_or(0);
    let seen = rested.seen.mask(Region::Observable);
    let judged = Raster::new(
        *regions.spec(),
        (0..regions.spec().cells()).map(|cell| regions[cell] >> place & 1 == 1 && seen[cell]).collect(),
    );
    let right = |map: &Raster<f64>| {
        let is_right = |cell: &usize| match ground.still()[*cell] {
            Some(true) => map[*cell] > score::threshold::HELD_OCCUPIED,
            Some(false) => map[*cell] < score::threshold::HELD_OCCUPIED,
            None => false,
        };
        (0..judged.spec().cells()).filter(|cell| judged[*cell]).filter(is_right).count()
    };
    let cells = judged.values().iter().filter(|inside| **inside).count();
    let both = trial.runs.iter().zip(&rested.runs);
    let judge = |(moving, rest): (&Run, &Run)| {
        let ends = [moving.stages.last()?, rest.stages.last()?];
        let is_there = cells > 0 && ends.iter().all(|end| end.fault.is_none());
        let [moving_right, rest_right] = ends.map(|end| right(&end.occupancy));
        let at_rest = AtRest { mapper: moving.mapper.to_owned(), cells, moving: moving_right, rest: rest_right };
        is_there.then_some(at_rest)
    };
    Ok(both.filter_map(judge).collect())
}

/// A row for every mapper: means over worlds, and points less with their interval, where worlds are enough for one.
pub(super) fn rows(worlds: &[WorldScores], mappers: &[&str]) -> Vec<Rested> {
    let row = |mapper: &&str| {
        let of: Vec<&AtRest> =
            worlds.iter().flat_map(|world| &world.at_rest).filter(|one| one.mapper == *mapper).collect();
        let share =
            |right: fn(&AtRest) -> usize| of.iter().map(|one| right(one) as f64 / one.cells as f64).collect::<Vec<_>>();
        let (moving, rest) = (share(|one| one.moving), share(|one| one.rest));
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let interval = Comparison::of(&rest, &moving).ok().map(|comparison| comparison.interval);
        (!of.is_empty()).then(|| Rested {
            mapper: (*mapper).to_owned(),
            worlds: of.len(),
            static_accuracy: mean(&moving),
            at_rest: mean(&rest),
            points_less: 100.0 * (mean(&rest) - mean(&moving)),
            low: interval.map(|interval| 100.0 * interval.low),
            high: interval.map(|interval| 100.0 * interval.high),
        })
    };
    mappers.iter().filter_map(row).collect()
}

/// As it is shown; none where nothing moves.
pub(super) fn sheet(rows: &[Rested], width: Width) -> Option<Sheet> {
    let line = |row: &Rested| {
        let interval = match (row.low, row.high) {
            (Some(low), Some(high)) => format!("[{low:+.2}, {high:+.2}]"),
            _ => "-".to_owned(),
        };
        vec![
            Cell::from(row.mapper.as_str()),
            format!("{:.3}", row.static_accuracy).into(),
            format!("{:.3}", row.at_rest).into(),
            format!("{:+.2}", row.points_less).into(),
            interval.into(),
        ]
    };
    (!rows.is_empty()).then(|| Sheet {
        caption: "Static accuracy among people and in the same worlds at rest".to_owned(),
        note: match width {
            Width::Terminal => String::new(),
            Width::Page => "the same layouts and seeds with nobody in them, on the cells that are static there and seen at rest; points less with their 95 % interval".to_owned(),
        },
        heads: ["mapper", "static", "at rest", "points less", "95 % interval"].map(str::to_owned).to_vec(),
        rows: rows.iter().map(line).collect(),
    })
}
