//! What can be wrong with a scene.

use std::io;

use grid::GridError;
use grid::ros_map::RosMapError;
use strict::{ErrorKind, Place};
use thiserror::Error;

use crate::floor_plan::FloorPlanError;

/// Why there is no scene, or no drive through it. Every message is one line: place, value, bound, what to do.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The scene file cannot be opened or read.
    #[error("{file}: cannot be read: {source}; check the path and the permissions")]
    Unreadable {
        /// The file as the caller named it.
        file: String,
        /// What the system reports.
        source: io::Error,
    },
    /// The file's content is wrong.
    #[error("{place}: {problem}")]
    Invalid {
        /// Where.
        place: Place,
        /// What is wrong.
        problem: Box<Problem>,
    },
}

impl SceneError {
    /// A problem at a place of the scene file.
    pub(crate) fn at(place: Place, problem: Problem) -> Self {
        Self::Invalid { place, problem: Box::new(problem) }
    }

    /// Where it is, unless the file cannot be read at all.
    pub fn place(&self) -> Option<&Place> {
        match self {
            Self::Unreadable { .. } => None,
            Self::Invalid { place, .. } => Some(place),
        }
    }

    /// What the error comes from.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable { source, .. } => ErrorKind::of(source),
            Self::Invalid { problem, .. } => match &**problem {
                Problem::Map(RosMapError::Unreadable { source, .. })
                | Problem::Plan(FloorPlanError::Unreadable { source, .. }) => ErrorKind::of(source),
                _ => ErrorKind::BadInput,
            },
        }
    }
}

impl From<strict::Error> for SceneError {
    fn from(error: strict::Error) -> Self {
        match error {
            strict::Error::Unreadable { file, source } => Self::Unreadable { file, source },
            strict::Error::Invalid { place, problem } => Self::at(place, Problem::File(*problem)),
        }
    }
}

/// What is wrong with the content of a scene file. `element` names its part, such as `box 3`.
#[derive(Debug, Error)]
#[allow(missing_docs)] // The fields are what the messages say.
pub enum Problem {
    /// What any file can have wrong: no text, no TOML, a key, a value.
    #[error("{0}")]
    File(strict::Problem),
    /// A name that is not declared.
    #[error("{element}: no waypoint `{name}`{hint}; known waypoints: {known}")]
    UnknownWaypoint { element: String, name: String, hint: String, known: String },
    /// A polygon whose sides meet.
    #[error(
        "{element}: sides {first} and {second} meet: must be an outline that does not touch itself (side k runs from point k to the next); put the points in order or make two polygons of it"
    )]
    Crossing { element: String, first: usize, second: usize },
    /// A name given twice.
    #[error("{element}: name = \"{name}\": must differ from the name in line {line}; choose another")]
    Duplicate { element: String, name: String, line: usize },
    /// Something reaches out of the scene.
    #[error("{element}: {}: must lie within the bounds, {} to {} m; move it or widen [bounds]", reach(.extent), point(.bounds[0]), point(.bounds[1]))]
    OutsideBounds { element: String, extent: [[f64; 2]; 2], bounds: [[f64; 2]; 2] },
    /// A waypoint at which the robot would touch something.
    #[error("waypoint {name} = {}: {} {obstacle}: must be at least {} m away (the robot's radius and {} m to spare); move the waypoint or the obstacle", point(*.at), gap(.distance_m), metres(.needed_m), metres(.spare_m))]
    NoRoom { name: String, at: [f64; 2], obstacle: String, distance_m: f64, needed_m: f64, spare_m: f64 },
    /// A map that cannot be read.
    #[error("[map]: {0}")]
    Map(RosMapError),
    /// A floor plan that cannot be read.
    #[error("[plan]: {0}")]
    Plan(FloorPlanError),
    /// Two places in one.
    #[error("[plan] beside [map]: must be one of the two; take the other out")]
    MapAndPlan,
    /// No grid can be made.
    #[error("{element}: cell = {cell_m} m: {source}")]
    Grid { element: String, cell_m: f64, source: GridError },
    /// More cells than memory holds.
    #[error("{element}: cell = {cell_m} m makes {columns} x {rows} = {cells} cells, about {}: must fit the {} that are free; use larger cells or smaller [bounds]", size(.bytes), size(.available))]
    Memory { element: String, cell_m: f64, columns: usize, rows: usize, cells: usize, bytes: u64, available: u64 },
    /// A family where a scene is wanted.
    #[error("describes a family of scenes, not a scene; ask for one of its layouts, or take [generate] out")]
    IsFamily,
    /// A layout of what is no family.
    #[error(
        "layout {layout} was asked for: must be a family of scenes to have layouts; leave the layout out, or add [generate]"
    )]
    NoFamily { layout: u64 },
    /// A family without room for its own furniture.
    #[error("[generate]: layout {layout} finds no room in {attempts} attempts: must hold obstacles of {} m over {covered} of the floor beside a route with {} m on either side; lower covered, obstacle_size or clearance, or make the place larger", metres(.obstacle_m), metres(.needed_m))]
    NoLayout { layout: u64, attempts: usize, obstacle_m: f64, covered: f64, needed_m: f64 },
    /// A family without room for its people.
    #[error(
        "[generate]: layout {layout} finds no room for its people: must hold up to {most} per 100 m²; lower people_per_100_m2 or covered, or make the place larger"
    )]
    Crowded { layout: u64, most: f64 },
    /// A route that would never end.
    #[error("[route]: about {scans:.3e} scans of {columns} columns: must be at most {limit} scans whose readings fit the {} that are free; drive faster, shorten the route, or scan less often", size(.available))]
    TooLong { scans: f64, columns: usize, limit: usize, available: u64 },
    /// A name of no stage.
    #[error("{element}: no stage `{name}`{hint}; known stages: {known}")]
    UnknownStage { element: String, name: String, hint: String, known: String },
    /// Something that moves is, at its start or later, where something else is.
    #[error("{element}: {what} {} {other}: must be at least {} m away; move one of them", gap(.distance_m), metres(.needed_m))]
    Touches { element: String, what: String, other: String, distance_m: f64, needed_m: f64 },
    /// A mover's way that leads through an obstacle.
    #[error("{element}: the way {} -> {} leads {} {other}: must keep {} m from every obstacle (the mover's reach and {} m to spare); move a point, or add one that leads round it", point(*.from), point(*.to), gap(.distance_m), metres(.needed_m), metres(.spare_m))]
    WayThrough {
        element: String,
        from: [f64; 2],
        to: [f64; 2],
        other: String,
        distance_m: f64,
        needed_m: f64,
        spare_m: f64,
    },
    /// Something that moves stands in the robot's way for longer than the robot waits.
    #[error("[route]: the way {from} -> {to} is blocked at {} by {thing}, for {patience_s} s: must be free within patience_s = {patience_s}; send it elsewhere, or give [robot] more patience", point(*.at))]
    Jammed { from: String, to: String, at: [f64; 2], thing: String, patience_s: f64 },
    /// A drive among things that would take too long to work out.
    #[error(
        "[route]: the drive takes more than {limit_s} s: must be at most that where something moves; drive faster, or wait for less long"
    )]
    TooLongAmong { limit_s: f64 },
    /// Something stands in the way.
    #[error("[route]: the way {from} -> {to} is blocked at {} by {obstacle}: must leave {} m on either side (the robot's radius and {} m to spare); move a waypoint or the obstacle, or add a stop that leads round it", point(*.at), metres(.needed_m), metres(.spare_m))]
    Blocked { from: String, to: String, at: [f64; 2], obstacle: String, needed_m: f64, spare_m: f64 },
}

