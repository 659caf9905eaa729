//! The other end of a conversation: a mapper in Rust as a program that takes scans one by one.

use std::io::{self, BufRead, Write};
use std::process::ExitCode;
use std::sync::Arc;

use grid::GridSpec;
use mapper::catalogue::Entry;
use mapper::{Mapper, Model, Prior, Reconciliation, Repeats, Sensors, Tuning};
use sensor::{Laser, Pose, Scan, SensorModel, Stereo};
use serde::Deserialize;
use serde_json::{Value, json};

use super::described::SCHEMA_VERSION;
use super::watcher;
use crate::exit;
use crate::failure::Failure;

/// Takes scans as lines of JSON on standard input until they end, and answers with maps on standard output: a program for
/// `--mapper NAME='online: COMMAND'`, by the messages of `experiments/MAPPERS.md`, that maps as `entry` does in this process.
///
/// The mapper is made from the grid, the sensors and the prior of the first message; all else of its [`Model`] is as by default.
/// It is to print nothing to standard output. The exit code is 0, or 2 after an error on standard error.
///
/// ```no_run
/// # use mapper::catalogue::{Entry, MAPPERS};
/// # const COUNTING: Entry = MAPPERS[0];
/// fn main() -> std::process::ExitCode {
///     experiments::program(&COUNTING)
/// }
/// ```
pub fn program(entry: &Entry) -> ExitCode {
    watcher::if_asked().unwrap_or_else(|| exit::code(converse(entry, io::stdin().lock(), io::stdout().lock())))
}

/// A line.
#[derive(Deserialize)]
struct Line {
    #[serde(rename = "type")]
    kind: String,
    schema_version: u32,
    #[serde(flatten)]
    rest: Value,
}

/// The first line.
#[derive(Deserialize)]
struct Start {
    grid: Cells,
    sensors: Vec<Assumed>,
}

#[derive(Deserialize)]
struct Cells {
    cell_m: f64,
    origin_m: [f64; 2],
    width: usize,
    height: usize,
}

/// A sensor, and what is assumed before its first reading.
#[derive(Deserialize)]
struct Assumed {
    kernel: Option<String>,
    noise: Value,
    prior: Before,
}

#[derive(Deserialize)]
struct Before {
    occupancy: f64,
    correlation: f64,
    correlation_law: mapper::CorrelationLaw,
}

#[derive(Deserialize)]
struct Readings {
    sensor: usize,
    time_s: f64,
    x_m: f64,
    y_m: f64,
    theta_rad: f64,
    bearing_rad: Vec<f64>,
    #[serde(default, alias = "disparity_px", alias = "range_m")]
    reading: Vec<Value>,
}

/// Answers until the lines end.
fn converse(entry: &Entry, input: impl BufRead, mut output: impl Write) -> Result<(), Failure> {
    let mut mapper: Option<Box<dyn Mapper>> = None;
    for (number, line) in input.lines().enumerate() {
        let refuse = |why: String| Failure::BadInput(format!("standard input, line {}: {why}", number + 1));
        let line = line.map_err(|error| Failure::Internal(format!("standard input: cannot be read: {error}")))?;
        let Line { kind, schema_version, rest } = told(&line).map_err(refuse)?;
        if schema_version != SCHEMA_VERSION {
            return Err(refuse(format!("has schema_version {schema_version}: must be {SCHEMA_VERSION}")));
        }
        match (kind.as_str(), &mut mapper) {
            ("start", none @ None) => *none = Some((entry.build)(&model(&rest).map_err(refuse)?)),
            ("scan", Some(mapper)) => mapper.integrate(&scan(&rest).map_err(refuse)?),
            ("map", Some(mapper)) => {
                mapper.settle();
                answer(&**mapper, &mut output)
                    .map_err(|error| Failure::Internal(format!("standard output: cannot be written: {error}")))?;
            }
            ("scan" | "map", None) => return Err(refuse(format!("is of type {kind:?}: must be \"start\", once"))),
            _ => return Err(refuse(format!("is of type {kind:?}: must be \"scan\" or \"map\""))),
        }
    }
    Ok(())
}

fn told(line: &str) -> Result<Line, String> {
    serde_json::from_str(line).map_err(|error| format!("is no message: {error}; write one in JSON to a line"))
}

fn part<T: serde::de::DeserializeOwned>(message: &Value) -> Result<T, String> {
    T::deserialize(message).map_err(|error| format!("is not as a message of its type is to be: {error}"))
}

/// What the mapper is made from.
fn model(message: &Value) -> Result<Model, String> {
    let Start { grid: Cells { cell_m, origin_m, width, height }, sensors } = part(message)?;
    let Some(Before { occupancy, correlation, correlation_law }) = sensors.first().map(|first| &first.prior) else {
        return Err("names no sensor; name one or more".to_owned());
    };
    let prior = Prior { occupancy: *occupancy, correlation: *correlation, correlation_law: *correlation_law };
    let sensors = sensors.iter().map(assumed).collect::<Result<Vec<_>, _>>()?;
    Ok(Model {
        grid: GridSpec { cell_m, origin_m, width, height },
        sensors: Sensors::new(sensors),
        prior,
        reconciliation: Reconciliation::default(),
        max_range_m: f64::INFINITY, // readings beyond a cut are not sent
        tuning: Tuning::default(),
        repeats: Repeats::CHOSEN,
    })
}

