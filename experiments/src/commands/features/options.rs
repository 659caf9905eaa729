//! Options of `features`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use sensor::OdometryNoise;
use slam::features::{Association, FeatureOptions, FeatureProposal, Identity};

use super::filter::Filter;
use super::metrics::METRICS;
use crate::figures::Paper;
use crate::output::args::{FormatOption, Given, ThreadsOption, count, number, positive, share};
use crate::output::folder;
use crate::worlds::bound::{Bound, bound};
use crate::worlds::kernels::StereoOptions;
use crate::worlds::odometry::noise;
use crate::worlds::reading::stem;

/// Options of `features`.
#[derive(Debug, Args)]
pub struct FeaturesOptions {
    /// Scene or family, or a table of features: scan,time_s,bearing_rad,disparity_px, and more (guide features)
    #[arg(value_name = "SCENE|TABLE", required_unless_present = "posts", conflicts_with = "posts")]
    pub source: Option<PathBuf>,
    /// An open field of so many posts instead of a scene, another one for each seed
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub posts: Option<u32>,
    /// What finds the landmarks; files and picture are of the first
    #[arg(long, value_enum, value_delimiter = ',', value_name = "NAME,..", default_value = "fastslam2")]
    pub filter: Vec<Filter>,
    /// Ways that the robot may have gone, which are followed at once
    #[arg(long, value_name = "N", default_value_t = FeatureOptions::default().particles as u32, allow_negative_numbers = true, value_parser = count(FeatureOptions::MOST_PARTICLES as u32))]
    pub particles: u32,
    /// Seed of all random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// So many seeds, one after the other; means come with an interval of 95 % from 6 on
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = count(10_000))]
    pub runs: u32,
    /// Whether readings say which feature they are of
    #[arg(long, value_enum, default_value_t)]
    pub identity: Asked,
    /// Do not doubt landmarks that should have been seen and were not
    #[arg(long)]
    pub no_negative_evidence: bool,
    /// A landmark should be seen no farther than this from where it was seen last, m, since a wall may hide it; inf in the open [default: 0.3, with --posts inf]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = vantage)]
    pub vantage: Option<f64>,
    /// Standard deviations of the odometry: rad per rad turned, rad per m, m per m, m per rad
    #[arg(long, value_name = "A,B,C,D", allow_hyphen_values = true, value_parser = noise)]
    pub noise: Option<OdometryNoise>,
    /// A landmark is of a feature within this distance, m, where it is scored
    #[arg(long, value_name = "M", default_value_t = 0.5, allow_negative_numbers = true, value_parser = positive)]
    pub gate: f64,
    /// Plan drives on the landmarks of a scene, with all between them taken for free, and on the grid that `visibility` makes of the same drive
    #[arg(long)]
    pub drives: bool,
    /// Fails (exit code 3) where the mean of a metric of the first filter is larger, such as ate=0.2; may be given several times
    #[arg(long, value_name = "METRIC=BOUND", allow_hyphen_values = true, value_parser = |text: &str| bound(text, &METRICS))]
    pub at_most: Vec<Bound>,
    /// Layout of a family of scenes
    #[arg(long, value_name = "N")]
    pub layout: Option<u64>,
    /// Standard deviation of a bearing, rad [default: of a scene half a column, else 0.005]
    #[arg(long, value_name = "RAD", allow_negative_numbers = true, value_parser = positive)]
    pub bearing_sigma: Option<f64>,
    /// Features beyond this depth are not looked for, m [default: where the disparity is three standard deviations]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub depth: Option<f64>,
    /// Probability that a feature in view is found [default: of a scene its camera's, else 0.9]
    #[arg(long, value_name = "P", allow_negative_numbers = true, value_parser = share)]
    pub detection: Option<f64>,
    /// Field of view of the camera that made a table, degrees
    #[arg(long, value_name = "DEG", default_value_t = 70.0, allow_negative_numbers = true, value_parser = field_of_view)]
    pub fov: f64,
    /// The camera that made a table; a scene has its own
    #[command(flatten)]
    pub stereo: StereoOptions,
    /// Folder for trajectory, landmarks, tables and picture, written whole or not at all [default: results/features- and the source's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
    /// Which options were given
    #[arg(skip)]
    pub given: Given,
}

/// Whether readings say which feature they are of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Asked {
    /// they do not, or are not asked: the likeliest landmark
    #[default]
    Unknown,
    /// they do
    Known,
}

fn field_of_view(text: &str) -> Result<f64, String> {
    number(text, "above 0, below 180", |value| value > 0.0 && value < 180.0)
}

fn vantage(text: &str) -> Result<f64, String> {
    number(text, "above 0, or inf", |value| value > 0.0)
}

impl FeaturesOptions {
    /// The filters, each once.
    pub(super) fn filters(&self) -> Vec<Filter> {
        let mut filters: Vec<Filter> = Vec::new();
        for filter in &self.filter {
            if !filters.contains(filter) {
                filters.push(*filter);
            }
        }
        filters
    }

    /// What messages call the source.
    pub(super) fn place(&self) -> String {
        match (&self.source, self.posts) {
            (Some(path), _) => crate::worlds::scenes::or_file(path).0.display().to_string(),
            (None, posts) => format!("field of {} posts", posts.unwrap_or_default()),
        }
    }

    /// How readings and landmarks find each other.
    pub(super) fn association(&self) -> Association {
        let usual = if self.posts.is_some() { f64::INFINITY } else { Association::default().vantage_m };
        let identity = match self.identity {
            Asked::Unknown => Identity::Unknown,
            Asked::Known => Identity::Known,
        };
        Association {
            identity,
            negative_evidence: !self.no_negative_evidence,
            vantage_m: self.vantage.unwrap_or(usual),
            ..Association::default()
        }
    }

    /// How particles are followed.
    pub(super) fn particle_filter(&self, proposal: FeatureProposal, seed: u64) -> FeatureOptions {
        FeatureOptions { particles: self.particles as usize, seed, proposal, association: self.association() }
    }

    /// How far the odometry is off.
    pub(super) fn noise(&self) -> OdometryNoise {
        self.noise.unwrap_or(OdometryNoise::STANDARD)
    }

    /// Where the files go.
    pub(super) fn out(&self, place: &str) -> PathBuf {
        if let Some(out) = &self.out {
            return out.clone();
        }
        match self.posts {
            Some(posts) => Path::new("results").join(format!("features-posts-{posts}")),
            None => {
                let base = Path::new("results").join(format!("features-{}", stem(Path::new(place))));
                let source = |record: &serde_json::Value| record["configuration"]["source"].as_str().map(PathBuf::from);
                folder::for_source(&base, Path::new(place), source)
            }
        }
    }
}
