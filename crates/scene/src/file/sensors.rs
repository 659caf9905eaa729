//! `[[sensor]]`: what the robot carries beside the camera.

use sensor::{Camera, Depth, Device, Laser, Matcher, Pose, SensorKind, Sonar};
use strict::{Error, Limit, Table};
use toml::de::DeValue;

use super::camera::{NOISE, noise, take};
use super::findings::Findings;
use super::limits::{
    ALL_ROUND, ANGLE, BEAMS, EARLY, EVERY, FIELD_OF_VIEW, GRAZING, INVERSE_SIGMA, MOUNT, PROBABILITY, RANGE,
    RANGE_SIGMA, WIDTH,
};
use super::route::duplicate;
use crate::Mounted;

/// The most sensors beside the camera.
const MOST: usize = 64;

/// A stereo camera that sees more than this has no image plane, rad.
const PLANE_RAD: f64 = FIELD_OF_VIEW.max * std::f64::consts::PI / 180.0;

/// Keys of every kind.
const COMMON: [&str; 7] = ["kind", "name", "x", "y", "yaw_deg", "field_of_view_deg", "every"];

/// Keys of lasers and sonars.
pub const ECHO: [&str; 5] = ["range_sigma", "max_range", "hit", "no_echo", "early_per_m"];

/// Keys of depth cameras.
pub const DEPTH: [&str; 5] = ["inverse_sigma_per_m", "max_range", "hit", "detection_rate", "grazing_deg"];

/// Whether sensors are listed, so that `[sensor]` is no table.
pub(super) fn listed(root: &Table) -> bool {
    root.get("sensor").is_some_and(|value| matches!(value.get_ref(), DeValue::Array(_)))
}

/// Every sensor of the file, in its order; none where `[sensor]` is the camera's noise.
pub(super) fn read(root: &Table, robot_radius_m: f64, found: &mut Findings) -> Vec<Mounted> {
    if !listed(root) {
        return Vec::new();
    }
    let tables = found.take(root.list("sensor")).unwrap_or_default();
    if let Some((table, value)) = tables.get(MOST).zip(root.get("sensor")) {
        let bound = format!("at most {MOST} sensors, of which {} is one more", table.element());
        found.add(root.refuse("sensor", value, &bound, "take some out; a ring of sonars is one sensor of many cones"));
    }
    let mut names: Vec<(String, usize)> = Vec::new();
    let mut sensors: Vec<Mounted> = Vec::new();
    for table in tables.iter().take(MOST) {
        let Some(kind) = found.take(kind(table)) else { continue };
        let nth = 1 + sensors.iter().filter(|other| other.device.kind() == kind).count();
        let name = match table.get("name") {
            None => Some(format!("{}-{nth}", kind.name())),
            Some(_) => found.take(table.name("name")),
        };
        let sensor = sensor(table, kind, robot_radius_m, found);
        let (Some(name), Some(sensor)) = (name, sensor) else { continue };
        found.take(free_name(table, &name, &names));
        names.push((name.clone(), table.place().line));
        sensors.push(Mounted { name, ..sensor });
    }
    sensors
}

fn kind(table: &Table) -> Result<SensorKind, Error> {
    let kinds = "one of laser, sonar, stereo, depth";
    let value = table.get("kind").ok_or_else(|| table.missing("kind", &format!("`kind = \"laser\"`, {kinds}")))?;
    let word = table.word("kind", value, &SensorKind::ALL.map(SensorKind::name))?;
    SensorKind::of(word).ok_or_else(|| table.refuse("kind", value, kinds, "name the kind of sensor"))
}

/// Refuses the name of another sensor, or the camera's.
fn free_name(table: &Table, name: &str, names: &[(String, usize)]) -> Result<(), crate::SceneError> {
    if let Some((_, line)) = names.iter().find(|(other, _)| other == name) {
        return Err(duplicate(table, name.to_owned(), *line));
    }
    match table.get("name").filter(|_| name == "camera") {
        Some(value) => Err(table.refuse("name", value, "another name than camera", "[camera] is called so").into()),
        None => Ok(()),
    }
}

