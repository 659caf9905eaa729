//! What mappers know of the sensor that took a log.

use std::collections::BTreeMap;
use std::sync::Arc;

use clap::Args;
use logs::{Report, Sensor};
use mapper::Sensors;
use sensor::{Depth, Laser, Omnidirectional, Scan, SensorKind, SensorModel, Sonar, Stereo};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output::args::{number, positive, probability};

/// A sensor that mappers share.
pub type Shared = Arc<dyn SensorModel>;

/// The kernel of a laser.
#[derive(Debug, Clone, Copy, Args)]
pub struct LaserOptions {
    /// Standard deviation of an echo, m
    #[arg(long, help_heading = "Laser", value_name = "M", default_value_t = Laser::default().range_sigma_m, allow_negative_numbers = true, value_parser = positive)]
    pub range_sigma: f64,
    /// Probability that a pulse is reflected by the first obstacle on the map
    #[arg(long, help_heading = "Laser", value_name = "P", default_value_t = Laser::default().hit, allow_negative_numbers = true, value_parser = probability)]
    pub hit: f64,
    /// Probability that a pulse is lost; what this and --hit leave of one are outliers
    #[arg(long, help_heading = "Laser", value_name = "P", default_value_t = Laser::default().no_echo, allow_negative_numbers = true, value_parser = probability)]
    pub no_echo: f64,
    /// Things on no map that stand in a metre of beam, 1/m
    #[arg(long, help_heading = "Laser", value_name = "RATE", default_value_t = Laser::default().early_per_m, allow_negative_numbers = true, value_parser = probability)]
    pub early: f64,
}

/// The kernel of a stereo camera.
#[derive(Debug, Clone, Copy, Args)]
pub struct StereoOptions {
    /// Focal length times baseline, px·m
    #[arg(long, help_heading = "Stereo camera", value_name = "PX·M", default_value_t = Stereo::default().focal_baseline, allow_negative_numbers = true, value_parser = positive)]
    pub focal_baseline: f64,
    /// Standard deviation of a correct disparity, px
    #[arg(long, help_heading = "Stereo camera", value_name = "PX", default_value_t = Stereo::default().disparity_sigma, allow_negative_numbers = true, value_parser = positive)]
    pub disparity_sigma: f64,
    /// Probability of a correct match
    #[arg(long, help_heading = "Stereo camera", value_name = "P", default_value_t = Stereo::default().correct_match, allow_negative_numbers = true, value_parser = probability)]
    pub correct_match: f64,
    /// Largest disparity searched, px
    #[arg(long, help_heading = "Stereo camera", value_name = "PX", default_value_t = Stereo::default().max_disparity, allow_negative_numbers = true, value_parser = positive)]
    pub max_disparity: f64,
}

impl StereoOptions {
    /// The camera that they describe.
    pub fn camera(&self) -> Stereo {
        let Self { focal_baseline, disparity_sigma, correct_match, max_disparity } = *self;
        Stereo { focal_baseline, disparity_sigma, correct_match, max_disparity }
    }

    /// The same, of one that looks all round.
    pub fn all_round(&self) -> Omnidirectional {
        Omnidirectional(self.camera())
    }
}

/// The kernel of a sonar.
#[derive(Debug, Clone, Copy, Args)]
pub struct SonarOptions {
    /// Range from which on a sonar hears nothing, m [default: what the log says, else 5]
    #[arg(long, help_heading = "Sonar", value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub sonar_range: Option<f64>,
    /// Angle between the edges of its cone, degrees [default: what the log says, else 30]
    #[arg(long, help_heading = "Sonar", value_name = "DEG", allow_negative_numbers = true, value_parser = cone)]
    pub sonar_width: Option<f64>,
    /// Standard deviation of an echo, m
    #[arg(long, help_heading = "Sonar", value_name = "M", default_value_t = Sonar::default().range_sigma_m, allow_negative_numbers = true, value_parser = positive)]
    pub sonar_sigma: f64,
    /// Probability of an echo from the nearest thing in the cone
    #[arg(long, help_heading = "Sonar", value_name = "P", default_value_t = Sonar::default().hit, allow_negative_numbers = true, value_parser = probability)]
    pub sonar_hit: f64,
    /// Probability of no echo although there is something; what this and --sonar-hit leave of one are false echoes
    #[arg(long, help_heading = "Sonar", value_name = "P", default_value_t = Sonar::default().no_echo, allow_negative_numbers = true, value_parser = probability)]
    pub sonar_no_echo: f64,
    /// Things on no map that stand in a metre of its cone, 1/m
    #[arg(long, help_heading = "Sonar", value_name = "RATE", default_value_t = Sonar::default().early_per_m, allow_negative_numbers = true, value_parser = probability)]
    pub sonar_early: f64,
}

