//! Whether a drive is within walls.

use rayon::prelude::*;
use sensor::Pose;

use crate::drive::Drive;
use crate::geometry::distance;
use crate::scene::Scene;
use crate::warning::Warning;
use crate::world::World;

/// Directions all round in which walls are looked for.
const DIRECTIONS: usize = 48;

/// A place is inside if this share of them ends on an obstacle; windows and doors may be open.
const INSIDE: f64 = 0.75;

/// A larger share of rays that end on nothing is suspicious ...
const MOST_OPEN: f64 = 0.5;

/// ... and so is a smaller share of the route inside: of eight maps of real buildings the least is 0.95.
const LEAST_INSIDE: f64 = 0.75;

/// What the rays of a drive end on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Enclosure {
    /// Length of the drive, m.
    pub length_m: f64,
    /// Length of the drive at places from which three quarters of all directions end on an obstacle, m.
    pub inside_m: f64,
    /// Share of all sensors' rays that end on nothing, 0 to 1; 0 of none.
    pub on_nothing: f64,
}

/// Casts the rays of a drive, and rays all round its poses.
pub fn enclosure(scene: &Scene, world: &World, drive: &Drive) -> Enclosure {
    let camera = (Pose::default(), scene.camera.bearings_rad());
    let beside = scene.sensors.iter().map(|sensor| (sensor.mount, sensor.bearings_rad.clone()));
    let sensors: Vec<(Pose, Vec<f64>)> = [camera].into_iter().chain(beside).collect();
    let turn = std::f64::consts::TAU / DIRECTIONS as f64;
    let looks = drive.poses.par_iter().map(|timed| {
        let ends = |bearing: f64| world.cast(timed.pose.position_m(), timed.pose.direction(bearing)).is_some();
        let ended = |(mount, bearings): &(Pose, Vec<f64>)| {
            let at = timed.pose.compose(*mount);
            let ends = |bearing: f64| world.cast(at.position_m(), at.direction(bearing)).is_some();
            bearings.iter().filter(|&&bearing| ends(bearing)).count()
        };
        let ended: usize = sensors.iter().map(ended).sum();
        let round = (0..DIRECTIONS).filter(|&k| ends(k as f64 * turn)).count();
        (ended, round as f64 >= INSIDE * DIRECTIONS as f64)
    });
    let looks: Vec<(usize, bool)> = looks.collect();
    let (mut length_m, mut inside_m) = (0.0, 0.0);
    for (poses, looks) in drive.poses.windows(2).zip(looks.windows(2)) {
        let step_m = distance(poses[0].pose.position_m(), poses[1].pose.position_m());
        length_m += step_m;
        inside_m += if looks.iter().all(|(_, inside)| *inside) { step_m } else { 0.0 };
    }
    let rays = drive.poses.len() * sensors.iter().map(|(_, bearings)| bearings.len()).sum::<usize>();
    let ended: usize = looks.iter().map(|(ended, _)| ended).sum();
    Enclosure { length_m, inside_m, on_nothing: (rays - ended) as f64 / rays.max(1) as f64 }
}

impl Enclosure {
    /// The warning about a drive most of which is outside; `path` is the scene, or what it is made from.
    pub fn warning(&self, path: &std::path::Path) -> Option<Warning> {
        let Self { length_m, inside_m, on_nothing } = *self;
        let open = on_nothing > MOST_OPEN || inside_m < LEAST_INSIDE * length_m;
        open.then(|| Warning::Open { path: path.to_owned(), on_nothing, length_m, inside_m })
    }
}
