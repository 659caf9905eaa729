//! CARMEN logs: one message per line, fields separated by blanks, numbers in m, rad and s.
//!
//! | message | fields |
//! |---|---|
//! | `FLASER` | `n r_1 .. r_n x y theta odom_x odom_y odom_theta ipc_time host logger_time` |
//! | `ROBOTLASER1` | `laser_type start_angle field_of_view angular_resolution maximum_range accuracy remission_mode n r_1 .. r_n m rem_1 .. rem_m laser_x laser_y laser_theta robot_x robot_y robot_theta tv rv forward_safety side_safety turn_axis ipc_time host logger_time`; `m` and the remissions may be missing |
//! | `PARAM` | `name value`; read are `robot_front_laser_max` (m), `robot_frontlaser_offset` (m) and `laser_front_laser_resolution` (degrees), from there on |
//!
//! Every other message, `RLASER` of a second scanner among them, and `#` comments are skipped and counted by name. A scan has the
//! pose of the laser (`x y theta`, `laser_x laser_y laser_theta`) and the time `ipc_time`.
//!
//! **Bearings.** Beams go from right to left. `ROBOTLASER1` says where they are. `FLASER` does not; as SICK's scanners and the programs
//! that read their logs have it, the first of 180 or 181 beams is at -90 degrees and the step 1 degree; of 360 or 361 likewise with half
//! a degree (with an even number the last beam, at +90 degrees, is not there); 540 or 541 begin at -135 degrees with half a degree, 401 at -50
//! with a quarter. Other numbers are centred on the axis with `laser_front_laser_resolution`, or without it spread evenly over -90 to +90
//! degrees. [`Options::fan`] overrides it all.
//!
//! **No echo.** Readings of the maximum range or more: of [`Options::max_range_m`], else of the message, else of
//! `robot_front_laser_max`, else 80 m. A maximum from 81.8 to 82 m is taken as 81.8 m: SICK's codes for no echo are 81.83 to 81.91 m, and
//! logs with them claim up to 82 m.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use sensor::{Pose, Scan};

use crate::fields::{Fields, quoted};
use crate::options::{Fan, Options};
use crate::ranges::{Rule, check_unit};
use crate::record::{Parser, Recorded, Sensor};
use crate::report::Report;

/// Coordinates reach so far, m: those of the world's usual grids do.
pub(crate) const FAR_M: f64 = 1e8;

/// Headings that are not wrapped reach so far, rad.
pub(crate) const WOUND_RAD: f64 = 1e6;

/// Times reach so far, s: 3,000 years.
pub(crate) const LATE_S: f64 = 1e11;

/// Fields of `FLASER` and `ROBOTLASER1` behind the ranges and remissions.
const BEHIND_FLASER: usize = 9;
const BEHIND_ROBOTLASER: usize = 14;

pub(crate) struct Carmen {
    options: Options,
    front_max_m: Option<f64>,
    resolution_rad: Option<f64>,
    offset_m: f64,
    ranges_m: Vec<f64>,
}

impl Carmen {
    pub(crate) fn new(options: &Options) -> Self {
        Self { options: options.clone(), front_max_m: None, resolution_rad: None, offset_m: 0.0, ranges_m: Vec::new() }
    }

    fn flaser(&mut self, fields: &mut Fields<'_>, line: u64) -> Result<Recorded, String> {
        let beams = fields.count("number of ranges")?;
        if fields.left() != beams + BEHIND_FLASER {
            return Err(uneven(beams, fields.left(), BEHIND_FLASER));
        }
        self.ranges(fields, beams)?;
        let pose = pose(fields, "laser pose")?;
        fields.skip(3);
        let time_s = fields.number("time", LATE_S)?;
        let fan = self.options.fan.unwrap_or_else(|| fan(beams, self.resolution_rad));
        let mount = Pose { x_m: self.offset_m, ..Pose::default() };
        Ok(self.recorded(time_s, pose, mount, fan, self.front_max_m, line))
    }