impl Default for SonarOptions {
    fn default() -> Self {
        let Sonar { range_sigma_m, hit, no_echo, early_per_m, .. } = Sonar::default();
        Self {
            sonar_range: None,
            sonar_width: None,
            sonar_sigma: range_sigma_m,
            sonar_hit: hit,
            sonar_no_echo: no_echo,
            sonar_early: early_per_m,
        }
    }
}

impl SonarOptions {
    /// The sonar that they describe; of what they leave open, as a log has it (m, rad), or as usual.
    pub fn sonar(&self, max_range_m: Option<f64>, width_rad: Option<f64>) -> Sonar {
        let usual = Sonar::default();
        let Self { sonar_range, sonar_width, sonar_sigma, sonar_hit, sonar_no_echo, sonar_early } = *self;
        Sonar {
            range_sigma_m: sonar_sigma,
            max_range_m: sonar_range.or(max_range_m).unwrap_or(usual.max_range_m),
            hit: sonar_hit,
            no_echo: sonar_no_echo,
            early_per_m: sonar_early,
            width_rad: sonar_width.map(f64::to_radians).or(width_rad).unwrap_or(usual.width_rad),
        }
    }
}

/// The angle of a cone, degrees.
///
/// # Errors
/// One that no sonar has.
pub fn cone(text: &str) -> Result<f64, String> {
    number(text, "of degrees from 0.1 to 170", |value| (0.1..=170.0).contains(&value))
}

/// The kernel of depth cameras, whose ranges a log does not tell from a laser's.
#[derive(Debug, Clone, Args)]
pub struct DepthOptions {
    /// Sensors whose ranges are a depth camera's, by their numbers; a log without numbers has number 0
    #[arg(
        long,
        help_heading = "Depth camera",
        value_name = "N,N",
        value_delimiter = ',',
        allow_negative_numbers = true
    )]
    pub depth: Vec<usize>,
    /// Standard deviation of the inverse range, 1/m
    #[arg(long, help_heading = "Depth camera", value_name = "1/M", default_value_t = Depth::default().inverse_sigma_per_m, allow_negative_numbers = true, value_parser = positive)]
    pub depth_sigma: f64,
    /// Probability that a reading is of the first surface
    #[arg(long, help_heading = "Depth camera", value_name = "P", default_value_t = Depth::default().hit, allow_negative_numbers = true, value_parser = probability)]
    pub depth_hit: f64,
    /// Range beyond which it measures nothing, m
    #[arg(long, help_heading = "Depth camera", value_name = "M", default_value_t = Depth::default().max_range_m, allow_negative_numbers = true, value_parser = positive)]
    pub depth_range: f64,
}

impl DepthOptions {
    /// The camera that they describe.
    pub fn camera(&self) -> Depth {
        Depth { inverse_sigma_per_m: self.depth_sigma, max_range_m: self.depth_range, hit: self.depth_hit }
    }
}

/// Refuses sensors that were called depth cameras and have no ranges.
///
/// # Errors
/// The first such sensor, and what it is.
pub fn refuse_no_ranges(depth: &[usize], place: &str, report: &Report) -> Result<(), Failure> {
    for sensor in depth {
        let what = match report.sensors.get(sensor).and_then(|found| found.kind) {
            Some(Sensor::Laser { .. }) => continue,
            None => "the log has no such sensor".to_owned(),
            Some(kind) => format!("that sensor is {}", called(kind)),
        };
        return Err(Failure::BadInput(format!("{place}: --depth {sensor}: {what}; name one with ranges")));
    }
    Ok(())
}

