//! What to type to run something again, from its record.

use std::path::Path;

use mapper::Prior;
use sensor::{Laser, Sonar, Stereo};
use serde_json::{Value, json};

use crate::figures::Paper;
use crate::programs::options::TIMEOUT_S;
use crate::worlds::drives::DriveOptions;
use crate::worlds::reading::DAMAGED_SHARE;

/// An option: where its value stands in a record, its name, and the value that need not be typed.
type Typed = (&'static str, &'static str, Value);

/// The command line of a record; empty where the command leaves no page.
pub fn command_line(record: &Value) -> String {
    let (arguments, options): (&[&str], Vec<Typed>) = match record["command"].as_str() {
        Some("room") => (&[], [room(), assumed(), drives(), pictures()].concat()),
        Some("compare") => (&[], [compare(), assumed(), drives(), pictures()].concat()),
        Some("score") => (&["/configuration/maps"], [score(), drives(), pictures()].concat()),
        Some("replay") => (&["/configuration/log"], [replay(), sensor(), assumed(), pictures()].concat()),
        Some("slam") => (&["/configuration/source"], [slam(), sensor(), assumed(), pictures()].concat()),
        _ => return String::new(),
    };
    let record = &by_kind(record);
    let at = |place: &str| record.pointer(place).filter(|value| !value.is_null());
    let mut words = vec!["sightgrid".to_owned(), record["command"].as_str().unwrap_or_default().to_owned()];
    for value in arguments.iter().filter_map(|place| at(place)) {
        match value.as_array() {
            Some(all) => words.extend(all.iter().map(word)),
            None => words.push(word(value)),
        }
    }
    // A quick comparison repeats scans less often.
    if record["configuration"]["repeats"] == json!([1, 10, 100]) {
        words.push("--quick".to_owned());
    }
    let programs = || record["configuration"]["programs"].as_array().into_iter().flatten();
    for (place, option, usual) in options {
        let Some(value) = at(place).filter(|value| **value != usual) else { continue };
        let own = |name: &&Value| programs().all(|program| program["name"] != **name);
        let text = match value.as_array() {
            Some(all) => all.iter().filter(own).map(word).collect::<Vec<_>>().join(","),
            None => word(value),
        };
        if !text.is_empty() {
            words.extend([option.to_owned(), text]);
        }
    }
    if let Some(origin) = record.pointer("/configuration/place").filter(|place| !place.is_null()) {
        let numbers =
            ["/origin_m/0", "/origin_m/1", "/yaw_rad"].map(|place| origin.pointer(place).map(Value::to_string));
        words.push("--origin".to_owned());
        words.push(numbers.into_iter().flatten().collect::<Vec<_>>().join(","));
    }
    for (place, option) in FLAGS {
        words.extend(at(place).filter(|value| **value == json!(true)).map(|_| option.to_owned()));
    }
    for program in programs() {
        let [name, command] = ["name", "command"].map(|key| program[key].as_str().unwrap_or_default());
        words.extend(["--mapper".to_owned(), quoted(&format!("{name}={command}"))]);
    }
    let timeout_s = programs().find_map(|program| program["timeout_s"].as_f64());
    if let Some(timeout_s) = timeout_s.filter(|time_s| time_s.total_cmp(&TIMEOUT_S).is_ne()) {
        words.extend(["--mapper-timeout".to_owned(), timeout_s.to_string()]);
    }
    words.join(" ")
}

/// The record with what is said of lasers and cameras, whichever of several sensors they are, under `sensor`, and what of sonars under `sonar`.
fn by_kind(record: &Value) -> Value {
    let mut record = record.clone();
    let Some(configuration) = record["configuration"].as_object_mut() else { return record };
    let several = configuration.get("sensors").and_then(Value::as_object).map(|all| all.values().cloned().collect());
    let all: Vec<Value> = several.unwrap_or_else(|| configuration.get("sensor").cloned().into_iter().collect());
    let is_sonar = |sensor: &&Value| sensor.get("width_rad").is_some();
    if let Some(sonar) = all.iter().find(is_sonar) {
        let width_deg = sonar["width_rad"].as_f64().map(|width_rad| (1e9 * width_rad.to_degrees()).round() / 1e9);
        let sonar = json!({"max_range_m": sonar["max_range_m"], "width_deg": width_deg});
        configuration.insert("sonar".to_owned(), sonar);
    }
    let others = all.iter().filter(|sensor| !is_sonar(sensor)).filter_map(Value::as_object);
    let others: serde_json::Map<String, Value> =
        others.flatten().map(|(key, value)| (key.clone(), value.clone())).collect();
    configuration.insert("sensor".to_owned(), Value::Object(others));
    record
}

