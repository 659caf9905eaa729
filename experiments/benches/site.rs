//! A site of 1 km x 1 km in cells of 5 cm, driven through with 50,000 scans: `cargo bench -p experiments --bench site`, on
//! Linux, some minutes.
//!
//! A town of blocks and parked cars. The robot drives twice round a ring of streets, 2.6 km; every 10 cm it takes a scan
//! of 100 rays, with the noise-free disparity of what each ray hits. Prints time and memory, and fails where memory
//! follows the site instead of what was seen of it.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use grid::GridSpec;
use mapper::{ConstantIncrements, FastVisibility, LogOdds, Mapper, Model};
use scene::{Scene, World};
use sensor::{Camera, Pose, Scan, Stereo};

const SITE_M: f64 = 1000.0;
const CELL_M: f64 = 0.05;
const SCANS: usize = 50_000;
const CAMERA: Camera = Camera { columns: 100, field_of_view_rad: std::f64::consts::FRAC_PI_2 };

/// Streets are so far apart, m, and so wide.
const PITCH_M: f64 = 50.0;
const STREET_M: f64 = 12.0;

fn main() {
    let scene = Scene::parse(&text(), Path::new("the site"), None).expect("valid");
    let (world, stereo) = (World::new(&scene), Stereo::default());
    let grid = GridSpec::covering([0.0; 2], [SITE_M; 2], CELL_M).expect("as many cells as a map can have");
    let setup = Model::new(grid, Arc::new(stereo));
    let poses: Vec<Pose> = (0..SCANS).map(pose).collect();
    let start = Instant::now();
    let scans: Vec<Scan> =
        poses.iter().enumerate().map(|(number, pose)| scan(number, *pose, &world, &stereo)).collect();
    say(&format!("{SCANS} scans of {} rays in {:.1} s", CAMERA.columns, start.elapsed().as_secs_f64()));

    let mut log_odds = ConstantIncrements::new(&setup, LogOdds::OCTOMAP);
    mapped("log-odds-octomap", &mut log_odds, &scans, grid);
    drop(log_odds);
    let mut visibility = FastVisibility::visibility(&setup);
    mapped("visibility", &mut visibility, &scans, grid);
}

/// Maps the scans and says what that took.
fn mapped(name: &str, mapper: &mut dyn Mapper, scans: &[Scan], grid: GridSpec) {
    let start = Instant::now();
    scans.iter().for_each(|scan| mapper.integrate(scan));
    let seconds = start.elapsed().as_secs_f64();
    let work = mapper.work();
    let share = work.bytes as f64 / grid.cells() as f64;
    say(&format!(
        "{name}: {:.0} scans/s, {:.1} ns per cell updated, {:.0} MB: {share:.2} bytes per cell of the site",
        scans.len() as f64 / seconds,
        1e9 * seconds / work.cells as f64,
        work.bytes as f64 / 1e6,
    ));
    assert!(work.cells as usize > 100 * scans.len() * CAMERA.columns, "every ray crosses cells");
    assert!(share < 4.0, "memory follows what was seen, less than a third of the site's cells with 12 bytes each");
}

/// Blocks with streets round them, and cars along the streets.
fn text() -> String {
    let mut text = format!(
        "name = \"site\"\n[bounds]\nmin = [0.0, 0.0]\nmax = [{SITE_M}, {SITE_M}]\n[grid]\ncell = 1.0\n[waypoints]\nA = [6.0, 6.0]\nB = [6.0, 900.0]\n\
         [route]\nstops = [\"A\", \"B\"]\n"
    );
    let blocks = (SITE_M / PITCH_M) as usize;
    for number in 0..blocks * blocks {
        let corner = [number % blocks, number / blocks].map(|k| k as f64 * PITCH_M + STREET_M);
        let side = PITCH_M - STREET_M;
        let centre = corner.map(|c| c + 0.5 * side);
        let _ = write!(text, "[[box]]\ncenter = [{}, {}]\nsize = [{side}, {side}]\n", centre[0], centre[1]);
        for car in 0..4 {
            let along = corner[1] + 9.0 * f64::from(car) + 3.0 * (number as f64 * 0.618_034).fract();
            let _ = write!(text, "[[box]]\ncenter = [{}, {along:.3}]\nsize = [1.8, 4.5]\n", corner[0] - 1.5);
        }
    }
    text
}

/// Round a square of streets, against the clock.
fn pose(number: usize) -> Pose {
    let [low, high] = [3.0, 16.0].map(|street: f64| street * PITCH_M + 0.4 * STREET_M);
    let side = high - low;
    let (quarter, along) = (0.1 * number as f64 / side, 0.1 * number as f64 % side);
    let [x_m, y_m] = match quarter as usize % 4 {
        0 => [low + along, low],
        1 => [high, low + along],
        2 => [high - along, high],
        _ => [low, high - along],
    };
    Pose { x_m, y_m, theta_rad: quarter.floor() * std::f64::consts::FRAC_PI_2 }
}

fn scan(number: usize, pose: Pose, world: &World, stereo: &Stereo) -> Scan {
    let bearings_rad = CAMERA.bearings_rad();
    let reading = |bearing: &f64| {
        let hit = world.cast(pose.position_m(), pose.direction(*bearing))?;
        Some(stereo.disparity(hit.range_m, *bearing)).filter(|disparity| *disparity <= stereo.max_disparity)
    };
    let readings = bearings_rad.iter().map(reading).collect();
    Scan { sensor: 0, time_s: number as f64, pose, bearings_rad, readings }
}

fn say(line: &str) {
    let _ = writeln!(std::io::stdout(), "{line}");
}
