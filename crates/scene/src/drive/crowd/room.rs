//! Everything that stands and everything that moves, as rapier's colliders.

use rapier2d_f64::math::{Pose2, Rot2, Vec2};
use rapier2d_f64::parry::query::ShapeCastOptions;
use rapier2d_f64::pipeline::{PhysicsWorld, QueryFilter};
use rapier2d_f64::prelude::{Collider, ColliderBuilder, ColliderHandle, SharedShape};

use super::super::{CLEARANCE_M, colliders, obstacles};
use crate::{Scene, Shape};

/// Who is in the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Who {
    /// An obstacle: an index into [`Scene::obstacles`].
    Obstacle(usize),
    /// The robot.
    Robot,
    /// Something that moves, by its number.
    Thing(usize),
}

/// A collider that is moved.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece(ColliderHandle);

/// What is looked at by a query, and what is passed by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Among {
    /// Everything else.
    All,
    /// Obstacles alone.
    Obstacles,
    /// The robot and what moves.
    Moving,
}

pub(super) struct Room {
    world: PhysicsWorld,
    /// Tags from here on are the robot's and the things'.
    obstacles: usize,
}

impl Room {
    /// The obstacles of a scene.
    pub(super) fn of(scene: &Scene) -> Self {
        Self { world: obstacles(scene), obstacles: scene.obstacles.len() }
    }

    /// Puts a shape in: the robot, or something that moves. A polygon moves as its convex hull.
    pub(super) fn add(&mut self, shape: &Shape, who: Who) -> Piece {
        let builder = match shape {
            Shape::Polygon { points_m } => {
                let corners: Vec<Vec2> = points_m.iter().map(|p| Vec2::from_array(*p)).collect();
                ColliderBuilder::convex_hull(&corners).unwrap_or_else(|| ColliderBuilder::polyline(corners, None))
            }
            other => colliders(other).swap_remove(0),
        };
        let tag = match who {
            Who::Obstacle(index) => index,
            Who::Robot => self.obstacles,
            Who::Thing(thing) => self.obstacles + 1 + thing,
        };
        Piece(self.world.insert_collider(builder.user_data(tag as u128), None))
    }

    /// Lets rapier take note of what was added, and keep its tree in shape.
    pub(super) fn settle(&mut self) {
        self.world.step();
    }

    /// Puts a piece somewhere else, at once for all that look.
    pub(super) fn place(&mut self, piece: Piece, at_m: [f64; 2], axis: [f64; 2]) {
        let rotation = Rot2 { re: axis[0], im: axis[1] };
        let Some(collider) = self.world.colliders.get_mut(piece.0) else { return };
        collider.set_position(Pose2::from_parts(Vec2::from_array(at_m), rotation));
        let around = collider.compute_aabb();
        self.world.broad_phase.set_aabb(&self.world.integration_parameters, piece.0, around);
    }

    /// How far a piece can go along a unit vector, up to `most_m`, until it would come nearer than the clearance to
    /// something, and what that is.
    pub(super) fn reach(&self, piece: Piece, direction: [f64; 2], most_m: f64, among: Among) -> (f64, Option<Who>) {
        let Some(collider) = self.world.colliders.get(piece.0) else { return (0.0, None) };
        let options = ShapeCastOptions {
            target_distance: CLEARANCE_M,
            stop_at_penetration: false,
            max_time_of_impact: most_m,
            compute_impact_geometry_on_penetration: true,
        };
        let seen = |_: ColliderHandle, other: &Collider| self.seen(other, among);
        let filter = QueryFilter::new().exclude_collider(piece.0).predicate(&seen);
        let query = self.world.query_pipeline_with_filter(filter);
        match query.cast_shape(collider.position(), Vec2::from_array(direction), collider.shape(), options) {
            Some((handle, hit)) => (hit.time_of_impact.clamp(0.0, most_m), self.who(handle)),
            None => (most_m, None),
        }
    }

    /// Whether a shape, with the clearance all round, is free of all but the piece that it is to be.
    pub(super) fn is_free(&self, piece: Piece, shape: &Shape, among: Among) -> bool {
        let seen = |_: ColliderHandle, other: &Collider| self.seen(other, among);
        let filter = QueryFilter::new().exclude_collider(piece.0).predicate(&seen);
        let query = self.world.query_pipeline_with_filter(filter);
        let (at, shape) = grown(shape);
        query.intersect_shape(at, &*shape).next().is_none()
    }

    fn seen(&self, other: &Collider, among: Among) -> bool {
        let moving = other.user_data as usize >= self.obstacles;
        among == Among::All || moving == (among == Among::Moving)
    }

    fn who(&self, handle: ColliderHandle) -> Option<Who> {
        let tag = self.world.colliders.get(handle)?.user_data as usize;
        Some(match tag.checked_sub(self.obstacles) {
            None => Who::Obstacle(tag),
            Some(0) => Who::Robot,
            Some(thing) => Who::Thing(thing - 1),
        })
    }
}

/// A shape with the clearance all round.
fn grown(shape: &Shape) -> (Pose2, SharedShape) {
    let at = |at_m: &[f64; 2], rotation| Pose2::from_parts(Vec2::from_array(*at_m), rotation);
    match shape {
        Shape::Box { center_m, half_m, axis } => {
            let [w, h] = half_m.map(|half| half + CLEARANCE_M);
            (at(center_m, Rot2 { re: axis[0], im: axis[1] }), SharedShape::cuboid(w, h))
        }
        Shape::Disc { center_m, radius_m } => {
            (at(center_m, Rot2::identity()), SharedShape::ball(radius_m + CLEARANCE_M))
        }
        Shape::Polygon { points_m } => {
            // Only what walks is a polygon, and that is never put anywhere at once.
            let corners: Vec<Vec2> = points_m.iter().map(|p| Vec2::from_array(*p)).collect();
            let hull = SharedShape::convex_hull(&corners);
            (Pose2::identity(), hull.unwrap_or_else(|| SharedShape::polyline(corners, None)))
        }
    }
}
