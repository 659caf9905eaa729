//! Scene files, the simulated world, the robot's drive, readings and ground truth.
//!
//! A [`Scene`] is read from a TOML file (its form: README.md of this crate) and is valid once it
//! exists: every check is made at that one door, and every problem is a [`SceneError`] with file,
//! line and column. From a scene follow
//!
//! - [`World`], in which parry casts rays, [`World::cast`], and discs are driven, [`World::collision`];
//! - [`drive`], in which rapier moves the robot along the route, and people, doors and chairs beside it, and finds what blocks it;
//!   [`Motion`] is where everything was at each scan;
//! - [`simulate`], which gives the readings of a seed, whatever the number of threads;
//! - [`features`], the vertical edges that a camera can find, and [`observe`], what it measures of them;
//! - [`truth`], the cells that are really occupied, and [`truth_at_centres`], those occupied where
//!   their centres are; [`covered_at`], those that moving things cover at a scan.
//!
//! A [`Family`] makes a scene of every layout number, with furniture of a given mean size that keeps
//! off the route; [`load`] takes a file of either form. [`from_map`] and [`from_plan`] make a scene file of a
//! robot's map or a floor plan, with a route that [`survey`] plans.
//!
//! Lengths are in metres, angles in radians, counter-clockwise from the x axis.

mod boxes;
mod drive;
mod enclosure;
mod error;
mod family;
mod features;
mod file;
mod floor_plan;
mod from_map;
mod gap;
mod generate;
mod geometry;
mod load;
mod memory;
mod motion;
mod mounted;
mod odometry;
mod scene;
mod shape;
mod simulate;
mod survey;
mod things;
mod truth;
mod warning;
mod world;

pub use drive::{Drive, TimedPose, drive};
/// What other files than scenes share with them: the camera's table, the limits of their numbers, and other values in the
/// place of a file's own.
pub mod reader {
    pub use crate::file::camera::{CLUSTERING, NOISE, stereo};
    pub use crate::file::edit::{Given, Override, with};
    pub use crate::file::limits;
    pub use crate::file::sensors::{DEPTH, ECHO};
}

pub use enclosure::{Enclosure, enclosure};
pub use error::{Problem, SceneError};
pub use family::{Family, Set, Variation};
pub use features::{Feature, FeatureTruth, ObservedFeatures, features, in_view, observe};
pub use floor_plan::{FloorPlan, FloorPlanError};
pub use from_map::{MadeScene, MakeError, from_map, from_plan};
pub use load::{examine, load};
pub use memory::available as available_memory;
pub use motion::{Motion, ThingKind};
pub use mounted::{Mounted, SeenBy};
pub use odometry::Odometry;
pub use scene::{Area, Obstacle, Origin, Region, Robot, Scene, StagePlan, Stop, Waypoint};
pub use shape::Shape;
pub use simulate::{BesideScan, Look, SimulatedScan, Simulation, Stage, simulate};
pub use strict::{ErrorKind, Place};
pub use survey::{Progress, Survey, SurveyError, SurveyOptions, Watch, survey, survey_watched};
pub use things::{Behaviour, Chair, ChairMove, Door, Due, Mover, Opening, Repeat};
pub use truth::{covered_at, truth, truth_at_centres};
pub use warning::Warning;
pub use world::{Hit, World};
