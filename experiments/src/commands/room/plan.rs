//! What a room is mapped by.

use mapper::Model;
use mapper::catalogue::Entry;

use super::options::RoomOptions;
use crate::failure::Failure;
use crate::jobs::memory;
use crate::page;
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::ground::{Driven, Ground};
use crate::worlds::mappers::entries;
use crate::worlds::site::{Assumptions, Site};

/// Everything that a trial needs, from the options.
pub(super) struct RoomPlan {
    pub(super) ground: Ground,
    pub(super) mappers: Vec<&'static Entry>,
    pub(super) setup: Model,
    /// Scans after which the report shows the maps.
    pub(super) frames: Vec<usize>,
}

impl RoomPlan {
    pub(super) fn of(options: &RoomOptions) -> Result<Self, Failure> {
        let mappers = entries(&options.mappers, &options.programs)?;
        let scene = scene::load(&options.scene, options.grid, options.layout)?;
        let assumed = Assumptions { max_range_m: options.cut.max_range_m, ..Assumptions::of(&options.prior) };
        let Site { ground, setup } = Site::of(scene, &AS_BELIEVED, &assumed)?;
        let ground = ground.with_drives(&options.drives, Driven::EveryStage);
        Ok(Self { frames: page::every_moment(&ground, mappers.len()), ground, mappers, setup })
    }
}

/// Refuses more cells than memory holds with what is kept of every mapper: its maps of every stage (f64) and frame (a byte a
/// cell), in each of the trials that run at once.
pub(super) fn refuse_too_large(
    options: &RoomOptions,
    ground: &Ground,
    mappers: &[&Entry],
    setup: &Model,
    frames: usize,
) -> Result<(), Failure> {
    let grid = &ground.scene.grid;
    let copies = ground.scene.stages.len() + 1 + frames.div_ceil(8);
    let at_once = rayon::current_num_threads().min(options.seeds as usize);
    let planned = if ground.planning.pairs > 0 { mappers.len().min(rayon::current_num_threads()) } else { 0 };
    let besides = memory::besides(grid) + planned as f64 * memory::of_drives(grid);
    let bytes = at_once as f64 * (memory::of_mapping(grid, mappers, setup, copies) + besides);
    let remedy = "use larger cells (--grid), fewer mappers, or fewer --threads with several seeds";
    memory::refuse(&options.scene.display().to_string(), grid, bytes, remedy)
}

/// Claims are made about free cells: a region without any is a mistake in the scene.
pub(super) fn claimable(ground: &Ground, options: &RoomOptions) -> Result<(), Failure> {
    for region in ground.scene.regions.iter().filter(|region| region.claims) {
        let mask = region.mask(ground.truth.spec());
        if !mask.values().iter().zip(ground.truth.values()).any(|(inside, truth)| *inside && *truth == Some(false)) {
            return Err(Failure::BadInput(format!(
                "{}: region {}: has claims = true but no free cell of {} m; make it larger, move it, or leave the claims out",
                options.scene.display(),
                region.name,
                ground.scene.grid.cell_m
            )));
        }
    }
    Ok(())
}
