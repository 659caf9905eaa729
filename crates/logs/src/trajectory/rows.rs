//! Lines of a trajectory: what their numbers are.

use crate::bounds::FAR_M;
use crate::fields::{number, quoted};

/// The norm of a quaternion may differ from 1 by this; what few digits leave of one does.
const NORM_TOLERANCE: f64 = 0.05;

/// What is beyond this has few digits.
const NORM_EXACT: f64 = 1e-3;

/// Times in ns since 1970 are below this.
const LATEST: f64 = 1e20;

/// What is tilted by more than 45 degrees has no heading: the z axis of a robot points up, that of a camera forward.
const LEAST_UPRIGHT: f64 = 0.707;

/// The order of the numbers of a quaternion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Order {
    /// x y z w, as in the TUM format.
    ScalarLast,
    /// w x y z, as in the format of EuRoC.
    ScalarFirst,
}

/// A line: a time as it stands, a place, and a heading for either order of the quaternion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) line: u64,
    pub(super) time: f64,
    pub(super) at_m: [f64; 2],
    /// The quaternion as it stands, of norm 1.
    pub(super) quaternion: [f64; 4],
    /// Whether it was normalised by more than rounding.
    pub(super) few_digits: bool,
}

/// Heading and how upright the body is (cosine of the tilt).
pub(super) fn heading(quaternion: [f64; 4], order: Order) -> (f64, f64) {
    let [x, y, z, w] = match (order, quaternion) {
        (Order::ScalarLast, same) => same,
        (Order::ScalarFirst, [w, x, y, z]) => [x, y, z, w],
    };
    let theta_rad = libm::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
    (theta_rad, 1.0 - 2.0 * (x * x + y * y))
}

/// Whether a body that is so upright has a heading.
pub(super) fn has_heading(upright: f64) -> bool {
    upright >= LEAST_UPRIGHT
}

/// The fields of a line: numbers, or names, separated by blanks, commas or semicolons.
pub(super) fn fields(text: &[u8]) -> Vec<&[u8]> {
    let apart = |byte: &u8| byte.is_ascii_whitespace() || matches!(byte, b',' | b';');
    text.split(apart).filter(|field| !field.is_empty()).collect()
}

/// Reads a line of numbers.
pub(super) fn row(text: &[u8], line: u64, named: bool) -> Result<Row, String> {
    let fields = fields(text);
    let count = fields.len();
    if count == 12 || count == 16 {
        return Err(format!(
            "{count} numbers are a matrix, as in the format of KITTI, which has no times; must be time x y z qx qy qz qw (TUM): \
             take times from times.txt, x y z from the fourth column of the matrix, and the quaternion of its rotation, such as \
             with evo_traj kitti --save_as_tum"
        ));
    }
    // Behind a pose, EuRoC's ground truth has velocities and biases.
    if count != 8 && !(named && count > 8) {
        let hint = match count {
            3 | 4 => ": heights and quaternions are missing; 0 and 0 0 sin(theta/2) cos(theta/2) will do",
            7 => ": is the time missing, or are the last three angles?",
            13 | 17 => ": is it a matrix with a time? must be a quaternion",
            _ => "",
        };
        return Err(format!("{count} fields; must be 8: time x y z qx qy qz qw{hint}"));
    }
    let value = |k: usize, name: &str, most: f64| -> Result<f64, String> {
        let found =
            number(fields[k]).ok_or_else(|| format!("field {}, {name}: {} is no number", k + 1, quoted(fields[k])))?;
        if found.abs() <= most {
            return Ok(found);
        }
        Err(format!("field {}, {name}: {} must be a number from {:e} to {most:e}", k + 1, quoted(fields[k]), -most))
    };
    let time = value(0, "time", LATEST)?;
    let at_m = [value(1, "x", FAR_M)?, value(2, "y", FAR_M)?];
    value(3, "z", FAR_M)?;
    let q = [value(4, "qx", 2.0)?, value(5, "qy", 2.0)?, value(6, "qz", 2.0)?, value(7, "qw", 2.0)?];
    let norm = libm::sqrt(q.iter().map(|part| part * part).sum::<f64>());
    if (norm - 1.0).abs() > NORM_TOLERANCE {
        return Err(format!(
            "quaternion of norm {norm:.4}: must be 1 to within {NORM_TOLERANCE}; are the last four fields qx qy qz qw?"
        ));
    }
    let few_digits = (norm - 1.0).abs() > NORM_EXACT;
    // What is rounded in the last of many digits stays as it is.
    let quaternion = if few_digits { q.map(|part| part / norm) } else { q };
    Ok(Row { line, time, at_m, quaternion, few_digits })
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    #[test]
    fn a_quaternion_has_a_heading_in_either_order() {
        let (sin, cos) = libm::sincos(0.5 * 2.5);
        let (last, first) =
            (heading([0.0, 0.0, sin, cos], Order::ScalarLast), heading([cos, 0.0, 0.0, sin], Order::ScalarFirst));
        assert!((last.0 - 2.5).abs() < 1e-12 && (first.0 - 2.5).abs() < 1e-12);
        assert!(has_heading(last.1) && has_heading(first.1));
        let optical = heading([-0.5, 0.5, -0.5, 0.5], Order::ScalarLast);
        assert!(!has_heading(optical.1));
        let back = heading([1.0, 0.0, 0.0, 0.0], Order::ScalarLast);
        assert!((back.1 + 1.0).abs() < 1e-12 && back.0.abs() <= PI);
    }
}
