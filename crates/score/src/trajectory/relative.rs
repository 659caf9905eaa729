//! How far motions are from what they should be.

use super::absolute::{PoseErrors, checked};
use super::association::Pair;
use super::error::TrajectoryError;
use super::pose::Pose;

/// Over what motions are compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Step {
    /// So many paired poses.
    Poses(usize),
    /// So many m of the reference's path, or a little more: up to the first pose that is so far along.
    Metres(f64),
    /// So many s, or a little more.
    Seconds(f64),
}

/// The relative pose error (RPE): `⊖ (⊖ r_i ⊕ r_j) ⊕ (⊖ e_i ⊕ e_j)` of motions over a step (Sturm et al. 2012, Eqs. 1 and 2), each of which begins
/// where the one before ended, as `evo` has it with `--pairs_from_reference`. Errors are those of a whole step, not divided by it.
///
/// # Errors
/// A step that is not positive; fewer poses than one step; a number that is none.
pub fn relative(pairs: &[Pair], step: Step) -> Result<PoseErrors, TrajectoryError> {
    checked(pairs, 2)?;
    let motion = |[from, to]: [usize; 2]| {
        let [start, end] = [pairs[from], pairs[to]];
        end.estimate.seen_from(start.estimate).seen_from(end.reference.seen_from(start.reference))
    };
    let motions: Vec<Pose> = steps(pairs, step)?.into_iter().map(motion).collect();
    let (value, unit) = match step {
        Step::Poses(count) => (count as f64, "poses"),
        Step::Metres(metres) => (metres, "m"),
        Step::Seconds(seconds) => (seconds, "s"),
    };
    PoseErrors::of(&motions).ok_or(TrajectoryError::Step { value, unit, pairs: pairs.len() })
}

/// First and last pose of every step.
fn steps(pairs: &[Pair], step: Step) -> Result<Vec<[usize; 2]>, TrajectoryError> {
    let mut ends = vec![0];
    match step {
        Step::Poses(0) => return Err(not_positive("step, poses", 0.0)),
        Step::Poses(count) => ends.extend((count..pairs.len()).step_by(count)),
        Step::Metres(least_m) => {
            let mut along_m = 0.0;
            for k in 1..pairs.len() {
                along_m += pairs[k].reference.seen_from(pairs[k - 1].reference).distance_m();
                if along_m >= positive("step, m", least_m)? {
                    ends.push(k);
                    along_m = 0.0;
                }
            }
        }
        Step::Seconds(least_s) => {
            let mut since_s = pairs[0].time_s;
            for (k, pair) in pairs.iter().enumerate().skip(1) {
                if pair.time_s - since_s >= positive("step, s", least_s)? {
                    ends.push(k);
                    since_s = pair.time_s;
                }
            }
        }
    }
    Ok(ends.windows(2).map(|ends| [ends[0], ends[1]]).collect())
}

fn positive(name: &'static str, value: f64) -> Result<f64, TrajectoryError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(not_positive(name, value)) }
}

fn not_positive(name: &'static str, value: f64) -> TrajectoryError {
    TrajectoryError::Bound { name, value, bound: "above 0 and finite" }
}

#[cfg(test)]
mod tests {
    use super::super::walks::{pose, walk};
    use super::*;
    use proptest::prelude::*;

    /// The same by homogeneous matrices.
    fn by_matrices(pairs: &[Pair], [from, to]: [usize; 2]) -> (f64, f64) {
        type Matrix = [[f64; 3]; 3];
        let matrix = |pose: Pose| -> Matrix {
            let (sin, cos) = pose.theta_rad.sin_cos();
            [[cos, -sin, pose.x_m], [sin, cos, pose.y_m], [0.0, 0.0, 1.0]]
        };
        let times = |a: Matrix, b: Matrix| -> Matrix {
            [0, 1, 2].map(|row| [0, 1, 2].map(|column| (0..3).map(|k| a[row][k] * b[k][column]).sum()))
        };
        let inverse = |m: Matrix| -> Matrix {
            let [[a, b, x], [c, d, y], last] = m;
            [[a, c, -(a * x + c * y)], [b, d, -(b * x + d * y)], last]
        };
        let between = |a: Pose, b: Pose| times(inverse(matrix(a)), matrix(b));
        let error = times(
            inverse(between(pairs[from].reference, pairs[to].reference)),
            between(pairs[from].estimate, pairs[to].estimate),
        );
        (error[0][2].hypot(error[1][2]), error[1][0].atan2(error[0][0]).abs())
    }

    #[test]
    fn steps_are_counted_in_poses_metres_and_seconds() {
        let pair = |k: u32| {
            let reference = Pose { x_m: 0.25 * f64::from(k), ..Pose::default() };
            Pair { time_s: 0.5 * f64::from(k), estimate: Pose { x_m: 0.275 * f64::from(k), ..reference }, reference }
        };
        let pairs: Vec<Pair> = (0..13).map(pair).collect();
        for (step, count, error_m) in [
            (Step::Poses(1), 12, 0.025),
            (Step::Poses(5), 2, 0.125),
            (Step::Metres(1.0), 3, 0.1),
            (Step::Metres(0.9), 3, 0.1),
            (Step::Seconds(1.0), 6, 0.05),
        ] {
            let errors = relative(&pairs, step).expect("steps");
            assert_eq!(errors.translation_m.count, count, "{step:?}");
            let near = |value: f64| (value - error_m).abs() < 1e-12;
            assert!(near(errors.translation_m.mean) && near(errors.translation_m.max), "{step:?}: {errors:?}");
        }
        for (step, message) in [
            (Step::Poses(0), "step, poses: 0 must be above 0"),
            (Step::Metres(f64::NAN), "step, m: NaN must be above 0"),
            (Step::Seconds(-1.0), "step, s: -1 must be above 0"),
            (Step::Metres(3.5), "no step of 3.5 m within 13 poses: give a shorter one"),
            (Step::Poses(13), "no step of 13 poses within 13 poses"),
        ] {
            let found = relative(&pairs, step).expect_err(message).to_string();
            assert!(found.contains(message), "{found}");
        }
    }

    proptest! {
        #[test]
        fn matrices_give_the_same_and_frames_do_not_matter(pairs in walk(2..20), count in 1usize..4, one in pose(), other in pose()) {
            prop_assume!(count < pairs.len());
            let found = relative(&pairs, Step::Poses(count)).expect("steps");
            let ends: Vec<usize> = (0..pairs.len()).step_by(count).collect();
            let expected: Vec<(f64, f64)> = ends.windows(2).map(|ends| by_matrices(&pairs, [ends[0], ends[1]])).collect();
            let mean = |part: fn(&(f64, f64)) -> f64| expected.iter().map(part).sum::<f64>() / expected.len() as f64;
            prop_assert!((found.translation_m.mean - mean(|error| error.0)).abs() < 1e-9);
            prop_assert!((found.rotation_rad.mean - mean(|error| error.1)).abs() < 1e-7);
            let moved: Vec<Pair> = pairs
                .iter()
                .map(|pair| Pair { estimate: one.moved(pair.estimate), reference: other.moved(pair.reference), ..*pair })
                .collect();
            let moved = relative(&moved, Step::Poses(count)).expect("steps");
            prop_assert!((found.translation_m.rmse - moved.translation_m.rmse).abs() < 1e-7);
            prop_assert!((found.rotation_rad.rmse - moved.rotation_rad.rmse).abs() < 1e-7);
        }
    }
}
