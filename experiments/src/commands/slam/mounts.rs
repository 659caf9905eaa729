//! Where the sensors of a log stand on its robot.

use std::collections::BTreeMap;

use sensor::{Pose, wrapped_rad};

use crate::failure::Failure;

/// Poses that differ by no more than what tables round are the same, m and rad.
const SAME: f64 = 2e-3;

/// Scans are not laid to those of another sensor that are farther away in time than this, s.
const MOST_GAP_S: f64 = 1.0;

/// A scan as its log has it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed {
    pub(super) sensor: usize,
    pub(super) time_s: f64,
    /// The pose of the sensor.
    pub(super) pose: Pose,
    /// The pose by odometry.
    pub(super) odometry: Pose,
    /// Where the sensor stands on the robot, if the log tells.
    pub(super) mount: Option<Pose>,
}

/// Where each sensor stands on the body whose poses the odometry gives. In this order: as the log tells; as the poses of each sensor lie to
/// the odometry, where that is the same for all its scans, since the log is raw; or as they lie to those of the sensor of the lowest number at
/// the same time, or between two of its scans, and that one stands where the odometry is of. `scans` are in the order of their times, which
/// rise for each sensor.
///
/// # Errors
/// A sensor that reads at no time at which another does, nor near one.
pub(super) fn mounts(place: &str, scans: &[Placed]) -> Result<BTreeMap<usize, Pose>, Failure> {
    let mut by_sensor: BTreeMap<usize, Vec<&Placed>> = BTreeMap::new();
    for scan in scans {
        by_sensor.entry(scan.sensor).or_default().push(scan);
    }
    let told = |of: &Vec<&Placed>| of[0].mount;
    let raw = |of: &Vec<&Placed>| {
        let mount = seen_from(of[0].odometry, of[0].pose);
        of.iter().all(|scan| is_same(seen_from(scan.odometry, scan.pose), mount)).then_some(mount)
    };
    let all = |mount: &dyn Fn(&Vec<&Placed>) -> Option<Pose>| -> Option<BTreeMap<usize, Pose>> {
        by_sensor.iter().map(|(number, of)| Some((*number, mount(of)?))).collect()
    };
    if let Some(mounts) = all(&told).or_else(|| all(&raw)) {
        return Ok(mounts);
    }
    let mut sensors = by_sensor.iter();
    let Some((first, reference)) = sensors.next() else { return Ok(BTreeMap::new()) };
    let mut mounts = BTreeMap::from([(*first, Pose::default())]);
    for (number, of) in sensors {
        let mount = relative(reference, of).ok_or_else(|| {
            Failure::BadInput(format!(
                "{place}: sensor {number} never reads within {MOST_GAP_S} s of sensor {first}, so that nobody knows how it stands to that one on the robot; \
                 give each sensor rows of the same times, or leave its rows out"
            ))
        })?;
        mounts.insert(*number, mount);
    }
    Ok(mounts)
}

/// The body's pose by odometry where that of a sensor on it is known.
pub(super) fn body(sensor: Pose, mount: Pose) -> Pose {
    sensor.compose(seen_from(mount, Pose::default()))
}

/// A pose in the frame of another, its heading from -pi to pi.
pub(super) fn seen_from(from: Pose, pose: Pose) -> Pose {
    let seen = pose.seen_from(from);
    Pose { theta_rad: wrapped_rad(seen.theta_rad), ..seen }
}

fn is_same(a: Pose, b: Pose) -> bool {
    let turn_rad = wrapped_rad(a.theta_rad - b.theta_rad).abs();
    libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m) < SAME && turn_rad < SAME
}

/// How a sensor stands to another: the median over the scans of the same time, or over all that lie between two of the other, if there are none.
fn relative(reference: &[&Placed], of: &[&Placed]) -> Option<Pose> {
    let at_once: Vec<Pose> =
        of.iter().filter_map(|scan| Some(seen_from(at(reference, scan.time_s)?, scan.pose))).collect();
    if !at_once.is_empty() {
        return median(at_once);
    }
    median(of.iter().filter_map(|scan| Some(seen_from(between(reference, scan.time_s)?, scan.pose))).collect())
}

fn at(reference: &[&Placed], time_s: f64) -> Option<Pose> {
    let found = reference.binary_search_by(|scan| scan.time_s.total_cmp(&time_s)).ok()?;
    Some(reference[found].pose)
}

