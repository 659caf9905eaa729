//! Options for reading a log, and what is to be known of one that was read.

use std::path::Path;

use clap::Args;
use logs::{FanOptions, Finding, Report, Sensor, Unit};

use crate::output::args::{Given, number};
use crate::output::note;

/// Share of damaged lines above which a log is refused.
pub const DAMAGED_SHARE: f64 = 0.05;

/// The name of a log without the extensions that say its form.
pub fn stem(log: &Path) -> String {
    let name = Path::new(log.file_name().unwrap_or_default());
    let packed = ["gz", "bz2", "xz", "zst", "zstd"]
        .iter()
        .any(|known| name.extension().is_some_and(|e| e.eq_ignore_ascii_case(known)));
    let name = if packed { Path::new(name.file_stem().unwrap_or_default()) } else { name };
    let stem = name.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if stem.is_empty() { "log".to_owned() } else { stem }
}

/// Where the beams of a laser go, instead of what its log says or what their number lets guess.
#[derive(Debug, Clone, Copy, Args)]
pub struct FanArgs {
    /// Field of view, degrees [default: what the log says, else by the number of beams]
    #[arg(long, help_heading = "Beams of a laser in a CARMEN log", value_name = "DEG", allow_negative_numbers = true, value_parser = turn)]
    pub fov: Option<f64>,
    /// Bearing of the first beam to the laser's axis, degrees counter-clockwise
    #[arg(long, help_heading = "Beams of a laser in a CARMEN log", value_name = "DEG", allow_negative_numbers = true, value_parser = angle)]
    pub first_bearing: Option<f64>,
    /// From one beam to the next, degrees; negative from left to right
    #[arg(long, help_heading = "Beams of a laser in a CARMEN log", value_name = "DEG", allow_negative_numbers = true, value_parser = step)]
    pub increment: Option<f64>,
}

impl FanArgs {
    /// In rad.
    pub(crate) fn fan(&self) -> FanOptions {
        let [fov_rad, first_rad, step_rad] =
            [self.fov, self.first_bearing, self.increment].map(|degrees| degrees.map(f64::to_radians));
        FanOptions { fov_rad, first_rad, step_rad }
    }
}

fn turn(text: &str) -> Result<f64, String> {
    number(text, "of degrees above 0, at most 360", |value| value > 0.0 && value <= 360.0)
}

fn angle(text: &str) -> Result<f64, String> {
    number(text, "of degrees from -360 to 360", |value| value.abs() <= 360.0)
}

fn step(text: &str) -> Result<f64, String> {
    number(text, "of degrees from -360 to 360, not 0", |value| value.abs() > 0.0 && value.abs() <= 360.0)
}

/// Prints what is to be known of a log on stderr: warnings and notes.
pub(crate) fn tell(place: &str, report: &Report) {
    report.findings().iter().for_each(|finding| say(place, report, finding, finding.is_warning()));
}

/// As [`tell`], but for what can only be judged by a map: poses of the odometry.
pub(crate) fn tell_before_mapping(place: &str, report: &Report) {
    let all = report.findings();
    all.iter().filter(|finding| !waits(finding)).for_each(|finding| say(place, report, finding, finding.is_warning()));
}

/// Prints the rest: a warning where scans do not agree with the map, else a note.
pub(crate) fn tell_after_mapping(place: &str, report: &Report, fails: bool) {
    let all = report.findings();
    all.iter().filter(|finding| waits(finding)).for_each(|finding| say(place, report, finding, fails));
}

/// Options of `replay` and `calibrate` that are of lasers alone, of sonars alone, and of stereo cameras alone.
const OF_LASERS: [&str; 8] =
    ["range_sigma", "hit", "no_echo", "early", "max_range", "fov", "first_bearing", "increment"];
const OF_SONARS: [&str; 6] = ["sonar_range", "sonar_width", "sonar_sigma", "sonar_hit", "sonar_no_echo", "sonar_early"];
const OF_CAMERAS: [&str; 4] = ["focal_baseline", "disparity_sigma", "correct_match", "max_disparity"];

/// Where the beams of a laser go, which a table says for each.
const OF_FANS: [&str; 3] = ["fov", "first_bearing", "increment"];

/// Warns of options that have no effect, since they are of another sensor than the log's.
pub(crate) fn tell_idle(given: &Given, place: &str, report: &Report, sensor: Sensor) {
    let kinds = report.sensors.values().filter_map(|sensor| sensor.kind).map(|kind| std::mem::discriminant(&kind));
    if kinds.collect::<std::collections::HashSet<_>>().len() > 1 {
        return; // each option is of one of the sensors
    }
    match sensor {
        Sensor::Stereo => given.warn(&[&OF_LASERS[..], &OF_SONARS].concat(), place, "a log of a stereo camera"),
        Sensor::Sonar { .. } => given.warn(&[&OF_LASERS[..], &OF_CAMERAS].concat(), place, "a log of sonars"),
        Sensor::Laser { .. } => {
            given.warn(&[&OF_CAMERAS[..], &OF_SONARS].concat(), place, "a log of a laser");
            if report.unit == Unit::Message {
                given.warn(&OF_FANS, place, "a bag, whose scans say where their beams go");
            } else if report.sensors.values().all(|sensor| sensor.name.is_empty()) {
                given.warn(&OF_FANS, place, "a table, which has the bearing of every beam");
            }
        }
    }
}

/// Whether only a map can tell if a finding makes results doubtful.
pub(crate) fn waits(finding: &Finding) -> bool {
    matches!(finding, Finding::OdometryPoses { .. })
}

fn say(place: &str, report: &Report, finding: &Finding, warning: bool) {
    let kind = if warning { "warning" } else { "note" };
    note(format_args!("{kind}: {place}: {}", finding.text(report.unit)));
}
