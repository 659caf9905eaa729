//! Scans with odometry: from a log, or from a scene that is simulated.

use std::collections::BTreeMap;

use logs::{Report, Sensor};
use mapper::Model;
use score::trajectory::Stamped;
use sensor::{FeatureCamera, FeatureReading, Pose};
use slam::Mounted;

use super::options::SlamOptions;
use super::read;
use crate::failure::Failure;
use crate::worlds::carried::{Carried, carried, mounted};
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::kernels::{self, Shared};
use crate::worlds::landmarks;
use crate::worlds::scenes;
use crate::worlds::site::{Assumptions, Site};
use crate::worlds::source::{self, Asked};
use crate::worlds::track::stamped;

/// Side of a cell of a log's map, m.
const CELL_M: f64 = 0.05;

/// More cells than this are not a building but a mistake.
const MOST_CELLS: usize = 100_000_000;

/// Share of the echoes that lie within the reach of the map.
const WITHIN: f64 = 0.99;

/// By how much the way may be off the odometry's, m, before the map ends.
const DRIFT_M: f64 = 5.0;

/// What the sensors read at one time, with the odometry's pose.
pub(super) struct Taken {
    /// The scans in the order of their sensors' numbers, one at least.
    pub(super) scans: Vec<Carried>,
    /// The robot by its odometry.
    pub(super) odometry: Pose,
    /// The features that the camera read there, where they are asked for.
    pub(super) features: Vec<FeatureReading>,
    /// Time by the log's own clock, s.
    pub(super) clock_s: f64,
}

impl Taken {
    /// Time since the first scan of the source, s.
    pub(super) fn time_s(&self) -> f64 {
        self.scans[0].scan.time_s
    }

    /// As the filter takes them.
    pub(super) fn mounted(&self) -> Vec<Mounted<'_>> {
        mounted(&self.scans)
    }
}

/// A sensor of the robot.
#[derive(Debug, Clone)]
pub(super) struct Carrier {
    pub(super) number: usize,
    /// What it is called.
    pub(super) called: String,
    /// What it is, of a log.
    pub(super) kind: Option<Sensor>,
    pub(super) mount: Pose,
}

/// Where scans come from.
pub(super) struct Source {
    pub(super) place: String,
    /// At least one; their times rise.
    pub(super) scans: Vec<Taken>,
    pub(super) model: Model,
    /// The sensors, at least one, by rising numbers.
    pub(super) sensors: Vec<Carrier>,
    /// The true way, of a scene.
    pub(super) truth: Option<Vec<Stamped>>,
    /// What finds features, where they are asked for.
    pub(super) camera: Option<FeatureCamera>,
    /// What is in the log, and what took the first of its scans.
    pub(super) report: Option<(Report, Sensor)>,
}

impl Source {
    /// None where the topics of a bag were to be listed. What a bag tells of its camera goes into the options.
    pub(super) fn of(options: &mut SlamOptions) -> Result<Option<Self>, Failure> {
        let (path, is_scene) = scenes::or_file(&options.source);
        let place = path.display().to_string();
        if is_scene {
            return Self::of_scene(options, &path, place).map(Some);
        }
        let asked = Asked {
            command: "slam",
            path: &options.source,
            bag: &options.bag,
            trajectory: None,
            body: logs::Body::Robot,
            focal_baseline: options.stereo.focal_baseline,
            given: &options.given,
        };
        let Some(source) = source::Source::open(&asked)? else { return Ok(None) };
        let stereo = &mut options.stereo;
        source.adapt(&options.given, &mut stereo.focal_baseline, &mut stereo.max_disparity);
        Self::of_log(options, &source, place).map(Some)
    }

