//! What ways and landmarks are worth, over all runs.

use score::landmarks::{Associated, BelievedLandmark, associations, landmarks};
use score::trajectory::{
    self, Believed, Pair, PoseErrors, Spread, Step, TrajectoryError, absolute, aligned, alignment, nees, relative,
};
use score::{Comparison, FEWEST_PAIRS};
use sensor::{FeatureCamera, Pose};
use serde_json::json;
use slam::features::{Landmark, Meant, PoseBelief};

use super::drives::NAMES;
use super::filter::Filter;
use super::source::Recording;
use super::track::Found;
use crate::failure::Failure;
use crate::output::table::{Table, optional, rounded};
use crate::worlds::bound::{self, Bound};
use crate::worlds::track::plain;

/// A step of the relative error, m.
const STEP_M: f64 = 1.0;

/// A feature that so many right readings are of can be asked for.
const LOOKS: usize = 3;

/// One number of one run.
struct Row {
    filter: &'static str,
    seed: u64,
    metric: &'static str,
    unit: &'static str,
    value: f64,
}

/// Scores of all runs.
#[derive(Default)]
pub(super) struct Scores {
    rows: Vec<Row>,
}

/// What a metric comes to over the runs.
struct Mean {
    filter: &'static str,
    metric: &'static str,
    unit: &'static str,
    runs: usize,
    mean: f64,
    interval: Option<[f64; 2]>,
}

impl Scores {
    fn put(&mut self, filter: &'static str, seed: u64, metric: &'static str, unit: &'static str, value: f64) {
        self.rows.push(Row { filter, seed, metric, unit, value });
    }

    /// The odometry of a run, where the true poses are known.
    pub(super) fn odometry(&mut self, seed: u64, recording: &Recording) -> Result<(), Failure> {
        let odometry: Option<Vec<Pose>> = recording.scans.iter().map(|scan| scan.odometry).collect();
        if let Some(pairs) = odometry.and_then(|way| pairs(recording, &way)) {
            self.way("odometry", seed, &pairs).map_err(refused)?;
        }
        Ok(())
    }

    /// A filter's run.
    pub(super) fn add(
        &mut self,
        filter: Filter,
        seed: u64,
        recording: &Recording,
        found: &Found,
        gate_m: f64,
    ) -> Result<(), Failure> {
        let filter_name = filter.name();
        let pairs = pairs(recording, &found.way);
        if let Some(pairs) = pairs.as_ref().filter(|_| filter != Filter::KnownPoses) {
            self.way(filter_name, seed, pairs).map_err(refused)?;
            self.belief(filter_name, seed, &found.beliefs, pairs);
        }
        self.put(filter_name, seed, "landmarks", "", found.landmarks.len() as f64);
        // As the way is brought onto the true one, so are the landmarks; a robot that stands is where it began.
        let motion = pairs.and_then(|pairs| alignment(&pairs).ok()).filter(|_| filter != Filter::KnownPoses);
        let motion = motion.unwrap_or_default();
        self.landmarks(filter_name, seed, recording, (found, motion), gate_m).map_err(refused)?;
        if let Some(yard) = &recording.yard {
            let landmarks_m: Vec<[f64; 2]> =
                found.landmarks.iter().map(|landmark| placed(landmark, &recording.camera, motion).at_m).collect();
            let moved = found.way.iter().map(|pose| motion.moved(plain(*pose)));
            let poses: Vec<Pose> =
                moved.map(|trajectory::Pose { x_m, y_m, theta_rad }| Pose { x_m, y_m, theta_rad }).collect();
            for (names, metrics) in NAMES.iter().zip(yard.metrics(&landmarks_m, &poses)?) {
                for (name, value) in names.iter().zip(metrics).filter_map(|(name, metric)| Some((*name, metric.value?)))
                {
                    self.put(filter_name, seed, name, "", value);
                }
            }
        }
        self.associations(filter_name, seed, recording, found);
        Ok(())
    }

    /// Errors of a way; those of one that never moves are as it stands.
    fn way(&mut self, filter: &'static str, seed: u64, pairs: &[Pair]) -> Result<(), TrajectoryError> {
        let aligned = aligned(pairs).unwrap_or_else(|_| pairs.to_vec());
        let mut both = |names: [&'static str; 2], errors: PoseErrors| {
            self.put(filter, seed, names[0], "m", errors.translation_m.rmse);
            self.put(filter, seed, names[1], "deg", errors.rotation_rad.rmse.to_degrees());
        };
        both(["ate", "ate_rotation"], absolute(&aligned)?);
        // A way that is shorter than a step has no such error.
        if let Ok(errors) = relative(pairs, Step::Metres(STEP_M)) {
            both(["rpe_1m", "rpe_1m_rotation"], errors);
        }
        Ok(())
    }

