//! What can be swept: the parameters of the simulated world, and of what mappers assume of it.

use std::collections::BTreeMap;

use scene::reader::{CLUSTERING, Given, Override, limits};
use serde::{Deserialize, Serialize};
use strict::Limit;

use crate::worlds::poses::WrongPoses;

/// A parameter.
pub struct Parameter {
    /// Its key in a sweep file, and its column in the table.
    pub key: &'static str,
    /// What it may be.
    pub kind: ParameterKind,
    /// What it is a parameter of.
    pub of: Of,
    /// One line about it.
    pub about: &'static str,
}

/// What a parameter is a parameter of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Of {
    /// The table of a scene or family file, in which it has the same key.
    File(&'static str),
    /// The layouts of a family.
    Layout,
    /// What mappers do with the readings.
    Map,
}

impl Parameter {
    /// Whether it changes the world and its readings, or only what mappers make of them.
    pub fn of_world(&self) -> bool {
        self.of != Of::Map
    }

    /// Whether there is no such thing without a family.
    pub fn of_family(&self) -> bool {
        matches!(self.of, Of::Layout | Of::File(GENERATE))
    }
}

/// What a parameter may be.
pub enum ParameterKind {
    /// A number within a limit.
    Number(Limit),
    /// A number within a limit, in the place of both ends of a range.
    Both(Limit),
    /// A whole number within a limit.
    Whole(Limit),
    /// One of some words.
    Word(&'static [&'static str]),
}

const fn number(min: f64, max: f64, bound: &'static str, remedy: &'static str) -> ParameterKind {
    ParameterKind::Number(Limit { min, max, bound, remedy })
}

const fn whole(min: f64, max: f64, bound: &'static str, remedy: &'static str) -> ParameterKind {
    ParameterKind::Whole(Limit { min, max, bound, remedy })
}

/// As `max_range`, this and more stands for all readings.
pub const ALL_READINGS_M: f64 = 1000.0;

const PROBABILITY: &str = "a number from 0 to 1";

const GENERATE: &str = "generate";

/// A parameter of a scene or family file.
const fn of_file(section: &'static str, key: &'static str, kind: ParameterKind, about: &'static str) -> Parameter {
    Parameter { key, kind, of: Of::File(section), about }
}

const fn of_map(key: &'static str, kind: ParameterKind, about: &'static str) -> Parameter {
    Parameter { key, kind, of: Of::Map, about }
}

