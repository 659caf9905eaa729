//! Landmarks as files have them, and the camera that finds features.

use scene::{Feature, Scene};
use sensor::FeatureCamera;
use serde_json::json;
use slam::features::Landmark;

use crate::failure::Failure;
use crate::output::table::{Table, rounded};

/// The file that landmarks are written to.
pub const FILE: &str = "landmarks.csv";

/// The features of a scene.
///
/// # Errors
/// A scene without any.
pub fn features(scene: &Scene) -> Result<Vec<Feature>, Failure> {
    let features = scene::features(scene);
    if features.is_empty() {
        return Err(Failure::BadInput(format!(
            "{}: the scene has no vertical edge: no outer corner of a box or polygon and no disc of at most 0.15 m; add some",
            scene.name
        )));
    }
    Ok(features)
}

/// The camera that finds features in a scene.
pub fn camera(scene: &Scene) -> FeatureCamera {
    FeatureCamera::of(&scene.camera, &scene.matcher)
}

/// A row for every landmark: where it is, m, with its covariance, how often it was seen, and how surely it is there.
pub fn table(landmarks: &[Landmark], camera: &FeatureCamera) -> Table {
    let place = |landmark: &Landmark| landmark.place(camera);
    Table::of(
        landmarks,
        &[
            ("landmark", &|row| json!(row.number)),
            ("feature", &|row| json!(row.identity)),
            ("x_m", &|row| rounded(place(row).0[0])),
            ("y_m", &|row| rounded(place(row).0[1])),
            ("variance_x_m2", &|row| rounded(place(row).1[0][0])),
            ("covariance_xy_m2", &|row| rounded(place(row).1[0][1])),
            ("variance_y_m2", &|row| rounded(place(row).1[1][1])),
            ("sightings", &|row| json!(row.sightings)),
            ("existence", &|row| rounded(row.existence())),
        ],
    )
}