    fn robot_laser(&mut self, fields: &mut Fields<'_>, line: u64) -> Result<Recorded, String> {
        fields.skip(1); // laser_type
        let first_rad = fields.number("start angle", TAU)?;
        fields.number("field of view", TAU)?;
        let step_rad = fields.number("angular resolution", PI)?;
        let max_m = Some(fields.any_number("maximum range")?).filter(|max| *max > 0.0);
        fields.skip(2); // accuracy, remission_mode
        let beams = fields.count("number of ranges")?;
        if fields.left() < beams + BEHIND_ROBOTLASER {
            return Err(uneven(beams, fields.left(), BEHIND_ROBOTLASER));
        }
        if step_rad == 0.0 || step_rad.abs() * (beams.max(1) - 1) as f64 > TAU + 1e-3 {
            return Err(format!("{beams} ranges, {step_rad} rad apart: must be within a full turn and apart"));
        }
        self.ranges(fields, beams)?;
        if fields.left() != BEHIND_ROBOTLASER {
            let remissions = fields.count("number of remissions")?;
            if fields.left() != remissions + BEHIND_ROBOTLASER {
                return Err(uneven(remissions, fields.left(), BEHIND_ROBOTLASER));
            }
            fields.skip(remissions);
        }
        let laser = pose(fields, "laser pose")?;
        let robot = pose(fields, "robot pose")?;
        fields.skip(5); // velocities, safety distances, turn_axis
        let time_s = fields.number("time", LATE_S)?;
        let fan = self.options.fan.unwrap_or(Fan { first_rad, step_rad });
        Ok(self.recorded(time_s, laser, seen_from(robot, laser), fan, max_m.or(self.front_max_m), line))
    }

    fn ranges(&mut self, fields: &mut Fields<'_>, beams: usize) -> Result<(), String> {
        if beams == 0 {
            return Err("a scan without ranges".to_owned());
        }
        self.ranges_m.clear();
        for _ in 0..beams {
            self.ranges_m.push(fields.any_number("range")?);
        }
        Ok(())
    }

    fn recorded(&mut self, time_s: f64, pose: Pose, mount: Pose, fan: Fan, max_m: Option<f64>, line: u64) -> Recorded {
        let rule = Rule::new(&self.options, max_m);
        let readings: Vec<_> = self.ranges_m.iter().map(|range| rule.reading(*range)).collect();
        let bearings_rad = (0..readings.len()).map(|k| fan.first_rad + k as f64 * fan.step_rad).collect();
        let sensor = Sensor::Laser { max_range_m: rule.max_m, beams: readings.len() };
        let unit = check_unit(&mut self.ranges_m);
        Recorded {
            scan: Scan { sensor: 0, time_s, pose, bearings_rad, readings },
            sensor,
            mount,
            line,
            unit,
            number: None,
        }
    }

    fn parameter(&mut self, fields: &mut Fields<'_>) -> Result<(), String> {
        match fields.raw("name")? {
            b"robot_front_laser_max" => {
                let max_m = fields.number("robot_front_laser_max", FAR_M)?;
                if max_m <= 0.0 {
                    return Err(format!("robot_front_laser_max: {max_m}: must be above 0 m"));
                }
                self.front_max_m = Some(max_m);
            }
            b"robot_frontlaser_offset" => self.offset_m = fields.number("robot_frontlaser_offset", FAR_M)?,
            b"laser_front_laser_resolution" => {
                let degrees = fields.number("laser_front_laser_resolution", 360.0)?;
                if degrees <= 0.0 {
                    return Err(format!("laser_front_laser_resolution: {degrees}: must be above 0 degrees"));
                }
                self.resolution_rad = Some(degrees.to_radians());
            }
            _ => {}
        }
        Ok(())
    }
}