    /// Whether the particles are where the robot is. The median, since particles that all come from one lie so near to each other that a mean would
    /// be that of a few scans.
    fn belief(&mut self, filter: &'static str, seed: u64, beliefs: &[PoseBelief], pairs: &[Pair]) {
        let believed = believed(beliefs, pairs);
        let each = |one: &Believed| nees(std::slice::from_ref(one)).map(|nees| nees.mean);
        let squares: Result<Vec<f64>, _> = believed.iter().map(each).collect();
        let spread = squares.ok().and_then(|squares| Spread::of(&squares));
        if let (Some(spread), Ok(all)) = (spread, nees(&believed)) {
            self.put(filter, seed, "nees_median", "", spread.median);
            self.put(filter, seed, "within_95", "", all.within);
        }
    }

    fn landmarks(
        &mut self,
        filter: &'static str,
        seed: u64,
        recording: &Recording,
        (found, motion): (&Found, trajectory::Pose),
        gate_m: f64,
    ) -> Result<(), TrajectoryError> {
        let Some(features_m) = &recording.features_m else { return Ok(()) };
        let mut looks = vec![0; features_m.len()];
        let known = recording.known.iter().flatten().flatten();
        known.filter(|known| known.matched).for_each(|known| looks[known.feature as usize] += 1);
        // A feature that was seen at all is no phantom.
        let seen: Vec<usize> = (0..looks.len()).filter(|feature| looks[*feature] > 0).collect();
        let truth_m: Vec<[f64; 2]> = seen.iter().map(|feature| features_m[*feature]).collect();
        let moved: Vec<BelievedLandmark> =
            found.landmarks.iter().map(|landmark| placed(landmark, &recording.camera, motion)).collect();
        let scores = landmarks(&moved, &truth_m, gate_m)?;
        let mut is_found = vec![false; seen.len()];
        scores.assigned.iter().flatten().for_each(|feature| is_found[*feature] = true);
        let missed = seen.iter().zip(is_found).filter(|(feature, found)| looks[**feature] >= LOOKS && !found).count();
        let asked = looks.iter().filter(|looks| **looks >= LOOKS).count();
        if let Some(errors) = scores.error_m {
            self.put(filter, seed, "landmark_error", "m", errors.rmse);
        }
        if let Some(within) = scores.within {
            self.put(filter, seed, "landmarks_within_95", "", within);
        }
        self.put(filter, seed, "false_landmarks", "", scores.false_ones as f64);
        self.put(filter, seed, "missed_landmarks", "", missed as f64);
        self.put(filter, seed, "features_seen", "", asked as f64);
        Ok(())
    }

    fn associations(&mut self, filter: &'static str, seed: u64, recording: &Recording, found: &Found) {
        let mut all = Vec::new();
        for (known, meant) in recording.known.iter().zip(&found.meant) {
            for (known, meant) in known.iter().zip(meant) {
                let Some(known) = known else { continue };
                let (landmark, is_first) = match meant {
                    Meant::Landmark(number) => (Some(*number), false),
                    Meant::New(number) => (Some(*number), true),
                    Meant::Nothing => (None, false),
                };
                all.push(Associated { landmark, is_first, feature: known.feature, matched: known.matched });
            }
        }
        let counted = associations(&all);
        if counted.given > 0 {
            let share = 1e3 * counted.wrong as f64 / counted.given as f64;
            self.put(filter, seed, "wrong_associations", "per 1,000", share);
        }
        if counted.failed > 0 {
            let share = 1e3 * counted.failed_given as f64 / counted.failed as f64;
            self.put(filter, seed, "failed_matches_taken", "per 1,000", share);
        }
    }

    /// Whether all bounds on a filter hold.
    ///
    /// # Errors
    /// A bound on a metric that there is not, or that does not hold.
    pub(super) fn hold(&self, filter: Filter, bounds: &[Bound]) -> Result<(), Failure> {
        let own = |metric: &str| {
            let rows: Vec<&Row> =
                self.rows.iter().filter(|row| row.filter == filter.name() && row.metric == metric).collect();
            let unit = rows.first()?.unit;
            Some((rows.iter().map(|row| row.value).sum::<f64>() / rows.len() as f64, unit))
        };
        let needed = |metric: &str| match metric {
            _ if NAMES.as_flattened().contains(&metric) => "--drives, and one that can be driven",
            "ate" | "ate_rotation" | "rpe_1m" | "rpe_1m_rotation" | "nees_median" | "within_95" => {
                "true poses, and a filter that finds the way"
            }
            _ => "a scene, or a table that says which feature each reading is of",
        };
        bound::hold(bounds, own, needed)
    }

    /// Every number of every run.
    pub(super) fn runs(&self) -> Table {
        Table::of(
            &self.rows,
            &[
                ("filter", &|row| json!(row.filter)),
                ("seed", &|row| json!(row.seed)),
                ("metric", &|row| json!(row.metric)),
                ("value", &|row| rounded(row.value)),
                ("unit", &|row| json!(row.unit)),
            ],
        )
    }

