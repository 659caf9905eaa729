//! A drive through the room with a laser in the place of its camera.

use std::fmt::Write as _;
use std::path::Path;

use experiments::worlds::run::Ground;
use grid::{DigitalLine, Raster};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::Laser;

/// Beams of a scan, one degree from each other.
pub(crate) const BEAMS: usize = 181;

/// The room.
pub(crate) fn room() -> Ground {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
    Ground::new(scene::load(&path, None, None).expect("valid"), 0.1).expect("drivable")
}

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
