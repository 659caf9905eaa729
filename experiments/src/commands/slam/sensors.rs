//! The sensors of a robot with several: what each read, and what it was used for.

use mapper::Model;
use serde_json::{Value, json};

use super::source::{Carrier, Taken};
use crate::output::table::{Table, rounded};

/// What the table shows.
pub(super) const SENSORS: &str = "What the sensors read at one time is one scan, each from its own place on the robot. Rays are matched and mapped; cones, whose \
    readings do not tell where in them something is, weigh particles by what their maps predict, and are mapped.";

/// The sensors, with what they read and how mappers know them.
#[derive(Clone, Copy)]
pub(super) struct Robot<'a> {
    pub(super) sensors: &'a [Carrier],
    pub(super) scans: &'a [Taken],
    pub(super) model: &'a Model,
}

/// A row for every sensor: its place on the robot, m and degrees, its scans and readings, and whether it is matched.
pub(super) fn table(robot: Robot) -> Table {
    Table::of(
        robot.sensors,
        &[
            ("sensor", &|sensor| json!(sensor.number)),
            ("name", &|sensor| json!(sensor.called)),
            ("x_m", &|sensor| rounded(sensor.mount.x_m)),
            ("y_m", &|sensor| rounded(sensor.mount.y_m)),
            ("theta_deg", &|sensor| rounded(sensor.mount.theta_rad.to_degrees())),
            ("scans", &|sensor| json!(scans(robot, sensor).count())),
            ("readings", &|sensor| {
                json!(scans(robot, sensor).flat_map(|scan| &scan.readings).flatten().filter(|r| r.is_finite()).count())
            }),
            ("matched", &|sensor| json!(is_matched(robot, sensor))),
        ],
    )
}

/// Where each stands, for the record: m, m and degrees by its number.
pub(super) fn mounts(sensors: &[Carrier]) -> Value {
    let of = |sensor: &Carrier| {
        let mount = sensor.mount;
        let place = [rounded(mount.x_m), rounded(mount.y_m), rounded(mount.theta_rad.to_degrees())];
        (sensor.number.to_string(), json!(place))
    };
    Value::Object(sensors.iter().map(of).collect())
}

/// A line for the terminal for every sensor; nothing of one alone.
pub(super) fn text(robot: Robot) -> String {
    if robot.sensors.len() < 2 {
        return String::new();
    }
    let line = |sensor: &Carrier| {
        let mount = sensor.mount;
        let used = if is_matched(robot, sensor) { "matched and mapped" } else { "weighs and is mapped" };
        format!(
            "{} {} at ({:.2}, {:.2}) m, {:.0} deg: {} scans, {used}\n",
            sensor.number,
            sensor.called,
            mount.x_m,
            mount.y_m,
            mount.theta_rad.to_degrees(),
            scans(robot, sensor).count()
        )
    };
    robot.sensors.iter().map(line).collect()
}

fn scans<'a>(robot: Robot<'a>, sensor: &Carrier) -> impl Iterator<Item = &'a sensor::Scan> {
    let number = sensor.number;
    let all = robot.scans.iter().flat_map(|taken| &taken.scans);
    all.map(|carried| &carried.scan).filter(move |scan| scan.sensor == number)
}

fn is_matched(robot: Robot, sensor: &Carrier) -> bool {
    robot.model.sensors.iter().nth(sensor.number).is_some_and(|model| model.width_rad() <= 0.0)
}
