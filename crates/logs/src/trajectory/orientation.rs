//! Headings of a trajectory: the order of its quaternions, and what has no heading.

use super::rows::{Order, Row, has_heading, heading};
use crate::finding::Finding;

/// With more than this, on average, in what a planar drive leaves 0, a body rolls and pitches.
const ROLLING: f64 = 1e-9;

/// The order of the quaternions: the one that is named, else the one in which the body stays upright.
///
/// A body that is upright in both has headings near 0 in one order and near 180 degrees in the other; of a drive in the plane the
/// two numbers that are always 0 tell which. x y z w, the order of the format, holds unless w x y z leaves much less roll and pitch.
pub(super) fn order(rows: &[Row], named: Option<Order>, findings: &mut Vec<Finding>) -> Order {
    let order = named.unwrap_or_else(|| guessed(rows));
    if order == Order::ScalarFirst {
        findings.push(Finding::ScalarFirst { named: named.is_some() });
    }
    let few = rows.iter().filter(|row| row.few_digits).count();
    if few > 0 {
        findings.push(Finding::Normalised { count: few as u64 });
    }
    order
}

fn guessed(rows: &[Row]) -> Order {
    let upright = |order| rows.iter().filter(|row| has_heading(heading(row.quaternion, order).1)).count();
    let [last, first] = [upright(Order::ScalarLast), upright(Order::ScalarFirst)];
    if last < rows.len() && first == rows.len() {
        return Order::ScalarFirst;
    }
    if last > 0 && first < rows.len() {
        return Order::ScalarLast;
    }
    // Mean square of what rolls and pitches.
    let roll = |of: fn([f64; 4]) -> f64| rows.iter().map(|row| of(row.quaternion)).sum::<f64>() / rows.len() as f64;
    let last = roll(|[x, y, ..]| x * x + y * y);
    let first = roll(|[_, x, y, _]| x * x + y * y);
    if last > ROLLING && first < 0.1 * last { Order::ScalarFirst } else { Order::ScalarLast }
}

/// Heading of a row, rad.
///
/// # Errors
/// Why it has none.
pub(super) fn upright(row: &Row, order: Order) -> Result<f64, String> {
    let (theta_rad, upright) = heading(row.quaternion, order);
    if has_heading(upright) {
        return Ok(theta_rad);
    }
    let tilt = libm::acos(upright.clamp(-1.0, 1.0)).to_degrees();
    let hint = if (60.0..120.0).contains(&tilt) {
        "give poses whose z axis points up: these are of an optical frame, whose z axis points forward; take the body's frame (base_link)"
    } else {
        "give poses whose z axis points up; is the order of the quaternion qx qy qz qw?"
    };
    Err(format!("tilted by {tilt:.0} degrees: must be at most 45; {hint}"))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn row(quaternion: [f64; 4]) -> Row {
        Row { line: 1, time: 0.0, at_m: [0.0; 2], quaternion, few_digits: false }
    }

    fn found(rows: &[Row]) -> Order {
        order(rows, None, &mut Vec::new())
    }

    proptest! {
        /// Headings all around, or all near one direction such as 0 or 180 degrees, in the plane.
        #[test]
        fn the_order_of_a_planar_drive_is_found(mean in prop_oneof![Just(0.0), Just(std::f64::consts::PI), -3.0..3.0], turns in prop::collection::vec(-0.3..0.3, 3..20)) {
            prop_assume!(turns.iter().any(|turn: &f64| turn.abs() > 0.01));
            let parts = turns.iter().map(|turn| libm::sincos(0.5 * (mean + turn))).collect::<Vec<_>>();
            let last: Vec<_> = parts.iter().map(|(sin, cos)| row([0.0, 0.0, *sin, *cos])).collect();
            let first: Vec<_> = parts.iter().map(|(sin, cos)| row([*cos, 0.0, 0.0, *sin])).collect();
            prop_assert_eq!((found(&last), found(&first)), (Order::ScalarLast, Order::ScalarFirst));
        }
    }

    #[test]
    fn a_standing_robot_and_a_rolling_one_have_the_order_of_the_format() {
        assert_eq!(found(&[row([0.0, 0.0, 0.0, 1.0])]), Order::ScalarLast);
        let rolling = |k: i32| row([0.01 * f64::from(k % 3), 0.01, 0.1 * f64::from(k), 1.0]);
        assert_eq!(found(&(0..9).map(rolling).collect::<Vec<_>>()), Order::ScalarLast);
    }

    #[test]
    fn optical_frames_are_named() {
        for (quaternion, expected) in
            [([-0.5, 0.5, -0.5, 0.5], "optical frame"), ([1.0, 0.0, 0.0, 0.0], "tilted by 180 degrees")]
        {
            let message = upright(&row(quaternion), Order::ScalarLast).expect_err("tilted");
            assert!(message.contains(expected), "{message}");
        }
    }
}