fn assumed(sensor: &Assumed) -> Result<Arc<dyn SensorModel>, String> {
    match sensor.kernel.as_deref() {
        Some("stereo") => Ok(Arc::new(part::<Stereo>(&sensor.noise)?)),
        Some("laser") => Ok(Arc::new(part::<Laser>(&sensor.noise)?)),
        other => Err(format!("has the kernel {other:?}: must be \"stereo\" or \"laser\"")),
    }
}

fn scan(message: &Value) -> Result<Scan, String> {
    let Readings { sensor, time_s, x_m, y_m, theta_rad, bearing_rad, reading } = part(message)?;
    if reading.len() != bearing_rad.len() {
        return Err(format!("has {} readings for {} bearings; give one for each", reading.len(), bearing_rad.len()));
    }
    let value = |value: &Value| match value {
        Value::Null => Ok(None),
        Value::String(text) if text == "inf" => Ok(Some(f64::INFINITY)),
        other => other
            .as_f64()
            .map(Some)
            .ok_or_else(|| format!("has the reading {other}: must be a number, \"inf\" or null")),
    };
    let readings = reading.iter().map(value).collect::<Result<_, _>>()?;
    Ok(Scan { sensor, time_s, pose: Pose { x_m, y_m, theta_rad }, bearings_rad: bearing_rad, readings })
}

/// The line and the values of a map, in full precision.
fn answer(mapper: &dyn Mapper, output: &mut impl Write) -> io::Result<()> {
    let map = mapper.occupancy();
    let spec = map.spec();
    let header =
        json!({ "schema_version": SCHEMA_VERSION, "height": spec.height, "width": spec.width, "dtype": "<f8" });
    let values: Vec<u8> = map.values().iter().flat_map(|p| p.to_le_bytes()).collect();
    output.write_all(format!("{header}\n").as_bytes())?;
    output.write_all(&values)?;
    output.flush()
}

#[cfg(test)]
mod tests {
    use super::super::{described, online};
    use super::*;

    use mapper::catalogue::find;
    use proptest::prelude::*;

    fn two_sensors() -> Model {
        let grid = GridSpec { cell_m: 0.1, origin_m: [-1.0, 1.0 / 3.0], width: 30, height: 20 };
        let laser = Laser { range_sigma_m: 0.1 / 3.0, ..Laser::default() };
        let stereo = Stereo { correct_match: 0.7, ..Stereo::default() };
        let prior = Prior { occupancy: 0.15, ..Prior::default() };
        Model {
            sensors: Sensors::new(vec![Arc::new(stereo), Arc::new(laser)]),
            prior,
            ..Model::new(grid, Arc::new(stereo))
        }
    }

    fn start(model: &Model) -> Value {
        json!({ "type": "start", "schema_version": 1, "grid": described::grid(model), "sensors": described::sensors(model) })
    }

    #[test]
    fn a_model_comes_back_as_it_was_described() {
        let given = two_sensors();
        let found = model(&start(&given)).expect("valid");
        assert_eq!((found.grid, found.prior), (given.grid, given.prior));
        assert_eq!(described::sensors(&found), described::sensors(&given));
    }

    proptest! {
        #[test]
        fn a_scan_comes_back_to_the_last_digit(
            numbers in prop::array::uniform4(-1e3_f64..1e3), sensor in 0_usize..2,
            rays in prop::collection::vec((-3.0_f64..3.0, prop::option::of(prop_oneof![0.0_f64..60.0, Just(f64::INFINITY)])), 0..8),
        ) {
            let [time_s, x_m, y_m, theta_rad] = numbers;
            let (bearings_rad, readings) = rays.into_iter().unzip();
            let given = Scan { sensor, time_s, pose: Pose { x_m, y_m, theta_rad }, bearings_rad, readings };
            let line = online::message(7, &given, ["disparity_px", "range_m"][sensor]).to_string();
            let line = told(&line).expect("a message");
            prop_assert_eq!((line.kind.as_str(), scan(&line.rest)), ("scan", Ok(given)));
        }
    }

    #[test]
    fn what_is_no_message_is_refused_in_a_line() {
        let start = start(&two_sensors()).to_string();
        let scan = r#"{"type":"scan","schema_version":1,"sensor":0,"time_s":0,"x_m":0,"y_m":0,"theta_rad":0,"bearing_rad":[0],"disparity_px":["#;
        for (lines, part) in [
            ("[1".to_owned(), "line 1: is no message"),
            (start.replace("\"schema_version\":1", "\"schema_version\":2"), "schema_version 2: must be 1"),
            (start.replace("laser", "radar"), "kernel Some(\"radar\"): must be"),
            (scan.to_owned() + "1]}", "line 1: is of type \"scan\": must be \"start\""),
            (format!("{start}\n{start}"), "line 2: is of type \"start\": must be"),
            (format!("{start}\n{scan}1,2]}}"), "line 2: has 2 readings for 1 bearings"),
            (format!("{start}\n{scan}\"far\"]}}"), "line 2: has the reading \"far\""),
        ] {
            let entry = find("prior").expect("known");
            let message = converse(entry, lines.as_bytes(), Vec::new()).expect_err(part).to_string();
            assert!(message.contains(part) && !message.contains('\n'), "{message}");
        }
    }
}