/// Options without a value: where a record says that they were given.
const FLAGS: [(&str, &str); 3] = [
    ("/configuration/row_order_top", "--row-order top"),
    ("/configuration/landmarks", "--landmarks"),
    ("/pictures/svg", "--svg"),
];

fn room() -> Vec<Typed> {
    vec![
        ("/configuration/scene", "--scene", json!("scenes/room.toml")),
        ("/configuration/layout", "--layout", Value::Null),
        ("/seed", "--seed", json!(1)),
        ("/configuration/seeds", "--seeds", json!(1)),
        ("/grid/cell_m", "--grid", Value::Null),
        ("/configuration/mappers", "--mappers", Value::Null),
        ("/configuration/max_range_m", "--max-range", Value::Null),
    ]
}

fn compare() -> Vec<Typed> {
    vec![
        ("/configuration/set", "--set", json!("test")),
        ("/configuration/families", "--families", Value::Null),
        ("/configuration/seeds", "--seeds", Value::Null),
        ("/configuration/batch_seeds", "--batch-seeds", Value::Null),
        ("/configuration/mappers", "--mappers", Value::Null),
        ("/configuration/max_range_m", "--max-range", Value::Null),
    ]
}

fn score() -> Vec<Typed> {
    vec![
        ("/configuration/truth", "--truth", Value::Null),
        ("/configuration/layout", "--layout", Value::Null),
        ("/configuration/cell_m", "--grid", Value::Null),
        ("/configuration/scans", "--scans", Value::Null),
        ("/configuration/unknown", "--unknown", json!("prior")),
        ("/configuration/prior", "--prior", json!(Prior::default().occupancy)),
        ("/configuration/finer", "--finer", json!("mean")),
        ("/configuration/align", "--align", json!("none")),
        ("/configuration/align_bound_m", "--align-bound", json!(0.5)),
        ("/configuration/align_bound_deg", "--align-turn", json!(5.0)),
        ("/configuration/read_as", "--read-as", Value::Null),
        ("/configuration/place/cell_m", "--resolution", Value::Null),
    ]
}

fn replay() -> Vec<Typed> {
    vec![
        ("/configuration/trajectory", "--trajectory", Value::Null),
        ("/configuration/body", "--body", Value::Null),
        ("/configuration/mappers", "--mappers", Value::Null),
        ("/configuration/hold_out", "--hold-out", json!(10)),
        ("/grid/cell_m", "--grid", json!(0.05)),
        ("/configuration/footprint_m", "--footprint", Value::Null),
        ("/configuration/given_reach_m", "--reach", Value::Null),
        ("/configuration/min_range_m", "--min-range", Value::Null),
        ("/configuration/given_max_range_m", "--max-range", Value::Null),
        ("/configuration/damaged_share", "--damaged-share", Value::Null),
        ("/configuration/max_gap_s", "--max-gap", json!(1.0)),
        ("/configuration/every", "--every", json!(1)),
        ("/configuration/window_s", "--window", Value::Null),
        ("/configuration/least_move_m", "--least-move", Value::Null),
        ("/configuration/least_turn_deg", "--least-turn", Value::Null),
        ("/configuration/repeat_distance_m", "--repeat-distance", Value::Null),
        ("/configuration/repeat_angle_deg", "--repeat-angle", Value::Null),
        ("/configuration/map_range_m", "--map-range", Value::Null),
    ]
}

