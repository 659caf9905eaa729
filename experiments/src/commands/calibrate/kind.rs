//! Kinds of sensors, as far as calibration tells them apart: which parameters their kernels have, and what they are called.

use std::sync::Arc;

use mapper::Prior;
use sensor::{Depth, Laser, Omnidirectional, SensorModel, Sonar, Stereo};

use super::noise::Instrument;
use super::search::{Parameter, Scale};
use crate::worlds::agreement::Spread;

/// A sensor of a log, with what is known of it beforehand.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Laser {
        max_range_m: f64,
    },
    /// Range and cone are known.
    Sonar(Sonar),
    /// Focal length times baseline and the largest disparity are known.
    Stereo(Stereo),
    Omnidirectional(Stereo),
    /// The range is known.
    Depth(Depth),
}

/// Some false readings there always are: without any, one of them makes a log impossible.
const LEAST_FALSE: f64 = 1e-4;

fn parameter(name: &'static str, unit: &'static str, range: [f64; 2], start: f64, scale: Scale) -> Parameter {
    Parameter { name, unit, range, start, scale }
}

fn belief() -> [Parameter; 2] {
    let Prior { occupancy, correlation, .. } = Prior::default();
    [
        parameter("prior", "1", [0.002, 0.6], occupancy, Scale::Odds),
        parameter("correlation", "1", [0.02, 0.99], correlation, Scale::Odds),
    ]
}

