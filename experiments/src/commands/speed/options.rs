//! Options of `speed`.

use std::path::PathBuf;

use clap::Args;

use super::scans::Kernel;
use super::world::Known;
use crate::figures::Paper;
use crate::output::args::{FormatOption, Given, count, positive, trimmed};
use crate::programs::options::ProgramOptions;
use crate::worlds::ranked::SortOption;

/// Mappers that are measured where none are named: those that a robot would run, side by side with the ablations.
pub(super) const MAPPERS: &str =
    "visibility,independent,conventional,log-odds-octomap,log-odds-cartographer,no-occlusion";

/// More repeats than this only take time.
const MOST_REPEATS: u32 = 1000;

/// Options of `speed`.
#[derive(Debug, Args)]
#[command(after_long_help = FORM)]
pub struct SpeedOptions {
    /// Scans to map: a CARMEN log, a table (its form: speed --help), or a scene with all of its sensors [default: 360 scans of 200 rays in a hall of 40 m by 40 m]
    #[arg(long, value_name = "FILE")]
    pub scans: Option<PathBuf>,
    /// What the mappers take the scans of --scans for, of a log of one kind of sensor
    #[arg(long, value_enum, default_value_t, requires = "scans")]
    pub sensor: Kernel,
    /// Mappers, comma-separated (see `list`); those that take all scans at once solve once, at the end
    #[arg(long, value_name = "A,B", value_delimiter = ',', value_parser = trimmed, default_value = MAPPERS)]
    pub mappers: Vec<String>,
    /// Programs of one's own that are measured too
    #[command(flatten)]
    pub programs: ProgramOptions,
    /// Side of a cell in metres
    #[arg(long, value_name = "M", default_value_t = 0.05, allow_negative_numbers = true, value_parser = positive)]
    pub grid: f64,
    /// The map covers all poses and what was read up to this range, m [default: every range; of disparities, which can say any, that of 99 in 100]
    #[arg(long, value_name = "M", requires = "scans", allow_negative_numbers = true, value_parser = positive)]
    pub reach: Option<f64>,
    /// Times that every mapper maps the scans; the best counts
    #[arg(long, value_name = "N", default_value_t = 3, allow_negative_numbers = true, value_parser = count(MOST_REPEATS))]
    pub repeats: u32,
    /// What mappers know of the world before the scans that are timed
    #[arg(long, value_enum, default_value_t)]
    pub world: Known,
    /// Measure too how time grows with cells per ray, rays per scan, cells of the map and scans, in cells of 5 cm
    /// whatever --scans and --grid say
    #[arg(long)]
    pub growth: bool,
    /// Folder for tables and pictures, written whole or not at all
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
    /// How rows are ordered
    #[command(flatten)]
    pub order: SortOption,
    /// Which options were given
    #[arg(skip)]
    pub given: Given,
}

const FORM: &str = "\
A table of scans has a row per ray and a head:

    scan,x_m,y_m,theta_rad,bearing_rad,range_m
    0,1.5,2.0,0.0,-0.1,3.25
    0,1.5,2.0,0.0,0.1,
    1,1.6,2.0,0.0,-0.1,3.15

It is read as by `replay` (see replay --help), but no damaged line is passed over: rows that follow each other with one number and one \
pose are a scan, and columns may stand in any order, among others. With --sensor stereo, a range becomes the noise-free disparity \
that the camera of the paper would read, or the table has disparity_px instead. Without a range, or where the camera cannot see \
it (a depth below 0.25 m, or behind the camera), the ray has no reading, and is not counted. With --sensor laser, the range is \
the reading; a range of 80 m or more (in a CARMEN log, of its maximum) is no echo, and is not counted. In a table of several kinds (disparity_px, \
range_m, sonar_m, by the column sensor), and of sonars, each sensor is what it is. What several sensors read at one time is one scan; each is \
measured without the others too.

The map covers all poses and ends of ranges up to --reach, and 1 m more on every side; a scene has a map of its own.";
