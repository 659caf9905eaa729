//! Rows put together to scans: of one number, time, pose and sensor.

use std::collections::{HashMap, HashSet, VecDeque};

use sensor::Scan;

use super::head::READINGS;
use super::row::Row;
use crate::finding::Finding;
use crate::record::Fault;
use crate::report::Report;

/// A scan of more beams is taken for a mistake.
pub(super) const MOST_BEAMS: usize = 100_000;

/// Rows of a table whose scans are spread over it, at most: they need 200 MB.
const MOST_ROWS: usize = 4_000_000;

/// Rows that are looked at to find out whether scans are spread over the table.
const MOST_PROBED: usize = 200_000;

/// Sensors, or poses, at one time and number.
const MOST_AT_ONCE: usize = 64;

/// Scans that are kept to notice rows that stand apart.
const MOST_RECENT: usize = 64;

/// Number and time of a scan, or of the scans of several sensors.
type Instant = (u64, Option<u64>);

/// What the rows of one scan have in common, exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Key {
    instant: Instant,
    pose: [u64; 3],
    sensor: Option<usize>,
}

impl Key {
    fn of(row: &Row) -> Self {
        // 0 and -0 are the same.
        let bits = |value: f64| (value + 0.0).to_bits();
        let instant = (row.number, row.time_s.map(bits));
        Self { instant, pose: [row.pose.x_m, row.pose.y_m, row.pose.theta_rad].map(bits), sensor: row.sensor }
    }
}

/// A scan that may not be complete yet.
pub(super) struct Group {
    key: Key,
    pub(super) first: Row,
    /// The line of its first row.
    pub(super) line: u64,
    /// The sensor's number; where the table has none, in the order of rows at that time.
    pub(super) sensor: usize,
    /// The scan but for its readings.
    pub(super) scan: Scan,
    /// The readings of every row, by their columns.
    pub(super) readings: Vec<ByColumn<Option<f64>>>,
    /// Readings as they stand, by their columns.
    pub(super) raw: ByColumn<Vec<f64>>,
}

/// A value for each of [`READINGS`].
pub(super) type ByColumn<T> = [T; READINGS.len()];

impl Group {
    fn new(key: Key, first: Row, line: u64, ordinal: usize) -> Self {
        let scan = Scan { time_s: first.time_s.unwrap_or(0.0), pose: first.pose, ..Scan::default() };
        Self {
            key,
            first,
            line,
            sensor: first.sensor.unwrap_or(ordinal),
            scan,
            readings: Vec::new(),
            raw: Default::default(),
        }
    }

    /// Whether a scan has the same number and time.
    pub(super) fn is_at_once_with(&self, instant: Option<Instant>) -> bool {
        instant == Some(self.key.instant)
    }

    /// Number and time.
    pub(super) fn instant(&self) -> Instant {
        self.key.instant
    }

    fn add(&mut self, row: &Row, readings: ByColumn<Option<f64>>) -> Result<(), Fault> {
        if self.readings.len() == MOST_BEAMS {
            return Err(Fault::Damage(format!(
                "scan {} has more than {MOST_BEAMS} rows; give its other beams another number",
                row.number
            )));
        }
        self.scan.bearings_rad.push(row.bearing_rad);
        self.readings.push(readings);
        self.raw.iter_mut().zip(row.raw).for_each(|(all, raw)| all.extend(raw));
        Ok(())
    }

    /// Puts the beams in the order of their bearings, unless they rise or fall already.
    fn sort(&mut self) {
        let bearings = &self.scan.bearings_rad;
        if bearings.is_sorted() || bearings.iter().rev().is_sorted() {
            return;
        }
        let mut beams: Vec<_> = bearings.iter().copied().zip(self.readings.iter().copied()).collect();
        beams.sort_by(|a, b| a.0.total_cmp(&b.0));
        (self.scan.bearings_rad, self.readings) = beams.into_iter().unzip();
    }
}

/// How rows are put together.
enum Order {
    /// The first rows: nothing is known.
    Probe { instants: HashSet<Instant> },
    /// Rows of one time and number follow each other.
    Stream { recent: VecDeque<Key> },
    /// Rows of one scan are spread over the table.
    Spread,
}