/// All parameters, in the order of the columns of a table.
pub const PARAMETERS: [Parameter; 53] = [
    Parameter {
        key: "size_factor",
        kind: number(0.1, 10.0, "a factor on the size of obstacles, 0.1 to 10", "give a factor such as 2"),
        of: Of::Layout,
        about: "factor on the mean size of the obstacles of a family",
    },
    of_file(GENERATE, "width", ParameterKind::Both(limits::SIDE), "width of the place, m"),
    of_file(GENERATE, "height", ParameterKind::Both(limits::SIDE), "height of the place, m"),
    of_file(GENERATE, "passage", ParameterKind::Both(limits::OPENING), "width of a corridor, m"),
    of_file(GENERATE, "door", ParameterKind::Both(limits::OPENING), "width of doors, m"),
    of_file(GENERATE, "obstacle_size", ParameterKind::Number(limits::OBSTACLE), "mean size of obstacles, m"),
    of_file(
        GENERATE,
        "obstacle_spread",
        ParameterKind::Number(limits::SPREAD),
        "spread of the size of obstacles, share of the mean",
    ),
    of_file(GENERATE, "covered", ParameterKind::Number(limits::COVERED), "share of the floor that obstacles cover"),
    of_file(GENERATE, "discs", ParameterKind::Number(limits::SHARE), "share of the obstacles that are discs"),
    of_file(
        GENERATE,
        "along_walls",
        ParameterKind::Number(limits::SHARE),
        "share of the obstacles that stand along walls",
    ),
    of_file(GENERATE, "clearance", ParameterKind::Number(limits::CLEARANCE), "what the route keeps off obstacles, m"),
    of_file(GENERATE, "wall_thickness", ParameterKind::Number(limits::THICKNESS), "thickness of walls, m"),
    of_file(GENERATE, "people_per_100_m2", ParameterKind::Both(limits::PEOPLE), "people per 100 m² of the place"),
    of_file(GENERATE, "people_speed_m_s", ParameterKind::Both(limits::PACE), "how fast people walk, m/s"),
    of_file("robot", "radius", ParameterKind::Number(limits::RADIUS), "radius of the robot, m"),
    of_file("robot", "speed", ParameterKind::Number(limits::SPEED), "speed of the robot, m/s"),
    of_file(
        "robot",
        "turn_rate_deg",
        ParameterKind::Number(limits::TURN_RATE),
        "rate at which it turns, degrees per s",
    ),
    of_file("robot", "scan_interval", ParameterKind::Number(limits::INTERVAL), "time between scans, s"),
    of_file("camera", "columns", ParameterKind::Whole(limits::COLUMNS), "columns of the image"),
    of_file(
        "camera",
        "field_of_view_deg",
        ParameterKind::Number(limits::FIELD_OF_VIEW),
        "horizontal field of view, degrees",
    ),
    of_file(
        "sensor",
        "focal_baseline",
        ParameterKind::Number(limits::FOCAL_BASELINE),
        "focal length times baseline, px m",
    ),
    of_file("sensor", "max_disparity", ParameterKind::Number(limits::SEARCH), "largest disparity searched, px"),
    of_file("sensor", "correct_match", ParameterKind::Number(limits::PROBABILITY), "share of correct matches"),
    of_file("sensor", "disparity_sigma", ParameterKind::Number(limits::SIGMA), "sigma of the disparities, px"),
    of_file(
        "sensor",
        "detection_rate",
        ParameterKind::Number(limits::PROBABILITY),
        "share of the columns with an edge to match",
    ),
    of_file(
        "sensor",
        "quantisation",
        ParameterKind::Number(limits::STEP),
        "step that disparities are rounded to, px; 0 for none",
    ),
    of_file("sensor", MISMATCHES, ParameterKind::Word(&[INDEPENDENT, "clustered"]), "how false matches come"),
    of_file(
        "sensor",
        "persistence",
        ParameterKind::Number(limits::PROBABILITY),
        "of clustered mismatches: how long runs are",
    ),
    of_file("sensor", "copies", ParameterKind::Number(limits::PROBABILITY), "of clustered mismatches: share of copies"),
    of_file(
        "sensor",
        "near_misses",
        ParameterKind::Number(limits::PROBABILITY),
        "of clustered mismatches: share of near misses",
    ),
    of_file(
        "sensor",
        "copy_reach",
        ParameterKind::Whole(limits::REACH),
        "of clustered mismatches: reach of copies, columns",
    ),
    of_map(
        "scans",
        whole(1.0, 1e6, "a whole number of scans, 1 to 1000000", "give how many scans of the drive are mapped"),
        "so many scans of the drive, evenly spread over it; all if it has fewer",
    ),
    of_map(
        "max_range",
        number(0.05, 1e6, "a range in m, 0.05 to 1000000", "give the range such as 3.0, and 1000.0 for all readings"),
        "readings beyond this are thrown away for every mapper, m",
    ),
    of_map(
        "grid",
        number(0.005, 10.0, "a cell size in m, 0.005 to 10", "give the side of a cell such as 0.05"),
        "side of a cell, m",
    ),
    of_map(
        "prior",
        number(0.0, 1.0, PROBABILITY, "give the probability that an unseen cell is occupied, such as 0.1"),
        "probability that an unseen cell is occupied",
    ),
    of_map(
        "correlation",
        number(0.0, 1.0, PROBABILITY, "give the correlation of cells 5 cm apart, such as 0.871"),
        "correlation of cells 5 cm apart",
    ),
    of_map(
        "assumed_length",
        number(0.001, 100.0, "a mean length in m, 0.001 to 100", "give the mean length of obstacles such as 0.4"),
        "expected mean length of obstacles, m: gives the correlation",
    ),
    of_map("correlation_law", ParameterKind::Word(&["scaled", "fixed"]), "correlation at other cell sizes"),
    of_map("reconciliation", ParameterKind::Word(&["all-edges", "touched"]), "edges that no ray runs along"),
    of_map(
        "believed_correct_match",
        ParameterKind::Number(limits::PROBABILITY),
        "share of correct matches that mappers believe in",
    ),
    of_map(
        "believed_sigma",
        ParameterKind::Number(limits::SIGMA),
        "sigma of the disparities that mappers believe in, px",
    ),
    of_map(
        "half_width",
        number(1e-3, 100.0, "a number of px, 0.001 to 100", "give half the bin of a reading, such as 0.5"),
        "of the conventional rules and no-occlusion: half the bin of a reading, px",
    ),
    of_map(
        "clamp_low",
        number(0.0, 1.0, PROBABILITY, "give the least probability of a cell, such as 0.12"),
        "of the conventional and log-odds rules: least probability of a cell",
    ),
    of_map(
        "clamp_high",
        number(0.0, 1.0, PROBABILITY, "give the largest probability of a cell, such as 0.97"),
        "of the conventional and log-odds rules: largest probability of a cell",
    ),
    of_map(
        "hit",
        number(1e-6, 1.0 - 1e-6, "a probability, 0.000001 to 0.999999", "give one above 0.5, such as 0.7"),
        "of the log-odds rules: probability that a hit stands for",
    ),
    of_map(
        "miss",
        number(1e-6, 1.0 - 1e-6, "a probability, 0.000001 to 0.999999", "give one below 0.5, such as 0.4"),
        "of the log-odds rules: probability that a miss stands for",
    ),
    of_map(
        "start",
        number(1e-6, 1.0 - 1e-6, "a probability, 0.000001 to 0.999999", "give one such as 0.5"),
        "of the log-odds rules: probability that an unknown cell starts from",
    ),
    of_map(
        "coupling",
        number(0.0, 1.0, PROBABILITY, "give one such as 0.225"),
        "of mrf: correlation of two neighbours that knew of no others",
    ),
    of_map(
        "damping",
        number(0.0, 0.99, "a share from 0 to 0.99", "give one such as 0.3"),
        "of mrf: share of a message that is kept from the sweep before",
    ),
    of_map("sweeps", whole(1.0, 1e4, "a whole number from 1 to 10000", "give one such as 40"), "of mrf: most sweeps"),
    of_map(
        POSE_SIGMA_M,
        number(0.0, 10.0, "a length in m, 0 to 10", "give a standard deviation such as 0.02, 0 for true places"),
        "poses that mappers are told: sigma of x and y, fresh at every scan, m",
    ),
    of_map(
        POSE_SIGMA_RAD,
        number(0.0, 3.0, "an angle in rad, 0 to 3", "give a standard deviation such as 0.01, 0 for true headings"),
        "the same: sigma of the heading, fresh at every scan, rad",
    ),
    of_map(
        POSE_DRIFT,
        number(
            0.0,
            100.0,
            "a factor on the standard noise of odometry, 0 to 100",
            "give 1 for the standard case, 0 for none",
        ),
        "the same: drift as odometry has it, in multiples of its standard noise",
    ),
];

