//! Readings of the sensors beside the camera.

use std::ops::Range;

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use sensor::{Device, Pose, Scan, SensorKind, Surface};

use super::standing::images;
use super::{End, Eye, WORDS_PER_RAY};
use crate::Hit;
use crate::mounted::Mounted;

/// Random streams of the seed, far from those of the camera, odometry, and what moves: of the readings of a scan, by sensor.
const READINGS: u64 = u64::MAX - (5 << 32);

/// ... and of what is seen of things that not every reading ends on.
const SEEN: u64 = u64::MAX - (128 << 32);

/// What a cone is sampled by is so far apart at its far end, m, ...
const CONE_STEP_M: f64 = 0.04;

/// ... and so many rays at most.
const MOST_CONE_RAYS: usize = 129;

/// Rays that are this far apart tell how a surface lies, rad.
const NEXT_RAD: f64 = 1e-3;

/// A scan of a sensor beside the camera.
#[derive(Debug, Clone, PartialEq)]
pub struct BesideScan {
    /// What it read.
    pub scan: Scan,
    /// Where it stands on the robot.
    pub mount: Pose,
    /// True range of every ray, m, of a cone that of the nearest thing in it; `None` where that is nothing. A sensor may measure less far.
    pub true_ranges_m: Vec<Option<f64>>,
    /// What each of its rays, or the rays by which a cone is sampled, could see.
    pub looks: Vec<Look>,
}

impl BesideScan {
    /// Where the sensor stands when the robot stands at `robot`.
    pub fn mounted_on(&self, robot: Pose) -> Pose {
        robot.compose(self.mount)
    }
}

/// What a ray could see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Angle to the axis of the sensor, rad.
    pub bearing_rad: f64,
    /// Range of the first thing, m; `None` where there is none.
    pub range_m: Option<f64>,
    /// How far the ray sees, m.
    pub reach_m: f64,
}

/// Which things a ray sees of those that not every reading ends on.
#[derive(Clone, Copy)]
pub(super) struct Sieve<'a> {
    pub(super) eye: &'a Eye<'a>,
    pub(super) kind: SensorKind,
    /// Number of the sensor, 0 of the camera.
    pub(super) sensor: usize,
    pub(super) scan: usize,
}

impl Sieve<'_> {
    /// Whether anything passes through it at all.
    pub(super) fn is_open(&self) -> bool {
        self.eye.scene.obstacles.iter().any(|obstacle| obstacle.seen_by.share(self.kind) < 1.0)
    }

    /// Whether a ray sees an obstacle: always, by the draw of this ray and obstacle, or never.
    pub(super) fn sees(&self, ray: usize, obstacle: usize) -> bool {
        let share = self.eye.scene.obstacles[obstacle].seen_by.share(self.kind);
        if share >= 1.0 {
            return true;
        }
        // A place in the stream for every ray and obstacle, whatever else is drawn.
        let mut rng = stream(self.eye.seed, SEEN - ((self.sensor as u64) << 32), self.scan);
        rng.set_word_pos((ray * self.eye.scene.obstacles.len() + obstacle) as u128 * 2);
        rng.random::<f64>() < share
    }
}

fn stream(seed: u64, first: u64, scan: usize) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(first - scan as u64);
    rng
}

/// What all sensors beside the camera read at a scan; `recorded` is where the robot is said to have stood, and `images` has, of a robot that stands,
/// the scans in which the images were made.
pub(super) fn scans(eye: &Eye, scan: usize, recorded: Pose, images: Option<&Images>) -> Vec<BesideScan> {
    if eye.scene.sensors.is_empty() {
        return Vec::new();
    }
    let things = eye.things(scan);
    let numbered = eye.scene.sensors.iter().zip(1..).filter(|(sensor, _)| sensor.reads_at(scan));
    let image = |number: usize, ray: usize| images.map_or(scan, |images| images.of(number, scan, ray));
    numbered
        .map(|(sensor, number)| read(&things, (scan, recorded), (sensor, number), &|ray| image(number, ray)))
        .collect()
}

