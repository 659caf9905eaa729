//! The landmarks of one way, and what a scan makes of them.

use nalgebra::Matrix2;
use sensor::{FeatureCamera, FeatureReading, Pose};

use super::association::{Candidate, likeliest};
use super::landmark::{Landmark, gaussian, vector};
use super::options::{Association, Identity};
use super::tree::{Stored, Tree};

/// A landmark is deleted once the logarithm of its odds is below this ...
const DELETED: f64 = -1.5;

/// ... is told as one above this ...
pub(super) const CONFIRMED: f64 = 2.0;

/// ... and cannot be surer than this, so that what was taken away is given up after some looks.
const SUREST: f64 = 6.0;

/// One reading cannot add more to it than this: it may be of a failed match.
const MOST_GAIN: f64 = 2.0;

/// Logarithm of the odds of a landmark that one reading tells of: as likely as not ...
const NEW: f64 = 0.0;

/// ... or, where a landmark stands in that direction from which no reading came, rather a failed match of that one.
const NEW_BEFORE_A_KNOWN_ONE: f64 = -1.0;

/// Readings of a disparity below so many standard deviations say nothing of a depth, and make no landmark.
const DEEPEST_SIGMAS: f64 = 2.0;

/// Landmarks may be so much farther away than the camera sees, m and share of the range, and still be meant by a reading.
const BEYOND: [f64; 2] = [1.0, 0.5];

/// A landmark must be so many standard deviations within the view to be expected there.
const WITHIN_SIGMAS: f64 = 3.0;

/// The landmarks of a particle; a copy shares them.
#[derive(Debug, Clone, Default)]
pub(crate) struct Map {
    tree: Tree,
    next: u32,
}

/// What a scan said, from a pose that is taken for true.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Taken {
    /// The landmark that each reading is of; none where it made no landmark and is of none.
    pub(crate) landmarks: Vec<Meant>,
    /// `ln p(readings | pose, landmarks)`.
    pub(crate) log_likelihood: f64,
}

/// What a reading is taken for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Meant {
    /// Of the landmark of this number.
    Landmark(u32),
    /// The first of the landmark of this number.
    New(u32),
    /// Of a match that failed.
    #[default]
    Nothing,
}

impl Map {
    /// Number of landmarks, sure ones and others.
    pub(crate) fn len(&self) -> usize {
        self.tree.len()
    }

    /// All landmarks, in the order of the tree.
    pub(crate) fn landmarks(&self) -> Vec<Landmark> {
        self.tree.all().into_iter().map(|stored| stored.landmark).collect()
    }

    /// Landmarks that may be meant by readings from about a pose.
    pub(crate) fn candidates(&self, camera: &FeatureCamera, pose: Pose) -> Vec<Candidate> {
        let reach_m = BEYOND[0] + (1.0 + BEYOND[1]) * camera.most_depth_m / libm::cos(0.5 * camera.field_of_view_rad);
        let around = [[pose.x_m - reach_m, pose.y_m - reach_m], [pose.x_m + reach_m, pose.y_m + reach_m]];
        let mut found = Vec::new();
        self.tree.within(around, |slot, stored| found.extend(Candidate::of(slot, &stored.landmark, camera, pose)));
        found
    }

    /// The landmark of an identity as a candidate, wherever it is.
    pub(crate) fn known(&self, identity: Option<u32>, camera: &FeatureCamera, pose: Pose) -> Option<Candidate> {
        let slot = identity? as usize;
        Candidate::of(slot, &self.tree.get(slot)?.landmark, camera, pose)
    }

    /// Takes a scan from a pose: finds what readings mean, updates those landmarks, doubts those that should have been seen, and adds
    /// new ones.
    pub(crate) fn take(
        &mut self,
        camera: &FeatureCamera,
        rules: &Association,
        pose: Pose,
        readings: &[FeatureReading],
    ) -> Taken {
        let mut candidates = self.candidates(camera, pose);
        let meant = match rules.identity {
            Identity::Unknown => likeliest(readings, &candidates, rules.gate, |candidate| candidate.innovation),
            Identity::Known => self.by_identity(camera, rules, pose, readings, &mut candidates),
        };
        let anywhere = camera.anywhere();
        let mut taken = Taken { landmarks: vec![Meant::Nothing; readings.len()], log_likelihood: 0.0 };
        let mut seen = vec![false; candidates.len()];
        for (k, meant) in meant.iter().enumerate() {
            let Some(which) = *meant else { continue };
            seen[which] = true;
            let candidate = &candidates[which];
            taken.landmarks[k] = Meant::Landmark(candidate.landmark.number);
            let density = camera.seen() * self.seen(camera, pose, candidate, &readings[k]);
            taken.log_likelihood += libm::log(density * candidate.landmark.existence() + anywhere);
        }
        let unexplained = meant.iter().filter(|meant| meant.is_none()).count();
        taken.log_likelihood += unexplained as f64 * libm::log(anywhere);
        let expected = expected(camera, rules, pose, readings, &candidates);
        let missed = |which: usize| expected[which] && !seen[which];
        for (k, reading) in readings.iter().enumerate().filter(|(k, _)| meant[*k].is_none()) {
            let known = |which: usize| {
                let candidate = &candidates[which];
                let off = reading.bearing_rad - candidate.expected.reading.x;
                off * off <= rules.gate * candidate.innovation[(0, 0)] && candidate.landmark.log_odds > CONFIRMED
            };
            let before = (0..candidates.len()).any(|which| missed(which) && known(which));
            let log_odds = if before { NEW_BEFORE_A_KNOWN_ONE } else { NEW };
            taken.landmarks[k] = self.add(camera, rules, pose, reading, log_odds);
        }
        if rules.negative_evidence {
            for which in (0..candidates.len()).filter(|which| missed(*which)) {
                let candidate = &candidates[which];
                taken.log_likelihood += libm::log(1.0 - camera.seen() * candidate.landmark.existence());
                self.doubt(camera, candidate);
            }
        }
        taken
    }

