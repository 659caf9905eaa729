//! Landmarks against the truth: how far they are off, which are false, which are missed, and whether their covariances fit.

mod assignment;
mod associations;

pub use associations::{Associated, Associations, associations};

use crate::trajectory::{Spread, TrajectoryError, chi_squared};

/// A landmark as it is believed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BelievedLandmark {
    /// Where, m.
    pub at_m: [f64; 2],
    /// Covariance of that, m².
    pub covariance: [[f64; 2]; 2],
}

/// How landmarks compare with the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkScores {
    /// Distances of the assigned landmarks to their features, m; none where nothing is assigned.
    pub error_m: Option<Spread>,
    /// Landmarks without a feature within the gate: phantoms, or the second of one feature.
    pub false_ones: usize,
    /// Features without a landmark within the gate.
    pub missed: usize,
    /// Mean of `eᵀ P⁻¹ e` of the assigned ones; 2 of landmarks whose covariances are right, more where they are too small.
    pub nees: Option<f64>,
    /// Share of the assigned ones within the ellipse of probability 0.95.
    pub within: Option<f64>,
    /// For each landmark the feature that it is assigned to.
    pub assigned: Vec<Option<usize>>,
}

/// Squares of numbers up to this stay finite.
const FARTHEST: f64 = 1e12;

/// Dimensions of a place.
const DIMENSIONS: f64 = 2.0;

/// Assigns landmarks to features within a distance of `gate_m`, each to one at most: as many as can be, and of all such assignments the
/// one whose squared distances have the least sum. O(landmarks x pairs within the gate), times landmarks at worst.
///
/// # Errors
/// A number that is none; a covariance that is not symmetric (to 1e-9 of its diagonal) and positive definite.
pub fn landmarks(
    believed: &[BelievedLandmark],
    truth_m: &[[f64; 2]],
    gate_m: f64,
) -> Result<LandmarkScores, TrajectoryError> {
    believed.iter().enumerate().try_for_each(|(k, one)| checked(k, one))?;
    let distance = |landmark: usize, feature: usize| {
        let [a, b] = [believed[landmark].at_m, truth_m[feature]];
        libm::hypot(a[0] - b[0], a[1] - b[1])
    };
    let near = |landmark: usize| {
        let features = (0..truth_m.len()).map(|feature| (feature, distance(landmark, feature)));
        features.filter(|(_, off)| *off <= gate_m).map(|(feature, off)| (feature, off * off)).collect()
    };
    let costs: Vec<Vec<(usize, f64)>> = (0..believed.len()).map(near).collect();
    let assigned = assignment::least(&costs, truth_m.len());
    let pairs: Vec<(usize, usize)> = assigned.iter().enumerate().filter_map(|(k, to)| to.map(|to| (k, to))).collect();
    let errors: Vec<f64> = pairs.iter().map(|(landmark, feature)| distance(*landmark, *feature)).collect();
    let normalised: Vec<f64> =
        pairs.iter().map(|(landmark, feature)| square(&believed[*landmark], truth_m[*feature])).collect();
    let bound = chi_squared::quantile(0.95, DIMENSIONS);
    let n = pairs.len() as f64;
    let some = |value: f64| (!pairs.is_empty()).then_some(value);
    Ok(LandmarkScores {
        error_m: Spread::of(&errors),
        false_ones: believed.len() - pairs.len(),
        missed: truth_m.len() - pairs.len(),
        nees: some(normalised.iter().sum::<f64>() / n),
        within: some(normalised.iter().filter(|value| **value <= bound).count() as f64 / n),
        assigned,
    })
}

/// Refuses what is no place with a covariance.
fn checked(index: usize, believed: &BelievedLandmark) -> Result<(), TrajectoryError> {
    let p = believed.covariance;
    let named = [("x, m", believed.at_m[0]), ("y, m", believed.at_m[1])];
    let named = named.into_iter().chain(p.iter().flatten().map(|value| ("covariance", *value)));
    for (name, value) in named {
        if value.is_nan() || value.abs() > FARTHEST {
            return Err(TrajectoryError::Landmark { index, name, value });
        }
    }
    let symmetric = (p[0][1] - p[1][0]).abs() <= 1e-9 * libm::sqrt((p[0][0] * p[1][1]).abs());
    if symmetric && p[0][0] > 0.0 && p[0][0] * p[1][1] - p[0][1] * p[1][0] > 0.0 {
        return Ok(());
    }
    Err(TrajectoryError::LandmarkCovariance { index, covariance: p })
}

