//! Landmarks from poses that are known.

use sensor::{FeatureCamera, FeatureReading, Pose};

use super::landmark::Landmark;
use super::map::{CONFIRMED, Map, Meant};
use super::options::{Association, FeatureOptionsError};

/// A map of landmarks that is made from poses which are taken for true: a Kalman filter to each landmark.
#[derive(Debug, Clone)]
pub struct LandmarkMap {
    camera: FeatureCamera,
    rules: Association,
    map: Map,
}

impl LandmarkMap {
    /// An empty map.
    ///
    /// # Errors
    /// The first number out of its bounds.
    pub fn new(camera: FeatureCamera, rules: Association) -> Result<Self, FeatureOptionsError> {
        rules.check(&camera)?;
        Ok(Self { camera, rules, map: Map::default() })
    }

    /// Takes the readings from a pose, and says what each of them was taken for. O(log landmarks) to each landmark in view.
    pub fn take(&mut self, pose: Pose, readings: &[FeatureReading]) -> Vec<Meant> {
        self.map.take(&self.camera, &self.rules, pose, readings).landmarks
    }

    /// All landmarks, those not yet confirmed among them.
    pub fn landmarks(&self) -> Vec<Landmark> {
        self.map.landmarks()
    }

    /// The landmarks that are hardly doubted: whose odds are above e².
    pub fn confirmed(&self) -> Vec<Landmark> {
        confirmed(self.landmarks())
    }
}

/// Those that are hardly doubted.
pub(crate) fn confirmed(mut landmarks: Vec<Landmark>) -> Vec<Landmark> {
    landmarks.retain(|landmark| landmark.log_odds > CONFIRMED);
    landmarks
}
