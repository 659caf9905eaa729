//! CARMEN logs: one message per line, fields separated by blanks, numbers in m, rad and s.
//!
//! | message | fields |
//! |---|---|
//! | `FLASER`, `RLASER` | `n r_1 .. r_n x y theta odom_x odom_y odom_theta ipc_time host logger_time` |
//! | `ROBOTLASER1` .. `5` | `laser_type start_angle field_of_view angular_resolution maximum_range accuracy remission_mode n r_1 .. r_n m rem_1 .. rem_m laser_x laser_y laser_theta robot_x robot_y robot_theta tv rv forward_safety side_safety turn_axis ipc_time host logger_time`; `m` and the remissions may be missing |
//! | `RAWLASER1` .. `5` | the same up to the remissions, then `ipc_time host logger_time` |
//! | `SONAR` | `cone_angle n r_1 .. r_n x_1 y_1 theta_1 .. x_n y_n theta_n ipc_time host logger_time`, with where each sonar stands on the robot |
//! | `ODOM` | `x y theta tv rv acceleration ipc_time host logger_time`: poses for raw lasers and sonars |
//! | `PARAM` | `name value`, from there on |
//!
//! Every other message and `#` comments are skipped and counted by name. Every kind of message is a sensor of its own. A scan has the
//! pose of the laser (`x y theta`, `laser_x laser_y laser_theta`) and the time `ipc_time`.
//!
//! **Raw lasers** have no pose: it is that of the odometry before and after them, not bridged over more than
//! [`Options::max_gap_s`], and of where the laser stands on the robot. They are left out where the same laser has scans with poses.
//!
//! **Sonars** have no pose in any version of CARMEN that writes them: the robot stands where its lasers with poses put it, so that sonars of a
//! corrected log are corrected too, else where the odometry does; both are interpolated, and not bridged over more than
//! [`Options::max_gap_s`] nor over a jump. Every sonar of a line is a sensor of its own, in the order of the line, with a scan of one reading; together they are an
//! array ([`Report::array_of`]). The cone is in rad, from pi on in degrees, and not known where it is 0. Readings from
//! [`Options::max_sonar_m`] on, else from `PARAM robot_max_sonar`, else from 5 m, are no echo. Lines `SONAR n r_1 .. r_n` with two poses behind them, as those of
//! lasers have, do not say where sonars stand: they are skipped, and a [`Finding`].
//!
//! **Said twice.** Where a laser has the same ranges at the same time in messages of two names, such as `FLASER` and `ROBOTLASER1`,
//! the second is skipped.
//!
//! **Parameters** of the first laser are named `laser_front_laser_*`, `laser_laser1_*`, `robot_front_laser_*` or `robot_frontlaser_*`, of the second
//! likewise with `rear` or `2`, of others with `laser3` and so on; read are `max` (m), `fov` (rad or degrees), `resolution` (degrees),
//! `start_angle`, and where it stands: `offset`, `side_offset` (m) and `angular_offset` (rad).
//!
//! **Bearings.** Beams go from right to left. `ROBOTLASER` and `RAWLASER` say where they are. Of `FLASER` and `RLASER` the field of
//! view and the resolution of the parameters decide; without them the number of beams, as SICK's and Hokuyo's scanners have it: the first of
//! 180 or 181 beams is at -90 degrees and the step 1 degree; of 360 or 361 likewise with half a degree (with an even number the last
//! beam, at +90 degrees, is not there); 540 or 541 begin at -135 degrees with half a degree, 1080 or 1081 with a quarter, 401 at -50 with
//! a quarter; 682 or 683 are centred with 360 / 1024 degrees. Other numbers are spread evenly over -90 to +90 degrees. A guess is a
//! [`Finding`]; [`Options::fan`] overrides it all.
//!
//! **No echo.** Readings of the maximum range or more: of [`Options::max_range_m`], else of the message, else of the parameter
//! `max`, else 80 m. A maximum from 81.8 to 82 m is taken as 81.8 m: SICK's codes for no echo are 81.83 to 81.91 m, and
//! logs with them claim up to 82 m.