/// Metres to the millimetre where that says enough, so that messages stay readable.
pub(crate) fn metres(value: &f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    let digits = || format!("{value:.2e}").parse().map_or_else(|_| value.to_string(), |few: f64| format!("{few:e}"));
    if rounded.abs() > 0.0 { format!("{rounded}") } else { digits() }
}

fn point(at: [f64; 2]) -> String {
    let [x, y] = at.map(|v| if v.abs() < 5e-4 { "0".to_owned() } else { metres(&v) });
    format!("[{x}, {y}]")
}

fn reach([min, max]: &[[f64; 2]; 2]) -> String {
    let (low, high) = (point(*min), point(*max));
    if low == high { format!("lies at {low} m") } else { format!("reaches from {low} to {high} m") }
}

fn gap(distance_m: &f64) -> String {
    if *distance_m > 1e-9 { format!("{} m from", metres(distance_m)) } else { "inside".to_owned() }
}

/// A number of bytes in the largest unit that keeps it above one.
fn size(value: &u64) -> String {
    const UNITS: [&str; 5] = ["B", "KiB", "MiB", "GiB", "TiB"];
    let mut value = *value as f64;
    let mut unit = 0;
    while value >= 1024.0 && unit + 1 < UNITS.len() {
        value /= 1024.0;
        unit += 1;
    }
    format!("{value:.1} {}", UNITS[unit])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(point([0.1 + 0.2, -1e-17]), "[0.3, 0]");
        assert_eq!(metres(&1e-6), "1e-6");
        assert_eq!((size(&512), size(&(3 << 30))), ("512.0 B".to_owned(), "3.0 GiB".to_owned()));
    }

    #[test]
    fn a_wrong_name_is_the_users_a_refusal_the_systems() {
        let error = |kind: io::ErrorKind| SceneError::Unreadable { file: "s.toml".to_owned(), source: kind.into() };
        assert_eq!(error(io::ErrorKind::NotFound).kind(), ErrorKind::BadInput);
        assert_eq!(error(io::ErrorKind::PermissionDenied).kind(), ErrorKind::Io);
    }
}
