//! `calibrate`: the parameters of a sensor's kernel that readings ask for, with what is not identified.

mod advice;
mod agreement;
mod calibration;
mod disparities;
mod log;
pub mod noise;
mod options;
mod outputs;
pub mod search;
mod views;

pub use options::CalibrateOptions;

use logs::bag::Drive;

use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::threads;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;

/// Fits the parameters and prints them.
///
/// # Errors
/// Bad input before any work, input that is refused, I/O.
pub fn run(mut options: CalibrateOptions) -> Result<(), Failure> {
    interruption::watch();
    threads::limit(options.threads.count)?;
    let purpose = Purpose::new("calibrate", &[&options.file], options.paper.files(&outputs::FILES));
    let staging = options.out.as_deref().map(|folder| Staging::open(folder, &purpose)).transpose()?;
    let disparities = if Drive::is_at(&options.file) { None } else { disparities::load(&options.file)? };
    let calibration = match disparities {
        Some(disparities) => disparities::calibrate(&disparities, &options)?,
        None => match log::calibrate(&mut options)? {
            Some(calibration) => calibration,
            None => return Ok(()),
        },
    };
    let options = &options;
    if let (Some(staging), Some(folder)) = (staging, &options.out) {
        outputs::write(staging, options, &calibration)?;
        note(folder.join("calibration.csv").display());
    }
    outputs::table(&calibration).print(options.print.format, || outputs::text(&calibration))
}
