//! `calibrate`: the parameters of a sensor's kernel that readings ask for, with what is not identified.

mod advice;
mod agreement;
mod calibration;
mod disparities;
mod groups;
mod kind;
mod log;
pub mod noise;
mod options;
mod outputs;
mod pixels;
pub mod search;
mod views;

pub use options::CalibrateOptions;

use logs::bag::Drive;

use self::calibration::Found;

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
    let found = match disparities {
        Some(disparities) => Found::of(disparities::calibrate(&disparities, &options)?),
        None => match log::calibrate(&mut options)? {
            Some(found) => found,
            None => return Ok(()),
        },
    };
    let options = &options;
    let place = options.file.display();
    found.left_out.iter().for_each(|why| note(format_args!("warning: {place}: {why}")));
    if let (Some(staging), Some(folder)) = (staging, &options.out) {
        outputs::write(staging, options, &found)?;
        note(folder.join("calibration.csv").display());
    }
    outputs::table(&found).print(options.print.format, || outputs::text(&found))
}
