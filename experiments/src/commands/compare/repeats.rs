//! A robot that stands: how often may evidence be counted that is not new, is what is new still used, and does driving on repair what is left?

use grid::Raster;
use mapper::Mapper;
use mapper::catalogue::{Entry, Kind};
use scene::{Drive, Family, Motion, SimulatedScan, TimedPose};
use score::{Region, Retention, Scorer};
use sensor::Scan;
use serde::{Deserialize, Serialize};

use super::world::WorldJob;
use crate::failure::Failure;
use crate::worlds::site::{Assumptions, Site};
use crate::worlds::witness::Witness;

/// What a robot that stands reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Readings {
    /// One scan again and again, with its time and all.
    Same,
    /// What a real camera gives: mismatches that stay, fresh noise, times that go on, and a pose that jitters by 2 mm and 0.1 degrees.
    Standing,
    /// Readings that are drawn anew each time, mismatches too.
    Fresh,
    /// As [`Standing`](Self::Standing), and then those of [`DRIVEN_M`] along the drive.
    Driven,
}

impl Readings {
    /// What a robot reads that stays where it is; [`Driven`](Self::Driven) follows one of them.
    const STAYING: [Self; 3] = [Self::Same, Self::Standing, Self::Fresh];

    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Same => "same",
            Self::Standing => "standing",
            Self::Fresh => "fresh",
            Self::Driven => "driven",
        }
    }
}

/// How far a robot drives that has stood, m.
pub const DRIVEN_M: f64 = 5.0;

/// By how much the pose of a robot that stands jitters: standard deviations, m and degrees.
const JITTER: (f64, f64) = (0.002, 0.1);

/// A map after so many repeats of one scan, over what that scan could see.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeated {
    /// Family of the world.
    pub family: String,
    /// Its seed.
    pub seed: u64,
    /// Number of the scan, from 0.
    pub scan: usize,
    /// What the robot reads there.
    pub readings: Readings,
    /// Name of the mapper.
    pub mapper: &'static str,
    /// How often the scan is in the map.
    pub repeats: usize,
    /// Log loss over the observable region of the scan, nats per cell.
    pub log_loss: Option<f64>,
    /// Share of its free cells held free.
    pub free_known: Option<f64>,
    /// Area of its free cells held occupied, m².
    pub phantom_area: Option<f64>,
    /// Area of its surface cells held free, m².
    pub missed_area: Option<f64>,
    /// Free-space retention over the region, followed from the first scan on; of a robot that stands as robots do, and drives on.
    pub retention: Option<f64>,
}

/// What maps of a stand are judged by.
struct Judge<'a> {
    /// What the first scan could see, with the truth there.
    scorer: Scorer<'a>,
    observable: Raster<bool>,
    /// Its free cells, as retention asks for them.
    visible: Raster<bool>,
    /// Before the first scan.
    retention: Retention,
}

/// What a robot reads that stands, and that then drives on, if it does.
struct Stand {
    readings: Readings,
    /// What all sensors read at one time, time by time.
    scans: Vec<Vec<Scan>>,
    then: Vec<Vec<Scan>>,
}

