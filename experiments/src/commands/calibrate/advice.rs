//! The command that uses what was found of a log.

use logs::Sensor;
use sensor::{Laser, Stereo};

use super::calibration::Advice;
use super::options::CalibrateOptions;
use super::outputs;
use super::search::{Fit, Found};
use crate::worlds::reading::FanArgs;

/// `replay` with everything that is identified, and what the log was read with.
pub(super) fn replay(sensor: Sensor, options: &CalibrateOptions, is_bag: bool, fit: &Fit) -> Option<Advice> {
    let mut words = vec!["replay".to_owned(), quoted(&options.file.display().to_string())];
    let mut add = |name: &str, value: String| words.extend([format!("--{}", name.replace('_', "-")), value]);
    let mut any = false;
    for found in identified(sensor, fit) {
        add(found.parameter.name, outputs::short(found.value));
        any = true;
    }
    // What one mapper alone takes goes with that mapper.
    if identified(sensor, fit).iter().any(|found| found.parameter.name.starts_with("repeat_")) {
        add("mappers", "visibility,visibility-dynamic".to_owned());
    }
    match sensor {
        // The messages of a bag say which range is the last, and the option would take what lies beyond for no echo.
        Sensor::Laser { .. } if is_bag && options.max_range.is_none() => {}
        Sensor::Laser { max_range_m, .. } => add("max-range", max_range_m.to_string()),
        Sensor::Stereo | Sensor::Sonar => {
            add("focal-baseline", options.focal_baseline.to_string());
            add("max-disparity", options.max_disparity.unwrap_or(Stereo::default().max_disparity).to_string());
        }
    }
    let FanArgs { fov, first_bearing, increment } = &options.fan;
    for (name, value) in [("fov", fov), ("first-bearing", first_bearing), ("increment", increment)] {
        if let Some(value) = value {
            add(name, value.to_string());
        }
    }
    words.extend(options.bag.words().iter().map(|word| quoted(word)));
    any.then(|| Advice { to: "To use it, behind the name of this program:", line: words.join(" ") })
}

/// The parameters to advise. Beside the usual share of hits, which `replay` takes where none is told, that of lost pulses may be too large.
fn identified(sensor: Sensor, fit: &Fit) -> Vec<&Found> {
    let mut known: Vec<&Found> = fit.found.iter().filter(|found| found.unidentified.is_none()).collect();
    let value =
        |known: &[&Found], name: &str| known.iter().find(|found| found.parameter.name == name).map(|found| found.value);
    let usual = Laser::default();
    let hit = value(&known, "hit").unwrap_or(usual.hit);
    let no_echo = value(&known, "no_echo").unwrap_or(usual.no_echo);
    if matches!(sensor, Sensor::Laser { .. }) && hit + no_echo > 1.0 {
        known.retain(|found| !["hit", "no_echo"].contains(&found.parameter.name));
    }
    known
}

/// A word for a shell.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "/._-+,:@%=".contains(c);
    if word.chars().all(plain) { word.to_owned() } else { format!("'{}'", word.replace('\'', "'\\''")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_shell_stay_whole() {
        assert_eq!(quoted("../logs/a-b_1.log.gz"), "../logs/a-b_1.log.gz");
        assert_eq!(quoted("a room's.log"), r"'a room'\''s.log'");
        assert_eq!(quoted("$x"), "'$x'");
    }
}