/// The pose between two scans that are not too far apart, along a line and by the shorter turn.
fn between(reference: &[&Placed], time_s: f64) -> Option<Pose> {
    let after = reference.partition_point(|scan| scan.time_s < time_s);
    let (before, after) = (reference.get(after.checked_sub(1)?)?, reference.get(after)?);
    let long_s = after.time_s - before.time_s;
    let share = (time_s - before.time_s) / long_s;
    let part = |from: f64, to: f64| from + share * (to - from);
    let turn_rad = wrapped_rad(after.pose.theta_rad - before.pose.theta_rad);
    (long_s <= MOST_GAP_S).then(|| Pose {
        x_m: part(before.pose.x_m, after.pose.x_m),
        y_m: part(before.pose.y_m, after.pose.y_m),
        theta_rad: before.pose.theta_rad + share * turn_rad,
    })
}

/// The median of each coordinate; of headings, of how they differ from the first.
fn median(poses: Vec<Pose>) -> Option<Pose> {
    let first = *poses.first()?;
    let middle = |value: &dyn Fn(&Pose) -> f64| {
        let mut values: Vec<f64> = poses.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let turn_rad = middle(&|pose| wrapped_rad(pose.theta_rad - first.theta_rad));
    let theta_rad = wrapped_rad(first.theta_rad + turn_rad);
    Some(Pose { x_m: middle(&|pose| pose.x_m), y_m: middle(&|pose| pose.y_m), theta_rad })
}

#[cfg(test)]
mod tests {
    use super::*;
    use slam::Mounted;

    const LASER: Pose = Pose { x_m: 0.3, y_m: -0.1, theta_rad: 0.4 };

    /// The true way of the robot, and by odometry that drifts.
    fn robot(k: f64) -> [Pose; 2] {
        let way = |drift: f64| Pose {
            x_m: 0.2 * k * (1.0 + drift),
            y_m: (0.3 * k).sin() + drift * k,
            theta_rad: 3.0 + 0.1 * k * (1.0 - drift),
        };
        [way(0.0), way(0.02)]
    }

    fn on(robot: Pose, mount: Pose) -> Pose {
        Mounted { scan: &sensor::Scan::default(), mount }.pose(robot)
    }

    /// A camera in the middle of the robot, number 0, and a laser, number 2, which reads so much later.
    fn drive(late_s: f64, is_raw: bool, told: bool) -> Vec<Placed> {
        let scan = |k: usize, sensor: usize, mount: Pose| {
            let late_s = if sensor == 2 { late_s } else { 0.0 };
            let [truth, odometry] = robot(k as f64 + 2.0 * late_s);
            let pose = on(if is_raw { odometry } else { truth }, mount);
            Placed { sensor, time_s: 0.5 * k as f64 + late_s, pose, odometry, mount: told.then_some(mount) }
        };
        (0..20).flat_map(|k| [scan(k, 0, Pose::default()), scan(k, 2, LASER)]).collect()
    }

    fn off(found: Pose, expected: Pose) -> f64 {
        let turn = wrapped_rad(found.theta_rad - expected.theta_rad).abs();
        libm::hypot(found.x_m - expected.x_m, found.y_m - expected.y_m).max(turn)
    }

    #[test]
    fn they_are_told_or_follow_from_the_poses() {
        for (scans, exact) in
            [(drive(0.0, false, true), 1e-12), (drive(0.0, true, false), 1e-9), (drive(0.0, false, false), 1e-9)]
        {
            let found = mounts("a.csv", &scans).expect("both are known");
            assert!(off(found[&2], LASER) < exact && off(found[&0], Pose::default()) < exact, "{found:?}");
        }
    }

    #[test]
    fn sensors_that_read_in_turns_are_laid_between_each_others_scans() {
        let found = mounts("a.csv", &drive(0.2, false, false)).expect("in between");
        assert!(off(found[&2], LASER) < 0.01, "{found:?}");
        assert!(off(found[&2], LASER) > 1e-6, "a way that bends is not quite a line");
        let far: Vec<Placed> = drive(50.0, false, false);
        let error = mounts("a.csv", &far).expect_err("never near").to_string();
        assert!(error.contains("a.csv: sensor 2 never reads within 1 s of sensor 0"), "{error}");
    }

    #[test]
    fn the_body_is_where_its_sensor_says() {
        let robot = Pose { x_m: 3.0, y_m: -2.0, theta_rad: 2.5 };
        assert!(off(body(on(robot, LASER), LASER), robot) < 1e-12);
        assert_eq!(body(robot, Pose::default()), robot, "to the bit");
        assert_eq!(seen_from(robot, robot), Pose::default());
    }
}
