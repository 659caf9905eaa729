//! What mappers know of the sensor that took a log.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use clap::Args;
use logs::{Report, Sensor};
use mapper::Sensors;
use sensor::{Laser, SensorKind, SensorModel, Sonar, Stereo};
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

/// The kernel of a sonar; the shares of its echoes are the usual ones.
#[derive(Debug, Clone, Copy, Args)]
pub struct SonarOptions {
    /// Range beyond which a sonar hears nothing, m
    #[arg(long, help_heading = "Sonar", value_name = "M", default_value_t = Sonar::default().max_range_m, allow_negative_numbers = true, value_parser = positive)]
    pub sonar_range: f64,
    /// Angle between the edges of its cone, degrees
    #[arg(long, help_heading = "Sonar", value_name = "DEG", default_value_t = 30.0, allow_negative_numbers = true, value_parser = cone)]
    pub sonar_width: f64,
}

impl SonarOptions {
    /// The sonar that they describe.
    pub fn sonar(&self) -> Sonar {
        Sonar { max_range_m: self.sonar_range, width_rad: self.sonar_width.to_radians(), ..Sonar::default() }
    }
}

fn cone(text: &str) -> Result<f64, String> {
    number(text, "of degrees from 0.1 to 170", |value| (0.1..=170.0).contains(&value))
}

/// What a kind of sensor is called in messages.
pub fn called(sensor: Sensor) -> &'static str {
    match sensor {
        Sensor::Laser { .. } => "a laser",
        Sensor::Stereo => "a stereo camera",
        Sensor::Sonar => "sonars",
    }
}

/// The name of a kind of sensor, as scene files have it.
pub fn kind(sensor: Sensor) -> &'static str {
    let kind = match sensor {
        Sensor::Laser { .. } => SensorKind::Laser,
        Sensor::Stereo => SensorKind::Stereo,
        Sensor::Sonar => SensorKind::Sonar,
    };
    kind.name()
}

/// The sensor of a log that one kernel is fitted to: the chosen one, or all, where they are of one kind.
///
/// # Errors
/// A number that the log does not have, several kinds and no choice, sonars.
pub fn fitted(place: &str, report: &Report, chosen: Option<usize>) -> Result<Sensor, Failure> {
    let known: BTreeMap<usize, Sensor> =
        report.sensors.iter().filter_map(|(number, sensor)| Some((*number, sensor.kind?))).collect();
    let all = || {
        let each = known.iter().map(|(number, sensor)| format!("{number} ({})", called(*sensor)));
        each.collect::<Vec<_>>().join(", ")
    };
    let refuse = |what: String| Err(Failure::BadInput(what));
    let of = known.iter().filter(|(number, _)| chosen.is_none_or(|chosen| chosen == **number));
    let of: Vec<Sensor> = of.map(|(_, sensor)| *sensor).collect();
    let kinds: BTreeSet<&str> = of.iter().map(|sensor| kind(*sensor)).collect();
    match (of.first(), kinds.len()) {
        (None, _) => refuse(format!(
            "--sensor {}: {place} has no such sensor, but {}; give one of these",
            chosen.unwrap_or_default(),
            all()
        )),
        (Some(Sensor::Sonar), 1) => refuse(format!(
            "{place}: holds readings of sonars, and `calibrate` fits lasers and stereo cameras; of a log of several sensors choose one with \
             --sensor: {}",
            all()
        )),
        (Some(sensor), 1) => Ok(*sensor),
        _ => refuse(format!(
            "{place}: holds readings of several kinds of sensors, and `calibrate` fits one; choose it with --sensor: {}",
            all()
        )),
    }
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
    pub laser: LaserOptions,
    pub stereo: StereoOptions,
    pub sonar: SonarOptions,
}

impl Kernels {
    /// The model of a sensor that took the log at `place`.
    ///
    /// # Errors
    /// A laser that makes no sense.
    pub fn of(&self, place: &str, sensor: Sensor) -> Result<Shared, Failure> {
        match sensor {
            Sensor::Laser { max_range_m, .. } => {
                let LaserOptions { range_sigma, hit, no_echo, early } = self.laser;
                let laser = Laser { range_sigma_m: range_sigma, max_range_m, hit, no_echo, early_per_m: early };
                laser.validate().map_err(|error| Failure::BadInput(format!("{place}: {error}")))?;
                Ok(Arc::new(laser))
            }
            Sensor::Stereo => {
                let StereoOptions { focal_baseline, disparity_sigma, correct_match, max_disparity } = self.stereo;
                Ok(Arc::new(Stereo { focal_baseline, disparity_sigma, correct_match, max_disparity }))
            }
            Sensor::Sonar => Ok(Arc::new(self.sonar.sonar())),
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
            Sensor::Sonar => json!(self.sonar.sonar()),
        }
    }
}
