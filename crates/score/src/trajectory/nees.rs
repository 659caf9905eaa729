//! Whether stated covariances fit the errors.

use std::f64::consts::TAU;

use super::chi_squared;
use super::error::{TrajectoryError, number};
use super::pose::Pose;

/// Dimensions of a pose.
const DIMENSIONS: f64 = 3.0;

/// A pose as it is believed, and as it should be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Believed {
    /// The estimate.
    pub estimate: Pose,
    /// Its covariance: x (m), y (m) and heading (rad), in the frame of the poses.
    pub covariance: [[f64; 3]; 3],
    /// The truth.
    pub reference: Pose,
}

/// The normalised estimation error squared of some poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nees {
    /// Number of poses.
    pub count: usize,
    /// Mean; 3 of poses whose covariances are right, more where they are too small.
    pub mean: f64,
    /// Where the mean of as many independent poses lies with probability 0.95 if the covariances are right. Poses of one drive are not independent: take one
    /// from each run (Bar-Shalom et al. 2001, Section 5.4.2), or read the interval as a lower bound of its width.
    pub interval: [f64; 2],
    /// Share of the poses within the ellipsoid of probability 0.95.
    pub within: f64,
}

/// `eᵀ P⁻¹ e` of each pose, where `e` is estimate less reference, the heading by the shorter turn (Bar-Shalom et al. 2001, Eq. 5.4.2-1).
///
/// # Errors
/// No pose; a number that is none; a matrix that is not symmetric (to 1e-9 of its diagonal) and positive definite.
pub fn nees(poses: &[Believed]) -> Result<Nees, TrajectoryError> {
    let errors: Vec<f64> =
        poses.iter().enumerate().map(|(index, pose)| error(index, pose)).collect::<Result<_, _>>()?;
    let count = errors.len();
    if count == 0 {
        return Err(TrajectoryError::TooFew { found: 0, what: "poses with covariances", needed: 1 });
    }
    let n = count as f64;
    let bound = chi_squared::quantile(0.95, DIMENSIONS);
    Ok(Nees {
        count,
        mean: errors.iter().sum::<f64>() / n,
        interval: [0.025, 0.975].map(|p| chi_squared::quantile(p, DIMENSIONS * n) / n),
        within: errors.iter().filter(|&&error| error <= bound).count() as f64 / n,
    })
}

