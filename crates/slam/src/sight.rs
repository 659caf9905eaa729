//! What the scans of one time are to the filter: their readings, where they ended, and the few that the map is asked about.

use grid::GridSpec;
use mapper::{Mapper, Sensors};
use sensor::{Pose, Scan, SensorModel, wrapped_rad};

use crate::frame::turned;
use crate::matcher::moved;
use crate::options::{Options, Weight};

/// Rays about which the map is asked to tell whether it still knows where it is.
const ASKED: usize = 60;

/// Readings that are worth less than this share of one without noise are not matched: nobody knows which surface they ended on.
const LEAST: f64 = 0.1;

/// What one sensor read, and where it stands on the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mounted<'a> {
    /// The scan; its pose does not matter.
    pub scan: &'a Scan,
    /// The sensor in the frame of the robot.
    pub mount: Pose,
}

impl Mounted<'_> {
    /// Where the sensor stands when the robot stands at `robot`.
    pub fn pose(&self, robot: Pose) -> Pose {
        let Pose { x_m, y_m, theta_rad } = self.mount;
        moved(robot, [x_m, y_m, theta_rad])
    }

    /// The scan as it was taken when the robot stood at `robot`.
    pub fn scan_from(&self, robot: Pose) -> Scan {
        Scan { pose: self.pose(robot), ..self.scan.clone() }
    }
}

/// Where a reading ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct End {
    /// The place in the robot's frame, m.
    pub(crate) at: [f64; 2],
    /// What the reading is worth of one without noise, 0 to 1: `s^2 / (s^2 + r^2)`, where `s` is the standard deviation of matching and `r`
    /// that of the reading's range.
    pub(crate) share: f64,
}

/// Scans of one time without the robot's pose.
pub(crate) struct Sight {
    pub(crate) time_s: f64,
    scans: Vec<Look>,
    /// Readings that lie within reach and say where a surface is, of all sensors but those with cones, whose readings do not tell the bearing.
    pub(crate) ends: Vec<End>,
    /// The rays about which the map is asked, and the cones.
    rays: Vec<Look>,
    cones: Vec<Look>,
    /// Whether a sensor took part whose readings can be matched.
    pub(crate) can_match: bool,
}

/// A scan, and where its sensor stands on the robot.
struct Look {
    scan: Scan,
    mount: Pose,
}

impl Look {
    fn mounted(&self) -> Mounted<'_> {
        Mounted { scan: &self.scan, mount: self.mount }
    }
}

impl Sight {
    pub(crate) fn new(scans: &[Mounted], sensors: &Sensors, options: &Options) -> Self {
        let is_cone = |scan: &Scan| sensors.of(scan).width_rad() > 0.0;
        let narrow = || scans.iter().filter(|mounted| !is_cone(mounted.scan));
        let beams = match options.weight {
            Weight::Evidence { beams, .. } => beams,
            Weight::Field { .. } => ASKED,
        };
        let look = |mounted: &Mounted| Look { scan: mounted.scan.clone(), mount: mounted.mount };
        let (cones, rays) = thinned(scans, beams).into_iter().partition(|look| is_cone(&look.scan));
        Self {
            time_s: scans.first().map_or(0.0, |first| first.scan.time_s),
            scans: scans.iter().map(look).collect(),
            ends: narrow().flat_map(|mounted| ends(mounted, &**sensors.of(mounted.scan), options)).collect(),
            rays,
            cones,
            can_match: narrow().next().is_some(),
        }
    }

    /// The scans from a pose of the robot.
    pub(crate) fn from(&self, robot: Pose) -> Vec<Scan> {
        self.scans.iter().map(|look| look.mounted().scan_from(robot)).collect()
    }

    /// `ln P(readings | map)` of the rays about which the map is asked, from a pose of the robot; none of a map that does not predict, and of
    /// one that a sensor is not on.
    pub(crate) fn evidence_of_rays(&self, map: &dyn Mapper, robot: Pose) -> Option<f64> {
        evidence(&self.rays, map, robot)
    }

    /// The same of the cones; 0 where there are none.
    pub(crate) fn evidence_of_cones(&self, map: &dyn Mapper, robot: Pose) -> Option<f64> {
        evidence(&self.cones, map, robot)
    }

    /// The same of both.
    pub(crate) fn evidence(&self, map: &dyn Mapper, robot: Pose) -> Option<f64> {
        Some(self.evidence_of_rays(map, robot)? + self.evidence_of_cones(map, robot)?)
    }

    /// Whether all cones begin on the map, from a pose of the robot.
    pub(crate) fn cones_begin_in(&self, cells: &GridSpec, robot: Pose) -> bool {
        self.cones.iter().all(|look| cells.locate(look.mounted().pose(robot).position_m()).is_some())
    }

    /// How many rays about which the map is asked have a reading.
    pub(crate) fn asked(&self) -> usize {
        self.rays.iter().chain(&self.cones).map(|look| look.scan.readings.iter().flatten().count()).sum()
    }
}

fn evidence(looks: &[Look], map: &dyn Mapper, robot: Pose) -> Option<f64> {
    looks.iter().try_fold(0.0, |sum, look| Some(sum + map.evidence(&look.mounted().scan_from(robot))?))
}

