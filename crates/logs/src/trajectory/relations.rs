//! Relations: motions between two times that are known, as those of Kümmerle et al. 2009 that come with public logs.
//!
//! A line is `from to x y z roll pitch yaw`: two times in s, then the pose at the second seen from the pose at the first, in m and rad. Fields are
//! separated by blanks, commas or semicolons; blank lines and `#` comments are skipped. z, roll and pitch are left out.

use std::f64::consts::{FRAC_PI_4, TAU};
use std::io::Read;
use std::path::Path;

use sensor::Pose;

use super::rows::fields;
use crate::bounds::{FAR_M, LATE_S};
use crate::error::LogError;
use crate::fields::{number, quoted};
use crate::lines::{LONGEST_LINE, Line, Lines};
use crate::source;

/// The fields of a line.
const NAMES: [&str; 8] = ["from", "to", "x", "y", "z", "roll", "pitch", "yaw"];

/// More relations are taken for a mistake.
const MOST: usize = 5_000_000;

/// Beyond a turn, and what rounding adds to it, an angle is in degrees, rad.
const MOST_RAD: f64 = TAU + 0.01;

/// A motion between two times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relation {
    /// From when, s, by the log's own clock.
    pub from_s: f64,
    /// Until when, s.
    pub to_s: f64,
    /// The pose then, seen from the pose before.
    pub motion: Pose,
}

/// Reads a file, plain, gzip or bzip2.
///
/// # Errors
/// As [`read`]; a file that cannot be opened.
pub fn open(path: &Path) -> Result<Vec<Relation>, LogError> {
    read(source::file(path, false)?, &path.display().to_string())
}

/// Reads relations, in their order; `place` names the file in messages.
///
/// # Errors
/// The first line that is not eight numbers within their bounds, or is a motion within no time; motions that are tilted by more than 45 degrees; no
/// relation at all; more than five million.
pub fn read(source: impl Read + Send, place: &str) -> Result<Vec<Relation>, LogError> {
    let interrupted = |line, source| LogError::Interrupted { place: place.to_owned(), line, source };
    let refused = |line, reason| LogError::Trajectory { place: place.to_owned(), line, reason };
    let mut lines = Lines::new(source::text(source, place)?);
    let mut relations = Vec::new();
    loop {
        let line = lines.number() + 1;
        let text = match lines.next().map_err(|error| interrupted(line - 1, error))? {
            None if relations.is_empty() => {
                return Err(refused(line, format!("no relation; give lines of {}", NAMES.join(" "))));
            }
            None => return Ok(relations),
            Some((_, Line::TooLong)) => return Err(refused(line, format!("is longer than {LONGEST_LINE} bytes"))),
            Some((_, Line::Text(text))) => text.trim_ascii(),
        };
        if text.is_empty() || text[0] == b'#' {
            continue;
        }
        if relations.len() == MOST {
            return Err(refused(line, format!("more than {MOST} relations; thin them out")));
        }
        relations.push(relation(text).map_err(|reason| refused(line, reason))?);
    }
}

