//! `SONAR` lines: what the sonars of a base hear, and where each of them stands.

use std::f64::consts::PI;

use sensor::Pose;

use super::pose;
use crate::bounds::LATE_S;
use crate::fields::{Fields, quoted};

/// Sonars of a robot, at most: rings have 8 to 48.
const MOST_SONARS: usize = 256;

/// Fields behind the mounts.
const BEHIND: usize = 3;

/// Fields behind the ranges in lines that are formed as those of lasers are: two poses, times and host.
const BEHIND_AS_LASERS: usize = 9;

/// What one line says.
#[derive(Debug, PartialEq)]
pub(super) struct Sonars {
    /// Angle between the edges of every cone, rad; none where the line has 0.
    pub(super) width_rad: Option<f64>,
    pub(super) time_s: f64,
    /// As written, m.
    pub(super) ranges_m: Vec<f64>,
    /// Where each stands on the robot, and the axis of its cone.
    pub(super) mounts: Vec<Pose>,
}

/// Reads what follows the name; none of a line that begins with the number of ranges, as those of lasers do: it does not say where sonars stand.
pub(super) fn read(fields: &mut Fields<'_>) -> Result<Option<Sonars>, String> {
    let width = fields.raw("cone angle")?;
    if is_as_lasers(width, fields.left()) && !has_mounts(fields) {
        return Ok(None);
    }
    let width_rad = cone(width)?;
    let count = fields.count("number of sonars")?;
    if count == 0 || count > MOST_SONARS {
        return Err(format!("field 3, number of sonars: {count}: must be from 1 to {MOST_SONARS}"));
    }
    let (asked, left) = (4 * count + BEHIND, fields.left());
    if left != asked {
        let cause = if left < asked { "the line is cut, or values are missing" } else { "there are too many" };
        return Err(format!(
            "{count} ranges, {count} mounts of 3 fields and {BEHIND} fields behind them must follow, which is {asked}; {left} do: {cause}"
        ));
    }
    let ranges_m = (0..count).map(|_| fields.any_number("range")).collect::<Result<_, _>>()?;
    let mounts = (0..count).map(|_| pose(fields, "mount")).collect::<Result<_, _>>()?;
    Ok(Some(Sonars { width_rad, time_s: fields.number("time", LATE_S)?, ranges_m, mounts }))
}

/// A whole number of ranges where the angle should be, and just as many fields as a line of a laser has then.
fn is_as_lasers(first: &[u8], left: usize) -> bool {
    let count = std::str::from_utf8(first).ok().and_then(|text| text.parse::<usize>().ok());
    count.is_some_and(|count| count > 0 && count.checked_add(BEHIND_AS_LASERS) == Some(left))
}

/// Whether the number of sonars is next, with as many fields as ranges and mounts of so many take.
fn has_mounts(fields: &Fields<'_>) -> bool {
    let count = fields.peek().and_then(|field| std::str::from_utf8(field).ok()?.parse::<usize>().ok());
    count.is_some_and(|count| count <= MOST_SONARS && 1 + 4 * count + BEHIND == fields.left())
}

/// CARMEN has rad; no cone is as wide as half a circle, so that what is more is in degrees.
fn cone(field: &[u8]) -> Result<Option<f64>, String> {
    let value = crate::fields::number(field).filter(|value| (0.0..180.0).contains(value));
    let value = value.ok_or_else(|| {
        format!(
            "field 2, cone angle: {} must be the angle between the edges of the cone in rad, above 0 and below pi, or 0 if it is not known",
            quoted(field)
        )
    })?;
    let width_rad = if value < PI { value } else { value.to_radians() };
    Ok(Some(width_rad).filter(|width_rad| *width_rad > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Option<Sonars>, String> {
        let mut fields = Fields::by_blanks(line.as_bytes());
        fields.skip(1);
        read(&mut fields)
    }

    #[test]
    fn a_line_has_a_cone_ranges_and_mounts() {
        let line = "SONAR 0.525 2 1.25 5.00 0.100 0.200 1.25 -0.1 0 -3.1 77.5 robot 1.5";
        let sonars = parse(line).expect("a line").expect("with mounts");
        let mounts = vec![Pose { x_m: 0.1, y_m: 0.2, theta_rad: 1.25 }, Pose { x_m: -0.1, y_m: 0.0, theta_rad: -3.1 }];
        let expected = Sonars { width_rad: Some(0.525), time_s: 77.5, ranges_m: vec![1.25, 5.0], mounts };
        assert_eq!(sonars, expected);
    }

    #[test]
    fn a_cone_is_in_rad_or_degrees_or_not_known() {
        for (cone, expected) in [("0.2618", Some(0.2618)), ("30", Some(30f64.to_radians())), ("0.0", None)] {
            let sonars = parse(&format!("SONAR {cone} 1 2 0 0 0 9 host 9")).expect(cone).expect("with mounts");
            assert_eq!(sonars.width_rad, expected, "{cone}");
        }
    }

    #[test]
    fn a_line_as_those_of_lasers_says_no_mounts() {
        assert_eq!(parse("SONAR 2 1.5 2.5 1 2 0.5 1 2 0.5 9 host 9"), Ok(None));
        // A cone of 15 degrees with five sonars has as many fields as fifteen ranges with two poses.
        let five = format!("SONAR 15 5 1 2 3 4 5 {}9 host 9", "0 0 0 ".repeat(5));
        assert_eq!(parse(&five).expect("a line").map(|sonars| sonars.mounts.len()), Some(5));
    }

    #[test]
    fn damaged_lines_say_what_is_wrong() {
        for (line, reason) in [
            ("SONAR", "cone angle is missing: the line is cut"),
            ("SONAR 0.5", "number of sonars is missing"),
            ("SONAR nan 1 2 0 0 0 9 host 9", "field 2, cone angle: \"nan\" must be the angle"),
            ("SONAR -0.5 1 2 0 0 0 9 host 9", "field 2, cone angle: \"-0.5\" must be the angle"),
            ("SONAR 180 1 2 0 0 0 9 host 9", "field 2, cone angle: \"180\" must be"),
            ("SONAR wide 1 2 0 0 0 9 host 9", "field 2, cone angle: \"wide\" must be"),
            ("SONAR 0.5 0 9 host 9", "field 3, number of sonars: 0: must be from 1 to 256"),
            ("SONAR 0.5 1.5 2 0 0 0 9 host 9", "field 3, number of sonars: \"1.5\" is no whole number"),
            ("SONAR 0.5 400 1 2 3", "field 3, number of sonars: 400 of them, but 3 fields follow"),
            ("SONAR 0.5 1 2 0 0 9 host 9", "which is 7; 6 do: the line is cut"),
            ("SONAR 0.5 1 2 0 0 0 0 9 host 9", "which is 7; 8 do: there are too many"),
            ("SONAR 0.5 1 x 0 0 0 9 host 9", "field 4, range: \"x\" is no number"),
            ("SONAR 0.5 1 2 0 nan 0 9 host 9", "field 6, mount: \"nan\" must be a number from -1e8 to 1e8"),
            ("SONAR 0.5 1 2 0 0 0 nan host 9", "field 8, time: \"nan\" must be"),
        ] {
            let found = parse(line).err().unwrap_or_default();
            assert!(found.contains(reason), "{line}: {found}");
        }
    }
}
