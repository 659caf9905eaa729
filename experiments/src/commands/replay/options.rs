//! Options of `replay`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::{Args, ValueEnum};
use logs::{Event, Report, Sensor, Unit};
use mapper::Repeats;

use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::args::{
    FormatOption, Given, OpenOption, PriorOptions, ThreadsOption, count, positive, probability, trimmed,
};
use crate::output::folder;
use crate::output::recording::RecordingOption;
use crate::programs::options::ProgramOptions;
use crate::worlds::agreement::Spread;
use crate::worlds::kernels::{self, DepthOptions, Kernels, LaserOptions, Shared, SonarOptions, StereoOptions};
use crate::worlds::ranked::SortOption;
use crate::worlds::reading::{self, DAMAGED_SHARE, FanArgs, stem};
use crate::worlds::source::BagArgs;

/// Mappers where none are named: those that a robot would run, and what knows nothing.
const MAPPERS: &str = "visibility,conventional,log-odds-octomap,log-odds-cartographer,prior";

/// Angle over which views share their errors, degrees, where none is given: 0.015 rad in four digits.
pub(super) const REPEAT_DEG: f64 = 0.8594;

/// The mapper to which what repeats is no news.
const HEEDFUL: &str = "visibility-dynamic";

/// Options of `replay`.
#[derive(Debug, Args)]
#[command(after_long_help = FORMATS)]
pub struct ReplayOptions {
    /// CARMEN log or table of scans, plain, gzip or bzip2, or a bag of ROS (.bag, .mcap, .db3, folder); its forms: replay --help
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// Poses instead of the log's (time x y z qx qy qz qw, the TUM format), by the log's own clock; other forms: replay --help
    #[arg(long, value_name = "FILE")]
    pub trajectory: Option<PathBuf>,
    /// What the trajectory is of
    #[arg(long, value_enum, default_value_t)]
    pub body: Body,
    /// Gaps without poses up to this are bridged, s; scans in longer ones are not used
    #[arg(long, value_name = "S", default_value_t = 1.0, allow_negative_numbers = true, value_parser = positive)]
    pub max_gap: f64,
    /// Mappers, comma-separated (see `list`)
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = trimmed, default_value = MAPPERS)]
    pub mappers: Vec<String>,
    /// Programs of one's own that map too
    #[command(flatten)]
    pub programs: ProgramOptions,
    /// Keep every K-th scan back, for the maps to predict
    #[arg(long, value_name = "K", default_value_t = 10, allow_negative_numbers = true, value_parser = clap::value_parser!(u64).range(2..=1_000_000))]
    pub hold_out: u64,
    /// Side of a cell in metres
    #[arg(long, value_name = "M", default_value_t = 0.05, allow_negative_numbers = true, value_parser = positive)]
    pub grid: f64,
    /// The map covers all poses and what was read up to this range, m [default: the range of 99 in 100 echoes]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub reach: Option<f64>,
    /// Also write costmaps of a robot of this radius, m: in percent, the probability that an obstacle stands under it
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub footprint: Option<f64>,
    /// Readings below this are not used, m
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub min_range: Option<f64>,
    /// Readings from this on are no echo, m [default: what the log says, else 80]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub max_range: Option<f64>,
    /// Throw readings beyond this (of a camera the depth) away before any mapper sees them, m; they are predicted all the same [default: all are used]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub map_range: Option<f64>,
    /// Use every N-th scan alone
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true, value_parser = count(1_000_000))]
    pub every: u32,
    /// Use scans of these times alone, s since the first
    #[arg(long, value_name = "FROM,TO", allow_hyphen_values = true, value_parser = window)]
    pub window: Option<[f64; 2]>,
    /// Use a scan only once the sensor has moved so far, m, or turned by --least-turn
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub least_move: Option<f64>,
    /// As --least-move, for turns, degrees
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = positive)]
    pub least_turn: Option<f64>,
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
    /// What the mappers know of depth cameras
    #[command(flatten)]
    pub depth: DepthOptions,
    /// Views up to so far apart share their false readings, m: what repeats is no news to `visibility-dynamic`
    #[arg(long, value_name = "M", default_value_t = Repeats::CHOSEN.distance_m, allow_negative_numbers = true, value_parser = positive)]
    pub repeat_distance: f64,
    /// As --repeat-distance, for turns, degrees
    #[arg(long, value_name = "DEG", default_value_t = REPEAT_DEG, allow_negative_numbers = true, value_parser = positive)]
    pub repeat_angle: f64,
    /// Map with one mapper after the other, and tell on stderr how long each took, without reading and predicting
    #[arg(long)]
    pub timing: bool,
    /// Folder for tables, maps, pictures and report, written whole or not at all [default: results/replay- and the log's name]
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
    /// How rows are ordered
    #[command(flatten)]
    pub order: SortOption,
    /// Whether the page is shown
    #[command(flatten)]
    pub open: OpenOption,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
    /// Which options were given
    #[arg(skip)]
    pub given: Given,
}

