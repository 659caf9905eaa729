//! How far a trajectory is from what is believed.

use score::trajectory::{
    LOOP_S, PoseErrors, Relation, Spread, Stamped, Step, TrajectoryError, absolute, aligned, associated, related,
    relative,
};
use sensor::Pose;
use serde_json::json;
use slam::Moments;

use super::options::SlamOptions;
use super::source::Taken;
use crate::failure::Failure;
use crate::output::table::{self, Table, rounded};
use crate::page::cloud::Moment;
use crate::worlds::bound::{self, Bound};
use crate::worlds::track::{consistency, plain, stamped};

/// Poses and relations are of the same moment up to this, s.
pub(super) const MOST_S: f64 = 0.1;

/// A step of the relative error, m.
const STEP_M: f64 = 1.0;

/// What a trajectory is scored against.
pub(super) struct References {
    pub(super) truth: Option<Vec<Stamped>>,
    /// Whether the truth is in the frame of the odometry's first pose, as that of a scene is.
    same_frame: bool,
    relations: Option<Vec<Relation>>,
}

impl References {
    /// What the options name, or else what the scene knows.
    pub(super) fn of(options: &SlamOptions, known: Option<Vec<Stamped>>) -> Result<Self, Failure> {
        let refused = |error: logs::LogError| Failure::BadInput(error.to_string());
        let same_frame = options.truth.is_none() && known.is_some();
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
        Ok(Self { truth, same_frame, relations })
    }
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
    pub(super) fn of(
        found: &[(f64, Pose)],
        scans: &[Taken],
        moments: &[Moment],
        references: &References,
    ) -> Result<Self, Failure> {
        let slam: Vec<Stamped> =
            scans.iter().zip(found).map(|(taken, (_, pose))| stamped(taken.clock_s, *pose)).collect();
        let odometry: Vec<Stamped> = scans.iter().map(|taken| stamped(taken.clock_s, taken.odometry)).collect();
        let mut scores = Self { rows: Vec::new(), left_out: 0 };
        for (name, poses) in [("slam", &slam), ("odometry", &odometry)] {
            scores.add(name, poses, references).map_err(|error| Failure::BadInput(format!("{name}: {error}")))?;
        }
        if let Some(truth) = references.truth.as_ref().filter(|_| references.same_frame) {
            scores.consistency(moments, truth);
        }
        Ok(scores)
    }

    /// Whether the particles are where the robot is, wherever they spread in all of x, y and heading.
    fn consistency(&mut self, moments: &[Moment], truth: &[Stamped]) {
        let nees = |moment: &Moment| {
            let at = truth.partition_point(|stamped| stamped.time_s < moment.time_s);
            let score::trajectory::Pose { x_m, y_m, theta_rad } = truth.get(at)?.pose;
            consistency(&Moments::of(moment.particles.iter().copied())?, Pose { x_m, y_m, theta_rad })
        };
        let all: Vec<f64> = moments.iter().filter_map(nees).collect();
        self.rows.extend(Spread::of(&all).map(|spread| Row { trajectory: "slam", metric: "nees", unit: "", spread }));
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

    /// Whether all bounds hold, as far as they can be judged.
    ///
    /// # Errors
    /// A bound on a metric that there is not, or that does not hold.
    pub(super) fn hold(&self, bounds: &[Bound]) -> Result<(), Failure> {
        let own = |metric: &str| self.rows.iter().find(|row| row.trajectory == "slam" && row.metric == metric);
        let needed = |metric: &str| match metric {
            _ if metric.starts_with("relations") => "--relations, with some of its kind",
            "nees" => "a scene, and particles that spread",
            _ => "--truth, or a scene",
        };
        bound::hold(bounds, |metric| own(metric).map(|row| (row.spread.mean, row.unit)), needed)
    }

    /// For the terminal: what fits 80 columns, in four digits.
    pub(super) fn text(&self) -> String {
        let digits = |value: f64| match value {
            _ if value < 10.0 => format!("{value:.3}"),
            _ if value < 1e5 => format!("{value:.2}"),
            _ => format!("{value:.1e}"),
        };
        let row = |row: &Row| {
            let Spread { count, mean, rmse, max, .. } = row.spread;
            let names =
                [row.trajectory.to_owned(), row.metric.replace('_', " "), row.unit.to_owned(), count.to_string()];
            names.into_iter().chain([mean, rmse, max].map(digits)).collect::<Vec<_>>()
        };
        let rows: Vec<Vec<String>> = self.rows.iter().map(row).collect();
        table::aligned(&["trajectory", "metric", "unit", "count", "mean", "rmse", "max"], &rows)
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