/// `eᵀ P⁻¹ e`.
fn square(believed: &BelievedLandmark, truth_m: [f64; 2]) -> f64 {
    let e = [believed.at_m[0] - truth_m[0], believed.at_m[1] - truth_m[1]];
    let p = believed.covariance;
    let determinant = p[0][0] * p[1][1] - p[0][1] * p[1][0];
    (p[1][1] * e[0] * e[0] - (p[0][1] + p[1][0]) * e[0] * e[1] + p[0][0] * e[1] * e[1]) / determinant
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn at(x: f64, y: f64) -> BelievedLandmark {
        BelievedLandmark { at_m: [x, y], covariance: [[0.04, 0.01], [0.01, 0.09]] }
    }

    #[test]
    fn by_hand() {
        let truth = [[0.0, 0.0], [5.0, 0.0], [9.0, 9.0]];
        // The second lies between two features, of which the first has another; the last is a phantom.
        let scores = landmarks(&[at(0.1, 0.0), at(0.3, 0.0), at(5.0, 0.3), at(3.0, 7.0)], &truth, 0.5).expect("fine");
        assert_eq!(scores.assigned, [Some(0), None, Some(1), None]);
        assert_eq!((scores.false_ones, scores.missed), (2, 1));
        let spread = scores.error_m.expect("two");
        assert!((spread.mean - 0.2).abs() < 1e-12 && spread.count == 2);
        // With P⁻¹ = [[0.09, -0.01], [-0.01, 0.04]] / 0.0035.
        let expected = 0.5 * (0.09 * 0.01 + 0.04 * 0.09) / 0.0035;
        assert!((scores.nees.expect("two") - expected).abs() < 1e-12);
        assert_eq!(scores.within, Some(1.0));
        let none = landmarks(&[], &truth, 0.5).expect("none");
        assert_eq!((none.error_m, none.missed, none.nees), (None, 3, None));
    }

    #[test]
    fn as_many_as_can_be_are_assigned() {
        // The nearest pair first would leave the second landmark without one.
        let scores = landmarks(&[at(0.0, 0.0), at(0.4, 0.0)], &[[0.3, 0.0], [-0.4, 0.0]], 0.5).expect("fine");
        assert_eq!(scores.assigned, [Some(1), Some(0)]);
    }

    #[test]
    fn what_is_no_landmark_is_refused_by_its_number() {
        for (broken, message) in [
            (BelievedLandmark { at_m: [f64::NAN, 0.0], ..at(0.0, 0.0) }, "landmark 1, x, m: NaN must be"),
            (BelievedLandmark { covariance: [[1.0, 2.0], [2.0, 1.0]], ..at(0.0, 0.0) }, "landmark 1: its covariance"),
            (BelievedLandmark { covariance: [[1.0, 0.5], [0.2, 1.0]], ..at(0.0, 0.0) }, "landmark 1: its covariance"),
        ] {
            let found = landmarks(&[at(0.0, 0.0), broken], &[], 1.0).expect_err("refused").to_string();
            assert!(found.starts_with(message), "{found}");
        }
    }

    proptest! {
        /// Every assignment there is, tried.
        #[test]
        fn no_assignment_is_better(
            believed in prop::collection::vec(prop::array::uniform2(0.0f64..3.0), 0..6), truth in prop::collection::vec(prop::array::uniform2(0.0f64..3.0), 0..6),
        ) {
            const GATE: f64 = 1.2;
            let all: Vec<_> = believed.iter().map(|[x, y]| at(*x, *y)).collect();
            let found = landmarks(&all, &truth, GATE).expect("fine");
            let cost = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
            fn best(believed: &[[f64; 2]], truth: &[[f64; 2]], used: u32, cost: &dyn Fn([f64; 2], [f64; 2]) -> f64) -> (usize, f64) {
                let Some((first, rest)) = believed.split_first() else { return (0, 0.0) };
                let mut most = best(rest, truth, used, cost);
                for (k, feature) in truth.iter().enumerate() {
                    let own = cost(*first, *feature);
                    if used >> k & 1 == 1 || own > GATE * GATE { continue }
                    let (count, sum) = best(rest, truth, used | 1 << k, cost);
                    if (count + 1, -(sum + own)) > (most.0, -most.1) { most = (count + 1, sum + own) }
                }
                most
            }
            let pairs: Vec<_> = found.assigned.iter().enumerate().filter_map(|(k, to)| to.map(|to| (k, to))).collect();
            let sum: f64 = pairs.iter().map(|(k, to)| cost(believed[*k], truth[*to])).sum();
            let (count, least) = best(&believed, &truth, 0, &cost);
            prop_assert_eq!(pairs.len(), count);
            prop_assert!((sum - least).abs() < 1e-9, "{} {}", sum, least);
            prop_assert_eq!((found.false_ones, found.missed), (believed.len() - count, truth.len() - count));
        }
    }
}
