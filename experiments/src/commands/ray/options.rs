//! The command line of `ray`.

use std::path::PathBuf;

use clap::Args;

use crate::figures::Paper;
use crate::output::args::Format;

/// Options of `ray`.
#[derive(Debug, Args)]
#[command(after_help = RAY_FILE)]
pub struct RayOptions {
    /// near, distant or occluded (Figures 8, 9 and 10), or a ray file
    #[arg(value_name = "CASE|FILE")]
    pub ray: PathBuf,
    /// Folder for table, pictures and record, written whole or not at all [default: results/ray-CASE, none for a file]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// How pictures are made
    #[command(flatten)]
    pub paper: Paper,
    /// Form of the answers on stdout; csv and json in full precision, json as {"schema_version": 1, "mappers": {...}}
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// The form of a ray file.
const RAY_FILE: &str = "A ray file is TOML. Cell k spans k to k + 1 cell sizes from the sensor.

  cells = 12
  cell_size = 0.05            # m
  observation = 10.0          # px
  prior = 0.1                 # 0 to 1, or a list with one per cell
  correlation = 0.871         # -1 to 1, or a list with one per neighbouring
                              # pair; as it is, whatever the cell size
  no_hit_likelihood = 0.004   # 1/px; if not given, the chain goes on past the
                              # last cell with that cell's prior and the last
                              # pair's correlation
  [sensor]                    # the paper's camera where not given
  focal_baseline = 15.0       # px·m
  disparity_sigma = 0.5       # px
  correct_match = 0.8
  max_disparity = 60.0        # px

Exit codes: 0 done, 1 internal or I/O error, 2 usage or bad input, 3 a claim does not hold, 130 Ctrl-C.";