/// Of the stereo cameras beside the camera, for every scan of a stand and every ray, the first scan in which the ray ended on the same. Others have no
/// images that repeat.
pub(super) struct Images {
    first: usize,
    /// By sensor, from 1, scan of the stand and ray; nothing of other sensors, and of scans at which a sensor does not read.
    sensors: Vec<Vec<Vec<usize>>>,
}

impl Images {
    /// Of the scans of a stand.
    pub(super) fn of_stand(eye: &Eye, stand: Range<usize>) -> Self {
        let of = |sensor: &Mounted| match sensor.device.kind() {
            SensorKind::Stereo if stand.len() > 1 => {
                let reads: Vec<usize> = stand.clone().filter(|scan| sensor.reads_at(*scan)).collect();
                let ends: Vec<Vec<End>> = reads.iter().map(|scan| ends(&eye.things(*scan), *scan, sensor)).collect();
                let firsts = images(&ends, 0).into_iter();
                let mut by_scan = vec![Vec::new(); stand.len()];
                for (scan, firsts) in reads.iter().zip(firsts) {
                    by_scan[scan - stand.start] = firsts.into_iter().map(|first| reads[first]).collect();
                }
                by_scan
            }
            _ => Vec::new(),
        };
        Self { first: stand.start, sensors: eye.scene.sensors.iter().map(of).collect() }
    }

    fn of(&self, number: usize, scan: usize, ray: usize) -> usize {
        let rays = self.sensors[number - 1].get(scan - self.first);
        rays.and_then(|rays| rays.get(ray)).copied().unwrap_or(scan)
    }
}

/// What the rays of a sensor end on, if every reading ended on all that is there.
fn ends(all: &Things, scan: usize, sensor: &Mounted) -> Vec<End> {
    let at = sensor.pose(all.eye.drive.poses[scan].pose);
    sensor.bearings_rad.iter().map(|&bearing| all.cast(at, bearing, |_| true)).collect()
}

/// What a sensor, and its number, reads at a scan and a recorded pose; `image(ray)` is the scan in which the image of a ray was made.
fn read(
    all: &Things,
    (scan, recorded): (usize, Pose),
    (sensor, number): (&Mounted, usize),
    image: &dyn Fn(usize) -> usize,
) -> BesideScan {
    let eye = all.eye;
    let at = sensor.pose(eye.drive.poses[scan].pose);
    let (device, bearings_rad) = (sensor.device, &sensor.bearings_rad);
    let sieve = Sieve { eye, kind: device.kind(), sensor: number, scan };
    let is_open = sieve.is_open();
    let fan = fan(&device);
    let (mut ends, mut true_ranges_m, mut looks) = (Vec::new(), Vec::new(), Vec::new());
    for (ray, &axis_rad) in bearings_rad.iter().enumerate() {
        let rays = || fan.iter().map(|offset_rad| axis_rad + offset_rad);
        let there: Vec<Option<f64>> =
            rays().map(|b| all.cast(at, b, |_| true).map(|surface| surface.range_m)).collect();
        let nearest = there.iter().flatten().copied().reduce(f64::min);
        // A cone tells nothing of what is behind the nearest thing in it.
        let reach_m = if fan.len() > 1 { nearest.unwrap_or(f64::INFINITY) } else { f64::INFINITY };
        let reach_m = reach_m.min(device.max_range_m());
        looks.extend(rays().zip(&there).map(|(bearing_rad, range_m)| Look { bearing_rad, range_m: *range_m, reach_m }));
        true_ranges_m.push(nearest);
        let end: End = if fan.len() > 1 || is_open {
            let seen = rays().filter_map(|b| all.cast(at, b, |obstacle| sieve.sees(ray, obstacle)));
            seen.min_by(|a, b| a.range_m.total_cmp(&b.range_m))
        } else {
            all.cast(at, axis_rad, |_| true)
        };
        ends.push(end.map(|surface| sensor.seen(surface, || all.cast(at, axis_rad + NEXT_RAD, |_| true))));
    }
    let stream_of = |scan: usize, ray: usize| {
        let mut rng = stream(eye.seed, READINGS - ((number as u64) << 32), scan);
        rng.set_word_pos(ray as u128 * WORDS_PER_RAY);
        rng
    };
    let fresh = |ray: usize| (image(ray) != scan).then(|| stream_of(scan, ray));
    let readings = device.read_again(bearings_rad, &ends, |ray| stream_of(image(ray), ray), fresh);
    let time_s = eye.drive.poses[scan].time_s;
    let pose = sensor.pose(recorded);
    let scan = Scan { sensor: number, time_s, pose, bearings_rad: bearings_rad.clone(), readings };
    BesideScan { scan, mount: sensor.mount, true_ranges_m, looks }
}

