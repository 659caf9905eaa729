//! What can be swept: the parameters of the simulated world, and of what mappers believe of it.

use std::collections::BTreeMap;

use scene::reader::Limit;
use serde::{Deserialize, Serialize};

/// A parameter.
pub struct Parameter {
    /// Its key in a sweep file, and its column in the table.
    pub key: &'static str,
    /// What it may be.
    pub kind: Kind,
    /// Whether it changes the world and its readings, or only what mappers make of them.
    pub of_world: bool,
    /// One line about it.
    pub about: &'static str,
}

/// What a parameter may be.
pub enum Kind {
    /// A number within a limit.
    Number(Limit),
    /// A whole number within a limit.
    Whole(Limit),
    /// One of some words.
    Word(&'static [&'static str]),
}

const fn number(min: f64, max: f64, bound: &'static str, remedy: &'static str) -> Kind {
    Kind::Number(Limit { min, max, bound, remedy })
}

const PROBABILITY: &str = "a number from 0 to 1";

/// All parameters, in the order of the columns of a table.
pub const PARAMETERS: [Parameter; 13] = [
    Parameter {
        key: "size_factor",
        kind: number(0.1, 10.0, "a factor on the size of obstacles, 0.1 to 10", "give a factor such as 2"),
        of_world: true,
        about: "factor on the mean size of the obstacles of a family",
    },
    Parameter {
        key: "correct_match",
        kind: number(0.0, 1.0, PROBABILITY, "give the share of correct matches, such as 0.8"),
        of_world: true,
        about: "share of correct matches of the simulated camera",
    },
    Parameter {
        key: "disparity_sigma",
        kind: number(0.01, 100.0, "a standard deviation in px, 0.01 to 100", "give one such as 0.5"),
        of_world: true,
        about: "sigma of the disparities of the simulated camera, px",
    },
    Parameter {
        key: "mismatches",
        kind: Kind::Word(&["independent", "clustered"]),
        of_world: true,
        about: "how false matches of the simulated camera come",
    },
    Parameter {
        key: "scans",
        kind: Kind::Whole(Limit {
            min: 1.0,
            max: 1e6,
            bound: "a whole number of scans, 1 to 1000000",
            remedy: "give how many scans of the drive are mapped",
        }),
        of_world: false,
        about: "so many scans of the drive, evenly spread over it; all if it has fewer",
    },
    Parameter {
        key: "grid",
        kind: number(0.005, 10.0, "a cell size in m, 0.005 to 10", "give the side of a cell such as 0.05"),
        of_world: false,
        about: "side of a cell, m",
    },
    Parameter {
        key: "prior",
        kind: number(0.0, 1.0, PROBABILITY, "give the probability that an unseen cell is occupied, such as 0.1"),
        of_world: false,
        about: "probability that an unseen cell is occupied",
    },
    Parameter {
        key: "correlation",
        kind: number(0.0, 1.0, PROBABILITY, "give the correlation of cells 5 cm apart, such as 0.871"),
        of_world: false,
        about: "correlation of cells 5 cm apart",
    },
    Parameter {
        key: "assumed_length",
        kind: number(0.001, 100.0, "a mean length in m, 0.001 to 100", "give the mean length of obstacles such as 0.4"),
        of_world: false,
        about: "mean length of obstacles that mappers expect, m: another way to give `correlation`",
    },
    Parameter {
        key: "correlation_law",
        kind: Kind::Word(&["scaled", "fixed"]),
        of_world: false,
        about: "whether the correlation follows the cell size or is the same at every one",
    },
    Parameter {
        key: "reconciliation",
        kind: Kind::Word(&["all-edges", "touched"]),
        of_world: false,
        about: "what becomes of neighbouring cells that no ray runs along",
    },
    Parameter {
        key: "believed_correct_match",
        kind: number(0.0, 1.0, PROBABILITY, "give the share of correct matches, such as 0.8"),
        of_world: false,
        about: "share of correct matches that mappers believe in; that of the camera if not given",
    },
    Parameter {
        key: "believed_sigma",
        kind: number(0.01, 100.0, "a standard deviation in px, 0.01 to 100", "give one such as 0.5"),
        of_world: false,
        about: "sigma of the disparities that mappers believe in, px; that of the camera if not given",
    },
];

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
