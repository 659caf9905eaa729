//! Options of `score`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use mapper::Prior;
use score::Finer;

use crate::figures::Paper;
use crate::output::args::{FormatOption, ThreadsOption, number, positive, probability};
use crate::worlds::drives::DriveOptions;
use crate::worlds::map_file::{Origin, RowOrder, Shading, origin, side};
use crate::worlds::ranked::SortOption;
use crate::worlds::scenes::scene;

/// Options of `score`.
#[derive(Debug, Args)]
#[command(after_long_help = HOW)]
pub struct ScoreOptions {
    /// Maps to score: .yaml with its image, .npy, or .pgm and .png without YAML; the first is what others are compared with
    #[arg(value_name = "MAP", required = true)]
    pub maps: Vec<PathBuf>,
    /// What is true: a scene or family (a name of `list`, or a file), or a map in any of these forms
    #[arg(long, value_name = "TRUTH", value_parser = scene())]
    pub truth: PathBuf,
    /// Which scene of the family [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub layout: Option<u64>,
    /// Side of a cell of the truth in metres, instead of the scene's
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub grid: Option<f64>,
    /// Scans of a log in the frame of the truth, such as scans.csv of `room`: regions are what their rays could see
    #[arg(long, value_name = "FILE")]
    pub scans: Option<PathBuf>,
    /// What a cell counts as of which a map knows nothing
    #[arg(long, value_enum, default_value_t)]
    pub unknown: Unknown,
    /// Probability that an unknown cell is occupied
    #[arg(long, value_name = "P", default_value_t = Prior::default().occupancy, allow_negative_numbers = true, value_parser = probability)]
    pub prior: f64,
    /// What a cell of the truth takes of several cells of a finer map
    #[arg(long, value_enum, default_value_t)]
    pub finer: FinerCells,
    /// Move every map to where it agrees best with the truth
    #[arg(long, value_enum, default_value_t)]
    pub align: Align,
    /// How far --align may move the middle of the truth's world, m
    #[arg(long, value_name = "M", default_value_t = 0.5, allow_negative_numbers = true, value_parser = reach)]
    pub align_bound: f64,
    /// How far --align rigid may turn a map either way, degrees
    #[arg(long, value_name = "DEG", default_value_t = 5.0, allow_negative_numbers = true, value_parser = turn)]
    pub align_turn: f64,
    /// What the shades of images without YAML mean [default: trinary]
    #[arg(long, value_enum, value_name = "MODE")]
    pub read_as: Option<Shading>,
    /// Which row of the map its .npy file begins with; of MAPs alone
    #[arg(long, value_enum, value_name = "ROW")]
    pub row_order: Option<RowOrder>,
    /// Side of a cell in metres, of files that do not say it
    #[arg(long, visible_alias = "cell", value_name = "M", allow_negative_numbers = true, value_parser = side)]
    pub resolution: Option<f64>,
    /// Lower-left corner in metres and angle in radians, of files that do not say it
    #[arg(long, value_name = "X,Y,YAW", allow_hyphen_values = true, value_parser = origin)]
    pub origin: Option<Origin>,
    /// Drives that are planned on every map
    #[command(flatten)]
    pub drives: DriveOptions,
    /// Folder for tables, pictures and report, written whole or not at all [default: none is written]
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
    /// Show the page in the browser when it is written
    #[arg(long, requires = "out")]
    pub open: bool,
    /// How many threads work
    #[command(flatten)]
    pub threads: ThreadsOption,
}

/// What a cell counts as of which a map knows nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Unknown {
    /// occupied with the probability --prior
    #[default]
    Prior,
    /// nothing: it is not scored
    Skip,
    /// an obstacle
    Occupied,
}

/// How a map may be moved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Align {
    /// not at all
    #[default]
    None,
    /// without a turn
    Shift,
    /// with a turn
    Rigid,
}

fn reach(text: &str) -> Result<f64, String> {
    number(text, "of metres above 0, at most 100", |value| value > 0.0 && value <= 100.0)
}

fn turn(text: &str) -> Result<f64, String> {
    number(text, "of degrees above 0, at most 45", |value| value > 0.0 && value <= 45.0)
}

/// Names of [`Finer`] on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum FinerCells {
    /// their mean
    #[default]
    Mean,
    /// the greatest
    Greatest,
}

impl From<FinerCells> for Finer {
    fn from(finer: FinerCells) -> Self {
        match finer {
            FinerCells::Mean => Self::Mean,
            FinerCells::Greatest => Self::Greatest,
        }
    }
}

impl Align {
    /// The name on the command line.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Shift => "shift",
            Self::Rigid => "rigid",
        }
    }
}

impl Unknown {
    /// The name on the command line.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Prior => "prior",
            Self::Skip => "skip",
            Self::Occupied => "occupied",
        }
    }
}

const HOW: &str = "\
Maps are scored in the cells of the truth. A map with other cells is brought into them: a coarser one gives the value of its cell about the centre of the truth's \
cell, a finer one the mean (--finer) over points spread evenly over it. Cells whose truth is not known are never scored. A map without a place lies where the \
truth does if it has as many rows and columns.

--align looks for the greatest correlation of map and truth, both smoothed by a Gaussian of a cell, where both are known. The map turns about the middle of the \
truth (align_turn, degrees, counter-clockwise) and then moves (align_x, align_y, m); unaligned_log_loss, unaligned_brier and unaligned_iou are the scores before.

With --scans, maps are scored over what the rays could see, in the regions of `room`: rays are cast without noise in the scene, or in a map up to the first cell that is not known to be free. \
Log loss and Brier score are told by the range from which cells were seen best, too (`range 1-1.5`, m, the upper end not included), and by the number of rays that \
looked at them (`looks 4-8`). Without, every known cell of the truth is scored, region `all`, and every occupied cell can be missed (missed_area). Metrics are those of `room` but for \
retention, which needs the maps after every scan, and a file holds one: of a program that makes them, `room --mapper NAME='online: COMMAND'` tells it. `known` is the share of the region of which the map knows something, `outside` the share beyond its border.

Drives (reached, colliding, detour; region `all`) go between the same pairs of places on every map: places and pairs follow from the truth, where a robot's disc stands clear and a way of at most 30 m joins them, at least 1 m apart. \
They are planned in the cells of the truth, 8 neighbours, on what the map takes for free, and driven as a disc among the scene's obstacles, or among the occupied cells of a map. reached is the share planned and driven without a collision, \
colliding the share planned and driven into something; the rest was not planned. footprint_reached, footprint_colliding and footprint_detour are the same of plans by the probability that an obstacle stands under the disc. detour is the mean length of those reached over a shortest way in the truth.

Differences are MAP minus the first MAP over the cells that both are scored on. Their 95 % intervals are those of a bootstrap of square tiles of this one \
world, since neighbouring cells err together; they say nothing of other worlds, and are not adjusted for the number of metrics. A verdict needs at least six tiles.";
