//! Motions between given times, as people or other programs have measured them.

use super::absolute::PoseErrors;
use super::error::{DIFFERENCE, TrajectoryError, duration, number};
use super::pose::{Pose, Stamped, in_order, nearest};
use super::spread::Spread;

/// Relations over more than this are loops, s: what the robot sees again then, no chain of scans has carried along.
pub const LOOP_S: f64 = 30.0;

/// A motion between two times that is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Relation {
    /// From when, s.
    pub from_s: f64,
    /// Until when, s; may be before `from_s`.
    pub to_s: f64,
    /// The pose then, seen from the pose before.
    pub motion: Pose,
}

/// Errors of some relations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelationErrors {
    /// Distances in m and turns in rad.
    pub errors: PoseErrors,
    /// Their squares, m² and rad²: the form of Kümmerle et al. 2009, Eq. 5.
    pub squares: (Spread, Spread),
}

/// Errors of relations, split by how far apart in time they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Related {
    /// Of all; none where no relation has both poses.
    pub all: Option<RelationErrors>,
    /// Of those over more than the split.
    pub loops: Option<RelationErrors>,
    /// Of the others.
    pub others: Option<RelationErrors>,
    /// Relations of which a time has no pose near enough.
    pub left_out: usize,
}

/// The metric of relations (Kümmerle et al. 2009, "On measuring the accuracy of SLAM algorithms", Eq. 5): `⊖ δ* ⊕ δ`, where `δ*` is the
/// relation's motion and `δ` that between the poses nearest to its times, at most `most_s` (s) from them. `split_s` (s, such as
/// [`LOOP_S`]) parts loops from the others. O(relations log poses).
///
/// # Errors
/// A number that is none; times that do not rise; a negative difference or split.
pub fn related(
    estimate: &[Stamped],
    relations: &[Relation],
    most_s: f64,
    split_s: f64,
) -> Result<Related, TrajectoryError> {
    duration(DIFFERENCE, most_s)?;
    duration("split between loops and others, s", split_s)?;
    in_order("the estimate's", estimate)?;
    for (index, relation) in relations.iter().enumerate() {
        number(index, "time of the relation, s", relation.from_s)?;
        number(index, "time of the relation, s", relation.to_s)?;
        relation.motion.checked(index)?;
    }
    let at = |time_s: f64| nearest(estimate, time_s).filter(|found| (found.time_s - time_s).abs() <= most_s);
    let error = |relation: &Relation| {
        let [from, to] = [at(relation.from_s)?.pose, at(relation.to_s)?.pose];
        Some(((relation.to_s - relation.from_s).abs() > split_s, to.seen_from(from).seen_from(relation.motion)))
    };
    let errors: Vec<(bool, Pose)> = relations.iter().filter_map(error).collect();
    let of = |wanted: &[bool]| {
        let motions: Vec<Pose> =
            errors.iter().filter(|(long, _)| wanted.contains(long)).map(|(_, error)| *error).collect();
        let squares =
            |part: fn(Pose) -> f64| Spread::of(&motions.iter().map(|&motion| part(motion).powi(2)).collect::<Vec<_>>());
        let squares = (squares(Pose::distance_m)?, squares(Pose::turn_rad)?);
        Some(RelationErrors { errors: PoseErrors::of(&motions)?, squares })
    };
    let [all, loops, others] = [of(&[true, false]), of(&[true]), of(&[false])];
    Ok(Related { all, loops, others, left_out: relations.len() - errors.len() })
}

#[cfg(test)]
mod tests {
    use super::super::walks::{pose, walk};
    use super::*;
    use proptest::prelude::*;

    fn along(steps: &[f64]) -> Vec<Stamped> {
        let stamped =
            |(k, &x_m): (usize, &f64)| Stamped { time_s: 20.0 * k as f64, pose: Pose { x_m, ..Pose::default() } };
        steps.iter().enumerate().map(stamped).collect()
    }

    fn relation(from_s: f64, to_s: f64, x_m: f64) -> Relation {
        Relation { from_s, to_s, motion: Pose { x_m, ..Pose::default() } }
    }

    #[test]
    fn by_hand() {
        let relations =
            [relation(0.0, 20.0, 1.0), relation(0.05, 39.96, 2.0), relation(20.0, 40.0, 0.5), relation(0.0, 99.0, 0.0)];
        let found = related(&along(&[0.0, 1.5, 3.0]), &relations, 0.1, LOOP_S).expect("fine");
        assert_eq!(found.left_out, 1);
        let [all, loops, others] = [found.all, found.loops, found.others].map(|errors| errors.expect("some"));
        assert_eq!((all.errors.translation_m.count, loops.errors.translation_m.count), (3, 1));
        assert!((loops.errors.translation_m.mean - 1.0).abs() < 1e-12, "3 m where 2 should be");
        assert!((others.errors.translation_m.mean - 0.75).abs() < 1e-12, "0.5 m and 1 m");
        assert!((others.errors.translation_m.deviation - 0.25).abs() < 1e-12);
        assert!((others.squares.0.mean - 0.625).abs() < 1e-12 && (others.squares.0.deviation - 0.375).abs() < 1e-12);
        assert!(all.errors.rotation_rad.max < 1e-12);
        let none = related(&[], &relations, 0.1, LOOP_S).expect("no pose is no error");
        assert_eq!((none.all, none.left_out), (None, 4));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let poses = along(&[0.0, 1.0]);
        for (relations, most_s, split_s, message) in [
            (vec![relation(0.0, f64::NAN, 1.0)], 0.1, 30.0, "pose 0, time of the relation, s: NaN must be a number"),
            (vec![relation(0.0, 1.0, f64::INFINITY)], 0.1, 30.0, "pose 0, x, m: inf must be a number"),
            (vec![], -0.1, 30.0, "largest difference in time, s: -0.1 must be 0 or more"),
            (vec![], 0.1, f64::NAN, "split between loops and others, s: NaN must be 0 or more"),
        ] {
            let found = related(&poses, &relations, most_s, split_s).expect_err(message).to_string();
            assert!(found.contains(message), "{found}");
        }
    }

    proptest! {
        #[test]
        fn a_trajectory_has_no_error_against_its_own_motions_in_any_frame(pairs in walk(2..15), by in pose()) {
            let stamped: Vec<Stamped> = pairs.iter().map(|pair| Stamped { time_s: pair.time_s, pose: pair.estimate }).collect();
            let moved: Vec<Stamped> = stamped.iter().map(|at| Stamped { pose: by.moved(at.pose), ..*at }).collect();
            let mut relations = Vec::new();
            for from in &stamped {
                relations.extend(stamped.iter().map(|to| Relation {
                    from_s: from.time_s,
                    to_s: to.time_s,
                    motion: to.pose.seen_from(from.pose),
                }));
            }
            let all = related(&moved, &relations, 0.0, LOOP_S).expect("fine").all.expect("some");
            prop_assert!(all.errors.translation_m.max < 1e-9 && all.errors.rotation_rad.max < 1e-9, "{all:?}");
        }
    }
}