/// Where the beams of a log go, and what mappers know of its sensor.
fn sensor() -> Vec<Typed> {
    vec![
        ("/configuration/fan/fov_deg", "--fov", Value::Null),
        ("/configuration/fan/first_bearing_deg", "--first-bearing", Value::Null),
        ("/configuration/fan/increment_deg", "--increment", Value::Null),
        ("/configuration/sensor/range_sigma_m", "--range-sigma", json!(Laser::default().range_sigma_m)),
        ("/configuration/sensor/hit", "--hit", json!(Laser::default().hit)),
        ("/configuration/sensor/no_echo", "--no-echo", json!(Laser::default().no_echo)),
        ("/configuration/sensor/early_per_m", "--early", json!(Laser::default().early_per_m)),
        ("/configuration/sensor/focal_baseline", "--focal-baseline", json!(Stereo::default().focal_baseline)),
        ("/configuration/sensor/disparity_sigma", "--disparity-sigma", json!(Stereo::default().disparity_sigma)),
        ("/configuration/sensor/correct_match", "--correct-match", json!(Stereo::default().correct_match)),
        ("/configuration/sensor/max_disparity", "--max-disparity", json!(Stereo::default().max_disparity)),
        ("/configuration/sonar/max_range_m", "--sonar-range", json!(Sonar::default().max_range_m)),
        ("/configuration/sonar/width_deg", "--sonar-width", json!(30.0)),
    ]
}

fn slam() -> Vec<Typed> {
    vec![
        ("/configuration/particles", "--particles", json!(30)),
        ("/configuration/seed", "--seed", json!(1)),
        ("/configuration/mapper", "--mapper", json!("visibility")),
        ("/configuration/weight", "--weight", json!("field")),
        ("/configuration/given_power", "--power", Value::Null),
        ("/configuration/update_move_m", "--update-move", json!(0.2)),
        ("/configuration/update_turn_deg", "--update-turn", json!(10.0)),
        ("/configuration/given_noise", "--noise", Value::Null),
        ("/configuration/truth", "--truth", Value::Null),
        ("/configuration/relations", "--relations", Value::Null),
        ("/configuration/layout", "--layout", Value::Null),
        ("/configuration/given_grid_m", "--grid", Value::Null),
        ("/configuration/reach_m", "--reach", Value::Null),
        ("/configuration/min_range_m", "--min-range", Value::Null),
        ("/configuration/given_max_range_m", "--max-range", Value::Null),
        ("/configuration/every", "--every", json!(1)),
        ("/configuration/window_s", "--window", Value::Null),
        ("/configuration/damaged_share", "--damaged-share", json!(DAMAGED_SHARE)),
    ]
}

/// What mappers assume.
fn assumed() -> Vec<Typed> {
    let usual = json!(Prior::default());
    vec![
        ("/configuration/prior/occupancy", "--prior", usual["occupancy"].clone()),
        ("/configuration/prior/correlation", "--correlation", usual["correlation"].clone()),
        ("/configuration/prior/correlation_law", "--correlation-law", usual["correlation_law"].clone()),
        ("/configuration/reconciliation", "--reconciliation", json!("all-edges")),
    ]
}

fn drives() -> Vec<Typed> {
    let usual = json!(DriveOptions::default());
    vec![
        ("/configuration/drives/pairs", "--plan-pairs", usual["pairs"].clone()),
        ("/configuration/drives/robot_radius_m", "--robot-radius", Value::Null),
        ("/configuration/drives/threshold", "--plan-threshold", usual["threshold"].clone()),
        ("/configuration/drives/unknown", "--plan-unknown", usual["unknown"].clone()),
    ]
}

/// How pictures are made.
fn pictures() -> Vec<Typed> {
    vec![("/pictures/dpi", "--dpi", json!(Paper::default().dpi)), ("/pictures/width_mm", "--width", Value::Null)]
}

/// A value as it is typed. Where a file lay on a machine is nobody's business: of an absolute path the name remains.
fn word(value: &Value) -> String {
    match value.as_str() {
        Some(text) if Path::new(text).is_absolute() => {
            quoted(&Path::new(text).file_name().unwrap_or_default().to_string_lossy())
        }
        Some(text) => quoted(text),
        None => value.to_string(),
    }
}

