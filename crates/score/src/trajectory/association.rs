//! Which poses of two trajectories belong together.

use super::error::{DIFFERENCE, TrajectoryError, duration};
use super::pose::{Pose, Stamped, in_order, nearest};

/// An estimated pose and the one it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// When the estimate was made, s.
    pub time_s: f64,
    /// The estimate.
    pub estimate: Pose,
    /// The truth.
    pub reference: Pose,
}

/// Pairs of poses nearest in time that are at most `most_s` (s) apart, in order: one for each pose of the trajectory that has fewer (the
/// reference where they have as many), as `evo` has it. Poses without a partner are left out. O(poses log poses).
///
/// # Errors
/// A number that is none; times that do not rise; no pair at all.
pub fn associated(estimate: &[Stamped], reference: &[Stamped], most_s: f64) -> Result<Vec<Pair>, TrajectoryError> {
    duration(DIFFERENCE, most_s)?;
    in_order("the estimate's", estimate)?;
    in_order("the reference's", reference)?;
    let by_reference = reference.len() <= estimate.len();
    let [few, many] = if by_reference { [reference, estimate] } else { [estimate, reference] };
    let pair = |one: &Stamped| {
        let other = nearest(many, one.time_s).filter(|other| (other.time_s - one.time_s).abs() <= most_s)?;
        let [estimated, truth] = if by_reference { [other, *one] } else { [*one, other] };
        Some(Pair { time_s: estimated.time_s, estimate: estimated.pose, reference: truth.pose })
    };
    let pairs: Vec<Pair> = few.iter().filter_map(pair).collect();
    if let ([first, .., last] | [first @ last], [begin, .., end] | [begin @ end], true) =
        (estimate, reference, pairs.is_empty())
    {
        return Err(TrajectoryError::Apart {
            estimated: estimate.len(),
            given: reference.len(),
            most_s,
            estimate_s: [first.time_s, last.time_s],
            reference_s: [begin.time_s, end.time_s],
        });
    }
    if pairs.is_empty() {
        return Err(TrajectoryError::TooFew { found: 0, what: "poses in one of the trajectories", needed: 1 });
    }
    Ok(pairs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(times: &[f64]) -> Vec<Stamped> {
        let stamped = |&time_s| Stamped { time_s, pose: Pose { x_m: time_s, ..Pose::default() } };
        times.iter().map(stamped).collect()
    }

    /// Times of the pairs: the estimate's, the reference's.
    fn times(pairs: &[Pair]) -> Vec<(f64, f64)> {
        pairs.iter().map(|pair| (pair.estimate.x_m, pair.reference.x_m)).collect()
    }

    #[test]
    fn the_nearest_within_the_bound_and_the_earlier_of_two() {
        let [few, many] = [at(&[0.0, 1.0, 2.0, 9.0]), at(&[-0.25, 0.5, 1.5, 1.75, 2.0])];
        let expected = [(0.0, -0.25), (1.0, 0.5), (2.0, 2.0)];
        assert_eq!(times(&associated(&few, &many, 0.5).expect("pairs")), expected);
        let turned = expected.map(|(a, b)| (b, a));
        assert_eq!(times(&associated(&many, &few, 0.5).expect("pairs")), turned);
    }

    #[test]
    fn what_is_wrong_is_said() {
        let fine = at(&[0.0, 1.0]);
        for (estimate, most_s, message) in [
            (at(&[5.0, 7.0]), 0.5, "none of 2 estimated poses (5.000 to 7.000 s) lies within 0.5 s of one of 2"),
            (at(&[]), 0.5, "0 poses in one of the trajectories: 1 are needed"),
            (at(&[0.0, 0.0]), 0.5, "the estimate's pose 1: time 0 s does not come after 0 s"),
            (at(&[0.0, f64::NAN]), 0.5, "pose 1, time, s: NaN must be a number"),
            (fine.clone(), -1.0, "largest difference in time, s: -1 must be 0 or more"),
            (fine.clone(), f64::NAN, "largest difference in time, s: NaN must be 0 or more"),
        ] {
            let found = associated(&estimate, &fine, most_s).expect_err(message).to_string();
            assert!(found.contains(message), "{found}");
        }
    }

    proptest! {
        #[test]
        fn the_dense_reference_finds_the_same(
            estimate in proptest::collection::btree_set(0u8..60, 1..20),
            reference in proptest::collection::btree_set(0u8..60, 1..20),
            most_s in 0u8..9,
        ) {
            let [estimate, reference] = [estimate, reference].map(|times| times.into_iter().map(f64::from).collect::<Vec<_>>());
            let (few, many) = if reference.len() <= estimate.len() { (&reference, &estimate) } else { (&estimate, &reference) };
            let mut expected = Vec::new();
            for &time in few {
                let best = many.iter().min_by(|a, b| (*a - time).abs().total_cmp(&(*b - time).abs())).expect("some");
                if (best - time).abs() <= f64::from(most_s) {
                    expected.push(if reference.len() <= estimate.len() { (*best, time) } else { (time, *best) });
                }
            }
            let found = associated(&at(&estimate), &at(&reference), most_s.into()).unwrap_or_default();
            prop_assert_eq!(times(&found), expected);
        }
    }
}
