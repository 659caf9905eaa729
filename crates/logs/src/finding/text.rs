//! Findings in words: a line each, with value, bound and remedy.

use std::fmt;

use super::Finding;
use crate::fan::Fan;
use crate::report::Unit;

/// What makes poses jump.
const JUMPS: &str = "is it a bad pose, a gap, centimetres for metres, two clocks, or two lasers in one table?";
const TWISTS: &str = "are headings in degrees, is there a gap, are there two clocks, or two lasers in one table?";

/// First and last bearing, and the step, in degrees.
fn degrees(fan: &Fan, beams: usize) -> String {
    let [first, step] = [fan.first_rad, fan.step_rad].map(f64::to_degrees);
    let last = first + beams.saturating_sub(1) as f64 * step;
    format!("from {first:.1} to {last:.1} degrees in steps of {step:.4}")
}

fn share(count: u64, beams: u64) -> String {
    format!("{count} disparities, {:.1} % of all readings,", 100.0 * count as f64 / beams.max(1) as f64)
}

impl Finding {
    /// A line that gives value, bound and remedy, of a log that is counted in lines or messages.
    pub fn text(&self, unit: Unit) -> String {
        struct Text<'a>(&'a Finding, Unit);
        impl fmt::Display for Text<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.0.write(f, self.1)
            }
        }
        Text(self, unit).to_string()
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.write(f, Unit::Line)
    }
}