    /// What readings of known identity mean: the landmark of that, if the reading is within its gate.
    fn by_identity(
        &self,
        camera: &FeatureCamera,
        rules: &Association,
        pose: Pose,
        readings: &[FeatureReading],
        candidates: &mut Vec<Candidate>,
    ) -> Vec<Option<usize>> {
        let of = |reading: &FeatureReading| {
            let candidate = self.known(reading.identity, camera, pose)?;
            let place = candidates.iter().position(|other| other.slot == candidate.slot).unwrap_or_else(|| {
                candidates.push(candidate);
                candidates.len() - 1
            });
            let [square, _] = gaussian(vector(reading) - candidate.expected.reading, &candidate.innovation)?;
            (square <= rules.gate).then_some(place)
        };
        readings.iter().map(of).collect()
    }

    /// Updates a landmark that was seen; gives the density of the reading, 1/(rad px).
    fn seen(&mut self, camera: &FeatureCamera, pose: Pose, candidate: &Candidate, reading: &FeatureReading) -> f64 {
        let off = vector(reading) - candidate.expected.reading;
        let density = gaussian(off, &candidate.innovation).map_or(0.0, |[_, log]| libm::exp(log));
        let mut landmark = candidate.landmark;
        landmark.take(camera, &candidate.expected, vector(reading));
        let gain = libm::log(camera.seen() * density / camera.anywhere()).min(MOST_GAIN);
        landmark.log_odds = (landmark.log_odds + gain).min(SUREST);
        landmark.seen_from_m = pose.position_m();
        landmark.sightings += 1;
        self.put(camera, candidate.slot, landmark);
        density
    }

    /// A landmark was not seen where it should have been.
    fn doubt(&mut self, camera: &FeatureCamera, candidate: &Candidate) {
        let mut landmark = candidate.landmark;
        landmark.log_odds += libm::log(1.0 - camera.seen().min(1.0 - 1e-6));
        if landmark.log_odds < DELETED {
            self.tree.remove(candidate.slot);
        } else {
            self.put(camera, candidate.slot, landmark);
        }
    }

    fn put(&mut self, camera: &FeatureCamera, slot: usize, landmark: Landmark) {
        let (at_m, _) = landmark.place(camera);
        self.tree.put(slot, Stored { landmark, at_m });
    }

    /// Adds a landmark, unless the reading says nothing of a depth, or its feature has one.
    fn add(
        &mut self,
        camera: &FeatureCamera,
        rules: &Association,
        pose: Pose,
        reading: &FeatureReading,
        log_odds: f64,
    ) -> Meant {
        let identity = reading.identity.filter(|_| rules.identity == Identity::Known);
        let known = identity.is_some_and(|identity| self.tree.get(identity as usize).is_some());
        if known || reading.disparity_px < DEEPEST_SIGMAS * camera.stereo.disparity_sigma {
            return Meant::Nothing;
        }
        let number = self.next;
        self.next += 1;
        let landmark = Landmark::first(number, camera, pose, &FeatureReading { identity, ..*reading }, log_odds);
        let (at_m, _) = landmark.place(camera);
        match identity {
            Some(identity) => self.tree.put(identity as usize, Stored { landmark, at_m }),
            None => {
                self.tree.add(Stored { landmark, at_m });
            }
        }
        Meant::New(number)
    }
}

/// Which landmarks should have been seen: well within the view, near where they were seen before, and with nothing before them, be it a
/// reading of this scan or another landmark.
fn expected(
    camera: &FeatureCamera,
    rules: &Association,
    pose: Pose,
    readings: &[FeatureReading],
    candidates: &[Candidate],
) -> Vec<bool> {
    let inside = |candidate: &Candidate| {
        let [across, along] = sigmas(&candidate.innovation).map(|sigma| WITHIN_SIGMAS * sigma);
        let (bearing, disparity) = (candidate.expected.reading.x, candidate.expected.reading.y);
        let from = candidate.landmark.seen_from_m;
        bearing.abs() + across <= 0.5 * camera.field_of_view_rad
            && (disparity - along) * camera.most_depth_m >= camera.stereo.focal_baseline
            && disparity + along <= camera.stereo.max_disparity
            && libm::hypot(pose.x_m - from[0], pose.y_m - from[1]) <= rules.vantage_m
    };
    let mut before: Vec<[f64; 2]> =
        readings.iter().map(|reading| [reading.bearing_rad, reading.disparity_px]).collect();
    let sure = candidates.iter().filter(|candidate| candidate.landmark.log_odds > CONFIRMED);
    before.extend(sure.map(|candidate| [candidate.expected.reading.x, candidate.expected.reading.y]));
    let hidden = |candidate: &Candidate| {
        let [across, along] = sigmas(&candidate.innovation).map(|sigma| WITHIN_SIGMAS * sigma);
        before.iter().any(|[bearing, disparity]| {
            let half = rules.occluder_m * disparity / camera.stereo.focal_baseline;
            (bearing - candidate.expected.reading.x).abs() <= half + across
                && *disparity > candidate.expected.reading.y + along
        })
    };
    candidates.iter().map(|candidate| inside(candidate) && !hidden(candidate)).collect()
}

fn sigmas(covariance: &Matrix2<f64>) -> [f64; 2] {
    [libm::sqrt(covariance[(0, 0)]), libm::sqrt(covariance[(1, 1)])]
}
