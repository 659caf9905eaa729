//! Options of `calibrate`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::TypedValueParser as _;

use crate::figures::Paper;
use crate::output::args::{FormatOption, Given, ThreadsOption, count, positive};
use crate::worlds::reading::FanArgs;
use crate::worlds::source::BagArgs;

/// Options of `calibrate`.
#[derive(Debug, Args)]
#[command(after_long_help = FORMS)]
pub struct CalibrateOptions {
    /// A log (see `replay --help`), or disparities with their truth (CSV); their form: calibrate --help
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// Of disparities: those alone that passed a left-right check
    #[arg(long)]
    pub consistent: bool,
    /// Of disparities: the largest searched, px [default: the largest in the file, up to the next whole pixel]
    #[arg(long, value_name = "PX", allow_negative_numbers = true, value_parser = positive)]
    pub max_disparity: Option<f64>,
    /// Of a camera's log: focal length times baseline, px·m
    #[arg(long, value_name = "PX·M", default_value_t = sensor::Stereo::default().focal_baseline, allow_negative_numbers = true, value_parser = positive)]
    pub focal_baseline: f64,
    /// Of a log of several sensors: the number of the one to fit [default: all, which must be of one kind]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(0..256).map(|number| number as usize))]
    pub sensor: Option<usize>,
    /// Of a log: scans to fit, spread evenly over it; all of a shorter one
    #[arg(long, value_name = "N", default_value_t = 200, allow_negative_numbers = true, value_parser = count(1_000_000))]
    pub scans: u32,
    /// Of a log: beams of each, spread evenly over it
    #[arg(long, value_name = "N", default_value_t = 180, allow_negative_numbers = true, value_parser = count(1_000_000))]
    pub beams: u32,
    /// Of a log: side of a cell in metres
    #[arg(long, value_name = "M", default_value_t = 0.05, allow_negative_numbers = true, value_parser = positive)]
    pub grid: f64,
    /// Of a log of a laser: readings from this on are no echo, m [default: what the log says, else 80]
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub max_range: Option<f64>,
    /// What of a bag is read
    #[command(flatten)]
    pub bag: BagArgs,
    /// Where the beams go
    #[command(flatten)]
    pub fan: FanArgs,
    /// Folder for the table, the picture and the record, written whole or not at all
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

const FORMS: &str = "\
Disparities with their truth have the columns disparity_px,true_disparity_px, and for --consistent \
left_right_consistent (0 or 1), among others; with a column row, neighbours in the image are taken for alike. Fitted are the \
probability of a correct match, and the sigma and the offset of a Gaussian, beside false matches that are uniform over 0 to the largest disparity.

Of a log, sigma is that of readings about straight pieces of surface, which are fitted to the other half of the scans. The rest is by \
maps: the mapper `visibility` maps every second scan and predicts the others, and what is maximised is the likelihood of their readings over hit \
(correct match), no echo, early returns, the prior, and the correlation of cells 5 cm apart. Where too few readings lie on straight surfaces, \
sigma is by maps too, is too small, and a note says so. \
The lengths over which views share their errors (--repeat-distance and --repeat-angle of `replay`) are those over which readings of no \
straight piece of surface come again by the same beam: a log can tell them where the robot has stood, or crept, and moved on. \
Intervals hold the values whose likelihood is not lower for sure (95 %), all else as found, by a bootstrap of blocks of neighbouring \
scans or rows. A parameter that the readings do not pin down is named, and is not advised. The last line can be pasted as it stands.";
