//! A covering route through a grid of free, occupied and unknown cells.
//!
//! The robot may stand where its disc keeps `radius_m + clearance_m` from every cell that is not free
//! ([`space`]). Of that, the largest connected part is driven: viewpoints are chosen greedily until they see
//! the floor ([`viewpoints`]), joined into a short tour over the grid ([`tour`]), and the tour is made of
//! straight legs ([`route`]). The robot's camera looks ahead, so short legs are added that turn it to what it
//! would miss, and what is claimed to be seen is what the camera's rays cross on that drive ([`sight`]).

mod distance;
mod looks;
mod route;
mod sight;
pub(crate) mod space;
mod tour;
mod viewpoints;

pub(crate) use route::length_m;

use grid::Raster;
use sensor::Camera;
use thiserror::Error;

use crate::Robot;
use sight::Sight;
use space::Space;

/// What a survey is asked for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurveyOptions {
    /// The robot.
    pub robot: Robot,
    /// The camera, which looks ahead.
    pub camera: Camera,
    /// What the robot keeps from everything beside its radius, m; from 0.005, so that rounding to the millimetre is safe.
    pub clearance_m: f64,
    /// A cell counts as seen up to this range, m.
    pub range_m: f64,
    /// The route is cut at this length, m.
    pub max_length_m: Option<f64>,
    /// Where to begin, m; chosen for a short route where none is given.
    pub start_m: Option<[f64; 2]>,
}

impl Default for SurveyOptions {
    fn default() -> Self {
        Self {
            robot: Robot {
                radius_m: 0.2,
                speed_m_s: 0.55,
                turn_rate_rad_s: std::f64::consts::FRAC_PI_4,
                scan_interval_s: 0.3,
            },
            camera: Camera { columns: 120, field_of_view_rad: 80f64.to_radians() },
            clearance_m: 0.05,
            range_m: 4.0,
            max_length_m: None,
            start_m: None,
        }
    }
}

/// A route and what is seen from it.
#[derive(Debug, Clone, PartialEq)]
pub struct Survey {
    /// The stops in order, m, to the millimetre; at least two. Every leg between them is clear.
    pub stops_m: Vec<[f64; 2]>,
    /// Length of the route, m.
    pub length_m: f64,
    /// Area that the robot's centre can reach, m².
    pub drivable_m2: f64,
    /// The floor: free cells that the robot reaches, or that lie round what it reaches.
    pub floor: Raster<bool>,
    /// Share of the floor that the camera's rays cross on the way, within the range.
    pub seen: f64,
    /// Whether the route was cut at the length asked for.
    pub cut: bool,
}

/// Why there is no route.
#[derive(Debug, Error)]
#[allow(missing_docs)] // The fields are what the messages say.
pub enum SurveyError {
    /// No cell is free.
    #[error(
        "none of its {cells} cells is free ({occupied} are occupied, {unknown} unknown): must have free space to drive in; correct the thresholds or negate in its YAML file"
    )]
    NoFree { cells: usize, occupied: usize, unknown: usize },
    /// The robot fits nowhere, or has no way to go.
    #[error(
        "a robot of radius {radius_m} m with {clearance_m} m to spare {fits} among {free} free cells of {cell_m} m: must reach two cells to have a route; give a smaller --radius or --clearance"
    )]
    NoRoom { radius_m: f64, clearance_m: f64, fits: &'static str, free: usize, cell_m: f64 },
    /// It cannot begin there.
    #[error(
        "start {x_m},{y_m}: must lie in the largest space that the robot can reach; the nearest place there is {:.3},{:.3}", nearest[0], nearest[1]
    )]
    Start { x_m: f64, y_m: f64, nearest: [f64; 2] },
}

/// Plans a covering route through `cells` (`Some(true)` occupied, `None` unknown). The same input gives the
/// same route, whatever the number of threads.
///
/// # Errors
/// A map without free space, or in which the robot cannot move; a start outside the space it can reach.
pub fn survey(cells: &Raster<Option<bool>>, options: &SurveyOptions) -> Result<Survey, SurveyError> {
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
    let viewpoints = viewpoints::choose(&space, &sight, start);
    let tour = tour::order(&space, viewpoints, start.is_some());
    let route = looks::add(&space, &sight, route::straight(&space, &tour), options);
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
