//! Options of `slam-worlds`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use scene::Set;
use sensor::OdometryNoise;
use slam::features::FeatureOptions;
use slam::{Options, Weight};

use crate::output::args::{FormatOption, ThreadsOption, count, share, trimmed};
use crate::worlds::scenes::{FAMILIES, scene};
use crate::worlds::weighing::Weighing;

/// Options of `slam-worlds`.
#[derive(Debug, Args)]
pub struct SlamWorldsOptions {
    /// Families of generated scenes, comma-separated: names of `list`, or files
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = scene(), default_value = FAMILIES)]
    pub families: Vec<PathBuf>,
    /// Worlds of each family
    #[arg(long, value_name = "N", default_value_t = 30, allow_negative_numbers = true, value_parser = count(Set::SIZE as u32))]
    pub seeds: u32,
    /// Which worlds: those that results are reported on, or those that parameters are chosen on
    #[arg(long, value_enum, default_value_t)]
    pub set: Worlds,
    /// Sensors, comma-separated
    #[arg(long, value_enum, value_name = "A,B", value_delimiter = ',', default_value = "stereo,laser")]
    pub sensors: Vec<Sensing>,
    /// What particles are weighed by, comma-separated
    #[arg(long, value_enum, value_name = "A,B", value_delimiter = ',', default_value = "field,evidence")]
    pub weights: Vec<By>,
    /// What the readings of a scan are worth of as many independent ones, comma-separated [default: as fitted for each of --weights]
    #[arg(long, value_name = "P,Q", value_delimiter = ',', allow_negative_numbers = true, value_parser = share)]
    pub powers: Vec<f64>,
    /// What the readings of a scan are worth of as many independent ones against the odometry, where they are matched [default: 1]
    #[arg(long, value_name = "P", allow_negative_numbers = true, value_parser = share)]
    pub sharpness: Option<f64>,
    /// Ways that the robot may have gone, which are followed at once
    #[arg(long, value_name = "N", default_value_t = 30, allow_negative_numbers = true, value_parser = count(Options::MOST_PARTICLES as u32))]
    pub particles: u32,
    /// The mapper that every particle has (see `list`)
    #[arg(long, value_name = "NAME", default_value = "visibility", value_parser = trimmed)]
    pub mapper: String,
    /// How the table is printed; csv and json give every world
    #[command(flatten)]
    pub print: FormatOption,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
}

/// A set of worlds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Worlds {
    /// those that results are reported on
    #[default]
    Test,
    /// those that parameters are chosen on
    Tuning,
}

/// What the robot looks with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Sensing {
    /// the camera of the family
    Stereo,
    /// a laser with 181 beams over half a turn
    Laser,
    /// both
    #[value(name = "stereo+laser")]
    Both,
    /// all sensors of the family's robot
    Own,
}

impl Sensing {
    /// Its name in the table.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Stereo => "stereo",
            Self::Laser => "laser",
            Self::Both => "stereo+laser",
            Self::Own => "own",
        }
    }
}

/// What particles are weighed by: a grid, landmarks, or both.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum By {
    /// the likelihood field of the surfaces, as GMapping has it
    Field,
    /// what the particle's map says of the readings
    Evidence,
    /// the field, and landmarks of the features that the camera finds
    #[value(name = "field+landmarks")]
    FieldAndLandmarks,
    /// the evidence, and these landmarks
    #[value(name = "evidence+landmarks")]
    EvidenceAndLandmarks,
    /// these landmarks alone: FastSLAM 2.0, and a map from the poses that it finds
    Landmarks,
}

/// What particles are weighed by, in full.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Weighed {
    pub(super) by: By,
    /// What the grid's part is; none of landmarks alone.
    pub(super) weight: Option<Weight>,
}

impl By {
    const fn grid(self) -> Option<Weighing> {
        match self {
            Self::Field | Self::FieldAndLandmarks => Some(Weighing::Field),
            Self::Evidence | Self::EvidenceAndLandmarks => Some(Weighing::Evidence),
            Self::Landmarks => None,
        }
    }

    /// Its name in the table.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::Evidence => "evidence",
            Self::FieldAndLandmarks => "field+landmarks",
            Self::EvidenceAndLandmarks => "evidence+landmarks",
            Self::Landmarks => "landmarks",
        }
    }
}

impl Weighed {
    /// Whether there are landmarks beside a grid.
    pub(super) fn with_landmarks(&self) -> bool {
        matches!(self.by, By::FieldAndLandmarks | By::EvidenceAndLandmarks)
    }
}

impl SlamWorldsOptions {
    /// The odometry's noise, which the filter knows.
    pub(super) const NOISE: OdometryNoise = OdometryNoise::STANDARD;

    /// Every weight with every power.
    pub(super) fn weighed(&self) -> Vec<Weighed> {
        let of = |by: &By| -> Vec<Weighed> {
            let by = *by;
            let Some(weighing) = by.grid() else { return vec![Weighed { by, weight: None }] };
            let usual = weighing.weight(None).power();
            let powers = if self.powers.is_empty() { vec![usual] } else { self.powers.clone() };
            powers.into_iter().map(|power| Weighed { by, weight: Some(weighing.weight(Some(power))) }).collect()
        };
        self.weights.iter().flat_map(of).collect()
    }

    /// How landmarks alone are followed in a world.
    pub(super) fn features(&self, seed: u64) -> FeatureOptions {
        FeatureOptions { particles: self.particles as usize, seed, ..FeatureOptions::default() }
    }

    /// How the filter works in a world, by one weight.
    pub(super) fn filter(&self, seed: u64, weight: Weight) -> Options {
        let mut options = Options { particles: self.particles as usize, seed, weight, ..Options::default() };
        options.sharpness.power = self.sharpness.unwrap_or(options.sharpness.power);
        options
    }

    /// The numbers of the worlds.
    pub(super) fn numbers(&self) -> std::ops::Range<u64> {
        let set = match self.set {
            Worlds::Test => Set::Test,
            Worlds::Tuning => Set::Tuning,
        };
        set.seeds(u64::from(self.seeds))
    }
}
