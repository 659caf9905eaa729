//! How far a trajectory is from what is believed.

use score::trajectory::{
    self, LOOP_S, PoseErrors, Relation, Spread, Stamped, Step, TrajectoryError, absolute, aligned, associated, related,
    relative,
};
use sensor::Pose;
use serde_json::json;

use super::options::SlamOptions;
use super::source::Taken;
use crate::failure::Failure;
use crate::output::table::{Table, rounded};

/// Poses and relations are of the same moment up to this, s.
const MOST_S: f64 = 0.1;

/// A step of the relative error, m.
const STEP_M: f64 = 1.0;

/// What a trajectory is scored against.
pub(super) struct References {
    pub(super) truth: Option<Vec<Stamped>>,
    relations: Option<Vec<Relation>>,
}

impl References {
    /// What the options name, or else what the scene knows.
    pub(super) fn of(options: &SlamOptions, known: Option<Vec<Stamped>>) -> Result<Self, Failure> {
        let refused = |error: logs::LogError| Failure::BadInput(error.to_string());
        let truth = match &options.truth {
            Some(path) => {
                let read = logs::Trajectory::open(path).map_err(refused)?;
                Some(read.poses().iter().map(|(time_s, pose)| stamped(*time_s, *pose)).collect())
            }
            None => known,
        };
        let relations = match &options.relations {
            Some(path) => {
                let read = logs::trajectory::relations::open(path).map_err(refused)?;
                let of = |relation: &logs::trajectory::relations::Relation| Relation {
                    from_s: relation.from_s,
                    to_s: relation.to_s,
                    motion: plain(relation.motion),
                };
                Some(read.iter().map(of).collect())
            }
            None => None,
        };
        Ok(Self { truth, relations })
    }
}

/// A pose and its time.
pub(super) fn stamped(time_s: f64, pose: Pose) -> Stamped {
    Stamped { time_s, pose: plain(pose) }
}

/// A pose as scores take it.
pub(in crate::commands) fn plain(pose: Pose) -> trajectory::Pose {
    trajectory::Pose { x_m: pose.x_m, y_m: pose.y_m, theta_rad: pose.theta_rad }
}

/// One number: whose, which, and over what.
struct Row {
    trajectory: &'static str,
    metric: &'static str,
    unit: &'static str,
    spread: Spread,
}

/// Scores of the trajectory that was found, and of the odometry beside it.
pub(super) struct Scores {
    rows: Vec<Row>,
    /// Relations without a pose.
    pub(super) left_out: usize,
}

impl Scores {
    pub(super) fn of(found: &[(f64, Pose)], scans: &[Taken], references: &References) -> Result<Self, Failure> {
        let slam: Vec<Stamped> =
            scans.iter().zip(found).map(|(taken, (_, pose))| stamped(taken.clock_s, *pose)).collect();
        let odometry: Vec<Stamped> = scans.iter().map(|taken| stamped(taken.clock_s, taken.odometry)).collect();
        let mut scores = Self { rows: Vec::new(), left_out: 0 };
        for (name, poses) in [("slam", &slam), ("odometry", &odometry)] {
            scores.add(name, poses, references).map_err(|error| Failure::BadInput(format!("{name}: {error}")))?;
        }
        Ok(scores)
    }

    fn add(&mut self, name: &'static str, poses: &[Stamped], references: &References) -> Result<(), TrajectoryError> {
        if let Some(truth) = &references.truth {
            let pairs = associated(poses, truth, MOST_S)?;
            self.both(name, ["ate", "ate_rotation"], &absolute(&aligned(&pairs)?)?);
            // A way that is shorter than a step has no such error.
            if let Ok(errors) = relative(&pairs, Step::Metres(STEP_M)) {
                self.both(name, ["rpe_1m", "rpe_1m_rotation"], &errors);
            }
        }
        if let Some(relations) = &references.relations {
            let related = related(poses, relations, MOST_S, LOOP_S)?;
            self.left_out = related.left_out;
            for (names, errors) in [
                (["relations", "relations_rotation"], related.all),
                (["relations_loops", "relations_loops_rotation"], related.loops),
                (["relations_others", "relations_others_rotation"], related.others),
            ] {
                if let Some(errors) = errors {
                    self.both(name, names, &errors.errors);
                }
            }
        }
        Ok(())
    }

    fn both(&mut self, trajectory: &'static str, names: [&'static str; 2], errors: &PoseErrors) {
        let turned = errors.rotation_rad;
        let degrees = Spread {
            count: turned.count,
            rmse: turned.rmse.to_degrees(),
            mean: turned.mean.to_degrees(),
            deviation: turned.deviation.to_degrees(),
            median: turned.median.to_degrees(),
            max: turned.max.to_degrees(),
        };
        for (metric, unit, spread) in [(names[0], "m", errors.translation_m), (names[1], "deg", degrees)] {
            self.rows.push(Row { trajectory, metric, unit, spread });
        }
    }

    pub(super) fn table(&self) -> Table {
        Table::of(
            &self.rows,
            &[
                ("trajectory", &|row| json!(row.trajectory)),
                ("metric", &|row| json!(row.metric)),
                ("unit", &|row| json!(row.unit)),
                ("count", &|row| json!(row.spread.count)),
                ("mean", &|row| rounded(row.spread.mean)),
                ("deviation", &|row| rounded(row.spread.deviation)),
                ("rmse", &|row| rounded(row.spread.rmse)),
                ("median", &|row| rounded(row.spread.median)),
                ("max", &|row| rounded(row.spread.max)),
            ],
        )
    }
}
