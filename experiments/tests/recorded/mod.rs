//! A drive through the room with a laser in the place of its camera.

use std::fmt::Write as _;
use std::path::Path;

use experiments::worlds::ground::Ground;
use grid::{DigitalLine, Raster};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use scene::TimedPose;
use sensor::{Laser, Scan};

/// Beams of a scan, one degree from each other.
pub(crate) const BEAMS: usize = 181;

/// The room.
pub(crate) fn room() -> Ground {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
    Ground::new(scene::load(&path, None, None).expect("valid"), 0.1).expect("drivable")
}

/// A layout of a family.
#[allow(dead_code, reason = "tests and a benchmark take some of them each")]
pub(crate) fn layout(family: &str, layout: u64) -> Ground {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../scenes/{family}.toml"));
    Ground::new(scene::load(&path, None, Some(layout)).expect("valid"), 0.1).expect("drivable")
}

/// Twenty rooms: the furnished one and layouts of the families.
#[allow(dead_code, reason = "tests and a benchmark take some of them each")]
pub(crate) fn rooms() -> Vec<Ground> {
    let families = ["clutter", "halls", "two-rooms", "corridors", "closets"];
    let others = (1..20).map(|number| layout(families[number as usize % families.len()], number));
    std::iter::once(room()).chain(others).collect()
}

/// So many scans, at most, of a laser on a drive, spread evenly over it.
#[allow(dead_code, reason = "tests and a benchmark take some of them each")]
pub(crate) fn scans(ground: &Ground, laser: &Laser, seed: u64, count: usize) -> Vec<Scan> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let bearings_rad: Vec<f64> = (0..BEAMS).map(|beam| (beam as f64 - 90.0).to_radians()).collect();
    let every = ground.drive.poses.len().div_ceil(count);
    let scan = |timed: &TimedPose| {
        let pose = timed.pose;
        let mut read = |bearing: &f64| {
            let hit = ground.world.cast(pose.position_m(), pose.direction(*bearing)).map(|hit| hit.range_m);
            Some(laser.sample(hit, &mut rng))
        };
        let readings = bearings_rad.iter().map(&mut read).collect();
        Scan { sensor: 0, time_s: timed.time_s, pose, bearings_rad: bearings_rad.clone(), readings }
    };
    ground.drive.poses.iter().step_by(every).map(scan).collect()
}

#[allow(dead_code, reason = "tests and a benchmark take some of them each")]
/// What a laser of up to 20 m records: a CARMEN log of every `every`-th pose, and the cells that a beam could see.
pub(crate) fn recorded(ground: &Ground, laser: &Laser, every: usize) -> (String, Raster<bool>) {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut log = "# simulated\nPARAM robot_front_laser_max 20.0\n".to_owned();
    let mut seen = Raster::filled(*ground.truth.spec(), false);
    let mut line = DigitalLine::default();
    for timed in ground.drive.poses.iter().step_by(every) {
        let pose = timed.pose;
        let _ = write!(log, "FLASER {BEAMS}");
        for beam in 0..BEAMS {
            let bearing = (beam as f64 - 90.0).to_radians();
            let hit = ground.world.cast(pose.position_m(), pose.direction(bearing)).map(|hit| hit.range_m);
            let until_m = hit.unwrap_or(20.0) + 1e-6;
            line.trace(&ground.scene.grid, pose.position_m(), pose.direction(bearing), until_m);
            line.cells().iter().for_each(|cell| seen[*cell] = true);
            let reading = laser.sample(hit, &mut rng);
            let _ = write!(log, " {:.3}", if reading.is_finite() { reading.min(19.99) } else { 20.0 });
        }
        let place = format!("{:.4} {:.4} {:.5}", pose.x_m, pose.y_m, pose.theta_rad);
        let time = 100.0 + timed.time_s;
        let _ = writeln!(log, " {place} {place} {time:.3} robot {time:.3}");
    }
    (log, seen)
}