impl Finding {
    fn write(&self, f: &mut fmt::Formatter<'_>, unit: Unit) -> fmt::Result {
        match self {
            Self::GuessedFan { sensor, line, beams, fan, usual } => {
                let why = match (usual, beams) {
                    (true, 360 | 361) => "; others turn a full circle with so many",
                    (true, _) => "",
                    (false, _) => ", which is no usual number",
                };
                write!(
                    f,
                    "line {line}: {sensor} does not say where its {beams} beams are; by their number they are taken to go {}{why}: \
                     if that is wrong, give --fov, --first-bearing or --increment",
                    degrees(fan, *beams)
                )
            }
            Self::UnevenFan { sensor, line, beams, fan } => write!(
                f,
                "line {line}: PARAM lines give {sensor} a field of view and a resolution that do not fit {beams} beams; they are \
                 taken to go {}: if that is wrong, give --fov, --first-bearing or --increment",
                degrees(fan, *beams)
            ),
            Self::OdometryPoses { sensor, scans } => write!(
                f,
                "the pose equals the odometry in all {scans} scans of {sensor}: the log is not corrected, unless a program wrote \
                 corrected poses into both; a SLAM program's poses are given by --trajectory"
            ),
            Self::Jump { step, count } => write!(
                f,
                "{unit} {}: the sensor is {:.2} m from where it was at {unit} {}, {:.2} s before, of which at most {:.2} m are plausible \
                 ({count} such jumps): {JUMPS}",
                step.line,
                step.move_m,
                step.before,
                step.time_s,
                step.move_bound_m()
            ),
            Self::Twist { step, count } => write!(
                f,
                "{unit} {}: the sensor is turned by {:.0} degrees since {unit} {}, {:.2} s before, of which at most {:.0} are plausible \
                 ({count} such turns): {TWISTS}",
                step.line,
                step.turn_rad.to_degrees(),
                step.before,
                step.time_s,
                step.turn_bound_rad().to_degrees()
            ),
            Self::StepsBack { count, largest_s, line, window } => {
                if *largest_s > 0.0 {
                    write!(f, "{count} steps back in time, the largest of {largest_s:.1} s at {unit} {line}")?;
                } else {
                    write!(f, "{count} scans have a lower number than the one before, first at {unit} {line}")?;
                }
                let hint = "are there two clocks, or two logs in one?";
                if *window {
                    write!(f, ": --window takes scans of several parts of the log; {hint}")
                } else {
                    write!(f, ": {hint}")
                }
            }
            Self::Strays { count, line, away_m } => write!(
                f,
                "{unit} {line}: the pose is {} from the drive; {count} scans with such poses are left out: correct or remove them",
                kilometres(*away_m)
            ),
            Self::Gaps { scans, longest_s, from_s, most_s } => write!(
                f,
                "{scans} scans are left out: they lie where no pose is known for more than {most_s} s, at most for {longest_s:.1} s \
                 from {from_s:.3} s on; --max-gap allows longer gaps"
            ),
            Self::SaidAgain { scans } => {
                write!(
                    f,
                    "{scans} scans stand in messages of two names, with the same ranges at the same time: each is used once"
                )
            }
            Self::Bag(finding) => write!(f, "{finding}"),
            Self::BeyondMaximum { count, beams } => write!(
                f,
                "{count} ranges, {:.1} % of all readings, lie beyond the range_max of their messages and say nothing (REP 117): if the driver \
                 means no echo by them, give --max-range",
                100.0 * *count as f64 / (*beams).max(1) as f64
            ),
            Self::Unplaced { scans, poses: Some(poses) } => {
                write!(f, "{scans} scans are left out: there is no pose before and after them from {poses}")
            }
            Self::Unplaced { scans, poses: None } => {
                write!(
                    f,
                    "{scans} scans of raw lasers or sonars are left out: no message gives the robot's pose before and after them"
                )
            }
            Self::ZeroDisparities { count, beams } => {
                write!(
                    f,
                    "{} are exactly 0 and are taken for no match: a disparity of 0 is a point at infinity",
                    share(*count, *beams)
                )
            }
            Self::InfiniteDisparities { count } => write!(
                f,
                "{count} disparities are infinite and are taken for no match: are they ranges? then name the column range_m"
            ),
            Self::LargeDisparities { count, beams, most_px } => write!(
                f,
                "{} lie above the largest disparity, {most_px} px (--max-disparity), and are taken for no match: are they sixteenths (OpenCV) or \
                 256ths (KITTI) of a pixel, or is the camera's bound larger?",
                share(*count, *beams)
            ),
            Self::OneBeam { scans } => write!(
                f,
                "all {scans} scans have a single beam: rows are a scan where number, time, pose and sensor are the same"
            ),
            Self::Regrouped { scans } => {
                write!(f, "rows of one scan do not follow each other; they were put together to {scans} scans")
            }
            Self::Split { count, line } => write!(
                f,
                "line {line}: the row stands apart from the others of its scan, as {count} do, which became scans of their own: \
                 sort the rows by the column scan"
            ),
            Self::GuessedMount { sensor, taken } => {
                write!(f, "no PARAM line says where {sensor} stands on the robot; it is taken to be {taken}")
            }
            Self::GuessedSonarRange { line, taken_m } => write!(
                f,
                "line {line}: no PARAM robot_max_sonar says how far SONAR hears; readings from {taken_m} m on are taken for no echo: if that is \
                 wrong, give --sonar-range"
            ),
            Self::SonarMaximum { range_m, count } => write!(
                f,
                "{count} readings of sonars are exactly {range_m} m, and none is longer: that is rather their maximum, which is no echo, than a \
                 wall; give --sonar-range {range_m}"
            ),
            Self::SonarsAlike { line, count } => write!(
                f,
                "line {line}: all {count} sonars of SONAR stand at one place and look the same way: did the base leave out where they stand?"
            ),
            Self::WithoutMounts { lines, line } => write!(
                f,
                "line {line}: {lines} SONAR lines have poses and do not say where the sonars stand on the robot: they are skipped; CARMEN writes \
                 SONAR cone_angle n, n ranges, n mounts (x y theta), times and host"
            ),
            Self::TrajectoryUnit { unit } => write!(f, "times of the trajectory are taken for {unit}"),
            Self::TrajectorySorted { steps_back } => {
                write!(f, "the poses of the trajectory were sorted by time, which went back {steps_back} times")
            }
            Self::TrajectoryDoubled { count } => {
                write!(f, "{count} poses of the trajectory come twice and are used once")
            }
            Self::ScalarFirst { named: true } => {
                write!(f, "quaternions of the trajectory are in the order w x y z, as its columns are named")
            }
            Self::ScalarFirst { named: false } => write!(
                f,
                "quaternions of the trajectory are taken to be in the order w x y z: in the order x y z w the body would be tilted; \
                 reorder them if that is wrong"
            ),
            Self::Normalised { count } => {
                write!(f, "{count} quaternions of the trajectory have few digits, and were normalised")
            }
            Self::TrajectoryStrays { count, line, away_m } => write!(
                f,
                "line {line} of the trajectory: the pose is {} from those around it; {count} such poses are left out: correct or \
                 remove them",
                kilometres(*away_m)
            ),
        }
    }
}

fn kilometres(m: f64) -> String {
    if m >= 1e4 { format!("{:.0} km", m / 1e3) } else { format!("{m:.0} m") }
}
