//! Driving a disc.

use parry2d_f64::bounding_volume::{Aabb, BoundingVolume as _};

use super::{World, vector};

/// What only touches the disc, m, is no collision: rounding may not decide.
const TOUCH_M: f64 = 1e-9;

impl World {
    /// The first leg, counted from 0, of the way along `path_m` on which a disc of `radius_m` covers a part of an
    /// obstacle, touching not counted; none where the whole way is clear. A way of one point is a disc that stands.
    ///
    /// It is exact but for rounding: on a straight leg the disc sweeps what lies within its radius of the leg, so that
    /// it meets an obstacle where the leg comes nearer to that than the radius. O(log obstacles) per leg and obstacle
    /// beside it.
    pub fn collision(&self, path_m: &[[f64; 2]], radius_m: f64) -> Option<usize> {
        let stands = path_m.first().filter(|_| path_m.len() == 1).map(|&at| [at, at]);
        let legs = path_m.windows(2).map(|leg| [leg[0], leg[1]]).chain(stands);
        legs.enumerate().find(|(_, [a, b])| self.is_swept(*a, *b, radius_m)).map(|(leg, _)| leg)
    }

    /// Whether any obstacle is nearer than the radius to the leg.
    fn is_swept(&self, a: [f64; 2], b: [f64; 2], radius_m: f64) -> bool {
        let (low, high) = ([0, 1].map(|k| a[k].min(b[k])), [0, 1].map(|k| a[k].max(b[k])));
        let around = Aabb::new(vector(low), vector(high)).loosened(radius_m);
        let near = |leaf: u32| self.shapes[leaf as usize].segment_distance_m(a, b) < radius_m - TOUCH_M;
        self.tree.intersect_aabb(&around).any(near)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::Shape;

    fn shapes() -> impl Strategy<Value = Shape> {
        let at = || prop::array::uniform2(-3.0f64..3.0);
        let boxes = (at(), prop::array::uniform2(0.02f64..0.8), 0.0f64..6.3)
            .prop_map(|(center_m, half_m, angle)| Shape::Box { center_m, half_m, axis: [angle.cos(), angle.sin()] });
        let discs = (at(), 0.02f64..0.8).prop_map(|(center_m, radius_m)| Shape::Disc { center_m, radius_m });
        // Not convex: a disc can stand in its notch.
        let notched = at().prop_map(|[x, y]| {
            let points =
                [[0.0, 0.0], [1.5, 0.0], [1.5, 1.0], [1.0, 1.0], [1.0, 0.3], [0.5, 0.3], [0.5, 1.0], [0.0, 1.0]];
            Shape::Polygon { points_m: points.iter().map(|p| [x + p[0], y + p[1]]).collect() }
        });
        prop_oneof![boxes, discs, notched]
    }

    /// The least distance of a point of a leg to any shape, by walking along it, and how far that may be off.
    fn walked(shapes: &[Shape], [a, b]: [[f64; 2]; 2]) -> (f64, f64) {
        let steps = 2000;
        let at = |k: i32| [0, 1].map(|i| a[i] + f64::from(k) / f64::from(steps) * (b[i] - a[i]));
        let nearest = |point| shapes.iter().map(|shape| shape.distance_m(point)).fold(f64::INFINITY, f64::min);
        let step = crate::geometry::distance(a, b) / f64::from(steps);
        ((0..=steps).map(|k| nearest(at(k))).fold(f64::INFINITY, f64::min), 0.5 * step + 1e-9)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn a_disc_collides_where_discs_along_its_way_do(
            shapes in prop::collection::vec(shapes(), 0..7),
            path in prop::collection::vec(prop::array::uniform2(-3.5f64..3.5), 1..5),
            radius_m in 0.01f64..0.6,
        ) {
            let world = World::of(shapes.clone());
            let legs: Vec<[[f64; 2]; 2]> = match path[..] {
                [only] => vec![[only, only]],
                _ => path.windows(2).map(|leg| [leg[0], leg[1]]).collect(),
            };
            let rooms: Vec<(f64, f64)> = legs.iter().map(|leg| walked(&shapes, *leg)).collect();
            match world.collision(&path, radius_m) {
                Some(leg) => {
                    prop_assert!(rooms[leg].0 < radius_m + rooms[leg].1, "leg {} has {:?}", leg, rooms[leg]);
                    prop_assert!(rooms[..leg].iter().all(|(room, _)| *room >= radius_m - 1e-8), "{:?}", rooms);
                }
                None => prop_assert!(rooms.iter().all(|(room, _)| *room >= radius_m - 1e-8), "{:?}", rooms),
            }
        }

        #[test]
        fn the_distance_of_a_leg_is_what_walking_along_it_finds(
            shape in shapes(), leg in prop::array::uniform2(prop::array::uniform2(-3.5f64..3.5)),
        ) {
            let (room, within) = walked(std::slice::from_ref(&shape), leg);
            let found = shape.segment_distance_m(leg[0], leg[1]);
            prop_assert!(found <= room + 1e-9 && room <= found + within, "{} {}", found, room);
        }
    }

    #[test]
    fn cells_of_a_map_are_boxes_and_what_is_not_known_is_open() {
        let spec = grid::GridSpec { cell_m: 0.5, origin_m: [1.0, -1.0], width: 4, height: 2 };
        let cell = |k: usize| [Some(false), Some(true), None, Some(false)][k % 4];
        let world = World::of_cells(&grid::Raster::new(spec, (0..8).map(cell).collect()));
        let down = |x: f64| world.collision(&[[x, 1.0], [x, -2.0]], 0.1);
        assert_eq!(
            [1.0, 1.39, 1.41, 1.75, 2.09, 2.11, 2.25].map(down),
            [None, None, Some(0), Some(0), Some(0), None, None]
        );
    }

    #[test]
    fn touching_is_no_collision_and_the_first_leg_is_told() {
        let shape = Shape::Box { center_m: [0.0, 0.0], half_m: [1.0, 1.0], axis: [1.0, 0.0] };
        let world = World::of(vec![shape]);
        let round = [[-1.2, -3.0], [-1.2, 3.0], [3.0, 3.0], [0.0, 0.0]];
        assert_eq!(world.collision(&round, 0.2), Some(2));
        assert_eq!(world.collision(&round[..3], 0.2), None);
        assert_eq!(world.collision(&round, 0.2001), Some(0));
        assert_eq!((world.collision(&[[0.0, 1.1]], 0.2), world.collision(&[[0.0, 1.3]], 0.2)), (Some(0), None));
        assert_eq!(world.collision(&[], 0.2), None);
    }
}