const POSE_SIGMA_M: &str = "pose_sigma_m";
const POSE_SIGMA_RAD: &str = "pose_sigma_rad";
const POSE_DRIFT: &str = "pose_drift";

/// How wrong the poses are that mappers are told.
pub fn wrong_poses(settings: &Settings) -> WrongPoses {
    let number = |key| number_of(settings, key).unwrap_or(0.0);
    WrongPoses { sigma_m: number(POSE_SIGMA_M), sigma_rad: number(POSE_SIGMA_RAD), drift: number(POSE_DRIFT) }
}

const MISMATCHES: &str = "mismatches";
const INDEPENDENT: &str = "independent";

/// The values that take the place of a scene or family file's own.
pub fn overrides(settings: &Settings) -> Vec<Override<'_>> {
    let mut overrides = Vec::new();
    if word_of(settings, MISMATCHES) == Some(INDEPENDENT) {
        // A file may not say of independent mismatches how they cluster.
        let taken_out = CLUSTERING.iter().filter(|key| !settings.contains_key(**key));
        overrides.extend(taken_out.map(|key| Override { section: "sensor", key, value: Given::Nothing }));
    }
    for parameter in &PARAMETERS {
        let (Of::File(section), Some(value)) = (parameter.of, settings.get(parameter.key)) else { continue };
        let value = match (value, &parameter.kind) {
            (Value::Word(word), _) => Given::Word(word),
            (Value::Number(number), ParameterKind::Both(_)) => Given::Both(*number),
            (Value::Number(number), _) => Given::Number(*number),
        };
        overrides.push(Override { section, key: parameter.key, value });
    }
    overrides
}

/// The parameter of the given key.
pub fn parameter(key: &str) -> Option<&'static Parameter> {
    PARAMETERS.iter().find(|parameter| parameter.key == key)
}

/// A value of a parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A number, in the parameter's unit.
    Number(f64),
    /// A word.
    Word(String),
}

/// The values of some parameters, by key.
pub type Settings = BTreeMap<String, Value>;

/// The number that a key is set to.
pub fn number_of(settings: &Settings, key: &str) -> Option<f64> {
    match settings.get(key) {
        Some(Value::Number(number)) => Some(*number),
        _ => None,
    }
}

/// The word that a key is set to.
pub fn word_of<'a>(settings: &'a Settings, key: &str) -> Option<&'a str> {
    match settings.get(key) {
        Some(Value::Word(word)) => Some(word),
        _ => None,
    }
}
