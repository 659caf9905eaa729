//! Where a scene has vertical edges.

use crate::geometry::{distance, minus};
use crate::{Scene, Shape};

/// Discs up to this radius, m, are posts: one edge, at their middle. The outline of a larger disc has no edge that stays where it is.
const POST_M: f64 = 0.15;

/// Corners within this distance of another obstacle, m, are where obstacles join, and no edge.
const JOINT_M: f64 = 1e-6;

/// Edges as near to each other as this, m, are one.
const SAME_M: f64 = 0.01;

/// Rays are aimed so far outside of a corner, m: one that grazes the sides of an obstacle is decided by rounding.
const OUTSIDE_M: f64 = 1e-4;

/// A point feature of a scene: a vertical edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Feature {
    /// Where it is, m.
    pub at_m: [f64; 2],
    /// Index into [`Scene::obstacles`].
    pub obstacle: usize,
    /// Factor on the detection rate, 0 to 1.
    pub texture: f64,
    /// Where rays to it are aimed, m: a hair outside of a corner, the middle of a post.
    pub(super) aim_m: [f64; 2],
    /// Whether it is a post, which hides no ray to its own middle.
    pub(super) is_post: bool,
}

/// The vertical edges of what stands in a scene: the outer corners of boxes and polygons where no other obstacle joins them, and the
/// middles of thin discs. In the order of the obstacles and of their corners.
pub fn features(scene: &Scene) -> Vec<Feature> {
    let mut found: Vec<Feature> = Vec::new();
    for (obstacle, described) in scene.obstacles.iter().enumerate() {
        let feature = |at_m, aim_m, is_post| Feature { at_m, obstacle, texture: described.texture, aim_m, is_post };
        let own: Vec<Feature> = match &described.shape {
            Shape::Disc { center_m, radius_m } if *radius_m <= POST_M => vec![feature(*center_m, *center_m, true)],
            Shape::Disc { .. } => Vec::new(),
            shape => outer(&shape.corners_m()).into_iter().map(|(at, aim)| feature(at, aim, false)).collect(),
        };
        let joins = |point: [f64; 2]| {
            let others = scene.obstacles.iter().enumerate().filter(|(other, _)| *other != obstacle);
            others.into_iter().any(|(_, other)| other.shape.distance_m(point) <= JOINT_M)
        };
        for feature in own {
            if !joins(feature.at_m) && found.iter().all(|other| distance(other.at_m, feature.at_m) > SAME_M) {
                found.push(feature);
            }
        }
    }
    found
}

/// The corners of a counter-clockwise outline that stick out, each with a point just outside of it.
fn outer(corners: &[[f64; 2]]) -> Vec<([f64; 2], [f64; 2])> {
    let n = corners.len();
    let unit = |from: [f64; 2], to: [f64; 2]| {
        let [x, y] = minus(to, from);
        let length = libm::hypot(x, y);
        [x / length, y / length]
    };
    let corner = |k: usize| {
        let (before, at, after) = (corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n]);
        let (to, from) = (unit(before, at), unit(at, after));
        // Sides that go on nearly straight have no edge that an image shows.
        let turn = crate::geometry::cross(to, from);
        if turn < 0.2 {
            return None;
        }
        let out = unit([0.0; 2], minus(to, from));
        Some((at, [at[0] + OUTSIDE_M * out[0], at[1] + OUTSIDE_M * out[1]]))
    };
    (0..n).filter_map(corner).collect()
}