/// What becomes of a pulse: sigma, hit, no echo, early.
fn pulse(names: [&'static str; 4], usual: Laser) -> Vec<Parameter> {
    let Laser { range_sigma_m, hit, no_echo, early_per_m, .. } = usual;
    vec![
        parameter(names[0], "m", [0.002, 0.5], range_sigma_m, Scale::Ratio),
        parameter(names[1], "1", [0.2, 0.9995], hit, Scale::Odds),
        parameter(names[2], "1", [1e-5, 0.5], no_echo, Scale::Odds),
        parameter(names[3], "1/m", [1e-5, 0.5], early_per_m, Scale::Ratio),
    ]
}

impl Kind {
    /// What is fitted: the noise first, the prior and the correlation last.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        let kernel = match self {
            Self::Laser { .. } => pulse(["range_sigma", "hit", "no_echo", "early"], Laser::default()),
            Self::Sonar(_) => {
                let Sonar { range_sigma_m, hit, no_echo, early_per_m, .. } = Sonar::default();
                let usual = Laser { range_sigma_m, hit, no_echo, early_per_m, ..Laser::default() };
                pulse(["sonar_sigma", "sonar_hit", "sonar_no_echo", "sonar_early"], usual)
            }
            Self::Stereo(_) | Self::Omnidirectional(_) => {
                let Stereo { disparity_sigma, correct_match, .. } = Stereo::default();
                vec![
                    parameter("disparity_sigma", "px", [0.02, 5.0], disparity_sigma, Scale::Ratio),
                    parameter("correct_match", "1", [0.05, 0.999], correct_match, Scale::Odds),
                ]
            }
            Self::Depth(_) => {
                let Depth { inverse_sigma_per_m, hit, .. } = Depth::default();
                vec![
                    parameter("inverse_sigma_per_m", "1/m", [1e-4, 0.2], inverse_sigma_per_m, Scale::Ratio),
                    parameter("hit", "1", [0.05, 0.9995], hit, Scale::Odds),
                ]
            }
        };
        kernel.into_iter().chain(belief()).collect()
    }

    /// The sensor and the prior of these values, in the order of the parameters; none where shares add up to more than one.
    pub(super) fn setting(&self, values: &[f64]) -> Option<(Arc<dyn SensorModel>, Prior)> {
        let prior = |at: usize| Prior { occupancy: values[at], correlation: values[at + 1], ..Prior::default() };
        let pulse = |max_range_m: f64| {
            let [range_sigma_m, hit, no_echo, early_per_m] = [values[0], values[1], values[2], values[3]];
            let laser = Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m };
            (laser.outlier() >= LEAST_FALSE && laser.validate().is_ok()).then_some(laser)
        };
        let camera = |known: &Stereo| Stereo { disparity_sigma: values[0], correct_match: values[1], ..*known };
        match self {
            Self::Laser { max_range_m } => pulse(*max_range_m).map(|laser| (Arc::new(laser) as _, prior(4))),
            Self::Sonar(known) => pulse(known.max_range_m).map(|laser| {
                let Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m } = laser;
                let width_rad = known.width_rad;
                let sonar = Sonar { range_sigma_m, max_range_m, hit, no_echo, early_per_m, width_rad };
                (Arc::new(sonar) as _, prior(4))
            }),
            Self::Stereo(known) => Some((Arc::new(camera(known)), prior(2))),
            Self::Omnidirectional(known) => Some((Arc::new(Omnidirectional(camera(known))), prior(2))),
            Self::Depth(known) => {
                let depth = Depth { inverse_sigma_per_m: values[0], hit: values[1], ..*known };
                Some((Arc::new(depth), prior(2)))
            }
        }
    }

    /// The sensor with the usual noise.
    pub(super) fn usual(&self) -> Arc<dyn SensorModel> {
        match *self {
            Self::Laser { max_range_m } => Arc::new(Laser { max_range_m, ..Laser::default() }),
            Self::Sonar(sonar) => Arc::new(sonar),
            Self::Stereo(stereo) => Arc::new(stereo),
            Self::Omnidirectional(stereo) => Arc::new(Omnidirectional(stereo)),
            Self::Depth(depth) => Arc::new(depth),
        }
    }

    /// What its readings say of ranges along their rays; none of a cone, in which a reading says no place.
    pub(super) fn instrument(&self) -> Option<Instrument> {
        match *self {
            Self::Laser { .. } => Some(Instrument::Laser),
            Self::Sonar(_) => None,
            Self::Stereo(stereo) => Some(Instrument::Stereo(stereo)),
            Self::Omnidirectional(stereo) => Some(Instrument::Omnidirectional(stereo)),
            Self::Depth(_) => Some(Instrument::Depth),
        }
    }

    /// How far readings of the usual noise lie from surfaces.
    pub(super) fn spread(&self) -> Spread {
        match self {
            Self::Laser { .. } => Spread::Range(Laser::default().range_sigma_m),
            Self::Sonar(_) => Spread::Cone,
            Self::Stereo(stereo) | Self::Omnidirectional(stereo) => Spread::Disparity(stereo.disparity_sigma),
            // At the middle of its range.
            Self::Depth(depth) => Spread::Range(depth.inverse_sigma_per_m * (0.5 * depth.max_range_m).powi(2)),
        }
    }

    /// What it is, in words.
    pub(super) fn called(&self) -> String {
        match self {
            Self::Laser { max_range_m } => format!("a laser up to {max_range_m} m"),
            Self::Sonar(sonar) => {
                format!(
                    "sonars up to {} m with cones of {:.0} degrees",
                    sonar.max_range_m,
                    sonar.width_rad.to_degrees()
                )
            }
            Self::Stereo(_) => "a stereo camera".to_owned(),
            Self::Omnidirectional(_) => "a stereo camera that looks all round".to_owned(),
            Self::Depth(depth) => format!("a depth camera up to {} m", super::outputs::short(depth.max_range_m)),
        }
    }

    /// The largest range that it reads, m.
    pub(super) fn max_range_m(&self) -> f64 {
        match self {
            Self::Laser { max_range_m } => *max_range_m,
            Self::Sonar(sonar) => sonar.max_range_m,
            Self::Stereo(_) | Self::Omnidirectional(_) => f64::INFINITY,
            Self::Depth(depth) => depth.max_range_m,
        }
    }

    /// Whether pixels without a reading are told of: what a camera sees and does not read.
    pub(super) fn has_pixels(&self) -> bool {
        matches!(self, Self::Depth(_) | Self::Omnidirectional(_))
    }
}