mod parameters;
mod sonar;
mod track;
mod waiting;

use std::collections::{BTreeMap, VecDeque};
use std::f64::consts::{PI, TAU};

use sensor::{Pose, Scan};

use self::parameters::Parameters;
use self::sonar::Sonars;
use self::waiting::Waiting;
use crate::bounds::{FAR_M, LATE_S, WOUND_RAD};
use crate::fan::{Fan, FanSource, guessed};
use crate::fields::{Fields, quoted};
use crate::finding::Finding;
use crate::frames::{distance_m, turn_rad};
use crate::options::Options;
use crate::ranges::{MAX_SONAR_M, Rule, check_unit};
use crate::record::{Fault, Parser, Recorded, Sensor};
use crate::report::{FanReport, Report};

/// The name of messages of sonars.
const SONAR: &str = "SONAR";

/// Fields of the messages behind the ranges and remissions.
const BEHIND_FLASER: usize = 9;
const BEHIND_ROBOTLASER: usize = 14;
const BEHIND_RAWLASER: usize = 3;

/// Two messages of one laser with the same ranges are of one scan up to this far apart in time, s.
const AT_ONCE_S: f64 = 0.5;

/// Poses that differ by no more than what logs round are the same, m and rad.
const SAME: f64 = 2e-4;

pub(crate) struct Carmen {
    options: Options,
    parameters: Parameters,
    /// Names of the messages that held scans, in order: the sensors.
    names: Vec<String>,
    /// The sensors that the sonars of a line are, in its order.
    sonars: Vec<usize>,
    waiting: Waiting,
    ranges_m: Vec<f64>,
    /// The last scan of each laser that has a pose.
    last: BTreeMap<u8, Last>,
}

/// A scan, to find out whether the next message of that laser says it again.
struct Last {
    sensor: usize,
    time_s: f64,
    ranges_m: Vec<f64>,
}

/// What a message says of its scan.
struct Message<'a> {
    name: &'a str,
    laser: u8,
    line: u64,
    time_s: f64,
    fan: Option<Fan>,
    max_m: Option<f64>,
}

impl Carmen {
    pub(crate) fn new(options: &Options) -> Self {
        Self {
            options: options.clone(),
            parameters: Parameters::default(),
            names: Vec::new(),
            sonars: Vec::new(),
            waiting: Waiting::default(),
            ranges_m: Vec::new(),
            last: BTreeMap::new(),
        }
    }

    fn flaser(
        &mut self,
        fields: &mut Fields<'_>,
        mut message: Message<'_>,
        report: &mut Report,
    ) -> Result<Recorded, String> {
        let beams = fields.count("number of ranges")?;
        if fields.left() != beams + BEHIND_FLASER {
            return Err(uneven(beams, fields.left(), BEHIND_FLASER));
        }
        self.ranges(fields, beams)?;
        let pose = pose(fields, "laser pose")?;
        let odometry = self::pose(fields, "odometry").ok();
        message.time_s = fields.number("time", LATE_S)?;
        let mount = self.parameters.laser(message.laser).mount(message.laser);
        let mut recorded = self.recorded(&message, report)?;
        (recorded.scan.pose, recorded.mount, recorded.odometry, recorded.placed) = (pose, Some(mount), odometry, true);
        Ok(recorded)
    }

    /// The fields that `ROBOTLASER` and `RAWLASER` have in common: fan, maximum range, ranges, remissions.
    fn described(&mut self, fields: &mut Fields<'_>, message: &mut Message<'_>, behind: usize) -> Result<(), String> {
        fields.skip(1); // laser_type
        let first_rad = fields.number("start angle", TAU)?;
        fields.number("field of view", TAU)?;
        let step_rad = fields.number("angular resolution", PI)?;
        message.max_m = Some(fields.any_number("maximum range")?).filter(|max| *max > 0.0);
        message.fan = Some(Fan { first_rad, step_rad });
        fields.skip(2); // accuracy, remission_mode
        let beams = fields.count("number of ranges")?;
        if fields.left() < beams + behind {
            return Err(uneven(beams, fields.left(), behind));
        }
        self.ranges(fields, beams)?;
        if fields.left() != behind {
            let remissions = fields.count("number of remissions")?;
            if fields.left() != remissions + behind {
                return Err(uneven(remissions, fields.left(), behind));
            }
            fields.skip(remissions);
        }
        Ok(())
    }

