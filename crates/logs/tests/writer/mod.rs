//! Writes scans as robots do, for tests that read them back.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;
use sensor::{Pose, Scan};

/// A beam without an echo as SICK's scanners write it.
const NO_ECHO: &str = "81.91";

fn ranges(scan: &Scan) -> String {
    let range = |reading: &Option<f64>| match reading {
        Some(f64::INFINITY) => NO_ECHO.to_owned(),
        Some(range) => range.to_string(),
        None => "nan".to_owned(),
    };
    let ranges: Vec<_> = scan.readings.iter().map(range).collect();
    format!("{} {}", ranges.len(), ranges.join(" "))
}

/// A `FLASER` line, with the odometry somewhere else.
pub(crate) fn flaser(scan: &Scan) -> String {
    let pose = scan.pose;
    let (x, y, theta, time) = (pose.x_m, pose.y_m, pose.theta_rad, scan.time_s);
    format!("FLASER {} {x} {y} {theta} 7 7 7 {time} robot {time}\n", ranges(scan))
}

/// A `ROBOTLASER1` line of a laser that stands 0.2 m before its robot.
pub(crate) fn robot_laser(scan: &Scan, max_range_m: f64) -> String {
    let [first, second] = [scan.bearings_rad[0], scan.bearings_rad[1]];
    let pose = scan.pose;
    let (x, y, theta, time) = (pose.x_m, pose.y_m, pose.theta_rad, scan.time_s);
    let (sin, cos) = libm::sincos(theta);
    let [robot_x, robot_y] = [x - 0.2 * cos, y - 0.2 * sin];
    format!(
        "ROBOTLASER1 0 {first} 3.14159 {} {max_range_m} 0.01 0 {} 0 {x} {y} {theta} {robot_x} {robot_y} {theta} 0.3 0 1 1 1000 {time} \
         robot {time}\n",
        second - first,
        ranges(scan)
    )
}

/// Compressed as one member.
pub(crate) fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text).expect("memory");
    encoder.finish().expect("memory")
}

/// A `SONAR` line: of a cone (rad), ranges (m) and mounts at a time (s).
pub(crate) fn sonar(width_rad: f64, readings: &[(Option<f64>, Pose)], time_s: f64) -> String {
    let range = |(reading, _): &(Option<f64>, Pose)| match reading {
        Some(f64::INFINITY) => "5.00".to_owned(),
        Some(range) => range.to_string(),
        None => "0.00".to_owned(),
    };
    let mount = |(_, mount): &(Option<f64>, Pose)| format!("{} {} {}", mount.x_m, mount.y_m, mount.theta_rad);
    let ranges: Vec<String> = readings.iter().map(range).collect();
    let mounts: Vec<String> = readings.iter().map(mount).collect();
    format!("SONAR {width_rad} {} {} {} {time_s} robot {time_s}\n", readings.len(), ranges.join(" "), mounts.join(" "))
}

/// An `ODOM` line.
pub(crate) fn odom(robot: Pose, time_s: f64) -> String {
    format!("ODOM {} {} {} 0.3 0.1 0 {time_s} robot {time_s}\n", robot.x_m, robot.y_m, robot.theta_rad)
}