fn error(index: usize, pose: &Believed) -> Result<f64, TrajectoryError> {
    pose.estimate.checked(index)?;
    pose.reference.checked(index)?;
    let p = pose.covariance;
    p.iter().flatten().try_for_each(|&value| number(index, "covariance", value))?;
    let refused = TrajectoryError::Covariance { index, covariance: p };
    let turn_rad = libm::remainder(pose.estimate.theta_rad - pose.reference.theta_rad, TAU);
    let e = [pose.estimate.x_m - pose.reference.x_m, pose.estimate.y_m - pose.reference.y_m, turn_rad];
    for (row, column) in [(0, 1), (0, 2), (1, 2)] {
        if (p[row][column] - p[column][row]).abs() > 1e-9 * libm::sqrt((p[row][row] * p[column][column]).abs()) {
            return Err(refused);
        }
    }
    // Cholesky: P = L Lᵀ; then L y = e, and the error is yᵀ y.
    let mut l = [[0.0; 3]; 3];
    let mut squares = 0.0;
    let mut y = [0.0; 3];
    for row in 0..3 {
        for column in 0..=row {
            let rest = p[row][column] - (0..column).map(|k| l[row][k] * l[column][k]).sum::<f64>();
            if row != column {
                l[row][column] = rest / l[column][column];
            } else if rest > 0.0 {
                l[row][row] = libm::sqrt(rest);
            } else {
                return Err(refused);
            }
        }
        y[row] = (e[row] - (0..row).map(|k| l[row][k] * y[k]).sum::<f64>()) / l[row][row];
        squares += y[row] * y[row];
    }
    Ok(squares)
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

    use super::*;
    use proptest::prelude::*;

    const UNIT: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    fn believed(x_m: f64, y_m: f64, theta_rad: f64, covariance: [[f64; 3]; 3]) -> Believed {
        Believed { estimate: Pose { x_m, y_m, theta_rad }, covariance, reference: Pose::default() }
    }

    #[test]
    fn by_hand() {
        let covariance = [[4.0, 0.0, 0.0], [0.0, 0.25, 0.0], [0.0, 0.0, 0.01]];
        let found = nees(&[believed(2.0, 1.0, TAU - 0.1, covariance), believed(0.0, 0.0, 0.0, UNIT)]).expect("two");
        assert!((found.mean - 0.5 * (1.0 + 4.0 + 1.0)).abs() < 1e-9, "{found:?}");
        assert_eq!((found.count, found.within), (2, 1.0));
        let far = nees(&[believed(9.0, 0.0, 0.0, UNIT)]).expect("one");
        assert!((far.mean - 81.0).abs() < 1e-12 && far.within < 0.5, "{far:?}");
    }

    #[test]
    fn what_is_no_covariance_is_refused_by_its_pose() {
        let fine = believed(0.0, 0.0, 0.0, UNIT);
        for (k, value) in [(0, 0.0), (4, -1.0), (8, 0.0), (1, 0.5), (2, f64::NAN)] {
            let mut covariance = UNIT;
            covariance[k / 3][k % 3] = value;
            let message = nees(&[fine, Believed { covariance, ..fine }]).expect_err("no covariance").to_string();
            assert!(message.starts_with("pose 1"), "{message}");
        }
        let full = [[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        assert!(nees(&[believed(0.0, 0.0, 0.0, full)]).is_err(), "singular");
        assert!(nees(&[]).is_err());
    }

    #[test]
    fn right_covariances_have_a_mean_of_three_within_the_interval() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut normal = || (0..12).map(|_| f64::from(rng.next_u32()) / 4_294_967_296.0 - 0.5).sum::<f64>();
        let factor = [[0.3, 0.0, 0.0], [0.1, 0.2, 0.0], [-0.02, 0.01, 0.05]];
        let covariance = [0, 1, 2]
            .map(|row: usize| [0, 1, 2].map(|column: usize| (0..3).map(|k| factor[row][k] * factor[column][k]).sum()));
        let mut pose = || {
            let z = [normal(), normal(), normal()];
            let [x, y, theta] = factor.map(|row: [f64; 3]| row.iter().zip(z).map(|(a, b)| a * b).sum());
            believed(x, y, theta, covariance)
        };
        let mut held = 0;
        for _ in 0..200 {
            let poses: Vec<Believed> = (0..50).map(|_| pose()).collect();
            let found = nees(&poses).expect("covariances");
            held += usize::from((found.interval[0]..=found.interval[1]).contains(&found.mean));
        }
        assert!((180..=198).contains(&held), "{held} of 200 at 0.95");
    }

    proptest! {
        #[test]
        fn the_adjugate_gives_the_same(l in proptest::array::uniform6(0.1..2.0), e in proptest::array::uniform3(-3.0..3.0)) {
            let factor = [[l[0], 0.0, 0.0], [l[1], l[2], 0.0], [l[3], l[4], l[5]]];
            let p = [0, 1, 2].map(|row: usize| [0, 1, 2].map(|column: usize| (0..3).map(|k| factor[row][k] * factor[column][k]).sum::<f64>()));
            let minor = |row: usize, column: usize| {
                let [a, b] = [(row + 1) % 3, (row + 2) % 3];
                let [c, d] = [(column + 1) % 3, (column + 2) % 3];
                p[a][c] * p[b][d] - p[a][d] * p[b][c]
            };
            let determinant: f64 = (0..3).map(|k| p[0][k] * minor(0, k)).sum();
            let expected: f64 = (0..9).map(|k| e[k / 3] * minor(k / 3, k % 3) * e[k % 3]).sum::<f64>() / determinant;
            let found = nees(&[believed(e[0], e[1], e[2], p)]).expect("positive").mean;
            prop_assert!((found - expected).abs() < 1e-6 * (1.0 + expected), "{found} {expected}");
        }
    }
}
