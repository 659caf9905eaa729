//! Which sensors are named, and what is said of them.

use std::fmt;

use super::evidence::{Named, Suspect};

/// A sensor is named where its own map explains less than this of the share of readings that it should. Measured in an office with glass: 0.95 of a camera that is
/// right, 1.0 of a laser; 0.67 and 0.61 where half of the readings are false.
const LEAST_EXPLAINED: f64 = 0.8;

/// A sensor reads always the same where this share of its readings do, while the robot moves and the map of the others makes them less likely than an
/// unseen world would.
const SAME: f64 = 0.9;

/// What is wrong with a sensor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wrong {
    /// It gives no reading.
    Blind,
    /// It always reads the same, wherever it is.
    Stuck {
        /// The reading, in the sensor's unit.
        reading: f64,
        /// The share of its readings that are this one, 0 to 1.
        share: f64,
    },
    /// Its own map does not explain its readings.
    Unexplained {
        /// The share that its map explains, 0 to 1 ...
        explained: f64,
        /// ... and the share that should come from what is there.
        correct: f64,
    },
    /// It is turned against the way it is mounted.
    Turned {
        /// By so much its readings are to be turned back, counter-clockwise, rad.
        back_rad: f64,
    },
}

impl Wrong {
    /// In a word, for tables.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Blind => "blind",
            Self::Stuck { .. } => "stuck",
            Self::Unexplained { .. } => "unexplained",
            Self::Turned { .. } => "turned",
        }
    }
}

impl fmt::Display for Wrong {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Blind => write!(f, "has no reading in the scans kept back: is it blinded, or broken? Map without it"),
            Self::Stuck { reading, share } => write!(
                f,
                "reads {reading:.3} in {:.0} % of its readings, wherever it is, and the other sensors see nothing there: it is stuck; map without it",
                100.0 * share
            ),
            Self::Unexplained { explained, correct } => write!(
                f,
                "has a map of its own that explains {:.0} % of its readings, and {:.0} % should come from what is there: is it broken, or are its poses or its \
                 noise others than assumed? Map without it, or calibrate it",
                100.0 * explained,
                100.0 * correct
            ),
            Self::Turned { back_rad } => write!(
                f,
                "fits the map of the other sensors, and its own, better when it is turned by {:+.0} degrees: correct its heading on the robot",
                back_rad.to_degrees()
            ),
        }
    }
}

/// Those that are named. Where one is wrong by itself, no other is called turned: it would be turned against the wrong one.
pub(super) fn named(suspects: &[Suspect]) -> Vec<(&Named, Wrong)> {
    let broken: Vec<(&Named, Wrong)> =
        suspects.iter().filter_map(|suspect| Some((&suspect.sensor, alone(suspect)?))).collect();
    if !broken.is_empty() {
        return broken;
    }
    suspects.iter().filter_map(|suspect| Some((&suspect.sensor, turned(suspect)?))).collect()
}

/// What is wrong in a sensor whatever the others say, or that they contradict.
fn alone(suspect: &Suspect) -> Option<Wrong> {
    let Some(by_itself) = suspect.by_itself else { return Some(Wrong::Blind) };
    let contradicted = suspect.over_unseen.is_some_and(|gain| gain.interval.high < 0.0);
    if let Some((reading, share)) = suspect.same.filter(|(_, share)| *share > SAME && contradicted && suspect.moved) {
        return Some(Wrong::Stuck { reading, share });
    }
    let unexplained = by_itself.interval.high < LEAST_EXPLAINED * suspect.correct;
    unexplained.then_some(Wrong::Unexplained { explained: by_itself.mean, correct: suspect.correct })
}

/// Whether it fits the others' map better when it is turned back, and its own as well.
fn turned(suspect: &Suspect) -> Option<Wrong> {
    let turn = suspect.turn?;
    let sharper = turn.by_itself.is_some_and(|gain| gain.interval.low > 0.0);
    sharper.then_some(Wrong::Turned { back_rad: turn.back_rad })
}