/// What a table says but for the name.
fn sensor(table: &Table, kind: SensorKind, robot_radius_m: f64, found: &mut Findings) -> Option<Mounted> {
    let before = found.count();
    let (own, count, [rays, degrees]): (&[&str], &str, [f64; 2]) = match kind {
        SensorKind::Laser => (&ECHO, "beams", [180.0, 180.0]),
        SensorKind::Sonar => (&[ECHO[0], ECHO[1], ECHO[2], ECHO[3], ECHO[4], "width_deg"], "cones", [16.0, 360.0]),
        SensorKind::Stereo => (&NOISE, "columns", [140.0, 80.0]),
        SensorKind::Depth => (&DEPTH, "columns", [140.0, 58.0]),
    };
    found.only(table, &[&COMMON[..], own, &[count]].concat());
    let rays = found.take(table.optional_whole(count, &BEAMS)).map(|given| given.unwrap_or(rays as u64) as usize);
    let wide = if kind == SensorKind::Depth { &FIELD_OF_VIEW } else { &ALL_ROUND };
    let view = found.take(table.optional_number("field_of_view_deg", wide));
    let view_rad = view.map(|given| given.unwrap_or(degrees).to_radians());
    let mount = mount(table, robot_radius_m, found);
    let every = found.take(table.optional_whole("every", &EVERY)).map(|given| given.unwrap_or(1) as usize);
    let mut grazing_deg = if kind == SensorKind::Depth { 10.0 } else { 0.0 };
    let is_all_round = view_rad.is_some_and(|view_rad| view_rad > PLANE_RAD * (1.0 + 1e-12));
    let device = match kind {
        SensorKind::Laser => Device::Laser(laser(table, Laser::default(), found)),
        SensorKind::Sonar => Device::Sonar(sonar(table, found)),
        SensorKind::Stereo => {
            let matcher = noise(table, Matcher::default(), found);
            if is_all_round { Device::Omnidirectional(matcher) } else { Device::Stereo(matcher) }
        }
        SensorKind::Depth => depth(table, &mut grazing_deg, found),
    };
    let has_plane = matches!(device, Device::Stereo(_) | Device::Depth(..));
    let (rays, view_rad) = (rays?, view_rad?);
    let bearings_rad = match has_plane {
        true => Camera { columns: rays, field_of_view_rad: view_rad }.bearings_rad(),
        false => (0..rays).map(|k| view_rad * ((k as f64 + 0.5) / rays as f64 - 0.5)).collect(),
    };
    let grazing_rad = grazing_deg.to_radians();
    let sensor = Mounted { name: String::new(), device, mount: mount?, bearings_rad, every: every?, grazing_rad };
    (found.count() == before).then_some(sensor)
}

/// Where it stands on the robot: within its outline, so that it is never in what the robot keeps clear of.
fn mount(table: &Table, robot_radius_m: f64, found: &mut Findings) -> Option<Pose> {
    let mut or_zero = |key, limit: &Limit| Some(found.take(table.optional_number(key, limit))?.unwrap_or(0.0));
    let (x_m, y_m, yaw_deg) = (or_zero("x", &MOUNT), or_zero("y", &MOUNT), or_zero("yaw_deg", &ANGLE));
    let (x_m, y_m, yaw_deg) = (x_m?, y_m?, yaw_deg?);
    let away_m = libm::hypot(x_m, y_m);
    if away_m > robot_radius_m
        && let Some((key, value)) = ["x", "y"].iter().find_map(|key| Some((key, table.get(key)?)))
    {
        let bound = format!("within the robot, at most its radius, {robot_radius_m} m, from its middle");
        found.add(table.refuse(key, value, &bound, "move the sensor inwards, or make the robot larger"));
        return None;
    }
    Some(Pose { x_m, y_m, theta_rad: yaw_deg.to_radians() })
}

fn laser(table: &Table, mut laser: Laser, found: &mut Findings) -> Laser {
    let Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m } = &mut laser;
    let fields = [
        (ECHO[0], &RANGE_SIGMA, range_sigma_m),
        (ECHO[1], &RANGE, max_range_m),
        (ECHO[2], &PROBABILITY, hit),
        (ECHO[3], &PROBABILITY, no_echo),
        (ECHO[4], &EARLY, early_per_m),
    ];
    take(table, fields, found);
    const ROUNDING: f64 = 1e-9;
    let (hit, no_echo) = (laser.hit, laser.no_echo);
    if hit + no_echo > 1.0 + ROUNDING
        && let Some((key, value)) = ["no_echo", "hit"].iter().find_map(|key| Some((key, table.get(key)?)))
    {
        let bound = format!("such that hit = {hit} and no_echo = {no_echo} add up to at most 1");
        found.add(table.refuse(key, value, &bound, "the rest of the pulses are outliers; lower one of them"));
    }
    laser
}

fn sonar(table: &Table, found: &mut Findings) -> Sonar {
    let Sonar { range_sigma_m, max_range_m, hit, no_echo, early_per_m, width_rad } = Sonar::default();
    let beam = laser(table, Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m }, found);
    let mut width_deg = width_rad.to_degrees();
    take(table, [("width_deg", &WIDTH, &mut width_deg)], found);
    let Laser { range_sigma_m, max_range_m, hit, no_echo, early_per_m } = beam;
    Sonar { range_sigma_m, max_range_m, hit, no_echo, early_per_m, width_rad: width_deg.to_radians() }
}

fn depth(table: &Table, grazing_deg: &mut f64, found: &mut Findings) -> Device {
    let (mut depth, mut detection_rate) = (Depth::default(), 1.0);
    let Depth { inverse_sigma_per_m, max_range_m, hit } = &mut depth;
    let fields = [
        (DEPTH[0], &INVERSE_SIGMA, inverse_sigma_per_m),
        (DEPTH[1], &RANGE, max_range_m),
        (DEPTH[2], &PROBABILITY, hit),
        (DEPTH[3], &PROBABILITY, &mut detection_rate),
        (DEPTH[4], &GRAZING, grazing_deg),
    ];
    take(table, fields, found);
    Device::Depth(depth, detection_rate)
}