impl Parser for Carmen {
    fn line(&mut self, text: &[u8], number: u64, report: &mut Report) -> Result<Option<Recorded>, String> {
        let name = text.split(u8::is_ascii_whitespace).find(|field| !field.is_empty()).unwrap_or_default();
        match name {
            b"FLASER" => self.flaser(&mut after_name(text), number).map(Some),
            b"ROBOTLASER1" => self.robot_laser(&mut after_name(text), number).map(Some),
            b"PARAM" => {
                self.parameter(&mut after_name(text))?;
                report.skip("PARAM");
                Ok(None)
            }
            [b'#', ..] => {
                report.skip("#");
                Ok(None)
            }
            name => {
                report.skip(message_name(name)?);
                Ok(None)
            }
        }
    }

    fn end(&mut self) -> Option<Recorded> {
        None
    }

    fn timed(&self) -> bool {
        true
    }
}

fn after_name(text: &[u8]) -> Fields<'_> {
    let mut fields = Fields::by_blanks(text);
    fields.skip(1);
    fields
}

/// What a line may begin with, so that noise is not taken for messages.
fn message_name(name: &[u8]) -> Result<&str, String> {
    let inner = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    let fine = name.len() <= 40 && name.first().is_some_and(u8::is_ascii_alphabetic) && name.iter().all(inner);
    match std::str::from_utf8(name) {
        Ok(text) if fine => Ok(text),
        _ => Err(format!("{} is no name of a message", quoted(name))),
    }
}

fn uneven(count: usize, left: usize, behind: usize) -> String {
    let asked = count + behind;
    let cause = if left < asked { "the line is cut, or values are missing" } else { "there are too many" };
    format!("{count} values and {behind} fields behind them must follow, which is {asked}; {left} do: {cause}")
}

fn pose(fields: &mut Fields<'_>, name: &str) -> Result<Pose, String> {
    Ok(Pose {
        x_m: fields.number(name, FAR_M)?,
        y_m: fields.number(name, FAR_M)?,
        theta_rad: fields.number(name, WOUND_RAD)?,
    })
}

/// `pose` in the frame of `from`.
fn seen_from(from: Pose, pose: Pose) -> Pose {
    let (sin, cos) = libm::sincos(from.theta_rad);
    let [x, y] = [pose.x_m - from.x_m, pose.y_m - from.y_m];
    Pose { x_m: cos * x + sin * y, y_m: cos * y - sin * x, theta_rad: pose.theta_rad - from.theta_rad }
}

