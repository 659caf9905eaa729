//! A world of every family to look into: its maps as they grew.

use super::plan::Plan;
use super::world::{WorldJob, WorldScores};
use crate::failure::Failure;
use crate::jobs::engine;
use crate::page::{self, Viewer};
use crate::worlds::run::Keep;
use crate::worlds::site::Site;

/// The first world of every family under every condition that is shown: of several conditions the first
/// family's, since a page has room for a few worlds.
pub fn jobs(plan: &Plan) -> Vec<WorldJob> {
    let jobs = plan.jobs().into_iter().take(plan.families.len() * plan.conditions.len());
    match plan.conditions.len() {
        1 => jobs.collect(),
        _ => jobs
            .filter(|job| job.world.family == plan.families[0].name && SHOWN.contains(&job.world.condition.as_str()))
            .collect(),
    }
}

/// The conditions to look into: the two that differ most from each other, and the one nearest to a real camera; of suites of sensors, a camera, and all.
const SHOWN: [&str; 5] = ["match-0.6", "sigma-2", "clusters", "camera", "all-three"];

/// Maps these worlds again, keeping their maps on the way; gives their scores too, in the same order.
///
/// # Errors
/// As [`Site::of_family`]; a mapper that gives something else than probabilities.
pub fn look(plan: &Plan) -> Result<(Viewer, Vec<WorldScores>), Failure> {
    let shown = engine::each(&jobs(plan), rayon::current_num_threads(), |job| {
        let Site { ground, setup } = plan.site(job)?;
        let frames = page::moments(&ground, page::FRAMES);
        let keep = Keep { timeline: false, frames: frames.clone() };
        let trial = ground.trial(job.world.seed, &job.mappers(&plan.mappers), &setup, &keep, &|_, _| {})?;
        let stages = ground.stages(&trial);
        let mut world = page::ViewedWorld::new(&ground, &trial, &stages, &frames)?;
        if plan.conditions.len() > 1 {
            world.name = format!("{} {}", world.name, job.world.condition);
        }
        Ok((world, job.score(&ground, &trial)?))
    })?;
    let (worlds, scores) = shown.into_iter().unzip();
    Ok((Viewer { worlds, budget: page::WORLDS_BYTES }, scores))
}
