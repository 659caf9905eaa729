//! Features with odometry and truth: from a scene that is simulated, a field of posts, or a table.

use grid::{GridSpec, Raster};
use logs::table::features::FeatureRow;
use scene::{Scene, World};
use sensor::{FeatureCamera, FeatureScan, OdometryNoise, Stereo};

use super::drives::Yard;
use super::filter::Filter;
use super::options::{Asked, FeaturesOptions};
use crate::failure::Failure;
use crate::worlds::{landmarks, scenes};

/// Standard deviation of a bearing, rad, and probability that a feature is found, where nothing is said of a table's camera.
const BEARING_SIGMA_RAD: f64 = 0.005;
const DETECTION: f64 = 0.9;

/// Disparities of the deepest feature are so many standard deviations above 0, where nothing is said of a table's camera.
const LEAST_SIGMAS: f64 = 3.0;

/// What is known of a reading.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Known {
    pub(super) feature: u32,
    pub(super) matched: bool,
}

/// A drive with what was measured of features, and what is known of it.
pub(super) struct Recording {
    pub(super) camera: FeatureCamera,
    /// At least one; times rise. Readings have the identities that are known.
    pub(super) scans: Vec<FeatureScan>,
    /// What is known of every reading.
    pub(super) known: Vec<Vec<Option<Known>>>,
    /// Where the features are, m, of a scene.
    pub(super) features_m: Option<Vec<[f64; 2]>>,
    /// Where drives are planned, of a scene, if they are asked for.
    pub(super) yard: Option<Yard>,
    /// What is drawn below, of a scene.
    pub(super) ground: Option<Raster<Option<bool>>>,
}

impl Recording {
    /// The recording of a seed; a table is the same for all.
    pub(super) fn of(options: &FeaturesOptions, seed: u64) -> Result<Self, Failure> {
        let Some(source) = &options.source else {
            return Self::of_scene(options, &super::field::field(options.posts.unwrap_or(1), seed)?, seed);
        };
        let (path, is_scene) = scenes::or_file(source);
        if is_scene {
            let scene = scene::load(&path, None, options.layout)?;
            return Self::of_scene(options, &scene, seed);
        }
        let rows = logs::table::features::open(&path).map_err(|error| Failure::BadInput(error.to_string()))?;
        Self::of_table(options, rows)
    }

    fn of_scene(options: &FeaturesOptions, scene: &Scene, seed: u64) -> Result<Self, Failure> {
        let features = landmarks::features(scene)?;
        let camera = landmarks::camera(scene);
        let camera = FeatureCamera {
            bearing_sigma_rad: options.bearing_sigma.unwrap_or(camera.bearing_sigma_rad),
            most_depth_m: options.depth.unwrap_or(camera.most_depth_m),
            detection: options.detection.unwrap_or(camera.detection),
            ..camera
        };
        checked(&camera)?;
        let (world, drive) = (World::new(scene), scene::drive(scene)?);
        let mut recording = Self {
            camera,
            scans: Vec::new(),
            known: Vec::new(),
            features_m: Some(features.iter().map(|feature| feature.at_m).collect()),
            yard: options.drives.then(|| Yard::of(scene, seed)).transpose()?,
            ground: Some(scene::truth(scene)),
        };
        for mut observed in scene::observe(scene, &world, &drive, &features, &camera, seed) {
            if recording.scans.last().is_some_and(|last| observed.scan.time_s <= last.time_s) {
                continue;
            }
            for (reading, truth) in observed.scan.readings.iter_mut().zip(&observed.truth) {
                reading.identity = Some(truth.feature as u32);
            }
            let known =
                |truth: &scene::FeatureTruth| Some(Known { feature: truth.feature as u32, matched: truth.matched });
            recording.known.push(observed.truth.iter().map(known).collect());
            recording.scans.push(observed.scan);
        }
        Ok(recording)
    }