fn relation(text: &[u8]) -> Result<Relation, String> {
    let fields = fields(text);
    if fields.len() != NAMES.len() {
        let hint = if fields.len() == 5 { "; 0 0 0 between y and yaw will do" } else { "" };
        return Err(format!("{} fields; must be 8: {}{hint}", fields.len(), NAMES.join(" ")));
    }
    let value = |k: usize, most: f64, hint: &str| -> Result<f64, String> {
        let [name, field] = [NAMES[k].to_owned(), quoted(fields[k])];
        let found = number(fields[k]).ok_or_else(|| format!("field {}, {name}: {field} is no number", k + 1))?;
        if found.abs() <= most {
            return Ok(found);
        }
        Err(format!("field {}, {name}: {field} must be a number from {:.6e} to {most:.6e}{hint}", k + 1, -most))
    };
    let [seconds, radians, upright] = [", in s", ", in rad", ", in rad: a robot that is tilted more has no heading"];
    let [from_s, to_s] = [value(0, LATE_S, seconds)?, value(1, LATE_S, seconds)?];
    let [x_m, y_m] = [value(2, FAR_M, ", in m")?, value(3, FAR_M, ", in m")?];
    value(4, FAR_M, ", in m")?;
    value(5, FRAC_PI_4, upright)?;
    value(6, FRAC_PI_4, upright)?;
    let motion = Pose { x_m, y_m, theta_rad: value(7, MOST_RAD, radians)? };
    // Zero to the bit: the same moment seen from itself.
    if from_s.total_cmp(&to_s).is_eq() && [x_m, y_m, motion.theta_rad].iter().any(|part| part.abs() > 0.0) {
        return Err(format!("a motion within no time: both times are {from_s} s"));
    }
    Ok(Relation { from_s, to_s, motion })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn lines_are_relations() {
        let text = "# of ACES\n90.239599 90.719599 0.422330 -0.000750 0.000000 0.000000 0.000000 0.017260\n\n\
                    5,1, -1,2, 0,0,0, -3.2\r\n";
        let found = read(text.as_bytes(), "a.relations").expect("fine");
        let motion = Pose { x_m: 0.42233, y_m: -0.00075, theta_rad: 0.01726 };
        assert_eq!(found[0], Relation { from_s: 90.239599, to_s: 90.719599, motion });
        assert_eq!(found[1].motion, Pose { x_m: -1.0, y_m: 2.0, theta_rad: -3.2 });
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn what_is_wrong_is_said_with_its_line() {
        let fine = "1 2 0 0 0 0 0 1\n";
        for (text, message) in [
            (String::new(), "a.relations:1: no relation; give lines of from to x y z roll pitch yaw"),
            (format!("{fine}1 2 0 0 0 0 1"), "a.relations:2: 7 fields; must be 8: from to x y z roll pitch yaw"),
            (
                format!("{fine}1 2 0 0 1"),
                "a.relations:2: 5 fields; must be 8: from to x y z roll pitch yaw; 0 0 0 between",
            ),
            (format!("{fine}1 two 0 0 0 0 0 1"), "a.relations:2: field 2, to: \"two\" is no number"),
            ("1e15 1e15 0 0 0 0 0 1".to_owned(), "field 1, from: \"1e15\" must be a number from -1.000000e11"),
            ("1 2 nan 0 0 0 0 1".to_owned(), "field 3, x: \"nan\" must be a number from"),
            (
                "1 2 0 0 0 0 0 90".to_owned(),
                "field 8, yaw: \"90\" must be a number from -6.293185e0 to 6.293185e0, in rad",
            ),
            ("1 2 0 0 0 0 1.6 0".to_owned(), "field 7, pitch: \"1.6\" must be a number from"),
            ("3 3 0.5 0 0 0 0 0".to_owned(), "a motion within no time: both times are 3 s"),
        ] {
            let found = read(text.as_bytes(), "a.relations").expect_err(&text).to_string();
            assert!(found.contains(message), "{text}: {found}");
        }
        assert!(read(&b"3 3 0 0 0 0 0 0"[..], "a.relations").is_ok(), "nothing within no time is right");
    }

    proptest! {
        #[test]
        fn what_is_written_comes_back(rows in prop::collection::vec((0.0..1e9, 0.0..1e9, -1e3..1e3, -1e3..1e3, -6.2..6.2), 1..20)) {
            let text: String = rows.iter().map(|(a, b, x, y, yaw)| format!("{a} {b} {x} {y} 0 0 0 {yaw}\n")).collect();
            let found = read(text.as_bytes(), "a").expect("fine");
            let back: Vec<_> = found.iter().map(|r| (r.from_s, r.to_s, r.motion.x_m, r.motion.y_m, r.motion.theta_rad)).collect();
            prop_assert_eq!(back, rows);
        }

        #[test]
        fn noise_is_refused_at_a_line_it_has(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
            if let Err(LogError::Trajectory { line, .. }) = read(bytes.as_slice(), "noise") {
                let ends = bytes.iter().filter(|byte| matches!(byte, b'\n' | b'\r')).count() as u64;
                prop_assert!((1..=ends + 2).contains(&line), "{line} of {ends}");
            }
        }
    }
}
