//! How well `calibrate` finds the noise of simulated sensors: `cargo bench -p experiments --bench calibrate`, from the top of the project.
//!
//! Prints, for twenty rooms driven through by a laser and as many drives of a stereo camera, the sigma found as a share of the true one, its
//! interval, and how often the interval holds the truth.

#[path = "../tests/recorded/mod.rs"]
#[allow(dead_code, reason = "the tests use the rest")]
mod recorded;

use std::io::Write as _;

use experiments::commands::calibrate::noise::{self, Instrument, Noise};
use sensor::{Laser, Scan};

/// Scans of a log that `calibrate` fits.
const SCANS: usize = 200;

fn main() {
    let rooms = recorded::rooms();
    let mut lasers = Coverage::default();
    for (ground, number) in rooms.iter().zip(0..) {
        let range_sigma_m = [0.01, 0.02, 0.03, 0.05][number as usize % 4];
        let laser = Laser { max_range_m: 20.0, range_sigma_m, hit: 0.9, no_echo: 0.05, early_per_m: 0.01 };
        let scans = recorded::scans(ground, &laser, 100 + number, SCANS);
        lasers.add(&ground.scene.name, range_sigma_m, noise::of(&scans, Instrument::Laser, 0.025));
    }
    lasers.print("a laser");
    let mut cameras = Coverage::default();
    for (ground, seed) in rooms.iter().zip(1..) {
        let drive = scene::simulate(&ground.scene, &ground.world, &ground.drive, seed);
        let all: Vec<Scan> = drive.scans.into_iter().map(|simulated| simulated.scan).collect();
        let every = (all.len() / SCANS).max(1);
        let scans: Vec<Scan> = all.into_iter().step_by(every).take(SCANS).collect();
        let stereo = ground.scene.matcher.stereo;
        cameras.add(&ground.scene.name, stereo.disparity_sigma, noise::of(&scans, Instrument::Stereo(stereo), 0.3));
    }
    cameras.print("a stereo camera");
}

/// How often intervals hold the truth.
#[derive(Default)]
struct Coverage {
    rooms: u32,
    found: u32,
    held: u32,
    half: f64,
    error: f64,
}

impl Coverage {
    fn add(&mut self, name: &str, sigma: f64, noise: Option<Noise>) {
        self.rooms += 1;
        let mut out = std::io::stdout();
        let Some(Noise { sigma: value, interval, readings, share, .. }) = noise else {
            let _ = writeln!(out, "{name:14} {sigma:.2}: too few readings");
            return;
        };
        let [value, low, high] = [value, interval.low, interval.high].map(|found| found / sigma);
        let _ = writeln!(
            out,
            "{name:14} {sigma:.2}: {value:.4} [{low:.4}, {high:.4}], {readings} readings, {share:.3} of them of surfaces"
        );
        self.found += 1;
        self.held += u32::from(low <= 1.0 && 1.0 <= high);
        self.half += 50.0 * (high - low);
        self.error += 100.0 * (value - 1.0);
    }

    fn print(&self, sensor: &str) {
        let Self { rooms, found, held, .. } = self;
        let [half, error] = [self.half, self.error].map(|sum| sum / f64::from((*found).max(1)));
        let mut out = std::io::stdout();
        let _ = writeln!(
            out,
            "{sensor}: {held} of {found} intervals hold the truth ({rooms} rooms); half-width {half:.2} %, error {error:+.2} % on average"
        );
    }
}