    fn robot_laser(
        &mut self,
        fields: &mut Fields<'_>,
        mut message: Message<'_>,
        report: &mut Report,
    ) -> Result<Recorded, String> {
        self.described(fields, &mut message, BEHIND_ROBOTLASER)?;
        let laser = pose(fields, "laser pose")?;
        let robot = pose(fields, "robot pose")?;
        fields.skip(5); // velocities, safety distances, turn_axis
        message.time_s = fields.number("time", LATE_S)?;
        let mut recorded = self.recorded(&message, report)?;
        (recorded.scan.pose, recorded.mount, recorded.placed) = (laser, Some(laser.seen_from(robot)), true);
        Ok(recorded)
    }

    fn raw_laser(
        &mut self,
        fields: &mut Fields<'_>,
        mut message: Message<'_>,
        report: &mut Report,
    ) -> Result<Recorded, String> {
        self.described(fields, &mut message, BEHIND_RAWLASER)?;
        message.time_s = fields.number("time", LATE_S)?;
        let laser = self.parameters.laser(message.laser);
        let new = !self.names.iter().any(|name| name == message.name);
        let mut recorded = self.recorded(&message, report)?;
        recorded.mount = Some(laser.mount(message.laser));
        if new && message.laser > 1 && !laser.is_mounted() {
            let taken = if message.laser == 2 { "in its middle, looking back" } else { "in its middle, looking ahead" };
            report.noted.push(Finding::GuessedMount { sensor: message.name.to_owned(), taken });
        }
        Ok(recorded)
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

    /// The fan of the beams at hand: of the options, else of the message, else of the parameters, else by their number.
    fn fan(&self, message: &Message<'_>) -> Result<FanReport, String> {
        let beams = self.ranges_m.len();
        let parameters = self.parameters.laser(message.laser).fan;
        let log = || message.fan.or_else(|| parameters.fan(beams));
        let (fan, source) = match (self.options.fan.fan(beams), log()) {
            (Some(fan), _) => (fan, FanSource::Options),
            (None, Some(fan)) => (fan, FanSource::Log),
            (None, None) => guessed(beams),
        };
        let fits = source != FanSource::Log || message.fan.is_some() || parameters.fits(beams);
        // Of parameters that do not fit, the field of view decides.
        let unresolved = crate::fan::FanOptions { step_rad: None, ..parameters };
        let fan = if fits { fan } else { unresolved.fan(beams).unwrap_or(fan) };
        let Fan { step_rad, .. } = fan;
        if !(step_rad.abs() > 0.0 && step_rad.abs() * (beams.max(1) - 1) as f64 <= TAU + 1e-2) {
            return Err(format!("{beams} ranges, {step_rad} rad apart: must be within a full turn and apart"));
        }
        Ok(FanReport { line: message.line, beams, fan, source, fits })
    }

    /// The scan of a message, without its pose.
    fn recorded(&mut self, message: &Message<'_>, report: &mut Report) -> Result<Recorded, String> {
        let found = self.fan(message)?;
        let max_m = message.max_m.or(self.parameters.laser(message.laser).max_range_m);
        let rule = Rule::new(&self.options, max_m);
        let readings: Vec<_> = self.ranges_m.iter().map(|range| rule.reading(*range)).collect();
        let Fan { first_rad, step_rad } = found.fan;
        let bearings_rad = (0..readings.len()).map(|k| first_rad + k as f64 * step_rad).collect();
        let kind = Sensor::Laser { max_range_m: rule.max_m, beams: readings.len() };
        let unit = check_unit(&mut self.ranges_m);
        let sensor = self.names.iter().position(|name| name == message.name).unwrap_or_else(|| {
            self.names.push(message.name.to_owned());
            self.names.len() - 1
        });
        if unit.is_ok() {
            report.fan(sensor, message.name, found);
        }
        let scan = Scan { sensor: 0, time_s: message.time_s, pose: Pose::default(), bearings_rad, readings };
        Ok(Recorded { scan, unit, ..Recorded::of(sensor, kind, message.line) })
    }

    /// The scans of the sonars of a line.
    fn sonars(&mut self, sonars: Sonars, line: u64, report: &mut Report) -> Result<Vec<Recorded>, String> {
        let Sonars { width_rad, time_s, mut ranges_m, mounts } = sonars;
        let max_m = self.options.max_sonar_m.or(self.parameters.max_sonar_m());
        let rule = Rule { min_m: self.options.min_range_m, max_m: max_m.unwrap_or(MAX_SONAR_M) };
        let kind = Sensor::Sonar { max_range_m: Some(rule.max_m), width_rad };
        let readings: Vec<Option<f64>> = ranges_m.iter().map(|range| rule.reading(*range)).collect();
        check_unit(&mut ranges_m)?;
        if self.sonars.is_empty() {
            if max_m.is_none() {
                report.noted.push(Finding::GuessedSonarRange { line, taken_m: rule.max_m });
            }
            if mounts.len() > 1 && mounts.iter().all(|mount| is_same(*mount, mounts[0])) {
                report.noted.push(Finding::SonarsAlike { line, count: mounts.len() });
            }
        }
        while self.sonars.len() < mounts.len() {
            self.sonars.push(self.names.len());
            report.sensors.entry(self.names.len()).or_default().name = SONAR.to_owned();
            self.names.push(SONAR.to_owned());
        }
        let of = |(k, (mount, reading)): (usize, (Pose, Option<f64>))| {
            let scan = Scan { time_s, bearings_rad: vec![0.0], readings: vec![reading], ..Scan::default() };
            Recorded { scan, mount: Some(mount), follows: k > 0, ..Recorded::of(self.sonars[k], kind, line) }
        };
        Ok(mounts.into_iter().zip(readings).enumerate().map(of).collect())
    }

    /// `ODOM`, as far as it can be read: it is of use for raw lasers and sonars alone.
    fn odometry(&mut self, fields: &mut Fields<'_>) -> Option<()> {
        let pose = pose(fields, "odometry").ok()?;
        fields.skip(3); // velocities, acceleration
        self.waiting.odometry(fields.number("time", LATE_S).ok()?, pose);
        Some(())
    }

    fn placed(&mut self, laser: u8, recorded: Recorded, report: &mut Report, out: &mut VecDeque<Recorded>) {
        let robot = (recorded.scan.time_s, robot(&recorded));
        self.waiting.placed(laser, recorded.mount.unwrap_or_default(), robot, report);
        if self.is_said_again(laser, &recorded) {
            report.said_again += 1;
            return report.skip(&self.names[recorded.sensor]);
        }
        if recorded.unit.is_ok() && recorded.odometry.is_some_and(|odometry| is_odometry(&recorded, odometry)) {
            report.sensors.entry(recorded.sensor).or_default().odometry_poses += 1;
        }
        self.waiting.give(recorded, out);
    }

    /// Whether the last message of the laser, of another name, has the same ranges at this time: newer programs of CARMEN write
    /// every scan as `FLASER` and as `ROBOTLASER1`.
    fn is_said_again(&mut self, laser: u8, recorded: &Recorded) -> bool {
        let (sensor, time_s) = (recorded.sensor, recorded.scan.time_s);
        let again = self.last.get(&laser).is_some_and(|last| {
            last.sensor != sensor && (last.time_s - time_s).abs() <= AT_ONCE_S && last.ranges_m == self.ranges_m
        });
        if !again {
            self.last.insert(laser, Last { sensor, time_s, ranges_m: self.ranges_m.clone() });
        }
        again
    }
}

/// Whether a scan's pose is that of the odometry, or of the laser on it.
fn is_odometry(recorded: &Recorded, odometry: Pose) -> bool {
    let pose = recorded.scan.pose;
    is_same(odometry, pose) || is_same(odometry.compose(recorded.mount.unwrap_or_default()), pose)
}

fn is_same(a: Pose, b: Pose) -> bool {
    distance_m(a, b) < SAME && turn_rad(a, b) < SAME
}

/// Where the robot stood whose laser has this pose. Some programs write the robot's pose for the laser's, which then is the odometry.
fn robot(recorded: &Recorded) -> Pose {
    let (mount, pose) = (recorded.mount.unwrap_or_default(), recorded.scan.pose);
    match recorded.odometry {
        Some(odometry) if is_same(odometry, pose) => pose,
        _ => pose.compose(Pose::default().seen_from(mount)),
    }
}

impl Parser for Carmen {
    fn line(
        &mut self,
        text: &[u8],
        number: u64,
        report: &mut Report,
        out: &mut VecDeque<Recorded>,
    ) -> Result<(), Fault> {
        let first = text.split(u8::is_ascii_whitespace).find(|field| !field.is_empty()).unwrap_or_default();
        if first.starts_with(b"#") {
            report.skip("#");
            return Ok(());
        }
        let name = message_name(first)?;
        let fields = &mut after_name(text);
        let message = |laser| Message { name, laser, line: number, time_s: 0.0, fan: None, max_m: None };
        let numbered =
            |kind: &str| name.strip_prefix(kind).and_then(|k| k.parse().ok()).filter(|k| (1..=5).contains(k));
        if name == "FLASER" || name == "RLASER" {
            let laser = if name == "FLASER" { 1 } else { 2 };
            let recorded = self.flaser(fields, message(laser), report)?;
            self.placed(laser, recorded, report, out);
        } else if let Some(laser) = numbered("ROBOTLASER") {
            let recorded = self.robot_laser(fields, message(laser), report)?;
            self.placed(laser, recorded, report, out);
        } else if let Some(laser) = numbered("RAWLASER").filter(|laser| self.waiting.wants(*laser)) {
            let recorded = self.raw_laser(fields, message(laser), report)?;
            match recorded.unit {
                Ok(()) => self.waiting.scan(laser, recorded),
                Err(_) => out.push_back(recorded),
            }
        } else if name == SONAR && self.options.sonars {
            match sonar::read(fields)? {
                Some(sonars) => {
                    let sonars = self.sonars(sonars, number, report)?;
                    self.waiting.sonars(sonars);
                }
                None => {
                    report.unmounted(number);
                    report.skip(name);
                }
            }
        } else {
            match name {
                "PARAM" => self.parameters.take(fields)?,
                "ODOM" => {
                    let _ = self.odometry(fields);
                }
                _ => {}
            }
            report.skip(name);
        }
        self.waiting.release(false, self.options.max_gap_s, report, out);
        Ok(())
    }