/// Where the readings of a scan ended that lie within reach and say where a surface is.
fn ends(mounted: &Mounted, sensor: &dyn SensorModel, options: &Options) -> Vec<End> {
    let Mounted { scan, mount } = mounted;
    let end = |(bearing, reading): (&f64, &Option<f64>)| {
        let range_m = sensor.range_of((*reading)?, *bearing).filter(|range| *range <= options.reach_m)?;
        let (sin, cos) = libm::sincos(*bearing);
        let off = sensor.range_sigma((*reading)?, *bearing) / options.sharpness.sigma_m;
        let share = 1.0 / (1.0 + off * off);
        let [x, y] = turned([range_m * cos, range_m * sin], mount.theta_rad);
        (share >= LEAST).then_some(End { at: [mount.x_m + x, mount.y_m + y], share })
    };
    scan.bearings_rad.iter().zip(&scan.readings).filter_map(end).collect()
}

/// So many of the rays of scans with readings at most, evenly spread over all of them, of several sensors in the order of their directions as seen
/// from the robot: every sensor has its share, and beams that are dealt to several are chosen as those of one.
fn thinned(scans: &[Mounted], beams: usize) -> Vec<Look> {
    let of = |(number, mounted): (usize, &Mounted)| {
        let readings = &mounted.scan.readings;
        (0..readings.len()).filter(|ray| readings[*ray].is_some()).map(move |ray| (number, ray)).collect::<Vec<_>>()
    };
    let mut read: Vec<(usize, usize)> = scans.iter().enumerate().flat_map(of).collect();
    if scans.len() > 1 {
        let direction = |(number, ray): &(usize, usize)| {
            let Mounted { scan, mount } = &scans[*number];
            wrapped_rad(mount.theta_rad + scan.bearings_rad[*ray])
        };
        read.sort_by(|a, b| direction(a).total_cmp(&direction(b)));
    }
    let taken = beams.min(read.len());
    let chosen: Vec<(usize, usize)> = (0..taken).map(|k| read[(2 * k + 1) * read.len() / (2 * taken)]).collect();
    let few = |(number, mounted): (usize, &Mounted)| {
        let rays = || chosen.iter().filter(|(of, _)| *of == number).map(|(_, ray)| *ray);
        let scan = Scan {
            bearings_rad: rays().map(|ray| mounted.scan.bearings_rad[ray]).collect(),
            readings: rays().map(|ray| mounted.scan.readings[ray]).collect(),
            ..*mounted.scan
        };
        Look { scan, mount: mounted.mount }
    };
    scans.iter().enumerate().map(few).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(sensor: usize) -> Scan {
        let readings: Vec<Option<f64>> = (0..90).map(|k| (k % 3 > 0).then_some(f64::from(k))).collect();
        Scan { sensor, bearings_rad: (0..90).map(f64::from).collect(), readings, ..Scan::default() }
    }

    #[test]
    fn rays_are_thinned_evenly_and_none_is_taken_twice() {
        let scan = scan(0);
        for beams in [1, 7, 30, 59, 60, 200] {
            let few = &thinned(&[Mounted { scan: &scan, mount: Pose::default() }], beams)[0].scan;
            assert_eq!(few.readings.len(), beams.min(60));
            assert!(few.bearings_rad.windows(2).all(|pair| pair[0] < pair[1]));
            assert!(few.bearings_rad.iter().zip(&few.readings).all(|(b, r)| *r == Some(*b)));
            let middle = few.bearings_rad.iter().sum::<f64>() / few.readings.len() as f64;
            assert!((middle - 45.0).abs() < 2.0, "{beams}: {middle}");
        }
    }

    #[test]
    fn beams_that_are_dealt_to_two_sensors_are_chosen_as_those_of_one() {
        let whole = Scan { bearings_rad: (0..90).map(|k| 0.03 * f64::from(k - 45)).collect(), ..scan(0) };
        let part = |sensor: usize| {
            let beams = || (0..90).filter(move |beam| beam % 2 == sensor);
            let bearings_rad = beams().map(|beam| whole.bearings_rad[beam]).collect();
            Scan {
                sensor,
                bearings_rad,
                readings: beams().map(|beam| whole.readings[beam]).collect(),
                ..Scan::default()
            }
        };
        let parts = [part(0), part(1)];
        let mounts = [Pose::default(), Pose { x_m: 0.1, ..Pose::default() }];
        let mounted = parts.iter().zip(mounts).map(|(scan, mount)| Mounted { scan, mount });
        let few = thinned(&mounted.collect::<Vec<_>>(), 20);
        let mut found: Vec<Option<f64>> = few.iter().flat_map(|look| look.scan.readings.clone()).collect();
        found.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
        let one = thinned(&[Mounted { scan: &whole, mount: Pose::default() }], 20);
        assert_eq!(found, one[0].scan.readings);
        assert_eq!(
            few.iter().map(|look| (look.scan.sensor, look.mount)).collect::<Vec<_>>(),
            [(0, mounts[0]), (1, mounts[1])]
        );
        assert!(few.iter().all(|look| (8..=12).contains(&look.scan.readings.len())));
    }
}
