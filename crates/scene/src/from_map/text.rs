//! The text of a scene file with a surveyed route.

use std::fmt::Write as _;
use std::path::{Component, Path, PathBuf};

use crate::file::edit::quoted;
use crate::survey::{Survey, SurveyOptions};

/// Width of the lines that list stops.
const WIDTH: usize = 120;

/// What a scene is made from, and what of it.
pub(super) struct Origin<'a> {
    pub(super) source: &'a Path,
    /// The table that names it.
    pub(super) table: &'a str,
    /// Whether its lower-left corner lies at [0, 0] in the scene.
    pub(super) moved: bool,
    /// The part of it that the scene holds, m.
    pub(super) bounds_m: Option<[[f64; 2]; 2]>,
}

/// The scene file.
pub(super) fn written(origin: &Origin, scene: &Path, survey: &Survey, options: &SurveyOptions) -> String {
    let &Origin { source, table, moved, bounds_m } = origin;
    let (names, waypoints) = named(&survey.stops_m);
    let file_name = source.file_name().unwrap_or_default().to_string_lossy();
    let printed: String = file_name.chars().filter(|c| !c.is_control()).collect();
    let mut text = String::new();
    let mut line = |args: std::fmt::Arguments| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{args}");
    };
    line(format_args!("# Made from {printed} by `scene from-{table}`; change it by hand as you like."));
    line(format_args!(
        "# Lengths are metres, angles degrees counter-clockwise from x; crates/scene/README.md explains every key."
    ));
    line(format_args!("#"));
    let cut = if survey.cut { ", cut at the length asked for" } else { "" };
    let area = survey.floor.values().iter().filter(|&&v| v).count() as f64 * survey.floor.spec().cell_area_m2();
    line(format_args!(
        "# The route: {} stops, {:.1} m{cut}. The robot keeps {} m from everything; its centre can reach {:.1} m².",
        survey.stops_m.len(),
        survey.length_m,
        shown(options.robot.radius_m + options.clearance_m),
        survey.drivable_m2
    ));
    line(format_args!(
        "# On the way the camera sees {:.1} % of the floor, {area:.1} m², from at most {} m away. Short legs turn it to what it",
        100.0 * survey.seen,
        shown(options.range_m)
    ));
    line(format_args!("# would miss. The robot can start at any waypoint: each is free."));
    line(format_args!(""));
    line(format_args!("name = {}", quoted(&scene_name(source))));
    line(format_args!(
        "description = {}",
        quoted(&format!("Route through all that a robot can reach in {}", short(&printed)))
    ));
    line(format_args!(""));
    let unknown =
        if table == "map" { "What the map does not know is not scored." } else { "What is outside is not scored." };
    line(format_args!("# {unknown}"));
    line(format_args!("[{table}]"));
    line(format_args!("file = {}", quoted(&relative(source, scene))));
    if moved {
        line(format_args!("origin = [0.0, 0.0]  # its lower-left corner in this scene: its own is too far away"));
    }
    if let Some([min, max]) = bounds_m {
        line(format_args!(""));
        line(format_args!("# The part of the map that the robot can reach, and its walls."));
        line(format_args!("[bounds]"));
        line(format_args!("min = [{:?}, {:?}]", min[0], min[1]));
        line(format_args!("max = [{:?}, {:?}]", max[0], max[1]));
    }
    line(format_args!(""));
    line(format_args!("[waypoints]"));
    for (name, at) in &waypoints {
        line(format_args!("{name} = [{:?}, {:?}]", at[0], at[1]));
    }
    line(format_args!(""));
    line(format_args!("[route]"));
    line(format_args!("stops = {}", list(&names)));
    line(format_args!(""));
    line(format_args!(
        "# A stage ends on arrival at the last of these stops, which are the first of the route: after each third of it."
    ));
    for (name, stops) in ["a", "b", "c"].iter().zip(thirds(&survey.stops_m)) {
        line(format_args!("[[stage]]"));
        line(format_args!("name = \"{name}\""));
        line(format_args!("after = {}", list(&names[..stops])));
        line(format_args!("label = \"at {}\"", names[stops - 1]));
        line(format_args!(""));
    }
    line(format_args!("[camera]"));
    line(format_args!("columns = {}", options.camera.columns));
    line(format_args!("field_of_view_deg = {}", shown(options.camera.field_of_view_rad.to_degrees())));
    line(format_args!(""));
    line(format_args!("[sensor]"));
    line(format_args!("focal_baseline = 15.0  # px·m"));
    line(format_args!("disparity_sigma = 0.5  # px"));
    line(format_args!("correct_match = 0.8"));
    line(format_args!("max_disparity = 60.0   # px"));
    line(format_args!("detection_rate = 0.6"));
    line(format_args!("quantisation = 0.0     # px"));
    line(format_args!(""));
    line(format_args!("[robot]"));
    line(format_args!("radius = {}", shown(options.robot.radius_m)));
    line(format_args!("speed = {}  # m/s", shown(options.robot.speed_m_s)));
    line(format_args!("turn_rate_deg = {}  # per second", shown(options.robot.turn_rate_rad_s.to_degrees())));
    line(format_args!("scan_interval = {}  # s", shown(options.robot.scan_interval_s)));
    text
}

/// A number without the digits that turning degrees into radians and back leaves.
fn shown(value: f64) -> f64 {
    let rounded = (value * 1e9).round() / 1e9;
    if rounded == 0.0 { value } else { rounded }
}

