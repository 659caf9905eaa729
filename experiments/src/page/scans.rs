//! The scans that a page draws: where they were taken, what they read, and how far their rays went.

use grid::{DigitalLine, Raster};
use scene::{Look, Mounted, SimulatedScan};
use score::NUDGE_M;
use sensor::{Device, Pose, Scan};

use crate::worlds::ground::Ground;

/// What readings are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReadingUnit {
    /// Disparities of a stereo camera, px; focal length times baseline, px·m.
    Disparity(f64),
    /// Ranges, m.
    Range,
}

/// Scans of one world, in order of time.
#[derive(Debug, Clone)]
pub struct Scans {
    /// What readings are.
    pub unit: ReadingUnit,
    /// The scans.
    pub scans: Vec<Scan>,
    /// Of simulated ones, what is true of every ray.
    pub truth: Option<Vec<Vec<TrueRay>>>,
}

/// What a sensor of several read along the drive of a world.
#[derive(Debug, Clone)]
pub struct SensorScans {
    /// What it is called.
    pub name: String,
    /// Angle between the edges of the cone of a reading, rad; 0 of rays.
    pub width_rad: f64,
    /// Whether a disparity is of the range along the ray, whatever its bearing: that of a camera that looks all round.
    pub all_round: bool,
    /// Of each scan, the number of the world's scan that it was taken with, from 1; rising.
    pub after: Vec<usize>,
    /// The scans.
    pub scans: Scans,
    /// Of cones, the range beyond which nothing is heard, m.
    pub most_m: Option<f64>,
}

/// What is true of a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrueRay {
    /// Range of the first hit, m; none where there is none.
    pub range_m: Option<f64>,
    /// Number of cells from the sensor to the last one that the ray looked at, both counted, as
    /// [`Sightings::looks`](score::Sightings::looks) counts; 0 of a cone.
    pub reach: u32,
}

impl Scans {
    /// Those of the camera in a simulation on this ground.
    pub fn simulated(scans: &[SimulatedScan], ground: &Ground) -> Self {
        let mut line = DigitalLine::default();
        // From where the robot truly stood: the recorded pose may jitter.
        let scans: Vec<(Scan, &SimulatedScan)> = (ground.drive.poses.iter().zip(scans))
            .map(|(timed, simulated)| (Scan { pose: timed.pose, ..simulated.scan.clone() }, simulated))
            .collect();
        let of_scan = |(number, (scan, simulated)): (usize, &(Scan, &SimulatedScan))| {
            let truth = ground.truth_after(number + 1);
            let rays = scan.bearings_rad.iter().zip(&simulated.true_ranges_m);
            let reach = |bearing: f64, range_m: Option<f64>, line: &mut DigitalLine| TrueRay {
                range_m,
                reach: reach(line, scan.pose, &look(bearing, range_m), &truth),
            };
            rays.map(|(bearing, range_m)| reach(*bearing, *range_m, &mut line)).collect()
        };
        Self {
            unit: ReadingUnit::Disparity(ground.scene.matcher.stereo.focal_baseline),
            truth: Some(scans.iter().enumerate().map(of_scan).collect()),
            scans: scans.into_iter().map(|(scan, _)| scan).collect(),
        }
    }
}

/// What a ray looks at that sees as far as there is anything.
fn look(bearing_rad: f64, range_m: Option<f64>) -> Look {
    Look { bearing_rad, range_m, reach_m: f64::INFINITY }
}

impl SensorScans {
    /// Those of the sensors beside the camera in a simulation on this ground.
    pub fn simulated(scans: &[SimulatedScan], ground: &Ground) -> Vec<Self> {
        let all = (1..).zip(&ground.scene.sensors);
        all.map(|(number, sensor)| Self::of(number, sensor, scans, ground)).collect()
    }

    fn of(number: usize, sensor: &Mounted, scans: &[SimulatedScan], ground: &Ground) -> Self {
        let mut line = DigitalLine::default();
        let width_rad = sensor.device.width_rad();
        let (mut after, mut taken, mut truth) = (Vec::new(), Vec::new(), Vec::new());
        for (place, (timed, simulated)) in ground.drive.poses.iter().zip(scans).enumerate() {
            let Some(beside) = simulated.beside.iter().find(|beside| beside.scan.sensor == number) else { continue };
            let pose = beside.mounted_on(timed.pose);
            let seen = ground.truth_after(place + 1);
            // A cone is seen into up to what is nearest in it, wherever that is: its range says all.
            let mut of_ray = |(ray, range_m): (usize, &Option<f64>)| TrueRay {
                range_m: *range_m,
                reach: if width_rad > 0.0 { 0 } else { reach(&mut line, pose, &beside.looks[ray], &seen) },
            };
            truth.push(beside.true_ranges_m.iter().enumerate().map(&mut of_ray).collect());
            after.push(place + 1);
            taken.push(Scan { pose, ..beside.scan.clone() });
        }
        let unit = match sensor.device {
            Device::Stereo(matcher) | Device::Omnidirectional(matcher) => {
                ReadingUnit::Disparity(matcher.stereo.focal_baseline)
            }
            Device::Laser(_) | Device::Sonar(_) | Device::Depth(..) => ReadingUnit::Range,
        };
        Self {
            name: sensor.name.clone(),
            width_rad,
            all_round: matches!(sensor.device, Device::Omnidirectional(_)),
            after,
            scans: Scans { unit, scans: taken, truth: Some(truth) },
            most_m: (width_rad > 0.0).then(|| sensor.device.max_range_m()),
        }
    }
}

/// Number of cells that a ray from a pose looks at: crossed before what it hits or its reach, or the surface that it hits, in this truth.
fn reach(line: &mut DigitalLine, pose: Pose, look: &Look, truth: &Raster<Option<bool>>) -> u32 {
    let range_m = look.range_m.unwrap_or(f64::INFINITY);
    let (is_hit, hit) = (look.range_m.is_some() && range_m <= look.reach_m, range_m.min(look.reach_m));
    line.trace(truth.spec(), pose.position_m(), pose.direction(look.bearing_rad), hit + NUDGE_M);
    let mut last = 0;
    for (k, (&cell, chord)) in line.cells().iter().zip(line.ranges().windows(2)).enumerate() {
        let crossed = chord[1].min(hit) - chord[0] > NUDGE_M;
        let ends = chord[1] >= hit + NUDGE_M;
        if crossed || ends && is_hit && truth[cell] == Some(true) {
            last = k + 1;
        }
        if ends {
            break;
        }
    }
    last as u32
}
