//! What uses what was found of a log: a command, or a sensor of a scene file.

use sensor::Laser;

use super::calibration::Advice;
use super::kind::Kind;
use super::options::CalibrateOptions;
use super::outputs;
use super::search::{Fit, Found};
use crate::worlds::reading::FanArgs;

/// An option of `replay` with its value.
type Word = (String, String);

const TO_REPLAY: &str = "To use it, behind the name of this program:";
const TO_SCENE: &str = "In a scene file, among its sensors:";

/// The options of `replay` that say what is identified of a sensor; nothing of one of which nothing is.
pub(super) fn options(kind: &Kind, options: &CalibrateOptions, is_bag: bool, fit: &Fit) -> Vec<Word> {
    let known = identified(kind, fit);
    if known.is_empty() {
        return Vec::new();
    }
    let mut words = Vec::new();
    let mut add = |name: &str, value: String| words.push((format!("--{}", name.replace('_', "-")), value));
    for found in &known {
        match (kind, found.parameter.name) {
            // No kernel has them.
            (_, "detection_rate" | "grazing_deg") => {}
            (Kind::Depth(_), "inverse_sigma_per_m") => add("depth-sigma", outputs::short(found.value)),
            (Kind::Depth(_), "hit") => add("depth-hit", outputs::short(found.value)),
            (_, name) => add(name, outputs::short(found.value)),
        }
    }
    // What one mapper alone takes goes with that mapper.
    if known.iter().any(|found| found.parameter.name.starts_with("repeat_")) {
        add("mappers", "visibility,visibility-dynamic".to_owned());
    }
    match kind {
        // The messages of a bag say which range is the last, and the option would take what lies beyond for no echo.
        Kind::Laser { .. } if is_bag && options.max_range.is_none() => {}
        Kind::Laser { max_range_m } => add("max-range", max_range_m.to_string()),
        Kind::Sonar(sonar) => {
            add("sonar-range", sonar.max_range_m.to_string());
            add("sonar-width", outputs::short(sonar.width_rad.to_degrees()));
        }
        Kind::Stereo(stereo) | Kind::Omnidirectional(stereo) => {
            add("focal-baseline", stereo.focal_baseline.to_string());
            add("max-disparity", stereo.max_disparity.to_string());
        }
        Kind::Depth(depth) => {
            add("depth", options.depth.iter().map(usize::to_string).collect::<Vec<_>>().join(","));
            add("depth-range", depth.max_range_m.to_string());
        }
    }
    words
}

/// `replay` with these options, and what the log was read with. Of an option that comes twice the first is taken: `replay` has one kernel for each kind.
pub(super) fn replay(words: &[Word], options: &CalibrateOptions) -> Option<Advice> {
    if words.is_empty() {
        return None;
    }
    let mut line = vec!["replay".to_owned(), quoted(&options.file.display().to_string())];
    for (k, (name, value)) in words.iter().enumerate() {
        if words[..k].iter().all(|(before, _)| before != name) {
            line.extend([name.clone(), value.clone()]);
        }
    }
    let FanArgs { fov, first_bearing, increment } = &options.fan;
    for (name, value) in [("--fov", fov), ("--first-bearing", first_bearing), ("--increment", increment)] {
        if let Some(value) = value {
            line.extend([name.to_owned(), value.to_string()]);
        }
    }
    line.extend(options.bag.words().iter().map(|word| quoted(word)));
    Some(Advice { to: TO_REPLAY, lines: vec![line.join(" ")] })
}

/// The sensor of a scene file, of a depth camera: scenes know which pixels have no reading.
pub(super) fn scene(kind: &Kind, fit: &Fit) -> Option<Advice> {
    let Kind::Depth(depth) = kind else { return None };
    let known = identified(kind, fit);
    let own = |found: &&Found| {
        !["prior", "correlation"].contains(&found.parameter.name) && !found.parameter.name.starts_with("repeat_")
    };
    let key = |found: &Found| format!("{} = {}", found.parameter.name, decimal(found.value));
    let keys: Vec<String> = known.into_iter().filter(own).map(key).collect();
    let head = ["[[sensor]]".to_owned(), "kind = \"depth\"".to_owned()];
    let range = format!("max_range = {}", decimal(depth.max_range_m));
    (!keys.is_empty()).then(|| Advice { to: TO_SCENE, lines: head.into_iter().chain(keys).chain([range]).collect() })
}

/// A number of TOML that is no whole number.
fn decimal(value: f64) -> String {
    let text = outputs::short(value);
    if text.contains('.') { text } else { text + ".0" }
}

/// The parameters to advise. Beside the usual share of hits, which `replay` takes where none is told, that of lost pulses may be too large.
fn identified<'a>(kind: &Kind, fit: &'a Fit) -> Vec<&'a Found> {
    let mut known: Vec<&Found> = fit.found.iter().filter(|found| found.unidentified.is_none()).collect();
    let value =
        |known: &[&Found], name: &str| known.iter().find(|found| found.parameter.name == name).map(|found| found.value);
    let (names, usual) = match kind {
        Kind::Laser { .. } => (["hit", "no_echo"], [Laser::default().hit, Laser::default().no_echo]),
        Kind::Sonar(_) => {
            let usual = sensor::Sonar::default();
            (["sonar_hit", "sonar_no_echo"], [usual.hit, usual.no_echo])
        }
        _ => return known,
    };
    let shares = [0, 1].map(|k| value(&known, names[k]).unwrap_or(usual[k]));
    if shares.iter().sum::<f64>() > 1.0 {
        known.retain(|found| !names.contains(&found.parameter.name));
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

    #[test]
    fn numbers_of_scenes_have_a_point() {
        assert_eq!([decimal(4.0), decimal(0.0125), decimal(12.0)], ["4.0", "0.0125", "12.0"]);
    }
}
