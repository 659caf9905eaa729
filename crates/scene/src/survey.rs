//! A covering route through a grid of free, occupied and unknown cells.
//!
//! The robot may stand where its disc keeps `radius_m + clearance_m` from every cell that is not free
//! ([`space`]). Of that, the largest connected part is driven: viewpoints are chosen greedily until they see
//! the floor ([`viewpoints`]), joined into a short tour over the grid ([`tour`]), and the tour is made of
//! straight legs ([`route`]). The robot's camera looks ahead, so short legs are added that turn it to what it
//! would miss, and what is claimed to be seen is what the camera's rays cross on that drive ([`sight`]).

mod looks;
mod plan;
mod route;
mod sight;
pub(crate) mod space;
mod tour;
mod view;
mod viewpoints;

pub(crate) use route::length_m;

use grid::Raster;

pub use plan::{Progress, Survey, SurveyError, SurveyOptions, Watch};
use sight::Sight;
use space::Space;

/// Plans a covering route through `cells` (`Some(true)` occupied, `None` unknown). The same input gives the
/// same route, whatever the number of threads.
///
/// # Errors
/// A map without free space, or in which the robot cannot move; a start outside the space it can reach.
pub fn survey(cells: &Raster<Option<bool>>, options: &SurveyOptions) -> Result<Survey, SurveyError> {
    survey_watched(cells, options, &|_| {})
}

/// As [`survey`]; `progress` is told how far it is.
///
/// # Errors
/// As [`survey`].
pub fn survey_watched(
    cells: &Raster<Option<bool>>,
    options: &SurveyOptions,
    progress: Watch,
) -> Result<Survey, SurveyError> {
    let spec = *cells.spec();
    let count = |state: Option<bool>| cells.values().iter().filter(|&&c| c == state).count();
    let free = count(Some(false));
    if free == 0 {
        return Err(SurveyError::NoFree { cells: spec.cells(), occupied: count(Some(true)), unknown: count(None) });
    }
    let space = Space::new(cells, options.robot.radius_m + options.clearance_m);
    let room = space.drivable().count();
    if room < 2 {
        let fits = if room == 0 { "fits nowhere" } else { "cannot move anywhere" };
        let (radius_m, clearance_m) = (options.robot.radius_m, options.clearance_m);
        return Err(SurveyError::NoRoom { radius_m, clearance_m, fits, free, cell_m: spec.cell_m });
    }
    let start = options.start_m.map(|at| start(&space, at)).transpose()?;
    let floor = space.floor(cells);
    let sight = Sight::new(cells, &floor, options);
    let viewpoints = viewpoints::choose(&space, &sight, start, progress);
    let tour = tour::order(&space, viewpoints, start.is_some(), progress);
    let route = looks::add(&space, &sight, route::straight(&space, &tour), options, progress);
    let (stops_m, cut) = route::stops_m(&spec, &route, options.max_length_m);
    let seen = sight.seen_on(&stops_m, options);
    let seen = seen.iter().filter(|&&v| v).count() as f64 / sight.floor_cells() as f64;
    Ok(Survey {
        length_m: length_m(&stops_m),
        stops_m,
        drivable_m2: room as f64 * spec.cell_area_m2(),
        floor,
        seen,
        cut,
    })
}

/// The cell of the place to begin.
fn start(space: &Space, at_m: [f64; 2]) -> Result<usize, SurveyError> {
    let spec = space.spec();
    if let Some(cell) = spec.locate(at_m).filter(|&cell| space.holds(cell)) {
        return Ok(cell);
    }
    let far = |cell: usize| crate::geometry::distance(spec.centre(cell), at_m);
    let nearest = space.drivable().min_by(|&a, &b| far(a).total_cmp(&far(b))).map_or(at_m, |cell| spec.centre(cell));
    Err(SurveyError::Start { x_m: at_m[0], y_m: at_m[1], nearest })
}

#[cfg(test)]
mod tests;
