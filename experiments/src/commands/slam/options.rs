//! Options of `slam`.

use std::path::{Path, PathBuf};

use clap::Args;
use sensor::OdometryNoise;
use slam::Options;

use super::metrics::METRICS;
use crate::figures::Paper;
use crate::output::args::{
    FormatOption, Given, PriorOptions, ThreadsOption, count, positive, probability, share, trimmed,
};
use crate::output::folder;
use crate::output::recording::RecordingOption;
use crate::worlds::bound::{Bound, bound};
use crate::worlds::kernels::{Kernels, LaserOptions, SonarOptions, StereoOptions};
use crate::worlds::odometry::noise;
use crate::worlds::reading::{DAMAGED_SHARE, FanArgs, stem};
use crate::worlds::source::BagArgs;
use crate::worlds::weighing::Weighing;

/// Options of `slam`.
#[derive(Debug, Args)]
pub struct SlamOptions {
    /// Log with odometry (CARMEN, a table with odom_x_m, odom_y_m, odom_theta_rad, or a bag of ROS), or a scene that has odometry; forms of logs: replay --help
    #[arg(value_name = "LOG|SCENE")]
    pub source: PathBuf,
    /// Ways that the robot may have gone, which are followed at once
    #[arg(long, value_name = "N", default_value_t = 30, allow_negative_numbers = true, value_parser = count(Options::MOST_PARTICLES as u32))]
    pub particles: u32,
    /// Seed of all random numbers
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// The mapper that every particle has (see `list`)
    #[arg(long, value_name = "NAME", default_value = "visibility", value_parser = trimmed)]
    pub mapper: String,
    /// What particles are weighed by
    #[arg(long, value_enum, default_value_t)]
    pub weight: Weighing,
    /// What the readings of a scan are worth of as many independent ones, where particles are weighed [default: as fitted for --weight]
    #[arg(long, value_name = "P", allow_negative_numbers = true, value_parser = share)]
    pub power: Option<f64>,
    /// Weigh particles also by the features that the camera of a scene finds: each has landmarks beside its map (guide features)
    #[arg(long)]
    pub landmarks: bool,
    /// A scan is matched and mapped once the sensor has moved so far, m, or turned by --update-turn
    #[arg(long, value_name = "M", default_value_t = 0.2, allow_negative_numbers = true, value_parser = positive)]
    pub update_move: f64,
    /// As --update-move, for turns, degrees
    #[arg(long, value_name = "DEG", default_value_t = 10.0, allow_negative_numbers = true, value_parser = positive)]
    pub update_turn: f64,
    /// Standard deviations of the odometry: rad per rad turned, rad per m, m per m, m per rad
    #[arg(long, value_name = "A,B,C,D", allow_hyphen_values = true, value_parser = noise)]
    pub noise: Option<OdometryNoise>,
    /// Trajectory that is believed, to be scored against (TUM format, by the log's clock); a scene brings its own
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
    /// Relations between poses that are believed, to be scored against (Kümmerle et al. 2009)
    #[arg(long, value_name = "FILE")]
    pub relations: Option<PathBuf>,
    /// Fails (exit code 3) where the mean error of the way that was found is larger: a metric of metrics.csv and its bound in m or degrees, such as ate=0.05; may be given several times
    #[arg(long, value_name = "METRIC=BOUND", allow_hyphen_values = true, value_parser = |text: &str| bound(text, &METRICS))]
    pub at_most: Vec<Bound>,
    /// Layout of a family of scenes
    #[arg(long, value_name = "N")]
    pub layout: Option<u64>,
    /// Side of a cell in metres [default: 0.05, of a scene its own]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub grid: Option<f64>,
    /// The map covers so much round the way by the odometry, m [default: the range of 99 in 100 echoes, and 5 m]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub reach: Option<f64>,
    /// Readings below this are not used, m
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub min_range: Option<f64>,
    /// Readings from this on are no echo, m [default: what the log says, else 80]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub max_range: Option<f64>,
    /// Use every N-th scan alone
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = count(1_000_000))]
    pub every: u32,
    /// Use scans of these times alone, s since the first
    #[arg(long, value_name = "FROM,TO", allow_hyphen_values = true, value_parser = window)]
    pub window: Option<[f64; 2]>,
    /// Share of damaged lines above which the log is refused
    #[arg(long, value_name = "P", default_value_t = DAMAGED_SHARE, allow_negative_numbers = true, value_parser = probability)]
    pub damaged_share: f64,
    /// What of a bag is read
    #[command(flatten)]
    pub bag: BagArgs,
    /// Where the beams go
    #[command(flatten)]
    pub fan: FanArgs,
    /// What the mappers assume before the first reading
    #[command(flatten)]
    pub prior: PriorOptions,
    /// What the mappers know of a laser
    #[command(flatten)]
    pub laser: LaserOptions,
    /// What the mappers know of a stereo camera
    #[command(flatten)]
    pub stereo: StereoOptions,
    /// What the mappers know of sonars
    #[command(flatten)]
    pub sonar: SonarOptions,
    /// Folder for trajectory, map, tables and picture, written whole or not at all [default: results/slam- and the log's name]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// What is recorded beside
    #[command(flatten)]
    pub recording: RecordingOption,
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

