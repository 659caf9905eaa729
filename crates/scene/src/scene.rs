//! A valid scene: plain values.

use std::fmt;

use grid::{GridSpec, Raster};
use sensor::{Camera, Matcher};
use strict::Place;

use crate::geometry::distance;
use crate::mounted::{Mounted, SeenBy};
use crate::odometry::Odometry;
use crate::shape::Shape;
use crate::things::{Chair, Door, Mover};
use crate::warning::Warning;

/// A room, a robot and its way through it, as a scene file describes them. Valid by construction:
/// [`Scene::load`] and [`Scene::parse`] are the only ways to one.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Scene {
    /// Short name, fit for file names.
    pub name: String,
    /// One line about it, possibly empty.
    pub description: String,
    /// Its number in its family, if it comes from one.
    pub layout: Option<u64>,
    /// Lower-left and upper-right corner, m.
    pub bounds_m: [[f64; 2]; 2],
    /// The cells that cover the bounds.
    pub grid: GridSpec,
    /// Everything that stands in the scene.
    pub obstacles: Vec<Obstacle>,
    /// For a scene from a map, in the map's own cells, or from a floor plan: whether it knows what is there.
    pub known: Option<Raster<bool>>,
    /// Named points, in the order of the file.
    pub waypoints: Vec<Waypoint>,
    /// The route: at least two stops.
    pub stops: Vec<Stop>,
    /// When the maps are looked at, in the order of the route; the last is the route's end.
    pub stages: Vec<StagePlan>,
    /// Named sets of cells to score.
    pub regions: Vec<Region>,
    /// Everything that walks.
    pub movers: Vec<Mover>,
    /// Everything that turns about a hinge.
    pub doors: Vec<Door>,
    /// Everything that stands elsewhere later.
    pub chairs: Vec<Chair>,
    /// Fixes every chance of what moves; the readings have a seed of their own.
    pub motion_seed: u64,
    /// The camera's columns; none in a scene without a camera.
    pub camera: Camera,
    /// The camera's noise.
    pub matcher: Matcher,
    /// The sensors beside the camera, numbered from 1.
    pub sensors: Vec<Mounted>,
    /// The robot.
    pub robot: Robot,
    /// The robot's odometry, where the scene has one.
    pub odometry: Option<Odometry>,
    /// What is suspicious about the scene, nothing where all is well.
    pub warnings: Vec<Warning>,
}

/// Something that rays end on and the robot cannot pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Obstacle {
    /// What it covers.
    pub shape: Shape,
    /// Factor on the detection rate of readings on it, 0 to 1.
    pub texture: f64,
    /// Which sensors' readings end on it.
    pub seen_by: SeenBy,
    /// Where it comes from, for messages.
    pub origin: Origin,
}

/// Which part of the scene file an obstacle comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// `wall`, `box`, `disc`, `polygon`, `map box` or `plan wall`; `mover`, `door` or `chair`.
    pub kind: &'static str,
    /// Its number among those of its kind, from 1.
    pub number: usize,
    /// Its line in the scene file, from 1.
    pub line: usize,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} (line {})", self.kind, self.number, self.line)
    }
}

/// A named point.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoint {
    /// Its name.
    pub name: String,
    /// Where it is, m.
    pub at_m: [f64; 2],
}

/// A stop of the route.
#[derive(Debug, Clone, PartialEq)]
pub struct Stop {
    /// Index into [`Scene::waypoints`].
    pub waypoint: usize,
    /// How long the robot stands there, s.
    pub wait_s: f64,
    /// Where the file names it.
    pub place: Place,
}

/// A moment of the drive at which the maps are looked at.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StagePlan {
    /// Short name, fit for file names.
    pub name: String,
    /// What figures call it.
    pub label: String,
    /// It ends on arrival at this many stops, the first one counted.
    pub stops: usize,
}

/// A named set of cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Its name.
    pub name: String,
    /// What it covers.
    pub area: Area,
    /// Whether the paper's claims about its region X are made for it: seen from near first, and only from far later.
    pub claims: bool,
}

/// What a region covers, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Area {
    /// A disc.
    Disc {
        /// Its middle.
        center_m: [f64; 2],
        /// Its radius.
        radius_m: f64,
    },
    /// An upright rectangle.
    Rectangle {
        /// Lower-left corner.
        min_m: [f64; 2],
        /// Upper-right corner.
        max_m: [f64; 2],
    },
}

/// The robot: a disc that turns on the spot and drives straight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Robot {
    /// Its radius, m.
    pub radius_m: f64,
    /// Driving, m/s.
    pub speed_m_s: f64,
    /// Turning on the spot, rad/s.
    pub turn_rate_rad_s: f64,
    /// Time between scans, s.
    pub scan_interval_s: f64,
    /// How long it stands before what moves and is in its way, s, until the drive is blocked.
    pub patience_s: f64,
    /// Standard deviation of either coordinate of the recorded place while it stands, m.
    pub jitter_m: f64,
    /// Standard deviation of its recorded heading while it stands, rad.
    pub jitter_rad: f64,
}

impl Scene {
    /// The waypoint of the stop with the given number, from 0.
    pub fn waypoint_of(&self, stop: usize) -> &Waypoint {
        &self.waypoints[self.stops[stop].waypoint]
    }

    /// Whether anything moves in it but the robot.
    pub fn moves(&self) -> bool {
        !(self.movers.is_empty() && self.doors.is_empty() && self.chairs.is_empty())
    }
}

impl Region {
    /// The cells whose centres lie in the region.
    pub fn mask(&self, spec: &GridSpec) -> Raster<bool> {
        Raster::new(*spec, (0..spec.cells()).map(|cell| self.area.contains(spec.centre(cell))).collect())
    }
}

impl Area {
    /// Whether `point` (m) lies in the area, its border included.
    pub fn contains(&self, point: [f64; 2]) -> bool {
        match *self {
            Self::Disc { center_m, radius_m } => distance(point, center_m) <= radius_m,
            Self::Rectangle { min_m, max_m } => (0..2).all(|k| min_m[k] <= point[k] && point[k] <= max_m[k]),
        }
    }

    /// Lower-left and upper-right corner of the smallest upright rectangle around it, m.
    pub fn extent_m(&self) -> [[f64; 2]; 2] {
        match *self {
            Self::Disc { center_m: [x, y], radius_m: r } => [[x - r, y - r], [x + r, y + r]],
            Self::Rectangle { min_m, max_m } => [min_m, max_m],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn masks_hold_the_cells_whose_centres_lie_within() {
        let spec = GridSpec { cell_m: 0.01, origin_m: [0.0; 2], width: 200, height: 100 };
        let disc =
            Region { name: "X".to_owned(), area: Area::Disc { center_m: [1.0, 0.5], radius_m: 0.3 }, claims: false };
        let held = disc.mask(&spec).values().iter().filter(|&&v| v).count() as f64;
        assert!((held * 1e-4 - std::f64::consts::PI * 0.09).abs() < 1e-3, "{held} cells");
        let upright = Area::Rectangle { min_m: [0.3, 0.2], max_m: [0.605, 0.406] };
        let held = Region { name: "Y".to_owned(), area: upright, claims: false }.mask(&spec);
        assert_eq!(held.values().iter().filter(|&&v| v).count(), 31 * 21);
        assert!(held[spec.locate([0.35, 0.25]).expect("inside")]);
    }
}
