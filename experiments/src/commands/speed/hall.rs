//! The scans that are mapped where no file is given: a drive round a hall of boxes.

use std::fmt::Write as _;
use std::path::Path;

use scene::{Scene, World};
use sensor::{Camera, Pose, Scan};

use super::scans::ScanSet;
use crate::failure::Failure;

/// Scans of the drive.
pub const SCANS: usize = 360;

/// Rays of each.
pub const RAYS: usize = 200;

/// Side of the hall, m.
const SIDE_M: f64 = 40.0;

/// Boxes stand about so far apart, m, in both directions; lanes are midway between them.
const PITCH_M: f64 = 2.5;

/// What is around the boxes.
const FRAME: &str = r#"
name = "speed-hall"
[bounds]
min = [0.0, 0.0]
max = [40.0, 40.0]
[[wall]]
from = [0.05, 0.05]
to = [39.95, 0.05]
thickness = 0.1
[[wall]]
from = [39.95, 0.05]
to = [39.95, 39.95]
thickness = 0.1
[[wall]]
from = [39.95, 39.95]
to = [0.05, 39.95]
thickness = 0.1
[[wall]]
from = [0.05, 39.95]
to = [0.05, 0.05]
thickness = 0.1
[waypoints]
A = [6.25, 6.25]
B = [33.75, 6.25]
C = [33.75, 33.75]
D = [6.25, 33.75]
E = [6.25, 8.75]
[route]
stops = ["A", "B", "C", "D", "E"]
[camera]
columns = 200
field_of_view_deg = 90.0
[robot]
radius = 0.1
speed = 1.0
scan_interval = 0.25
"#;

/// The hall, and the places that scans are made from.
pub struct Hall {
    world: World,
    poses: Vec<Pose>,
    field_of_view_rad: f64,
}

impl Hall {
    /// The same on every machine.
    ///
    /// # Errors
    /// None but a defect.
    pub fn new() -> Result<Self, Failure> {
        let scene = Scene::parse(&text(), Path::new("the hall of speed"), None).map_err(Failure::internal)?;
        let drive = scene::drive(&scene).map_err(Failure::internal)?.poses;
        let poses = (0..SCANS).map(|k| drive[k * (drive.len() - 1) / (SCANS - 1)].pose).collect();
        Ok(Self { world: World::new(&scene), poses, field_of_view_rad: scene.camera.field_of_view_rad })
    }

    /// All scans.
    pub fn scans(&self) -> ScanSet {
        let mut set = ScanSet::default();
        self.poses.iter().for_each(|pose| self.add(&mut set, *pose, RAYS));
        set
    }

    /// The first scan alone, with so many rays over the same angle.
    pub fn scan(&self, rays: usize) -> Scan {
        let mut set = ScanSet::default();
        self.add(&mut set, self.poses[0], rays);
        set.scans.remove(0)
    }

    fn add(&self, set: &mut ScanSet, pose: Pose, columns: usize) {
        set.begin(pose);
        for bearing in (Camera { columns, field_of_view_rad: self.field_of_view_rad }).bearings_rad() {
            let hit = self.world.cast(pose.position_m(), pose.direction(bearing));
            set.ray(bearing, hit.map(|hit| hit.range_m));
        }
    }
}

/// The scene as a file: boxes of different sizes, turned and moved from where they would stand in line by sequences
/// that never repeat (multiples of the golden section and its kin).
fn text() -> String {
    let mut text = FRAME.to_owned();
    let lines = (SIDE_M / PITCH_M) as usize - 1;
    for number in 0..lines * lines {
        let at = |line: usize| PITCH_M * (line + 1) as f64;
        let drawn = |factor: f64| (number as f64 * factor).fract();
        let (x, y) =
            (at(number % lines) + 0.5 * drawn(0.618_034) - 0.25, at(number / lines) + 0.5 * drawn(0.754_878) - 0.25);
        let (width, depth) = (0.3 + 0.5 * drawn(0.569_84), 0.3 + 0.5 * drawn(0.819_173));
        let _ = write!(
            text,
            "[[box]]\ncenter = [{x:.3}, {y:.3}]\nsize = [{width:.3}, {depth:.3}]\nrotation_deg = {:.1}\n",
            90.0 * drawn(0.671_044)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_ray_is_read_and_crosses_about_175_cells() {
        let set = Hall::new().expect("valid").scans();
        let visited = set.visited(&set.grid(0.05).expect("small"));
        assert_eq!((set.scans.len(), set.rays(), visited.rays), (SCANS, SCANS * RAYS, 72_000));
        let mean = visited.cells as f64 / visited.rays as f64;
        assert!((170.0..180.0).contains(&mean), "{mean} cells per ray");
    }
}
