//! Times of a trajectory: their unit, their order, and those that come twice.

use super::rows::Row;
use crate::bounds::LATE_S;
use crate::finding::Finding;
use crate::frames::distance_m;

use sensor::Pose;

/// Poses that follow each other are so far apart, s, in the median.
const SOONEST_S: f64 = 1e-4;
const LATEST_S: f64 = 1e3;

/// A unit of times.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    Seconds,
    Milliseconds,
    Microseconds,
    Nanoseconds,
}

impl Unit {
    fn name(self) -> &'static str {
        match self {
            Self::Seconds => "seconds",
            Self::Milliseconds => "milliseconds",
            Self::Microseconds => "microseconds",
            Self::Nanoseconds => "nanoseconds",
        }
    }

    fn seconds(self) -> f64 {
        match self {
            Self::Seconds => 1.0,
            Self::Milliseconds => 1e-3,
            Self::Microseconds => 1e-6,
            Self::Nanoseconds => 1e-9,
        }
    }

    /// Of names of columns in lower case.
    pub(super) fn named(text: &str) -> Option<Self> {
        [
            ("[ns]", Self::Nanoseconds),
            ("[us]", Self::Microseconds),
            ("[ms]", Self::Milliseconds),
            ("[s]", Self::Seconds),
        ]
        .into_iter()
        .find_map(|(name, unit)| text.contains(name).then_some(unit))
    }

    /// By the size of times since 1970, unless poses would then be implausibly far apart, as those of a clock that starts with the
    /// machine are; and else by how far apart whole numbers are.
    fn guessed(rows: &[Row]) -> Self {
        let by_size = match rows.iter().map(|row| row.time.abs()).fold(0.0, f64::max) {
            1e17.. => Self::Nanoseconds,
            1e14..1e17 => Self::Microseconds,
            1e11..1e14 => Self::Milliseconds,
            _ => Self::Seconds,
        };
        let mut steps: Vec<f64> = rows.windows(2).map(|pair| (pair[1].time - pair[0].time).abs()).collect();
        let whole = rows.iter().all(|row| row.time.fract() == 0.0);
        if !whole || steps.is_empty() {
            return by_size;
        }
        let middle = steps.len() / 2;
        let step = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
        let apart_s = step * by_size.seconds();
        if (by_size == Self::Seconds || apart_s >= SOONEST_S) && apart_s <= LATEST_S || step <= 0.0 {
            return by_size;
        }
        // The geometric mean of what is usual, a tenth of a second, in us and in ns.
        if step < 3e6 { Self::Microseconds } else { Self::Nanoseconds }
    }
}

/// Gives the times in s, in order, each once.
///
/// # Errors
/// Line and reason: a time that comes twice with different poses, or two runs.
pub(super) fn ordered(
    rows: &mut Vec<Row>,
    named: Option<Unit>,
    findings: &mut Vec<Finding>,
) -> Result<(), (u64, String)> {
    let unit = named.unwrap_or_else(|| Unit::guessed(rows));
    if unit != Unit::Seconds {
        rows.iter_mut().for_each(|row| row.time *= unit.seconds());
        findings.push(Finding::TrajectoryUnit { unit: unit.name() });
    }
    if let Some(row) = rows.iter().find(|row| row.time.abs() > LATE_S) {
        return Err((row.line, format!("time {:e} s: must be from -{LATE_S:e} to {LATE_S:e} s", row.time)));
    }
    sorted(rows, findings)?;
    once(rows, findings)
}

/// Puts poses in the order of their times, unless they are of two runs: then the path would go to and fro between both.
fn sorted(rows: &mut [Row], findings: &mut Vec<Finding>) -> Result<(), (u64, String)> {
    let back = |pair: &[Row]| pair[1].time < pair[0].time;
    let steps_back = rows.windows(2).filter(|pair| back(pair)).count();
    let Some(first) = rows.windows(2).find(|pair| back(pair)).map(|pair| (pair[0], pair[1])) else { return Ok(()) };
    let before_m = length_m(rows);
    rows.sort_by(|a, b| a.time.total_cmp(&b.time));
    if length_m(rows) > 1.5 * before_m + 1.0 {
        let (before, after) = first;
        return Err((
            after.line,
            format!(
                "time {} s comes after {} s, and sorted by time the path would go to and fro: are there two runs in one file? give one of them",
                after.time, before.time
            ),
        ));
    }
    findings.push(Finding::TrajectorySorted { steps_back: steps_back as u64 });
    Ok(())
}

fn length_m(rows: &[Row]) -> f64 {
    rows.windows(2).map(|pair| libm::hypot(pair[1].at_m[0] - pair[0].at_m[0], pair[1].at_m[1] - pair[0].at_m[1])).sum()
}

/// Uses poses once that come twice.
fn once(rows: &mut Vec<Row>, findings: &mut Vec<Finding>) -> Result<(), (u64, String)> {
    let twice = |a: &Row, b: &Row| a.time.total_cmp(&b.time).is_eq();
    let other = |a: &Row, b: &Row| {
        let pose = |row: &Row| Pose { x_m: row.at_m[0], y_m: row.at_m[1], theta_rad: 0.0 };
        distance_m(pose(a), pose(b)) > 1e-6 || (0..4).any(|k| (a.quaternion[k] - b.quaternion[k]).abs() > 1e-6)
    };
    let pairs = || rows.windows(2).filter(|pair| twice(&pair[0], &pair[1]));
    let count = pairs().count();
    if let Some(pair) = pairs().find(|pair| other(&pair[0], &pair[1])) {
        let (line, before) = (pair[0].line.max(pair[1].line), pair[0].line.min(pair[1].line));
        let time = pair[0].time;
        let all_one = count + 1 == rows.len();
        let whole = rows.iter().all(|row| row.time.fract() == 0.0);
        let hint = match (all_one, whole) {
            (true, _) => format!("; all {} poses have it: write their times", rows.len()),
            (false, true) => "; all times are whole seconds: write them with more digits".to_owned(),
            (false, false) if 2 * count >= rows.len().saturating_sub(1) => {
                "; are there two runs in one file? give one of them".to_owned()
            }
            (false, false) => "; remove one of them".to_owned(),
        };
        return Err((
            line,
            format!(
                "time {time} s: is there twice with different poses, first in line {before}, as are {count} poses{hint}"
            ),
        ));
    }
    if count > 0 {
        rows.dedup_by(|b, a| twice(a, b));
        findings.push(Finding::TrajectoryDoubled { count: count as u64 });
    }
    Ok(())
}
