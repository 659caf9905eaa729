//! `scene from-map MAP` and `scene from-plan PLAN`: a scene file with a route through all that the robot can reach.

use std::path::{Path, PathBuf};

use scene::{MadeScene, MakeError, SurveyOptions};

use super::options::FromMapOptions;
use crate::failure::Failure;
use crate::jobs::progress::Steps;
use crate::output::single::{self, Existing, Whole};
use crate::output::{note, table, warn};

/// Which of the two is read.
#[derive(Debug, Clone, Copy)]
pub(super) enum Drawing {
    /// A ROS map.
    Map,
    /// A floor plan in JSON.
    Plan,
}

/// Prints the scene file, or writes it and prints a line about it.
///
/// # Errors
/// The first problem with the map or plan; no room to drive; a file that cannot be written, or that is the map itself.
pub(super) fn run(options: &FromMapOptions, source: Drawing) -> Result<(), Failure> {
    let defaults = SurveyOptions::default();
    let mut survey = SurveyOptions {
        clearance_m: options.clearance,
        range_m: options.range,
        max_length_m: options.max_length,
        start_m: options.start,
        ..defaults
    };
    survey.robot.radius_m = options.radius;
    survey.camera.columns = options.camera_columns as usize;
    survey.camera.field_of_view_rad = options.camera_field_of_view.to_radians();
    if let Some(path) = &options.out {
        refuse_sources(path, &options.file)?;
        single::refuse_taken(path, &[&options.file], Existing::forced(options.force))?;
    }
    // Printed scenes are for the folder one is in.
    let out = options.out.clone().unwrap_or_else(|| PathBuf::from("scene.toml"));
    let make = match source {
        Drawing::Map => scene::from_map,
        Drawing::Plan => scene::from_plan,
    };
    let bar = Steps::new();
    let made = make(&options.file, &out, &survey, &|progress| bar.show(progress.step, progress.done, progress.of));
    bar.finish();
    let made = made?;
    warn(&made.warnings);
    match &options.out {
        None => {
            // The scene goes to stdout.
            note(summary(&options.file, &made, options.range).trim_end());
            table::print(&made.text)
        }
        Some(path) => {
            let whole = Whole { path: path.clone(), bytes: made.text.clone().into_bytes() };
            single::put(&[whole], &[&options.file], Existing::forced(options.force))?;
            table::print(&summary(path, &made, options.range))
        }
    }
}

/// The map, its image or the plan must not be lost to a slip of the pen.
fn refuse_sources(out: &Path, source: &Path) -> Result<(), Failure> {
    let toml = out.extension().is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    if toml {
        return Ok(());
    }
    let remedy = format!("write a scene next to it, such as {}", source.with_extension("toml").display());
    Err(Failure::BadInput(format!("--out {}: must be a file that ends in .toml; {remedy}", out.display())))
}

fn summary(path: &Path, made: &MadeScene, range_m: f64) -> String {
    let survey = &made.survey;
    let [free, occupied, unknown] = made.cells;
    format!(
        "{}: {free} free, {occupied} occupied and {unknown} unknown cells\n{0}: {} stops, {:.1} m{}, {:.1} m of it with obstacles all round, {} scans; sees {:.1} % of the floor from at most {range_m} m away\n",
        path.display(),
        survey.stops_m.len(),
        survey.length_m,
        if survey.cut { ", cut at --max-length" } else { "" },
        made.enclosure.inside_m,
        made.scans,
        100.0 * survey.seen,
    )
}

impl From<MakeError> for Failure {
    fn from(error: MakeError) -> Self {
        match error.kind() {
            scene::ErrorKind::BadInput => Self::BadInput(error.to_string()),
            scene::ErrorKind::Io => Self::Internal(error.to_string()),
        }
    }
}
