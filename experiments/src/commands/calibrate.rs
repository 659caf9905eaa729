//! `calibrate`: the parameters of a sensor's kernel that readings ask for, with what is not identified.

mod disparities;
mod log;
mod options;
mod outputs;
pub mod search;

pub use options::CalibrateOptions;

use std::io::{self, Write as _};

use self::search::Fit;
use crate::cli::Format;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::threads;
use crate::output::folder::{Purpose, Staging};
use crate::output::table;

/// What was fitted to what.
pub(crate) struct Calibration {
    /// What it was fitted to, in words.
    pub(crate) about: String,
    /// What is maximised, in words, with its unit.
    pub(crate) measure: &'static str,
    /// Number of readings.
    pub(crate) readings: u64,
    pub(crate) fit: Fit,
    /// The picture of the fit against the readings, if there is one.
    pub(crate) picture: Option<Vec<u8>>,
    /// What is to be known besides.
    pub(crate) notes: Vec<String>,
    /// Options of other commands that use what was found.
    pub(crate) advice: String,
}

/// Fits and tells.
///
/// # Errors
/// Bad input before any work, input that is refused, I/O.
pub fn run(options: &CalibrateOptions) -> Result<(), Failure> {
    interruption::watch();
    threads::limit(options.threads)?;
    let purpose = Purpose::new("calibrate", &[&options.file], outputs::FILES);
    let staging = options.out.as_deref().map(|folder| Staging::open(folder, &purpose)).transpose()?;
    let calibration = match disparities::load(&options.file)? {
        Some(disparities) => disparities::calibrate(&disparities, options)?,
        None => log::calibrate(options)?,
    };
    if let (Some(staging), Some(folder)) = (staging, &options.out) {
        outputs::write(staging, options, &calibration)?;
        let _ = writeln!(io::stderr(), "{}", folder.join("calibration.csv").display());
    }
    match options.format {
        Format::Text => table::print(&outputs::text(&calibration)),
        Format::Csv => outputs::table(&calibration).print(false),
        Format::Json => outputs::table(&calibration).print(true),
    }
}