/// Bearings of the beams of `FLASER`, as its readers take them.
fn fan(beams: usize, resolution_rad: Option<f64>) -> Fan {
    let degrees = |first: f64, step: f64| Fan { first_rad: first.to_radians(), step_rad: step.to_radians() };
    match (beams, resolution_rad) {
        (180 | 181, _) => degrees(-90.0, 1.0),
        (360 | 361, _) => degrees(-90.0, 0.5),
        (540 | 541, _) => degrees(-135.0, 0.5),
        (401, _) => degrees(-50.0, 0.25),
        (0 | 1, _) => degrees(0.0, 1.0),
        (_, Some(step_rad)) => Fan { first_rad: -0.5 * step_rad * (beams - 1) as f64, step_rad },
        (_, None) => Fan { first_rad: -FRAC_PI_2, step_rad: PI / (beams - 1) as f64 },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Recorded, String> {
        let recorded = Carmen::new(&Options::default()).line(line.as_bytes(), 1, &mut Report::default())?;
        recorded.ok_or_else(|| "no scan".to_owned())
    }

    #[test]
    fn beams_are_where_scanners_have_them() {
        for (beams, resolution_deg, first, last) in [
            (180, None, -90.0, 89.0),
            (181, None, -90.0, 90.0),
            (360, Some(1.0), -90.0, 89.5),
            (361, None, -90.0, 90.0),
            (401, None, -50.0, 50.0),
            (541, None, -135.0, 135.0),
            (91, None, -90.0, 90.0),
            (101, Some(1.0), -50.0, 50.0),
            (1, None, 0.0, 0.0),
        ] {
            let fan = fan(beams, resolution_deg.map(f64::to_radians));
            let ends = [fan.first_rad, fan.first_rad + (beams - 1) as f64 * fan.step_rad].map(f64::to_degrees);
            assert!((ends[0] - first).abs() < 1e-9 && (ends[1] - last).abs() < 1e-9, "{beams}: {ends:?}");
        }
    }

    #[test]
    fn a_robotlaser_says_where_its_beams_are_and_how_far_it_sees() {
        let head = "ROBOTLASER1 4 -0.6 1.2 0.6 5.5 0.01 0 3 1.0 5.5 nan";
        let tail = "1.0 3.0 1.6 1.0 2.0 1.5707963267948966 0 0 0 0 0 77.5 \u{e9}host 1.5";
        for line in [format!("{head} 2 9 8 {tail}"), format!("{head} 0 {tail}"), format!("{head} {tail}")] {
            let recorded = parse(&line).expect(&line);
            let scan = &recorded.scan;
            assert_eq!(scan.readings, [Some(1.0), Some(f64::INFINITY), None]);
            assert_eq!(scan.bearings_rad, [-0.6, 0.0, 0.6]);
            assert_eq!((scan.time_s, scan.pose), (77.5, Pose { x_m: 1.0, y_m: 3.0, theta_rad: 1.6 }));
            assert_eq!(recorded.sensor, Sensor::Laser { max_range_m: 5.5, beams: 3 });
            // The robot looks along y, and the laser stands 1 m further along y: 1 m before the robot.
            let mount = recorded.mount;
            assert!((mount.x_m - 1.0).abs() < 1e-12 && mount.y_m.abs() < 1e-12, "{mount:?}");
            assert!((mount.theta_rad - (1.6 - FRAC_PI_2)).abs() < 1e-12, "{mount:?}");
        }
    }

    #[test]
    fn damaged_lines_say_what_is_wrong() {
        for (line, reason) in [
            ("FLASER", "number of ranges is missing: the line is cut"),
            ("FLASER 4000000000 1 2 3", "field 2, number of ranges: 4000000000 of them, but 3 fields follow"),
            ("FLASER 0 1 2 3 1 2 3 9 host 9", "a scan without ranges"),
            ("FLASER 3 1 1 0 0 0 0 0 0 9 host 9", "which is 12; 11 do: the line is cut"),
            ("FLASER 1 1 1 0 0 0 0 0 0 9 host 9", "which is 10; 11 do: there are too many"),
            ("FLASER 1 a 0 0 0 0 0 0 9 host 9", "field 3, range: \"a\" is no number"),
            ("FLASER 1 1 inf 0 0 0 0 0 9 host 9", "field 4, laser pose: \"inf\" must be a number from -1e8 to 1e8"),
            ("FLASER 1 1 0 0 0 0 0 0 nan host 9", "field 10, time: \"nan\" must be"),
            (
                "ROBOTLASER1 0 -1.5 3 0 80 0 0 2 1 1 0 0 0 0 0 0 0 0 0 0 0 0 9 host 9",
                "must be within a full turn and apart",
            ),
            ("ROBOTLASER1 0 -1.5 3 1 80 0 0 9 1 1 1 1 1 1 1 1 1", "the line is cut"),
            ("ROBOTLASER1 0 -1.5 3 1 80 0 0 1 1 5 1 1 1 0 0 0 0 0 0 0 0 0 0 0 9 host 9", "5 values and 14 fields"),
            ("PARAM", "name is missing"),
            ("PARAM robot_front_laser_max", "robot_front_laser_max is missing"),
            ("PARAM robot_front_laser_max -3", "must be above 0 m"),
            ("PARAM laser_front_laser_resolution 0", "must be above 0 degrees"),
            ("12 34", "\"12\" is no name of a message"),
            ("\u{fffd}", "is no name of a message"),
        ] {
            let found = parse(line).err().unwrap_or_default();
            assert!(found.contains(reason), "{line}: {found}");
        }
    }
}