/// Stands at `scans` places of a world, evenly spread over the drive, and maps what is read at each alone, up to the last of `counts` times,
/// by every mapper that takes scans one by one.
///
/// # Errors
/// As [`Site::of_family`]; a mapper that gives something else than probabilities.
pub fn repeat(
    job: &WorldJob,
    family: &Family,
    assumed: &Assumptions,
    mappers: &[&'static Entry],
    scans: usize,
    counts: &[usize],
) -> Result<Vec<Repeated>, Failure> {
    let site = Site::of_family(family, &job.world, assumed)?;
    let simulation = scene::simulate(&site.ground.scene, &site.ground.world, &site.ground.drive, job.world.seed);
    let most = counts.last().copied().unwrap_or(0);
    let mut repeated = Vec::new();
    for number in (0..scans).map(|k| k * simulation.scans.len() / scans) {
        let simulated = &simulation.scans[number];
        let mut witness = Witness::new(&site.ground);
        witness.look(&site.ground, number, simulated)?;
        let truth = witness.truth(&site.ground);
        let judge = Judge {
            scorer: Scorer::new(truth, witness.seen.surface())?,
            observable: witness.seen.mask(Region::Observable),
            visible: witness.seen.visible().clone(),
            retention: Retention::new(truth),
        };
        for readings in Readings::STAYING {
            let scans = stand(&site, simulated, readings, job.world.seed, most);
            // Where things move, what comes after a stand is another world than the one that is judged.
            let drives_on = readings == Readings::Standing && !site.ground.moves();
            let ended_s = scans.iter().flatten().last().map_or(0.0, |scan| scan.time_s);
            let then = if drives_on { onward(&simulation.scans, number, ended_s) } else { Vec::new() };
            let stand = Stand { readings, scans, then };
            for entry in mappers.iter().filter(|entry| entry.kind == Kind::Online) {
                let at = Repeated::unscored(job, number, readings, entry.name);
                repeated.extend(judge.scored(entry.mapper(&site.setup), &stand, counts, &at)?);
            }
        }
    }
    Ok(repeated)
}

/// The scans of [`DRIVEN_M`] of a drive after the scan of this number, at times after `ended_s`: ahead, or back the way it came where less of it is left;
/// all of the longer way where neither is as long.
fn onward(scans: &[SimulatedScan], number: usize, ended_s: f64) -> Vec<Vec<Scan>> {
    let from_s = scans[number].scan.time_s;
    let along = |way: &mut dyn Iterator<Item = &SimulatedScan>| {
        let (mut at, mut along_m, mut driven) = (scans[number].scan.pose, 0.0, Vec::new());
        for simulated in way {
            let scan = &simulated.scan;
            if along_m >= DRIVEN_M {
                break;
            }
            along_m += libm::hypot(scan.pose.x_m - at.x_m, scan.pose.y_m - at.y_m);
            at = scan.pose;
            driven.push(at_time(simulated, ended_s + (scan.time_s - from_s).abs()));
        }
        (along_m, driven)
    };
    let [ahead, back] = [along(&mut scans[number + 1..].iter()), along(&mut scans[..number].iter().rev())];
    if ahead.0 >= DRIVEN_M.min(back.0) { ahead.1 } else { back.1 }
}

/// What was read at one time, as of another time, s.
fn at_time(simulated: &SimulatedScan, time_s: f64) -> Vec<Scan> {
    simulated.together().into_iter().map(|scan| Scan { time_s, ..scan }).collect()
}

/// The scans of a robot that stands where a scan was made, time by time.
fn stand(site: &Site, first: &SimulatedScan, readings: Readings, seed: u64, count: usize) -> Vec<Vec<Scan>> {
    let ground = &site.ground;
    let interval_s = ground.scene.robot.scan_interval_s;
    let drive = |count: usize| {
        let pose = |k: usize| TimedPose { time_s: k as f64 * interval_s, pose: first.scan.pose };
        Drive { poses: (0..count).map(pose).collect(), stage_ends: Vec::new(), motion: Motion::default() }
    };
    let mut scene = ground.scene.clone();
    (scene.robot.jitter_m, scene.robot.jitter_rad) = (JITTER.0, JITTER.1.to_radians());
    let read = |count: usize, seed: u64| scene::simulate(&scene, &ground.world, &drive(count), seed).scans;
    match readings {
        Readings::Same => vec![first.together(); count],
        Readings::Standing | Readings::Driven => read(count, seed).iter().map(SimulatedScan::together).collect(),
        // Two scans of one stand share their mismatches: each is a stand of its own, with a seed of its own.
        Readings::Fresh => (0..count)
            .flat_map(|k| {
                let seed = seed ^ (k as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
                read(1, seed).into_iter().map(move |one| at_time(&one, k as f64 * interval_s))
            })
            .collect(),
    }
}

impl Judge<'_> {
    /// A mapper's maps of a stand, and of the drive after it.
    fn scored(
        &self,
        mut mapper: Box<dyn Mapper>,
        stand: &Stand,
        counts: &[usize],
        at: &Repeated,
    ) -> Result<Vec<Repeated>, Failure> {
        let mut retention = (stand.readings == Readings::Standing).then(|| self.retention.clone());
        let mut rows = Vec::new();
        let whole = stand.scans.len();
        for (k, scans) in stand.scans.iter().chain(&stand.then).enumerate() {
            mapper.integrate_together(scans);
            let is_last = !stand.then.is_empty() && k + 1 == whole + stand.then.len();
            let is_counted = k < whole && counts.contains(&(k + 1));
            if retention.is_none() && !is_counted {
                continue;
            }
            mapper.settle();
            // What gives no map has no values.
            let has_map = mapper.fault().is_none();
            if let Some(retention) = retention.as_mut().filter(|_| has_map) {
                retention.observe(&self.visible, mapper.occupancy())?;
            }
            if is_counted || is_last {
                let readings = if is_last { Readings::Driven } else { stand.readings };
                let at = Repeated { readings, repeats: (k + 1).min(whole), ..at.clone() };
                rows.push(if has_map { self.row(mapper.occupancy(), retention.as_ref(), at)? } else { at });
            }
        }
        Ok(rows)
    }

    /// A row with its scores.
    fn row(&self, map: &Raster<f64>, retention: Option<&Retention>, at: Repeated) -> Result<Repeated, Failure> {
        let scores = self.scorer.scores(map, &self.observable)?;
        let retention = retention.map(|retention| retention.metric(Some(&self.observable))).transpose()?;
        Ok(Repeated {
            log_loss: scores.log_loss.value,
            free_known: scores.free_known.value,
            phantom_area: scores.phantom_area.value,
            missed_area: scores.missed_area.value,
            retention: retention.and_then(|retention| retention.value),
            ..at
        })
    }
}

impl Repeated {
    /// A row without its scores.
    fn unscored(job: &WorldJob, scan: usize, readings: Readings, mapper: &'static str) -> Self {
        Self {
            family: job.world.family.clone(),
            seed: job.world.seed,
            scan,
            readings,
            mapper,
            repeats: 0,
            log_loss: None,
            free_known: None,
            phantom_area: None,
            missed_area: None,
            retention: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sensor::Pose;

    /// A drive along x, a metre each second.
    fn drive(count: usize) -> Vec<SimulatedScan> {
        let scan = |k: usize| {
            let pose = Pose { x_m: k as f64, ..Pose::default() };
            SimulatedScan {
                scan: Scan { time_s: k as f64, pose, bearings_rad: vec![0.0], readings: vec![None], ..Scan::default() },
                true_ranges_m: Vec::new(),
                odometry: None,
                beside: Vec::new(),
            }
        };
        (0..count).map(scan).collect()
    }

    #[test]
    fn five_metres_go_ahead_or_back_or_as_far_as_there_is_a_way() {
        for (count, number, expected) in [
            (12, 3, vec![4.0, 5.0, 6.0, 7.0, 8.0]),
            (12, 8, vec![7.0, 6.0, 5.0, 4.0, 3.0]),
            (6, 1, vec![2.0, 3.0, 4.0, 5.0]),
            (6, 3, vec![2.0, 1.0, 0.0]),
            (1, 0, vec![]),
        ] {
            let scans = onward(&drive(count), number, 100.0);
            let places: Vec<f64> = scans.iter().flatten().map(|scan| scan.pose.x_m).collect();
            assert_eq!(places, expected, "{count} {number}");
            let times: Vec<f64> = scans.iter().flatten().map(|scan| scan.time_s).collect();
            let expected: Vec<f64> = (1..=expected.len()).map(|k| 100.0 + k as f64).collect();
            assert_eq!(times, expected, "times go on");
        }
    }
}