/// Angles of the rays by which a reading is sampled to its axis, rad: the axis alone, of a sensor that looks along a ray.
fn fan(device: &Device) -> Vec<f64> {
    let width_rad = device.width_rad();
    if width_rad <= 0.0 {
        return vec![0.0];
    }
    let halves = libm::ceil(0.5 * width_rad * device.max_range_m() / CONE_STEP_M) as usize;
    let halves = halves.clamp(1, MOST_CONE_RAYS / 2);
    (0..=2 * halves).map(|k| 0.5 * width_rad * (k as f64 / halves as f64 - 1.0)).collect()
}

impl Mounted {
    /// A surface as the sensor sees it: a depth camera needs no texture, but light that comes back.
    fn seen(&self, surface: Surface, next: impl Fn() -> End) -> Surface {
        match self.device {
            Device::Depth(..) => {
                let grazes = next().is_some_and(|next| grazes(surface.range_m, next.range_m, self.grazing_rad));
                Surface { texture: if grazes { 0.0 } else { 1.0 }, ..surface }
            }
            _ => surface,
        }
    }
}

/// Whether a surface through the ends of two rays that are [`NEXT_RAD`] apart makes less than an angle with them.
fn grazes(range_m: f64, next_m: f64, angle_rad: f64) -> bool {
    let (sin, cos) = libm::sincos(NEXT_RAD);
    let [along, across] = [next_m * cos - range_m, next_m * sin];
    libm::atan2(across, along.abs()) < angle_rad
}

/// Everything that rays can end on at a scan.
pub(super) struct Things<'a> {
    pub(super) eye: &'a Eye<'a>,
    /// What moves, where anything does.
    pub(super) moving: Option<crate::World>,
}

impl Things<'_> {
    /// The first surface on a ray at a bearing (rad) from a pose, of those obstacles that it sees; what moves is always seen.
    pub(super) fn cast(&self, at: Pose, bearing_rad: f64, sees: impl Fn(usize) -> bool) -> End {
        let (origin, direction) = (at.position_m(), at.direction(bearing_rad));
        let still =
            |hit: Hit| Surface { range_m: hit.range_m, texture: self.eye.scene.obstacles[hit.obstacle].texture };
        let fixed = self.eye.world.cast_past(origin, direction, sees);
        let thing = self.moving.as_ref().and_then(|moving| moving.cast(origin, direction));
        match (fixed, thing) {
            (Some(fixed), Some(thing)) if thing.range_m < fixed.range_m => Some(self.moving_surface(thing)),
            (None, Some(thing)) => Some(self.moving_surface(thing)),
            (fixed, _) => fixed.map(still),
        }
    }

    fn moving_surface(&self, hit: Hit) -> Surface {
        Surface { range_m: hit.range_m, texture: self.eye.drive.motion.texture(hit.obstacle) }
    }
}

#[cfg(test)]
mod tests;