fn window(text: &str) -> Result<[f64; 2], String> {
    match numbers(text)[..] {
        [from, to] if from < to => Ok([from, to]),
        _ => Err("must be two numbers of seconds that rise, such as 60,120".to_owned()),
    }
}

/// The finite numbers of a list; none where a part is no such number.
fn numbers(text: &str) -> Vec<f64> {
    let parts: Option<Vec<f64>> =
        text.split(',').map(|part| part.trim().parse().ok().filter(|value: &f64| value.is_finite())).collect();
    parts.unwrap_or_default()
}

impl SlamOptions {
    /// How the filter works on a log or a scene.
    pub(super) fn filter_of(&self, is_log: bool) -> Options {
        let usual = self.filter();
        Options { least_sigmas: if is_log { Options::OF_LOGS } else { usual.least_sigmas }, ..usual }
    }

    /// How the filter works, whatever the source.
    pub(super) fn filter(&self) -> Options {
        Options {
            particles: self.particles as usize,
            seed: self.seed,
            weight: self.weight.weight(self.power),
            update_move_m: self.update_move,
            update_turn_rad: self.update_turn.to_radians(),
            ..Options::default()
        }
    }

    /// How far the odometry is off.
    pub(super) fn noise(&self) -> OdometryNoise {
        self.noise.unwrap_or(OdometryNoise::STANDARD)
    }

    /// What the mappers know of the sensors that took a log.
    pub(super) fn kernels(&self) -> Kernels {
        Kernels { laser: self.laser, stereo: self.stereo, sonar: self.sonar }
    }

    /// How a log is read.
    pub(super) fn reading(&self) -> logs::Options {
        logs::Options {
            min_range_m: self.min_range.unwrap_or(0.0),
            max_range_m: self.max_range,
            max_disparity_px: Some(self.stereo.max_disparity),
            fan: self.fan.fan(),
            every: u64::from(self.every),
            window_s: self.window.map(|[from, to]| from..to),
            damaged_share: self.damaged_share,
            ..logs::Options::default()
        }
    }

    /// Where the files go, of a log or scene at a place.
    pub(super) fn out(&self, place: &str) -> PathBuf {
        let usual = || {
            let base = Path::new("results").join(format!("slam-{}", stem(Path::new(place))));
            let source = |record: &serde_json::Value| record["configuration"]["source"].as_str().map(PathBuf::from);
            folder::for_source(&base, Path::new(place), source)
        };
        self.out.clone().unwrap_or_else(usual)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_of_numbers_are_whole_or_refused() {
        assert_eq!(window("1, 2.5"), Ok([1.0, 2.5]));
        assert!(["2,1", "1", "1,2,3", "a,b", "1,inf"].iter().all(|text| window(text).is_err()));
    }
}
