//! Every world of a comparison as a row: how its maps did, and what to type to make them again.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::plan::Plan;
use super::sheets::OBSERVABLE;
use crate::page::{Cell, Part, Section, Sheet, Viewer};
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::site::WorldId;

/// What a row needs of `scores-MAPPER.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct WorldScore {
    condition: String,
    family: String,
    seed: u64,
    mapper: String,
    region: String,
    log_loss: Option<f64>,
}

const LEAD: &str = "Log loss over all that could be seen, nats per cell, in every world. The worlds that the viewer has are links into it; the \
    command beside any other maps the same readings again, with all its maps on a page of its own.";

/// A row per world.
pub fn section(plan: &Plan, scores: &[WorldScore], viewer: &Viewer) -> Section {
    let mut losses: BTreeMap<(&str, &str, u64, &str), Option<f64>> = BTreeMap::new();
    for score in scores.iter().filter(|score| score.region == OBSERVABLE) {
        losses.insert((&score.condition, &score.family, score.seed, &score.mapper), score.log_loss);
    }
    let mappers = plan.names();
    let row = |world: WorldId| -> Vec<Cell> {
        let loss = |mapper: &&str| {
            let loss = losses.get(&(world.condition.as_str(), world.family.as_str(), world.seed, *mapper));
            Cell::from(loss.copied().flatten().map_or_else(|| "-".to_owned(), |loss| format!("{loss:.3}")))
        };
        let again = again(plan, &world).unwrap_or_else(|| "-".to_owned());
        [named(plan, &world, viewer)].into_iter().chain(mappers.iter().map(loss)).chain([again.into()]).collect()
    };
    let sheet = Sheet {
        caption: "Every world".to_owned(),
        note: String::new(),
        heads: ["world"]
            .into_iter()
            .chain(mappers.iter().copied())
            .chain(["to map it again"])
            .map(str::to_owned)
            .collect(),
        rows: plan.jobs().into_iter().map(|job| row(job.world)).collect(),
    };
    let fold = Part::Fold { summary: format!("{} worlds", sheet.rows.len()), open: true, parts: vec![sheet] };
    Section { heading: "The worlds".to_owned(), lead: LEAD.to_owned(), parts: vec![fold] }
}

/// The name of a world, a link where the viewer has it.
fn named(plan: &Plan, world: &WorldId, viewer: &Viewer) -> Cell {
    let shown = match plan.conditions.len() {
        1 => world.family.clone(),
        _ => format!("{} {}", world.family, world.condition),
    };
    let viewed = viewer.worlds.iter().any(|viewed| viewed.name == shown && viewed.seed == Some(world.seed));
    match viewed {
        true => Cell::link(world.to_string(), format!("#scene={}", shown.replace(' ', "+"))),
        false => world.to_string().into(),
    }
}

/// The command that maps a world again; none of a camera that differs from what mappers believe, which `room` has not.
fn again(plan: &Plan, world: &WorldId) -> Option<String> {
    let family = plan.families.iter().position(|family| family.name == world.family)?;
    let file = plan.paths[family].file_name().filter(|_| plan.paths[family].is_absolute()).map(std::path::Path::new);
    let file = file.unwrap_or(&plan.paths[family]).display();
    let seed = world.seed;
    (world.condition == AS_BELIEVED.name)
        .then(|| format!("sightgrid room --scene {file} --layout {seed} --seed {seed} --out world-{seed}"))
}
