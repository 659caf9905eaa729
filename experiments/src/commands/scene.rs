//! `scene`: scene files, new or from families of scenes, maps and floor plans.

mod from_map;
mod generate;
mod new;
mod options;

pub use options::SceneCommand;

use self::from_map::Drawing;
use crate::failure::Failure;

/// Makes a scene file.
///
/// # Errors
/// The first problem with what it is made from; a file that cannot be written.
pub fn run(command: &SceneCommand) -> Result<(), Failure> {
    match command {
        SceneCommand::New(options) => new::run(options),
        SceneCommand::Generate(options) => generate::run(options),
        SceneCommand::FromMap(options) => from_map::run(options, Drawing::Map),
        SceneCommand::FromPlan(options) => from_map::run(options, Drawing::Plan),
    }
}