/// Names of the stops, and the waypoints in the order in which the route first comes to them.
fn named(stops_m: &[[f64; 2]]) -> (Vec<String>, Vec<(String, [f64; 2])>) {
    let mut numbers = std::collections::BTreeMap::new();
    let mut waypoints = Vec::new();
    let names = stops_m.iter().map(|&at| {
        let number = *numbers.entry(at.map(f64::to_bits)).or_insert_with(|| {
            waypoints.push((letters(waypoints.len()), at));
            waypoints.len() - 1
        });
        letters(number)
    });
    (names.collect(), waypoints)
}

/// A to Z, then AA to AZ, BA and so on.
fn letters(number: usize) -> String {
    let last = char::from(b'A' + (number % 26) as u8);
    if number < 26 { last.to_string() } else { format!("{}{last}", letters(number / 26 - 1)) }
}

/// How many stops come before the end of each third of the route; fewer where there are not enough stops.
fn thirds(stops_m: &[[f64; 2]]) -> Vec<usize> {
    let length_m = |stops: usize| crate::survey::length_m(&stops_m[..stops]);
    let all = stops_m.len();
    let mut ends: Vec<usize> = [1.0, 2.0]
        .iter()
        .map(|third| (2..all).find(|&stops| length_m(stops) >= third / 3.0 * length_m(all)).unwrap_or(all))
        .collect();
    ends.push(all);
    ends.dedup();
    ends
}

/// A list of names, broken where lines get long.
fn list(names: &[String]) -> String {
    let mut lines = vec![String::new()];
    for name in names {
        let item = format!("\"{name}\",");
        match lines.last_mut() {
            Some(last) if last.len() + item.len() < WIDTH => {
                if !last.is_empty() {
                    last.push(' ');
                }
                last.push_str(&item);
            }
            _ => lines.push(item),
        }
    }
    match &lines[..] {
        [only] => format!("[{}]", only.trim_end_matches(',')),
        _ => format!("[\n    {}\n]", lines.join("\n    ")),
    }
}

/// The name of the file as the name of a scene.
fn scene_name(source: &Path) -> String {
    let stem = source.file_stem().unwrap_or_default().to_string_lossy();
    let fit = |c: char| if c.is_ascii_alphanumeric() || c == '_' { c } else { '-' };
    let name: String = stem.chars().map(fit).take(32).collect();
    if name.is_empty() { "map".to_owned() } else { name }
}

fn short(name: &str) -> String {
    if name.chars().count() <= 100 { name.to_owned() } else { name.chars().take(97).chain("...".chars()).collect() }
}

/// `source` as seen from the folder of `scene`, with forward slashes; whole where no relative way is known.
fn relative(source: &Path, scene: &Path) -> String {
    let folder = match scene.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let real = |path: &Path| std::fs::canonicalize(path).ok();
    // The map's folder is made real, but not its last name: a link keeps the name it is known by.
    let beside = match source.parent() {
        Some(parent) if parent != Path::new("") => parent,
        _ => Path::new("."),
    };
    let (Some(from), Some(to), Some(name)) = (real(folder), real(beside), source.file_name()) else {
        return source.display().to_string();
    };
    let (from, to): (Vec<_>, Vec<_>) = (from.components().collect(), to.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return source.display().to_string();
    }
    let up = from[common..].iter().map(|_| Component::ParentDir);
    let path: PathBuf = up.chain(to[common..].iter().copied()).collect::<PathBuf>().join(name);
    let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy().into_owned()).collect();
    parts.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_on_after_z() {
        assert_eq!([0, 25, 26, 51, 52, 701, 702].map(letters), ["A", "Z", "AA", "AZ", "BA", "ZZ", "AAA"]);
    }

    #[test]
    fn a_place_that_is_passed_twice_has_one_name() {
        let (names, waypoints) = named(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]);
        assert_eq!((names.concat().as_str(), waypoints.len()), ("ABA", 2));
    }

    #[test]
    fn stages_end_at_the_thirds() {
        let stops: Vec<[f64; 2]> = (0..10).map(|k| [f64::from(k), 0.0]).collect();
        assert_eq!(thirds(&stops), [4, 7, 10]);
        assert_eq!(thirds(&stops[..2]), [2]);
        assert_eq!(thirds(&stops[..3]), [2, 3]);
    }

    #[test]
    fn long_lists_are_broken() {
        let names: Vec<String> = (0..100).map(letters).collect();
        let text = format!("a = {}", list(&names));
        assert!(text.lines().all(|line| line.len() <= WIDTH + 4));
        let read: toml::Table = text.parse().expect("TOML");
        assert_eq!(read["a"].as_array().map(Vec::len), Some(100));
        assert_eq!(list(&names[..2]), "[\"A\", \"B\"]");
    }

    #[test]
    fn files_are_named_from_the_scene() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let at = |name: &str| folder.path().join(name);
        for made in ["maps", "scenes/deep"] {
            std::fs::create_dir_all(at(made)).expect("made");
        }
        assert_eq!(relative(&at("maps/m.yaml"), &at("scenes/deep/s.toml")), "../../maps/m.yaml");
        assert_eq!(relative(&at("maps/m.yaml"), &at("maps/s.toml")), "m.yaml");
        assert_eq!(relative(&at("maps/m.yaml"), &at("s.toml")), "maps/m.yaml");
    }

    #[test]
    fn scenes_are_named_after_their_file() {
        assert_eq!(scene_name(Path::new("a/b c\u{e9}.d.yaml")), "b-c--d");
        assert_eq!(scene_name(Path::new(&"x".repeat(50))).len(), 32);
        assert_eq!(quoted("a\"b\\c"), "\"a\\\"b\\\\c\"");
    }
}
