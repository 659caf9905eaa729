//! A row for every scan, out of the poses at those that updated the filter.

use sensor::{Pose, Step, wrapped_rad};

use crate::frame::Frame;

/// A scan as it came.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row {
    pub(crate) time_s: f64,
    pub(crate) odometry: Pose,
    /// How many scans had updated the filter, this one among them.
    pub(crate) updates: usize,
}

/// A turn of a radian counts for as much of a way as this, m, where what odometry was off is spread over it.
const M_PER_RAD: f64 = 0.5;

/// Time, s, and pose of every scan. Between two updates the odometry carries the pose, and what it is found to be off at the second
/// is spread over the way between them.
pub(crate) fn poses(rows: &[Row], path: &[Pose]) -> Vec<(f64, Pose)> {
    let mut poses = Vec::with_capacity(rows.len());
    for between in rows.chunk_by(|a, b| a.updates == b.updates) {
        let Some(start) = between[0].updates.checked_sub(1).and_then(|update| path.get(update)) else { continue };
        let frame = Frame::taking(between[0].odometry, *start);
        let first = poses.len();
        poses.extend(between.iter().map(|row| (row.time_s, frame.pose(row.odometry))));
        let next = rows.get(first + between.len()).zip(path.get(between[0].updates));
        if let Some((next, found)) = next {
            spread(&mut poses[first..], between, next, frame, *found);
        }
    }
    poses
}

/// Spreads what the frame is off at the next update over the poses since the last.
fn spread(poses: &mut [(f64, Pose)], between: &[Row], next: &Row, frame: Frame, found: Pose) {
    let carried = frame.pose(next.odometry);
    let off = [found.x_m - carried.x_m, found.y_m - carried.y_m, wrapped_rad(found.theta_rad - carried.theta_rad)];
    let length = |from: &Row, to: &Row| {
        let step = Step::between(from.odometry, to.odometry);
        step.distance_m.abs() + M_PER_RAD * step.turn_rad().abs()
    };
    let mut ways = vec![0.0];
    for pair in between.windows(2) {
        ways.push(ways[ways.len() - 1] + length(&pair[0], &pair[1]));
    }
    let all = ways[ways.len() - 1] + length(&between[between.len() - 1], next);
    for ((_, pose), way) in poses.iter_mut().zip(ways) {
        let share = if all > 0.0 { way / all } else { 0.0 };
        pose.x_m += share * off[0];
        pose.y_m += share * off[1];
        pose.theta_rad = wrapped_rad(pose.theta_rad + share * off[2]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matcher::moved;

    fn row(number: usize, updates: usize) -> Row {
        let k = number as f64;
        let odometry = Pose { x_m: 0.1 * k, y_m: 0.02 * k * k, theta_rad: 0.04 * k };
        Row { time_s: k, odometry, updates }
    }

    #[test]
    fn rows_meet_the_path_and_in_between_keep_to_the_odometry() {
        let rows: Vec<Row> = (0..9).map(|k| row(k, 1 + k / 4)).collect();
        let path = [0, 4, 8].map(|k| moved(rows[k].odometry, [0.01 * k as f64, -0.02 * k as f64, 0.003 * k as f64]));
        let poses = poses(&rows, &path);
        assert_eq!(poses.len(), 9);
        for (k, found) in path.iter().enumerate() {
            let pose = poses[4 * k].1;
            assert!((pose.x_m - found.x_m).hypot(pose.y_m - found.y_m) < 1e-12);
            assert!((pose.theta_rad - found.theta_rad).abs() < 1e-12);
        }
        for (k, (time_s, pose)) in poses.iter().enumerate() {
            assert!((time_s - k as f64).abs() < 1e-12);
            let (off, expected) = (pose.theta_rad - rows[k].odometry.theta_rad, 0.003 * k as f64);
            assert!((off - expected).abs() < 0.002, "{k}: {off} {expected}");
        }
    }

    #[test]
    fn exact_odometry_comes_out_to_the_bit() {
        let rows: Vec<Row> = (0..9).map(|k| row(k, 1 + k / 3)).collect();
        let path = [0, 3, 6].map(|k| rows[k].odometry);
        for (row, (_, pose)) in rows.iter().zip(poses(&rows, &path)) {
            assert_eq!(row.odometry, pose);
        }
    }
}