    fn end(&mut self, report: &mut Report, out: &mut VecDeque<Recorded>) {
        self.waiting.release(true, self.options.max_gap_s, report, out);
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
    match std::str::from_utf8(name) {
        Ok(text) if is_message_name(name) => Ok(text),
        _ => Err(format!("{} is no name of a message", quoted(name))),
    }
}

/// Whether a message can have this name.
pub(crate) fn is_message_name(name: &[u8]) -> bool {
    let inner = |byte: &u8| byte.is_ascii_alphanumeric() || *byte == b'_';
    name.len() <= 40 && name.first().is_some_and(u8::is_ascii_alphabetic) && name.iter().all(inner)
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

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    fn parse(line: &str) -> Result<Recorded, String> {
        let mut out = VecDeque::new();
        match Carmen::new(&Options::default()).line(line.as_bytes(), 1, &mut Report::default(), &mut out) {
            Ok(()) => out.pop_front().ok_or_else(|| "no scan".to_owned()),
            Err(Fault::Damage(reason) | Fault::Refusal(reason)) => Err(reason),
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
            assert_eq!(recorded.kind, Sensor::Laser { max_range_m: 5.5, beams: 3 });
            // The robot looks along y, and the laser stands 1 m further along y: 1 m before the robot.
            let mount = recorded.mount.expect("told");
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
