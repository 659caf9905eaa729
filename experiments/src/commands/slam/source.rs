//! Scans with odometry: from a log, or from a scene that is simulated.

use logs::{LogError, Report, Sensor};
use mapper::Model;
use score::trajectory::Stamped;
use sensor::{FeatureCamera, FeatureReading, Pose, Scan};

use super::options::SlamOptions;
use crate::failure::Failure;
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::kernels::{self, SonarOptions};
use crate::worlds::landmarks;
use crate::worlds::scenes;
use crate::worlds::site::{Assumptions, Site, camera_alone};
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

/// A scan with the odometry's pose.
pub(super) struct Taken {
    pub(super) scan: Scan,
    pub(super) odometry: Pose,
    /// The features that the camera read there, where they are asked for.
    pub(super) features: Vec<FeatureReading>,
    /// Time by the log's own clock, s.
    pub(super) clock_s: f64,
}

/// Where scans come from.
pub(super) struct Source {
    pub(super) place: String,
    /// At least one; their times rise.
    pub(super) scans: Vec<Taken>,
    pub(super) model: Model,
    /// The true way, of a scene.
    pub(super) truth: Option<Vec<Stamped>>,
    /// What finds features, where they are asked for.
    pub(super) camera: Option<FeatureCamera>,
    /// What is in the log.
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
        camera_alone(&scene, &place, "`slam`")?;
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
            if let Some(odometry) = simulated.odometry.filter(|_| rises) {
                truth.push(stamped(clock_s, timed.pose));
                scans.push(Taken { scan: simulated.scan, odometry, features, clock_s });
            }
        }
        if scans.is_empty() {
            return Err(Failure::BadInput(format!("{place}: the drive has no scan; give the robot a route")));
        }
        Ok(Self { place, scans, model: setup, truth: Some(truth), camera, report: None })
    }

    fn of_log(options: &SlamOptions, source: &source::Source, place: String) -> Result<Self, Failure> {
        if options.landmarks {
            return Err(Failure::BadInput(format!(
                "--landmarks: {place} is a log, whose scans have no features; give a scene, or a table of features to `features`"
            )));
        }
        let refused = |error: LogError| Failure::BadInput(error.to_string());
        let mut log = source.log(&options.reading())?;
        let kind = log.sensor();
        let mut scans: Vec<Taken> = Vec::new();
        let mut back = 0usize;
        while let Some(event) = log.next_event() {
            let event = event.map_err(refused)?;
            // The file of --pose is the odometry of a bag.
            let odometry = if source.is_along() { Some(event.scan.pose) } else { event.odometry };
            let Some(odometry) = odometry else {
                return Err(Failure::BadInput(format!(
                    "{place}, line {}: the scan has no pose by odometry, which slam needs of every scan; give a CARMEN log, or a table with \
                     odom_x_m, odom_y_m and odom_theta_rad, or map the poses that it has with `replay`",
                    event.line
                )));
            };
            if scans.last().is_some_and(|last| event.scan.time_s <= last.scan.time_s) {
                back += 1;
                continue;
            }
            let scan = Scan { sensor: 0, ..event.scan };
            scans.push(Taken { clock_s: scan.time_s, scan, odometry, features: Vec::new() });
        }
        let report = log.report().clone();
        kernels::one_kind(&place, &report, "`slam`")?;
        if scans.is_empty() {
            return Err(Failure::BadInput(format!(
                "{place}: none of its {} scans is in use; give another --window",
                report.scans
            )));
        }
        if back > 0 {
            crate::output::note(format_args!(
                "warning: {place}: {back} scans are not later than the one before them and are left out: the clock jumps"
            ));
        }
        scans.iter_mut().for_each(|taken| taken.clock_s = report.start_s + taken.scan.time_s);
        let sensor = kernels::sensor(&place, kind, (options.laser, options.stereo, SonarOptions::default()))?;
        let ranges = |taken: &Taken| -> Vec<f64> {
            let read = taken.scan.readings.iter().zip(&taken.scan.bearings_rad);
            read.filter_map(|(reading, bearing)| sensor.range_of((*reading)?, *bearing)).collect()
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
        let model = Model {
            prior: options.prior.prior(),
            reconciliation: options.prior.reconciliation(),
            ..Model::new(grid, sensor)
        };
        Ok(Self { place, scans, model, truth: None, camera: None, report: Some((report, kind)) })
    }
}
