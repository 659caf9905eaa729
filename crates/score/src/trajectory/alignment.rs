//! The rigid motion that brings a trajectory nearest to another.

use super::absolute::checked;
use super::association::Pair;
use super::error::TrajectoryError;
use super::pose::Pose;

/// Below this share of what points so far apart could give, the direction of the alignment is rounding.
const ROUNDING: f64 = 1e-12;

/// The rigid motion `T` for which the squared distances between the positions of `T ⊕ estimate` and of the reference have the least sum
/// (Umeyama 1991, without scale; in the plane its singular value decomposition is the angle of one sum). O(pairs).
///
/// # Errors
/// Fewer than two pairs; a number that is none; a trajectory that stays where it is, which any turn fits as well.
pub fn alignment(pairs: &[Pair]) -> Result<Pose, TrajectoryError> {
    checked(pairs, 2)?;
    let n = pairs.len() as f64;
    let mean = |part: &dyn Fn(&Pair) -> f64| pairs.iter().map(part).sum::<f64>() / n;
    let [ex, ey] = [mean(&|pair| pair.estimate.x_m), mean(&|pair| pair.estimate.y_m)];
    let [rx, ry] = [mean(&|pair| pair.reference.x_m), mean(&|pair| pair.reference.y_m)];
    let [mut dot, mut cross, mut estimate, mut reference] = [0.0; 4];
    for pair in pairs {
        let [a, b] = [pair.estimate.x_m - ex, pair.estimate.y_m - ey];
        let [u, v] = [pair.reference.x_m - rx, pair.reference.y_m - ry];
        dot += a * u + b * v;
        cross += a * v - b * u;
        estimate += a * a + b * b;
        reference += u * u + v * v;
    }
    // By Cauchy and Schwarz, at most the root of the product; means of many equal numbers are rounded.
    let still = |spread: f64, [x, y]: [f64; 2]| spread <= n * 1e-24 * (x * x + y * y);
    let length = libm::hypot(dot, cross);
    let least = ROUNDING * libm::sqrt(estimate * reference);
    if still(estimate, [ex, ey]) || still(reference, [rx, ry]) || length <= least {
        return Err(TrajectoryError::Still);
    }
    let theta_rad = libm::atan2(cross, dot);
    let (sin, cos) = libm::sincos(theta_rad);
    Ok(Pose { x_m: rx - cos * ex + sin * ey, y_m: ry - sin * ex - cos * ey, theta_rad })
}

/// The pairs with their estimates in the reference's frame, by [`alignment`].
///
/// # Errors
/// As [`alignment`].
pub fn aligned(pairs: &[Pair]) -> Result<Vec<Pair>, TrajectoryError> {
    let motion = alignment(pairs)?;
    Ok(pairs.iter().map(|pair| Pair { estimate: motion.moved(pair.estimate), ..*pair }).collect())
}

#[cfg(test)]
mod tests {
    use super::super::absolute;
    use super::super::walks::{pose, walk};
    use super::*;
    use proptest::prelude::*;

    /// Sum of the squared distances under a turn, with the best shift for it.
    fn squares(pairs: &[Pair], theta_rad: f64) -> f64 {
        let turned = |pair: &Pair| Pose { theta_rad, ..Pose::default() }.moved(pair.estimate);
        let n = pairs.len() as f64;
        let off: Vec<[f64; 2]> = pairs
            .iter()
            .map(|pair| [turned(pair).x_m - pair.reference.x_m, turned(pair).y_m - pair.reference.y_m])
            .collect();
        let mean = [0, 1].map(|k| off.iter().map(|by| by[k]).sum::<f64>() / n);
        off.iter().map(|by| (by[0] - mean[0]).powi(2) + (by[1] - mean[1]).powi(2)).sum()
    }

    #[test]
    fn what_stays_where_it_is_cannot_be_turned() {
        let still = Pair { time_s: 0.0, estimate: Pose { x_m: 0.1, ..Pose::default() }, reference: Pose::default() };
        let moves = Pair { reference: Pose { x_m: 4.0, ..Pose::default() }, ..still };
        for pairs in [vec![still; 7], vec![still, moves, moves]] {
            assert_eq!(alignment(&pairs), Err(TrajectoryError::Still));
        }
        let few = alignment(&[still]).expect_err("one").to_string();
        assert_eq!(few, "1 paired poses: 2 are needed");
    }

    proptest! {
        #[test]
        fn a_known_motion_is_found(pairs in walk(3..20), by in pose()) {
            let moved: Vec<Pair> = pairs.iter().map(|pair| Pair { reference: by.moved(pair.estimate), ..*pair }).collect();
            prop_assume!(alignment(&moved).is_ok());
            prop_assert!(absolute(&aligned(&moved).expect("moves")).expect("pairs").translation_m.max < 1e-9);
        }

        #[test]
        fn no_turn_of_a_dense_search_is_better(pairs in walk(2..12)) {
            prop_assume!(alignment(&pairs).is_ok());
            let rmse = absolute(&aligned(&pairs).expect("moves")).expect("pairs").translation_m.rmse;
            let found = rmse * rmse * pairs.len() as f64;
            let best = (0..3600).map(|k| squares(&pairs, f64::from(k) * std::f64::consts::TAU / 3600.0)).fold(f64::INFINITY, f64::min);
            prop_assert!(found <= best * (1.0 + 1e-9) + 1e-9, "{found} {best}");
            // And the search comes as near as its step allows: the sum is quadratic about its minimum.
            let spread = pairs.iter().map(|pair| pair.estimate.distance_m() + pair.reference.distance_m()).fold(0.0, f64::max);
            prop_assert!(best - found <= pairs.len() as f64 * (spread * 0.001).powi(2) + 1e-9, "{found} {best}");
        }
    }
}