/// What a trajectory is of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Body {
    /// the sensor
    #[default]
    Sensor,
    /// the robot, on which the sensor stands as the log says
    Robot,
}

fn window(text: &str) -> Result<[f64; 2], String> {
    let bound = "two numbers of seconds that rise, such as 60,120";
    let parts: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match parts[..] {
        [from, to] if from < to && from.is_finite() && text.split(',').count() == 2 => Ok([from, to]),
        _ => Err(format!("must be {bound}")),
    }
}

impl ReplayOptions {
    /// How the log is read.
    pub(super) fn reading(&self) -> logs::Options {
        logs::Options {
            min_range_m: self.min_range.unwrap_or(0.0),
            max_range_m: self.max_range,
            max_sonar_m: self.sonar.sonar_range,
            max_disparity_px: Some(self.stereo.max_disparity),
            fan: self.fan.fan(),
            max_gap_s: self.max_gap,
            every: u64::from(self.every),
            window_s: self.window.map(|[from, to]| from..to),
            least_move_m: self.least_move,
            least_turn_rad: self.least_turn.map(f64::to_radians),
            damaged_share: self.damaged_share,
            ..logs::Options::default()
        }
    }

    /// Where the files go.
    pub(super) fn out(&self) -> PathBuf {
        let usual = || {
            let base = Path::new("results").join(format!("replay-{}", stem(&self.log)));
            folder::for_source(&base, &self.log, |record| record["configuration"]["log"].as_str().map(PathBuf::from))
        };
        self.out.clone().unwrap_or_else(usual)
    }

    /// How far readings of the sensor that took the log deviate.
    pub(super) fn spread(&self, sensor: Sensor) -> Spread {
        match sensor {
            Sensor::Laser { .. } => Spread::Range(self.laser.range_sigma),
            Sensor::Stereo => Spread::Disparity(self.stereo.disparity_sigma),
            Sensor::Sonar { .. } => Spread::Cone,
        }
    }

    /// Warns of options that have no effect on this log.
    pub(super) fn tell_idle(&self, place: &str, report: &Report, sensor: Sensor) {
        reading::tell_idle(&self.given, place, report, sensor);
        let is_bag = report.unit == Unit::Message;
        if self.trajectory.is_none()
            && !is_bag
            && report.sensors.values().all(|sensor| !sensor.name.starts_with("RAWLASER") && sensor.name != "SONAR")
        {
            self.given.warn(&["max_gap"], place, "a log that has poses of its own");
        }
        if self.depth.depth.is_empty() {
            let of_depth = ["depth_sigma", "depth_hit", "depth_range"];
            self.given.warn(&of_depth, place, "a log in which --depth names no sensor");
        }
        if !self.mappers.iter().any(|mapper| mapper == HEEDFUL) {
            let among = format!("of which none is {HEEDFUL}");
            self.given.warn(&["repeat_distance", "repeat_angle"], "these mappers", &among);
        }
    }