    /// Means over the runs, with an interval of 95 %.
    pub(super) fn table(&self, filters: &[Filter]) -> Table {
        Table::of(
            &self.means(filters),
            &[
                ("filter", &|row| json!(row.filter)),
                ("metric", &|row| json!(row.metric)),
                ("unit", &|row| json!(row.unit)),
                ("runs", &|row| json!(row.runs)),
                ("mean", &|row| rounded(row.mean)),
                ("low", &|row| optional(row.interval.map(|ends| ends[0]))),
                ("high", &|row| optional(row.interval.map(|ends| ends[1]))),
            ],
        )
    }

    fn means(&self, filters: &[Filter]) -> Vec<Mean> {
        let names = filters.iter().map(|filter| filter.name()).chain(["odometry"]);
        let mut means: Vec<Mean> = Vec::new();
        for filter in names {
            let own: Vec<&Row> = self.rows.iter().filter(|row| row.filter == filter).collect();
            for row in &own {
                if means.iter().any(|mean| mean.filter == filter && mean.metric == row.metric) {
                    continue;
                }
                let values: Vec<f64> = own.iter().filter(|other| other.metric == row.metric).map(|o| o.value).collect();
                means.push(Mean {
                    filter,
                    metric: row.metric,
                    unit: row.unit,
                    runs: values.len(),
                    mean: values.iter().sum::<f64>() / values.len() as f64,
                    interval: interval(&values, &vec![0.0; values.len()]).map(|(_, ends)| ends),
                });
            }
        }
        means
    }

    /// By how much the ATE of the first filter differs from that of each other, on the same runs: its name, the mean of the differences, and their
    /// interval.
    pub(super) fn differences(&self, filters: &[Filter]) -> Vec<(&'static str, f64, [f64; 2])> {
        let ates = |filter: Filter| -> Vec<f64> {
            self.rows
                .iter()
                .filter(|row| row.filter == filter.name() && row.metric == "ate")
                .map(|row| row.value)
                .collect()
        };
        let Some((first, others)) = filters.split_first() else { return Vec::new() };
        let own = ates(*first);
        let of = |other: &Filter| interval(&own, &ates(*other)).map(|(mean, ends)| (other.name(), mean, ends));
        others.iter().filter_map(of).collect()
    }
}

/// Mean of paired differences, and where it lies with 95 %; none of too few.
fn interval(ours: &[f64], theirs: &[f64]) -> Option<(f64, [f64; 2])> {
    if ours.len() < FEWEST_PAIRS {
        return None;
    }
    let comparison = Comparison::of(ours, theirs).ok()?;
    Some((comparison.mean_difference, [comparison.interval.low, comparison.interval.high]))
}

fn refused(error: TrajectoryError) -> Failure {
    Failure::BadInput(error.to_string())
}

/// Poses beside the true ones; none where these are not all known.
fn pairs(recording: &Recording, way: &[Pose]) -> Option<Vec<Pair>> {
    let pair = |(scan, pose): (&sensor::FeatureScan, &Pose)| {
        let (time_s, estimate, reference) = (scan.time_s, plain(*pose), plain(scan.pose?));
        Some(Pair { time_s, estimate, reference })
    };
    recording.scans.iter().zip(way).map(pair).collect()
}

/// Where the particles were after each scan, beside where the robot was; not where they all were at one place.
fn believed(beliefs: &[PoseBelief], pairs: &[Pair]) -> Vec<Believed> {
    let all = beliefs.iter().zip(pairs).map(|(belief, pair)| Believed {
        estimate: plain(belief.mean),
        covariance: belief.covariance,
        reference: pair.reference,
    });
    all.filter(|believed| nees(std::slice::from_ref(believed)).is_ok()).collect()
}

/// A landmark after a motion.
pub(super) fn placed(landmark: &Landmark, camera: &FeatureCamera, motion: trajectory::Pose) -> BelievedLandmark {
    let (at, p) = landmark.place(camera);
    let moved = motion.moved(trajectory::Pose { x_m: at[0], y_m: at[1], theta_rad: 0.0 });
    let (sin, cos) = libm::sincos(motion.theta_rad);
    let turn = [[cos, -sin], [sin, cos]];
    let entry = |row: usize, column: usize| -> f64 {
        (0..4).map(|k| turn[row][k / 2] * p[k / 2][k % 2] * turn[column][k % 2]).sum()
    };
    // Once for both of its sides, so that rounding leaves it symmetric.
    let mixed = entry(0, 1);
    BelievedLandmark { at_m: [moved.x_m, moved.y_m], covariance: [[entry(0, 0), mixed], [mixed, entry(1, 1)]] }
}
