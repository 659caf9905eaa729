//! Where the robot comes back to where it has been: there a filter can see how far its way has drifted.

use std::collections::HashMap;

use score::trajectory::LOOP_S;

/// The robot is back where it was so near before, m ...
const NEAR_M: f64 = 1.0;

/// ... and has left once it has been on new ground for so long a way, m.
const AWAY_M: f64 = 3.0;

/// The numbers of the poses at which the robot comes back to within a metre or two of where it was more than [`LOOP_S`] before, after a way
/// over new ground. Times in s, rising; places in m.
pub(super) fn returns(poses: &[(f64, [f64; 2])]) -> Vec<usize> {
    let square = |at: [f64; 2]| at.map(|metres| (metres / NEAR_M).floor() as i64);
    let mut first: HashMap<[i64; 2], f64> = HashMap::new();
    let mut found = Vec::new();
    // The robot starts where it starts: that is no return.
    let (mut away_m, mut last) = (0.0, None::<[f64; 2]>);
    for (number, (time_s, at)) in poses.iter().enumerate() {
        let moved_m = last.map_or(0.0, |last| (at[0] - last[0]).hypot(at[1] - last[1]));
        last = Some(*at);
        let [column, row] = square(*at);
        let around = (-1..=1).flat_map(|i| (-1..=1).map(move |k| [column + i, row + k]));
        let known = around.filter_map(|square| first.get(&square)).any(|then| time_s - then > LOOP_S);
        first.entry([column, row]).or_insert(*time_s);
        if !known {
            away_m += moved_m;
        } else {
            if away_m > AWAY_M {
                found.push(number);
            }
            away_m = 0.0;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Once round a square of 10 m and a half, at 0.5 m/s.
    fn round(scans: usize) -> Vec<(f64, [f64; 2])> {
        let at = |way: f64| match way.rem_euclid(40.0) {
            w if w < 10.0 => [w, 0.0],
            w if w < 20.0 => [10.0, w - 10.0],
            w if w < 30.0 => [30.0 - w, 10.0],
            w => [0.0, 40.0 - w],
        };
        (0..scans).map(|k| (k as f64, at(0.5 * k as f64))).collect()
    }

    #[test]
    fn a_loop_is_closed_once_where_the_robot_is_back_at_its_start() {
        let poses = round(120);
        let found = returns(&poses);
        assert_eq!(found.len(), 1, "{found:?}");
        let [x, y] = poses[found[0]].1;
        assert!(x.hypot(y) < 2.0 * NEAR_M * 2f64.sqrt(), "({x}, {y})");
        assert!(returns(&round(70)).is_empty(), "three sides are no loop");
    }

    #[test]
    fn who_stands_or_turns_back_at_once_has_not_returned() {
        let standing: Vec<(f64, [f64; 2])> = (0..500).map(|k| (k as f64, [0.0, 0.0])).collect();
        assert!(returns(&standing).is_empty());
        assert!(returns(&[]).is_empty());
    }
}