    fn of_scene(options: &SlamOptions, path: &std::path::Path, place: String) -> Result<Self, Failure> {
        let scene = scene::load(path, options.grid, options.layout)?;
        if scene.odometry.is_none() {
            return Err(Failure::BadInput(format!(
                "{place}: the scene has no odometry, by which a robot knows roughly how it moved; add a section [odometry] (guide scenes)"
            )));
        }
        let Site { ground, setup } = Site::of(scene, &AS_BELIEVED, &Assumptions::of(&options.prior))?;
        let simulated = scene::simulate(&ground.scene, &ground.world, &ground.drive, options.seed).scans;
        let (features, camera) = match options.landmarks {
            true => (landmarks::features(&ground.scene)?, Some(landmarks::camera(&ground.scene))),
            false => (Vec::new(), None),
        };
        let observe = |camera: &FeatureCamera| {
            scene::observe(&ground.scene, &ground.world, &ground.drive, &features, camera, options.seed)
        };
        let mut observed = camera.as_ref().map(observe).unwrap_or_default().into_iter();
        let mut truth = Vec::new();
        let mut scans: Vec<Taken> = Vec::new();
        for (simulated, timed) in simulated.into_iter().zip(&ground.drive.poses) {
            let clock_s = simulated.scan.time_s;
            let features = observed.next().map(|observed| observed.scan.readings).unwrap_or_default();
            let rises = scans.last().is_none_or(|last| clock_s > last.clock_s);
            let carried = carried(&simulated);
            if let Some(odometry) = simulated.odometry.filter(|_| rises && !carried.is_empty()) {
                truth.push(stamped(clock_s, timed.pose));
                scans.push(Taken { scans: carried, odometry, features, clock_s });
            }
        }
        let eye = Carrier { number: 0, called: "camera".to_owned(), kind: None, mount: Pose::default() };
        let is_there = |number: usize| scans.iter().any(|taken| taken.scans.iter().any(|of| of.scan.sensor == number));
        let beside = (1..).zip(&ground.scene.sensors).map(|(number, sensor)| Carrier {
            number,
            called: sensor.name.clone(),
            kind: None,
            mount: sensor.mount,
        });
        let sensors: Vec<Carrier> = [eye].into_iter().chain(beside).filter(|sensor| is_there(sensor.number)).collect();
        if scans.is_empty() {
            return Err(Failure::BadInput(format!("{place}: the drive has no scan; give the robot a route")));
        }
        Ok(Self { place, scans, model: setup, sensors, truth: Some(truth), camera, report: None })
    }

    fn of_log(options: &SlamOptions, source: &source::Source, place: String) -> Result<Self, Failure> {
        if options.landmarks {
            return Err(Failure::BadInput(format!(
                "--landmarks: {place} is a log, whose scans have no features; give a scene, or a table of features to `features`"
            )));
        }
        let read::Read { scans, sensors, report, first } = read::read(options, source, &place)?;
        let kernels = options.kernels();
        let of = |sensor: &Carrier| Some(kernels.of(&place, sensor.kind?).map(|model| (sensor.number, model)));
        let known = sensors.iter().filter_map(of).collect::<Result<BTreeMap<usize, Shared>, Failure>>()?;
        let models = kernels::sensors(&known);
        let ranges = |taken: &Taken| -> Vec<f64> {
            let of = |carried: &Carried| -> Vec<f64> {
                let sensor = models.of(&carried.scan);
                let read = carried.scan.readings.iter().zip(&carried.scan.bearings_rad);
                read.filter_map(|(reading, bearing)| sensor.range_of((*reading)?, *bearing)).collect()
            };
            taken.scans.iter().flat_map(of).collect()
        };
        let reach_m = match options.reach {
            Some(reach_m) => reach_m,
            None => {
                let mut all: Vec<f64> = scans.iter().flat_map(ranges).collect();
                all.sort_by(f64::total_cmp);
                all.get((WITHIN * all.len() as f64) as usize).copied().unwrap_or(0.0) + DRIFT_M
            }
        };
        let cell_m = options.grid.unwrap_or(CELL_M);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for at in scans.iter().map(|taken| taken.odometry.position_m()) {
            low = [0, 1].map(|k| low[k].min(at[k] - reach_m));
            high = [0, 1].map(|k| high[k].max(at[k] + reach_m));
        }
        let snapped = |at: f64, by: f64| ((at + by) / cell_m).floor() * cell_m;
        let grid = grid::GridSpec::covering(low.map(|at| snapped(at, 0.0)), high.map(|at| snapped(at, cell_m)), cell_m)
            .map_err(|error| Failure::BadInput(format!("{place}: {error} (--grid, --reach, --window)")))?;
        if grid.cells() > MOST_CELLS {
            return Err(Failure::BadInput(format!(
                "{place}: the map has {} cells of {cell_m} m, more than {MOST_CELLS}; use larger cells (--grid), a shorter --reach, or a part of the log (--window)",
                grid.cells()
            )));
        }
        let any =
            models.iter().next().cloned().ok_or_else(|| Failure::Internal("a log without a sensor".to_owned()))?;
        let model = Model {
            prior: options.prior.prior(),
            reconciliation: options.prior.reconciliation(),
            sensors: models,
            ..Model::new(grid, any)
        };
        Ok(Self { place, scans, model, sensors, truth: None, camera: None, report: Some((report, first)) })
    }
}
