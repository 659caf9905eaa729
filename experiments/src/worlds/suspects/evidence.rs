//! What speaks for a sensor, and against it: plain values.

use score::SeriesMean;
use sensor::Scan;

use crate::failure::Failure;

/// Reads all scans in their order and hands each over.
pub type Visit<'a> = dyn FnMut(&mut dyn FnMut(&Scan)) -> Result<(), Failure> + 'a;

/// A sensor of a robot with several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Named {
    /// Its number in scans; of sonars that are mounted together, all of theirs.
    pub numbers: Vec<usize>,
    /// What people call it.
    pub called: String,
}

impl Named {
    /// The number that it goes by: the first.
    pub fn number(&self) -> usize {
        self.numbers.first().copied().unwrap_or_default()
    }
}

/// What speaks for a sensor, and against it.
#[derive(Debug, Clone)]
pub struct Suspect {
    /// Which sensor.
    pub sensor: Named,
    /// `P(T)`: the share of its readings that should come from what is there.
    pub correct: f64,
    /// Readings that were judged; none of them is in the maps.
    pub readings: u64,
    /// Share of these that come from what its own map holds, by that map's probabilities.
    pub by_itself: Option<SeriesMean>,
    /// The same by the maps of the other sensors, pooled.
    pub by_others: Option<SeriesMean>,
    /// How much more likely its readings are under the maps of the others than in an unseen world, nats per reading.
    pub over_unseen: Option<SeriesMean>,
    /// The reading about which most of its readings lie, and their share.
    pub same: Option<(f64, f64)>,
    /// How far it seems to be turned.
    pub turn: Option<Turn>,
    /// Whether the robot moved enough to tell a sensor that always reads the same from a place where it should.
    pub moved: bool,
}

/// How far a sensor seems to be turned against its mount.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    /// By so much its readings are to be turned back, counter-clockwise, rad.
    pub back_rad: f64,
    /// How much more likely they are then under the map of the others, nats per reading.
    pub by_others: SeriesMean,
    /// The same under its own map, made of readings that are turned back too; none where it was not made.
    pub by_itself: Option<SeriesMean>,
}
