//! Casting rays, by parry.

mod swept;

use grid::Raster;
use parry2d_f64::bounding_volume::{Aabb, BoundingVolume as _};
use parry2d_f64::math::{Pose2, Rot2, Vec2};
use parry2d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhNode};
use parry2d_f64::query::{Ray, RayCast as _};
use parry2d_f64::shape::{Ball, Cuboid};

use crate::boxes::boxes;
use crate::geometry::{cross, dot, minus, sides};
use crate::{Scene, Shape};

/// Boxes are cast this much larger all round, m: boxes that touch then overlap, and no ray slips
/// through their seam.
const HAIR_M: f64 = 1e-9;

/// The tree's boxes are loosened by more than that, m, so that rounding in its tests hides no hit.
const LOOSE_M: f64 = 1e-8;

/// The obstacles of a scene, ready for rays.
pub struct World {
    tree: Bvh,
    targets: Vec<Target>,
    /// The same as they are described: rays see boxes a hair larger.
    shapes: Vec<Shape>,
}

/// Where a ray ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray, m; 0 where the ray starts inside an obstacle.
    pub range_m: f64,
    /// Index into [`Scene::obstacles`].
    pub obstacle: usize,
}

/// An obstacle as rays see it.
enum Target {
    Cuboid(Pose2, Cuboid),
    Ball(Pose2, Ball),
    Polygon(Vec<[f64; 2]>),
}

impl World {
    /// Sorts the obstacles of a scene into a tree of boxes.
    pub fn new(scene: &Scene) -> Self {
        Self::of(scene.obstacles.iter().map(|obstacle| obstacle.shape.clone()).collect())
    }

    /// The world of a map that is believed: its occupied cells are boxes, all others are open.
    pub fn of_cells(cells: &Raster<Option<bool>>) -> Self {
        Self::of(boxes(&cells.map(|&cell| cell == Some(true))))
    }

    /// The world of these shapes; a hit's `obstacle` is the shape's number.
    pub(crate) fn of(shapes: Vec<Shape>) -> Self {
        let loosened = |shape: &Shape| {
            let [min, max] = shape.extent_m();
            Aabb::new(vector(min), vector(max)).loosened(LOOSE_M)
        };
        let leaves: Vec<Aabb> = shapes.iter().map(loosened).collect();
        let targets = shapes.iter().map(Target::of).collect();
        Self { tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves), targets, shapes }
    }

    /// The first obstacle on the ray from `origin` (m) along the unit vector `direction`.
    pub fn cast(&self, origin: [f64; 2], direction: [f64; 2]) -> Option<Hit> {
        self.cast_past(origin, direction, |_| true)
    }

    /// The first obstacle on the ray of those that it sees, by their indices: it passes through the others.
    #[inline]
    pub fn cast_past(&self, origin: [f64; 2], direction: [f64; 2], sees: impl Fn(usize) -> bool) -> Option<Hit> {
        let ray = Ray::new(vector(origin), vector(direction));
        let slabs = Slabs::of(&ray);
        let entry = |node: &BvhNode, nearest: f64| slabs.entry(node.mins(), node.maxs(), nearest);
        let target = |leaf: u32, nearest: f64| {
            let met = self.targets[leaf as usize].cast(&ray, nearest);
            met.filter(|_| sees(leaf as usize))
        };
        let found = self.tree.find_best(f64::MAX, entry, target);
        found.map(|(leaf, range_m)| Hit { range_m, obstacle: leaf as usize })
    }
}

/// A ray against the boxes of the tree: parry's own test, to the last bit, with what only depends on the ray
/// taken out of it, and without branches that no processor can foresee.
///
/// Its rounding decides which of two obstacles that touch a ray meets first, so that it must not change.
struct Slabs {
    origin: [f64; 2],
    inverse: [f64; 2],
    /// The axes that the ray runs along the other of; it is on one side of their slabs from end to end.
    level: [bool; 2],
}

impl Slabs {
    fn of(ray: &Ray) -> Self {
        let direction = [ray.dir.x, ray.dir.y];
        let level = direction.map(|d| d.abs() <= 0.0);
        Self { origin: [ray.origin.x, ray.origin.y], inverse: direction.map(|d| 1.0 / d), level }
    }

    /// Range at which the ray enters a box, m, 0 from inside; `f64::MAX` where it misses it or enters beyond `limit`.
    #[inline]
    fn entry(&self, mins: Vec2, maxs: Vec2, limit: f64) -> f64 {
        let (mins, maxs) = ([mins.x, mins.y], [maxs.x, maxs.y]);
        let (mut enter, mut exit) = (0.0f64, limit);
        for k in 0..2 {
            if self.level[k] {
                if self.origin[k] < mins[k] || self.origin[k] > maxs[k] {
                    return f64::MAX;
                }
                continue;
            }
            let (a, b) = ((mins[k] - self.origin[k]) * self.inverse[k], (maxs[k] - self.origin[k]) * self.inverse[k]);
            let (near, far) = if a > b { (b, a) } else { (a, b) };
            enter = enter.max(near);
            exit = exit.min(far);
        }
        if enter > exit { f64::MAX } else { enter }
    }
}

impl Target {
    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Box { center_m, half_m, axis } => {
                let rotation = Rot2 { re: axis[0], im: axis[1] };
                let cuboid = Cuboid::new(vector(half_m.map(|h| h + HAIR_M)));
                Self::Cuboid(Pose2::from_parts(vector(*center_m), rotation), cuboid)
            }
            Shape::Disc { center_m, radius_m } => {
                Self::Ball(Pose2::from_translation(vector(*center_m)), Ball::new(*radius_m))
            }
            Shape::Polygon { points_m } => Self::Polygon(points_m.clone()),
        }
    }

    /// Range of the first hit up to `limit`, m.
    fn cast(&self, ray: &Ray, limit: f64) -> Option<f64> {
        match self {
            Self::Cuboid(pose, cuboid) => cuboid.cast_ray(pose, ray, limit, true),
            Self::Ball(pose, ball) => ball.cast_ray(pose, ray, limit, true),
            Self::Polygon(points) => outline_range(points, [ray.origin.x, ray.origin.y], [ray.dir.x, ray.dir.y]),
        }
    }
}

/// Range at which a ray meets a closed outline, m; 0 from inside.
///
/// A side is met if its ends lie on different sides of the ray, the ray itself counted with one of
/// them. The sign of a corner is the same for both sides that share it, so no ray passes between
/// them, which segment tests with a tolerance do not guarantee.
fn outline_range(points: &[[f64; 2]], origin: [f64; 2], direction: [f64; 2]) -> Option<f64> {
    let mut nearest = None;
    let mut ahead = 0usize;
    for (a, b) in sides(points) {
        let (left, right) = (cross(direction, minus(a, origin)), cross(direction, minus(b, origin)));
        if (left >= 0.0) == (right >= 0.0) {
            continue;
        }
        let t = left / (left - right);
        let met = [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])];
        let range = dot(minus(met, origin), direction);
        if range >= 0.0 {
            ahead += 1;
            nearest = Some(nearest.map_or(range, |n: f64| n.min(range)));
        }
    }
    // From inside, an odd number of sides lies ahead.
    if ahead % 2 == 1 { Some(0.0) } else { nearest }
}

fn vector([x, y]: [f64; 2]) -> Vec2 {
    Vec2::new(x, y)
}

#[cfg(test)]
mod tests;
