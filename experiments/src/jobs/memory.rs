//! Memory: estimated before the work, and told in a line where it runs out.

use std::panic::{self, AssertUnwindSafe, catch_unwind, resume_unwind};

use grid::{GridSpec, NoMemory};
use mapper::Model;
use mapper::catalogue::Entry;

use crate::failure::Failure;

/// Side of the map that a mapper is weighed on, cells.
const SIDE: usize = 64;

/// What there is besides maps, bytes per cell: the truth, what was seen, pictures.
const BESIDES: f64 = 24.0;

/// Planning drives on a map, bytes per cell: what is free, the steps between, and the costs of ways; and the places they lead between.
const DRIVES: f64 = 24.0;

/// A map that is shown while it is being made, bytes per cell: a copy of its occupancy.
const COPY: f64 = 8.0;

/// A pair of neighbours, bytes per cell: the marginal and two edges.
const PAIRS: f64 = 24.0;

/// What mapping the cells at once by all of these takes, bytes: what the mappers hold, and `copies` of the map of each.
pub(crate) fn of_mapping(grid: &GridSpec, mappers: &[&Entry], setup: &Model, copies: usize) -> f64 {
    let small = GridSpec { width: SIDE.min(grid.width), height: SIDE.min(grid.height), ..*grid };
    let setup = Model { grid: small, ..setup.clone() };
    let per_cell = |entry: &&Entry| {
        let mapper = (entry.build)(&setup);
        let pairs = if mapper.pairwise().is_some() { PAIRS } else { 0.0 };
        mapper.work().bytes as f64 / small.cells() as f64 + pairs + COPY * copies as f64
    };
    grid.cells() as f64 * mappers.iter().map(per_cell).sum::<f64>()
}

/// What the cells take besides the mappers, bytes.
pub(crate) fn besides(grid: &GridSpec) -> f64 {
    grid.cells() as f64 * BESIDES
}

/// What planning drives on a map takes besides, bytes.
pub(crate) fn of_drives(grid: &GridSpec) -> f64 {
    grid.cells() as f64 * DRIVES
}

/// Refuses a map that memory does not hold.
///
/// # Errors
/// More bytes than there are, with both numbers and the remedy.
pub(crate) fn refuse(place: &str, grid: &GridSpec, bytes: f64, remedy: &str) -> Result<(), Failure> {
    refuse_above(scene::available_memory(), place, grid, bytes, remedy)
}

fn refuse_above(available: u64, place: &str, grid: &GridSpec, bytes: f64, remedy: &str) -> Result<(), Failure> {
    if bytes <= available as f64 {
        return Ok(());
    }
    let GridSpec { width, height, cell_m, .. } = grid;
    Err(Failure::BadInput(format!(
        "{place}: a map of {width} x {height} cells of {cell_m} m may take {:.1} GB of memory: must fit the {:.1} GB that are \
         free; {remedy}",
        bytes / 1e9,
        available as f64 / 1e9
    )))
}

/// Does the work; memory that the system does not give for the cells of a grid is a failure in one line, and no panic.
///
/// # Errors
/// Those of the work, and [`NoMemory`].
pub(crate) fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> Result<(), Failure> {
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        if !info.payload().is::<NoMemory>() {
            usual(info);
        }
    }));
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|payload| match payload.downcast::<NoMemory>() {
        Ok(error) => Err(Failure::Internal(error.to_string())),
        Err(payload) => resume_unwind(payload),
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use mapper::catalogue::{MAPPERS, find};
    use sensor::Stereo;

    use super::*;

    fn grid(width: usize) -> GridSpec {
        GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height: 200 }
    }

    #[test]
    fn an_estimate_is_at_least_what_a_mapper_holds_before_its_first_scan() {
        for entry in MAPPERS {
            let model = Model::new(grid(300), Arc::new(Stereo::default()));
            let (held, estimate) = ((entry.build)(&model).work().bytes, of_mapping(&model.grid, &[entry], &model, 1));
            assert!(estimate >= held as f64 * 0.9, "{}: {estimate} {held}", entry.name);
            let wide = of_mapping(&grid(600), &[entry], &model, 1);
            assert!((wide / estimate - 2.0).abs() < 1e-9, "in proportion to the cells");
        }
        let model = Model::new(grid(300), Arc::new(Stereo::default()));
        let both = [find("visibility"), find("conventional")].map(|entry| entry.expect("known"));
        let sum: f64 = both.iter().map(|entry| of_mapping(&model.grid, &[entry], &model, 2)).sum();
        assert!((of_mapping(&model.grid, &both, &model, 2) / sum - 1.0).abs() < 1e-9);
    }

    #[test]
    fn what_does_not_fit_is_refused_with_both_numbers_and_the_remedy() {
        assert!(refuse_above(2_000_000_000, "a.log", &grid(300), 1.9e9, "use larger cells").is_ok());
        let refused =
            refuse_above(2_000_000_000, "a.log", &grid(300), 2.5e9, "use larger cells").expect_err("too much");
        let text = "a.log: a map of 300 x 200 cells of 0.1 m may take 2.5 GB of memory: must fit the 2.0 GB that are free; use \
                    larger cells";
        assert!(matches!(&refused, Failure::BadInput(said) if said == text), "{refused}");
    }
}