/// A stereo camera that sees something farther to the side than this, rad, looks all round: no image plane is as wide.
pub const PLANE_RAD: f64 = 87.5 * std::f64::consts::PI / 180.0;

/// Whether a scan of a stereo camera is of one that looks all round.
pub fn is_all_round(scan: &Scan) -> bool {
    scan.bearings_rad.iter().any(|bearing| bearing.abs() > PLANE_RAD)
}

/// What a kind of sensor is called in messages.
pub fn called(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::Laser { .. } => "a laser",
        Sensor::Stereo => "a stereo camera",
        Sensor::Sonar { .. } => "sonars",
    }
}

/// The name of a kind of sensor, as scene files have it.
pub fn kind(sensor: Sensor) -> &'static str {
    let kind = match sensor {
        Sensor::Laser { .. } => SensorKind::Laser,
        Sensor::Stereo => SensorKind::Stereo,
        Sensor::Sonar { .. } => SensorKind::Sonar,
    };
    kind.name()
}

/// The sensors of a log by number as mappers take them: numbers that no scan has are taken for the first sensor.
///
/// # Panics
/// Where there is none.
pub fn sensors(known: &BTreeMap<usize, Shared>) -> Sensors {
    let last = known.keys().next_back().copied().unwrap_or(0);
    let of = |number: usize| known.get(&number).or_else(|| known.values().next());
    Sensors::new((0..=last).filter_map(of).cloned().collect())
}

/// What mappers know of the sensors of a log, of every kind.
#[derive(Debug, Clone, Copy)]
pub struct Kernels {
    /// Of lasers.
    pub laser: LaserOptions,
    /// Of stereo cameras.
    pub stereo: StereoOptions,
    /// Of sonars.
    pub sonar: SonarOptions,
}

impl Kernels {
    /// The model of a sensor that took the log at `place`.
    ///
    /// # Errors
    /// A laser or a sonar that makes no sense.
    pub fn of(&self, place: &str, sensor: Sensor) -> Result<Shared, Failure> {
        match sensor {
            Sensor::Laser { max_range_m, .. } => {
                let LaserOptions { range_sigma, hit, no_echo, early } = self.laser;
                let laser = Laser { range_sigma_m: range_sigma, max_range_m, hit, no_echo, early_per_m: early };
                laser.validate().map_err(|error| Failure::BadInput(format!("{place}: {error}")))?;
                Ok(Arc::new(laser))
            }
            Sensor::Stereo => Ok(Arc::new(self.stereo.camera())),
            Sensor::Sonar { max_range_m, width_rad } => {
                let sonar = self.sonar.sonar(max_range_m, width_rad);
                sonar.validate().map_err(|error| Failure::BadInput(format!("{place}: sonars: {error}")))?;
                Ok(Arc::new(sonar))
            }
        }
    }

    /// What the options say of a log's sensor, for the record.
    pub fn record(&self, kind: Sensor) -> Value {
        let LaserOptions { range_sigma, hit, no_echo, early } = self.laser;
        let StereoOptions { focal_baseline, disparity_sigma, correct_match, max_disparity } = self.stereo;
        match kind {
            Sensor::Laser { max_range_m, .. } => json!({
                "range_sigma_m": range_sigma, "max_range_m": max_range_m, "hit": hit, "no_echo": no_echo, "early_per_m": early,
            }),
            Sensor::Stereo => json!({
                "focal_baseline": focal_baseline, "disparity_sigma": disparity_sigma, "correct_match": correct_match,
                "max_disparity": max_disparity,
            }),
            Sensor::Sonar { max_range_m, width_rad } => json!(self.sonar.sonar(max_range_m, width_rad)),
        }
    }
}
