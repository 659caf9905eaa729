//! Landmarks of a particle that has a grid too.

use sensor::{FeatureCamera, FeatureReading, Pose};

pub(crate) use super::map::Map as Landmarks;
use super::options::Association;

/// The features that were read with a scan, and how they are taken.
#[derive(Clone, Copy)]
pub(crate) struct Beside<'a> {
    pub(crate) camera: &'a FeatureCamera,
    pub(crate) rules: &'a Association,
    pub(crate) readings: &'a [FeatureReading],
}

impl Beside<'_> {
    /// Takes them from a pose; gives `ln p(readings | pose, landmarks)`.
    pub(crate) fn take(&self, landmarks: &mut Landmarks, pose: Pose) -> f64 {
        landmarks.take(self.camera, self.rules, pose, self.readings).log_likelihood
    }
}