/// A word for a shell.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,=:+@%".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        text.to_owned()
    } else {
        format!("'{}'", text.replace('\'', r"'\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_usual_need_not_be_typed_and_no_place_of_a_machine_is_told() {
        let record = json!({
            "command": "room", "seed": 1, "grid": {"cell_m": 0.1},
            "configuration": {
                "scene": "/home/somebody/my room.toml", "seeds": 3, "mappers": ["visibility", "own"],
                "programs": [{"name": "own", "command": "python3 'a b.py'"}],
                "prior": Prior::default(), "reconciliation": "touched", "drives": DriveOptions::default(),
            },
        });
        let typed = "sightgrid room --scene 'my room.toml' --seeds 3 --grid 0.1 --mappers visibility --reconciliation touched \
            --mapper 'own=python3 '\\''a b.py'\\'''";
        assert_eq!(command_line(&record), typed);
        assert_eq!(command_line(&json!({"command": "sensor"})), "");
    }

    #[test]
    fn maps_and_logs_stand_before_the_options() {
        let of = |record: Value| command_line(&record);
        let score = json!({"command": "score", "configuration": {"maps": ["a.npy", "b.yaml"], "truth": "t.yaml", "unknown": "skip"}});
        assert_eq!(of(score), "sightgrid score a.npy b.yaml --truth t.yaml --unknown skip");
        let replay = json!({"command": "replay", "grid": {"cell_m": 0.05}, "configuration": {"log": "fr.log", "window_s": [0.0, 9.5]}});
        assert_eq!(of(replay), "sightgrid replay fr.log --window 0.0,9.5");
    }

    #[test]
    fn of_several_sensors_each_has_its_own_options() {
        let camera = json!({"focal_baseline": 18.5, "max_disparity": Stereo::default().max_disparity});
        let laser = json!({"hit": 0.9, "no_echo": Laser::default().no_echo});
        let sonar = json!(Sonar { max_range_m: 4.0, hit: 0.5, width_rad: 25f64.to_radians(), ..Sonar::default() });
        let of = |configuration: Value| {
            command_line(&json!({"command": "replay", "grid": {"cell_m": 0.05}, "configuration": configuration}))
        };
        let all = json!({"log": "a.csv", "sensor": sonar, "sensors": {"0": sonar, "1": laser, "3": camera}});
        let typed = "sightgrid replay a.csv --hit 0.9 --focal-baseline 18.5 --sonar-range 4.0 --sonar-width 25.0";
        assert_eq!(of(all), typed);
        assert_eq!(of(json!({"log": "a.csv", "sensor": Sonar::default()})), "sightgrid replay a.csv");
    }

    #[test]
    fn what_is_seldom_asked_for_is_told_too() {
        let of = |record: Value| command_line(&record);
        let pictures = json!({"svg": true, "dpi": 300, "width_mm": 178.0});
        let score = json!({"command": "score", "pictures": pictures, "configuration": {
            "maps": ["a.npy"], "truth": "room", "read_as": "raw", "row_order_top": true,
            "place": {"cell_m": 0.1, "origin_m": [-1.0, 2.5], "yaw_rad": 0.0},
        }});
        assert_eq!(
            of(score),
            "sightgrid score a.npy --truth room --read-as raw --resolution 0.1 --dpi 300 --width 178.0 --origin -1.0,2.5,0.0 \
             --row-order top --svg"
        );
        let replay = json!({"command": "replay", "grid": {"cell_m": 0.05}, "configuration": {
            "log": "a.log", "trajectory": "a.tum", "body": "robot", "given_max_range_m": 40.0, "given_reach_m": 12.0, "damaged_share": 0.5,
            "programs": [{"name": "own", "command": "./own", "timeout_s": 30.0}],
        }});
        assert_eq!(
            of(replay),
            "sightgrid replay a.log --trajectory a.tum --body robot --reach 12.0 --max-range 40.0 --damaged-share 0.5 \
             --mapper own=./own --mapper-timeout 30"
        );
    }
}