    fn of_table(options: &FeaturesOptions, rows: Vec<FeatureRow>) -> Result<Self, Failure> {
        if options.drives {
            return Err(Failure::BadInput(
                "--drives: a table does not say what stands in the world, into which drives may lead; give a scene or --posts".to_owned(),
            ));
        }
        let given = &options.stereo;
        let stereo = Stereo {
            focal_baseline: given.focal_baseline,
            disparity_sigma: given.disparity_sigma,
            correct_match: given.correct_match,
            max_disparity: given.max_disparity,
        };
        let least_px = LEAST_SIGMAS * stereo.disparity_sigma;
        let camera = FeatureCamera {
            stereo,
            bearing_sigma_rad: options.bearing_sigma.unwrap_or(BEARING_SIGMA_RAD),
            field_of_view_rad: options.fov.to_radians(),
            most_depth_m: options.depth.unwrap_or(stereo.focal_baseline / least_px),
            detection: options.detection.unwrap_or(DETECTION),
        };
        checked(&camera)?;
        let known = |row: &FeatureRow| {
            let readings = row.scan.readings.iter().zip(&row.matched);
            readings
                .map(|(reading, matched)| Some(Known { feature: reading.identity?, matched: (*matched)? }))
                .collect()
        };
        Ok(Self {
            camera,
            known: rows.iter().map(known).collect(),
            scans: rows.into_iter().map(|row| row.scan).collect(),
            features_m: None,
            yard: None,
            ground: None,
        })
    }

    /// Refuses a filter that needs what is not there.
    pub(super) fn serves(&self, filter: Filter, options: &FeaturesOptions, place: &str) -> Result<(), Failure> {
        let line = |scan: usize| format!("scan {} of {place}", scan + 1);
        let lacks = |lacking: &dyn Fn(&FeatureScan) -> bool| self.scans.iter().position(lacking).map(line);
        if filter == Filter::KnownPoses
            && let Some(scan) = lacks(&|scan| scan.pose.is_none())
        {
            return Err(Failure::BadInput(format!(
                "{scan} has no pose, which --filter known-poses needs of every scan; give x_m, y_m and theta_rad, or take --filter fastslam2"
            )));
        }
        if filter != Filter::KnownPoses
            && let Some(scan) = lacks(&|scan| scan.odometry.is_none())
        {
            return Err(Failure::BadInput(format!(
                "{scan} has no pose by odometry, which --filter {} needs of every scan; give odom_x_m, odom_y_m and odom_theta_rad in a \
                 table or a section [odometry] in a scene (guide scenes), or take --filter known-poses",
                filter.name()
            )));
        }
        let unnamed = |scan: &FeatureScan| scan.readings.iter().any(|reading| reading.identity.is_none());
        if options.identity == Asked::Known
            && let Some(scan) = lacks(&unnamed)
        {
            return Err(Failure::BadInput(format!(
                "{scan} has a reading without a feature, which --identity known needs of every reading; give the column feature, or take \
                 --identity unknown"
            )));
        }
        Ok(())
    }

    /// Warns of options without an effect.
    pub(super) fn tell_idle(&self, options: &FeaturesOptions, place: &str) {
        if self.features_m.is_some() {
            let camera = ["fov", "focal_baseline", "disparity_sigma", "correct_match", "max_disparity"];
            options.given.warn(&camera, place, "which has a camera of its own");
        }
        if options.posts.is_some() {
            options.given.warn(&["layout"], place, "which is no family");
        }
        if options.filters() == [Filter::KnownPoses] {
            options.given.warn(&["particles", "noise"], place, "from known poses");
        }
        if options.noise() == OdometryNoise::NONE && options.filters() != [Filter::KnownPoses] {
            crate::output::note(format_args!(
                "warning: --noise of zeros takes the odometry for exact, so that all particles are one; give what it is off"
            ));
        }
    }

    /// The cells that a picture shows: the scene's, or those round what is there.
    pub(super) fn grid(&self, places_m: &[[f64; 2]]) -> GridSpec {
        const CELL_M: f64 = 0.1;
        const MARGIN_M: f64 = 1.0;
        if let Some(ground) = &self.ground {
            return *ground.spec();
        }
        let (mut low, mut high) = ([0.0f64; 2], [1.0f64; 2]);
        for (number, at) in places_m.iter().enumerate() {
            low = [0, 1].map(|k| if number == 0 { at[k] } else { low[k].min(at[k]) });
            high = [0, 1].map(|k| if number == 0 { at[k] } else { high[k].max(at[k]) });
        }
        let size = [0, 1].map(|k| high[k] - low[k] + 2.0 * MARGIN_M);
        let cell_m = CELL_M.max(size[0].max(size[1]) / 2000.0);
        let [width, height] = size.map(|v| (v / cell_m).ceil() as usize);
        GridSpec { cell_m, origin_m: low.map(|v| v - MARGIN_M), width, height }
    }
}

fn checked(camera: &FeatureCamera) -> Result<(), Failure> {
    camera.check().map_err(|error| Failure::BadInput(format!("camera: {error}")))
}