/// Puts rows together to scans. Holds those of one time and number; at the beginning, and all where scans are spread over the
/// table, more.
pub(super) struct Gather {
    order: Order,
    /// Scans that are not complete.
    open: Vec<Group>,
    /// Where they stand in `open`; unused in a stream.
    places: HashMap<Key, usize>,
    /// Sensors by time and number, to number them; unused in a stream.
    at_once: HashMap<Instant, usize>,
    now: Option<Instant>,
    rows: usize,
    /// Rows that stand apart, and the line of the first.
    split: Option<(u64, u64)>,
}

impl Gather {
    pub(super) fn new() -> Self {
        Self {
            order: Order::Probe { instants: HashSet::new() },
            open: Vec::new(),
            places: HashMap::new(),
            at_once: HashMap::new(),
            now: None,
            rows: 0,
            split: None,
        }
    }

    /// Takes a row; adds the scans that are complete.
    pub(super) fn add(
        &mut self,
        row: &Row,
        readings: ByColumn<Option<f64>>,
        line: u64,
        out: &mut Vec<Group>,
    ) -> Result<(), Fault> {
        let key = Key::of(row);
        if self.now != Some(key.instant) {
            self.turn_to(key.instant, out);
        }
        self.rows += 1;
        let place = match &self.order {
            Order::Stream { .. } => self.open.iter().position(|group| group.key == key),
            Order::Spread if self.rows > MOST_ROWS => {
                return Err(Fault::Refusal(format!(
                    "the rows of a scan are spread over the table, of which {MOST_ROWS} rows can be put together; sort the rows by \
                     the column scan"
                )));
            }
            Order::Probe { .. } | Order::Spread => self.places.get(&key).copied(),
        };
        let place = place.unwrap_or_else(|| self.begin(key, row, line, out));
        self.open[place].add(row, readings)
    }

    /// The table ends: adds all scans.
    pub(super) fn end(&mut self, report: &mut Report, out: &mut Vec<Group>) {
        let mut rest = std::mem::take(&mut self.open);
        if matches!(self.order, Order::Spread) {
            rest.iter_mut().for_each(Group::sort);
            let time = |group: &Group| (group.scan.time_s, group.first.number, group.line);
            rest.sort_by(|a, b| {
                let (a, b) = (time(a), time(b));
                a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2))
            });
            report.noted.push(Finding::Regrouped { scans: rest.len() as u64 });
        }
        if let Some((count, line)) = self.split {
            report.noted.push(Finding::Split { count, line });
        }
        out.extend(rest);
    }

    /// A row of another time or number than the one before.
    fn turn_to(&mut self, next: Instant, out: &mut Vec<Group>) {
        let before = self.now.replace(next);
        match &mut self.order {
            Order::Probe { instants } => {
                instants.extend(before);
                if instants.contains(&next) {
                    self.order = Order::Spread;
                } else if instants.len() >= 3 && self.rows >= 2 * self.open.len() || self.rows >= MOST_PROBED {
                    self.order = Order::Stream { recent: VecDeque::new() };
                    self.places.clear();
                    self.at_once.clear();
                    out.append(&mut self.open);
                }
            }
            Order::Stream { recent } => {
                recent.extend(self.open.iter().map(|group| group.key));
                let old = recent.len().saturating_sub(MOST_RECENT);
                recent.drain(..old);
                out.append(&mut self.open);
            }
            Order::Spread => {}
        }
    }

    /// A new scan; gives where it stands.
    fn begin(&mut self, key: Key, row: &Row, line: u64, out: &mut Vec<Group>) -> usize {
        let ordinal = if let Order::Stream { recent } = &self.order {
            if recent.contains(&key) {
                let (count, _) = self.split.get_or_insert((0, line));
                *count += 1;
            }
            if self.open.len() == MOST_AT_ONCE {
                out.append(&mut self.open);
            }
            self.open.len()
        } else {
            self.places.insert(key, self.open.len());
            let count = self.at_once.entry(key.instant).or_default();
            *count += 1;
            (*count - 1).min(MOST_AT_ONCE - 1)
        };
        self.open.push(Group::new(key, *row, line, ordinal));
        self.open.len() - 1
    }
}