    /// When readings repeat.
    pub(super) fn repeats(&self) -> Repeats {
        let is_usual = self.repeat_angle.total_cmp(&REPEAT_DEG).is_eq();
        let angle_rad = if is_usual { Repeats::CHOSEN.angle_rad } else { self.repeat_angle.to_radians() };
        Repeats { distance_m: self.repeat_distance, angle_rad, ..Repeats::CHOSEN }
    }

    /// What the mappers know of the sensors that took the log.
    pub(super) fn kernels(&self) -> Kernels {
        Kernels { laser: self.laser, stereo: self.stereo, sonar: self.sonar }
    }

    /// The same of one of them.
    pub(super) fn sensor(&self, sensor: Sensor) -> Result<Shared, Failure> {
        self.kernels().of(&self.log.display().to_string(), sensor)
    }

    /// What the mappers know of the sensor that took a scan of the log.
    pub(super) fn sensor_of(&self, event: &Event) -> Result<Shared, Failure> {
        match event.kind {
            Sensor::Laser { .. } if self.depth.depth.contains(&event.sensor) => Ok(Arc::new(self.depth.camera())),
            Sensor::Stereo if kernels::is_all_round(&event.scan) => Ok(Arc::new(self.stereo.all_round())),
            kind => self.sensor(kind),
        }
    }
}

const FORMATS: &str = "\
Logs of lasers and sonars: CARMEN (FLASER, RLASER, ROBOTLASER1 to 5, RAWLASER1 to 5 with poses from ODOM, and SONAR with poses from the lasers' or from \
ODOM; other messages are skipped and counted), and \
tables (CSV; also with semicolons, tabs or blanks) with the columns scan,x_m,y_m,theta_rad,bearing_rad,range_m, time_s if there are times, and \
sensor if there are several; range_m is inf where no echo came back, and empty, NaN, 0 or negative where a beam says nothing. Logs of \
stereo cameras: such tables with disparity_px, as `room` writes them (scans.csv); no match is empty, NaN, 0, negative, or above --max-disparity. \
Logs of sonars: such tables with sonar_m, a row for each cone. A table may have several of these columns, each sensor its own; what sensors read at one time is one scan.

Bags of ROS 1 (.bag, format 2.0) and ROS 2 (.mcap, .db3, or the folder of either): LaserScan, DisparityImage and Image of depths (16UC1, 32FC1, with \
CameraInfo) are scans, each topic a sensor; Odometry, PoseStamped, PoseWithCovarianceStamped and TF are poses, and TF says where sensors stand on the \
robot. --topics lists what there is. Of an image the row at the axis of the camera is read, a beam per column; --rows takes the nearest of several. \
A camera of depths is taken for a stereo camera of --focal-baseline.

Costmaps (--footprint) are NAME-footprint.yaml with .pgm in mode raw, 0 to 100, for nav2_map_server and a static layer with \
trinary_costmap: false and lethal_cost_threshold: 50. Walls that are known to lie somewhere among a few cells are obstacles in them, and no inflation by \
the radius is needed.

Trajectories may have times in ns, us or ms, commas, quaternions in the order w x y z (EuRoC), and poses that are not in order: what is \
taken for what is said.

The score is the mean of -ln P(reading | map) over the readings of scans kept back: nats per reading, lower is better. One \
model predicts for all maps: the likelihood of the reading over the first occupied cell on its ray under the map's own \
probabilities; a row NAME-chain is the same with the joint probabilities of neighbours, for maps that hold them. Recalibrated \
scores are of maps whose log odds were multiplied by a slope and moved by a shift that were fitted to scans neither mapped nor \
scored, so that neither clamps nor overconfidence decide. Intervals are 95 % by a bootstrap of blocks of scans that follow each \
other.";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_log_keeps_its_dots() {
        for (log, expected) in [
            ("2026-11-26.a.log", "2026-11-26.a"),
            ("2026-11-26.b.log.gz", "2026-11-26.b"),
            ("day1/run.csv", "run"),
            ("run.CLF.BZ2", "run"),
            ("run", "run"),
            ("v1.2", "v1"),
            ("..", "log"),
        ] {
            assert_eq!(stem(Path::new(log)), expected, "{log}");
        }
    }
}
