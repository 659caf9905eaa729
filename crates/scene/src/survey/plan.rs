//! What is asked of a survey, and what comes of it.

use grid::Raster;
use sensor::Camera;
use thiserror::Error;

use crate::Robot;

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
                patience_s: 60.0,
                jitter_m: 0.0,
                jitter_rad: 0.0,
            },
            camera: Camera { columns: 120, field_of_view_rad: 80f64.to_radians() },
            clearance_m: 0.05,
            range_m: 4.0,
            max_length_m: None,
            start_m: None,
        }
    }
}

/// How far the work is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// What is being done, in a few words.
    pub step: &'static str,
    /// How much of this step is done ...
    pub done: usize,
    /// ... of how much.
    pub of: usize,
}

/// Is told how far the work is, from any thread.
pub type Watch<'a> = &'a (dyn Fn(Progress) + Sync);

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
    /// No cell is occupied.
    #[error(
        "none of its {cells} cells is occupied ({free} are free, {unknown} unknown): must have obstacles for rays to end on; correct the thresholds or negate in its YAML file"
    )]
    NoOccupied { cells: usize, free: usize, unknown: usize },
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
