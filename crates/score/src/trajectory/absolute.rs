//! How far poses are from where they should be.

use super::association::Pair;
use super::error::TrajectoryError;
use super::pose::Pose;
use super::spread::Spread;

/// Errors of poses or of motions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseErrors {
    /// Distances, m.
    pub translation_m: Spread,
    /// Turns, the shorter way, rad, 0 to pi.
    pub rotation_rad: Spread,
}

impl PoseErrors {
    /// Of the motions from what should be to what is; none of no motions.
    pub(super) fn of(motions: &[Pose]) -> Option<Self> {
        Some(Self {
            translation_m: Spread::of(&motions.iter().map(|motion| motion.distance_m()).collect::<Vec<_>>())?,
            rotation_rad: Spread::of(&motions.iter().map(|motion| motion.turn_rad()).collect::<Vec<_>>())?,
        })
    }
}

/// The absolute trajectory error (ATE): `⊖ reference ⊕ estimate` of each pair (Sturm et al. 2012, Eq. 4), in the frames as they stand;
/// [`aligned`](super::aligned) brings the estimates into the reference's first.
///
/// # Errors
/// No pair; a number that is none.
pub fn absolute(pairs: &[Pair]) -> Result<PoseErrors, TrajectoryError> {
    checked(pairs, 1)?;
    let motions: Vec<Pose> = pairs.iter().map(|pair| pair.estimate.seen_from(pair.reference)).collect();
    PoseErrors::of(&motions).ok_or(TrajectoryError::TooFew { found: 0, what: "paired poses", needed: 1 })
}

/// Refuses fewer pairs, and numbers that are none.
pub(super) fn checked(pairs: &[Pair], needed: usize) -> Result<(), TrajectoryError> {
    if pairs.len() < needed {
        return Err(TrajectoryError::TooFew { found: pairs.len(), what: "paired poses", needed });
    }
    for (index, pair) in pairs.iter().enumerate() {
        pair.estimate.checked(index)?;
        pair.reference.checked(index)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::walks::{pose, walk};
    use super::super::{aligned, alignment};
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn by_hand() {
        let estimate = Pose { x_m: 3.0, y_m: 4.0, theta_rad: PI - 0.1 };
        let reference = Pose { theta_rad: -PI + 0.1, ..Pose::default() };
        let pair = Pair { time_s: 0.0, estimate, reference };
        let errors = absolute(&[pair, Pair { estimate: reference, ..pair }]).expect("two");
        assert!((errors.translation_m.max - 5.0).abs() < 1e-12 && (errors.translation_m.mean - 2.5).abs() < 1e-12);
        assert!((errors.rotation_rad.max - 0.2).abs() < 1e-12, "{errors:?}");
        assert!(absolute(&[]).is_err());
        let broken = Pair { estimate: Pose { x_m: f64::NAN, ..estimate }, ..pair };
        assert!(absolute(&[pair, broken]).expect_err("NaN").to_string().contains("pose 1, x, m: NaN"));
    }

    proptest! {
        #[test]
        fn a_rigid_motion_of_both_changes_nothing_and_of_one_nothing_after_alignment(pairs in walk(3..20), by in pose()) {
            prop_assume!(alignment(&pairs).is_ok());
            let both: Vec<Pair> = pairs
                .iter()
                .map(|pair| Pair { estimate: by.moved(pair.estimate), reference: by.moved(pair.reference), ..*pair })
                .collect();
            let one: Vec<Pair> = pairs.iter().map(|pair| Pair { estimate: by.moved(pair.estimate), ..*pair }).collect();
            for (a, b) in [
                (absolute(&pairs), absolute(&both)),
                (absolute(&aligned(&pairs).expect("moves")), absolute(&aligned(&one).expect("moves"))),
            ] {
                let [a, b] = [a.expect("pairs"), b.expect("pairs")];
                prop_assert!((a.translation_m.rmse - b.translation_m.rmse).abs() < 1e-7, "{a:?} {b:?}");
                // Headings half a turn off may go either way about.
                prop_assert!((a.rotation_rad.max - b.rotation_rad.max).abs() < 1e-7, "{a:?} {b:?}");
            }
        }
    }
}
