use super::*;
use crate::geometry::distance;
use proptest::prelude::*;

fn upright(min: [f64; 2], max: [f64; 2]) -> Shape {
    let center_m = [0.5 * (min[0] + max[0]), 0.5 * (min[1] + max[1])];
    Shape::Box { center_m, half_m: [0.5 * (max[0] - min[0]), 0.5 * (max[1] - min[1])], axis: [1.0, 0.0] }
}

fn turned(center_m: [f64; 2], size: [f64; 2], angle: f64) -> Shape {
    Shape::Box { center_m, half_m: size.map(|s| 0.5 * s), axis: [angle.cos(), angle.sin()] }
}

/// The letter L, not convex.
fn ell([x, y]: [f64; 2]) -> Shape {
    let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.3], [0.3, 0.3], [0.3, 1.0], [0.0, 1.0]];
    Shape::Polygon { points_m: points.iter().map(|p| [x + p[0], y + p[1]]).collect() }
}

fn world(shapes: Vec<Shape>) -> World {
    World::of(shapes)
}

fn unit(angle: f64) -> [f64; 2] {
    [angle.cos(), angle.sin()]
}

/// The oracle: the nearest hit over all targets, without the tree.
fn brute(world: &World, origin: [f64; 2], direction: [f64; 2]) -> Option<f64> {
    let ray = Ray::new(vector(origin), vector(direction));
    world.targets.iter().filter_map(|t| t.cast(&ray, f64::MAX)).min_by(f64::total_cmp)
}

/// The oracle of the faster test of the tree's boxes: parry's own cast, obstacle and bits of the range.
fn by_parry(world: &World, origin: [f64; 2], direction: [f64; 2]) -> Option<(usize, u64)> {
    let ray = Ray::new(vector(origin), vector(direction));
    let found = world.tree.cast_ray(&ray, f64::MAX, |leaf, nearest| world.targets[leaf as usize].cast(&ray, nearest));
    found.map(|(leaf, range_m)| (leaf as usize, range_m.to_bits()))
}

fn to_the_bit(world: &World, origin: [f64; 2], direction: [f64; 2]) -> Option<(usize, u64)> {
    world.cast(origin, direction).map(|hit| (hit.obstacle, hit.range_m.to_bits()))
}

fn range(shape: Shape, origin: [f64; 2], direction: [f64; 2]) -> Option<f64> {
    world(vec![shape]).cast(origin, direction).map(|hit| hit.range_m)
}

fn near(found: Option<f64>, expected: f64) {
    // A box is a hair larger than it says.
    assert!(found.is_some_and(|r| (r - expected).abs() < 4.0 * HAIR_M), "{found:?} is not {expected}");
}

#[test]
fn analytic_ranges() {
    let h = std::f64::consts::FRAC_1_SQRT_2;
    near(range(upright([2.0, -0.5], [2.4, 0.5]), [0.0, 0.2], [1.0, 0.0]), 2.0);
    near(range(upright([2.0, 2.0], [3.0, 3.0]), [0.0, 0.5], [h, h]), 2.0 / h);
    near(range(turned([3.0, 0.0], [1.0, 1.0], std::f64::consts::FRAC_PI_4), [0.0, 0.0], [1.0, 0.0]), 3.0 - h);
    near(range(Shape::Disc { center_m: [4.0, 0.3], radius_m: 0.5 }, [0.0, 0.0], [1.0, 0.0]), 4.0 - 0.4);
    assert_eq!(range(Shape::Disc { center_m: [4.0, 0.6], radius_m: 0.5 }, [0.0, 0.0], [1.0, 0.0]), None);
    near(range(ell([1.0, 0.0]), [0.0, 0.15], [1.0, 0.0]), 1.0);
    near(range(ell([1.0, 0.0]), [3.0, 0.5], [-1.0, 0.0]), 1.7);
    assert_eq!(range(ell([1.0, 0.0]), [0.0, 1.1], [1.0, 0.0]), None);
}

#[test]
fn from_inside_the_range_is_zero() {
    for shape in [upright([0.0; 2], [1.0; 2]), turned([0.1, 0.1], [1.0, 1.0], 0.4), ell([0.0, 0.0])] {
        assert_eq!(range(shape, [0.15, 0.2], unit(0.3)), Some(0.0));
    }
    assert_eq!(range(Shape::Disc { center_m: [0.0; 2], radius_m: 1.0 }, [0.2, 0.2], unit(2.0)), Some(0.0));
}

#[test]
fn an_empty_world_is_dark() {
    assert_eq!(world(Vec::new()).cast([0.0; 2], [1.0, 0.0]), None);
}

/// A closed room of many boxes that touch only along seams, as merged map cells do; the corners
/// are left to boxes that touch corner to corner.
fn seams() -> Vec<Shape> {
    let mut shapes = Vec::new();
    for k in 0..40 {
        let [from, to] = [f64::from(k) * 0.1, f64::from(k + 1) * 0.1];
        shapes.push(upright([from, -0.1], [to, 0.0]));
        shapes.push(upright([from, 4.0], [to, 4.1]));
        shapes.push(upright([-0.1, from], [0.0, to]));
        shapes.push(upright([4.0, from], [4.1, to]));
    }
    shapes
}

/// A closed room that is one outline: a ring with a slit of no width is not simple, so two halves.
fn halves() -> Vec<Shape> {
    let left = [[2.0, -0.5], [2.0, 0.0], [0.0, 0.0], [0.0, 4.0], [2.0, 4.0], [2.0, 4.5], [-0.5, 4.5], [-0.5, -0.5]];
    let right = left.map(|[x, y]| [4.0 - x, y]);
    [left, right].map(|points| Shape::Polygon { points_m: points.to_vec() }).to_vec()
}

fn aimed(origin: [f64; 2], at: [f64; 2]) -> [f64; 2] {
    let d = minus(at, origin);
    let length = d[0].hypot(d[1]);
    d.map(|v| v / length)
}

/// Boxes that touch along whole sides, looked at along these sides and at their corners: where two are hit at the same
/// range, the tree must meet the same one first.
#[test]
fn ties_go_to_the_obstacle_that_parry_meets_first() {
    let tiles =
        (0..400).map(|k| [f64::from(k % 20), f64::from(k / 20)]).filter(|[x, y]| (x - 9.5).hypot(y - 9.5) > 4.0);
    let world = world(tiles.map(|[x, y]| upright([x, y], [x + 1.0, y + 1.0])).collect());
    let tiny = f64::MIN_POSITIVE * 1e-10;
    let mut ties = 0;
    for origin in [[10.0, 10.0], [10.0, 9.5], [9.75, 10.0], [-3.0, 7.0], [5.0, 30.0]] {
        let corners = (0..=20).flat_map(|x| (0..=20).map(move |y| [f64::from(x), f64::from(y)]));
        let along = [[1.0, 0.0], [-1.0, -0.0], [0.0, 1.0], [-0.0, -1.0], [1.0, tiny], [-tiny, -1.0]];
        let directions =
            corners.filter(|&corner| distance(corner, origin) > 0.0).map(|corner| aimed(origin, corner)).chain(along);
        for direction in directions {
            assert_eq!(to_the_bit(&world, origin, direction), by_parry(&world, origin, direction), "{direction:?}");
            let ray = Ray::new(vector(origin), vector(direction));
            let ranges = world.targets.iter().filter_map(|t| t.cast(&ray, f64::MAX));
            ties += usize::from(
                brute(&world, origin, direction)
                    .is_some_and(|nearest| ranges.filter(|range| range.to_bits() == nearest.to_bits()).count() > 1),
            );
        }
    }
    assert!(ties > 20, "{ties}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_closed_room_never_leaks(
        origin in prop::array::uniform2(0.01f64..3.99), angle in -4.0f64..4.0, seam in 0i32..41, side in 0usize..4, snap: bool,
    ) {
        // Half of the origins on the seams' own lines, so that rays run along them.
        let origin = if snap { origin.map(|v| (v * 10.0).round().clamp(1.0, 39.0) * 0.1) } else { origin };
        let s = f64::from(seam) * 0.1;
        let target = [[s, 0.0], [s, 4.0], [0.0, s], [4.0, s]][side];
        let along = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][side];
        for room in [world(seams()), world(halves())] {
            for direction in [unit(angle), aimed(origin, target), along] {
                let hit = room.cast(origin, direction);
                prop_assert_eq!(to_the_bit(&room, origin, direction), by_parry(&room, origin, direction));
                prop_assert!(hit.is_some(), "{:?} {:?}", origin, direction);
                let range = hit.map_or(0.0, |h| h.range_m);
                for k in 0..2 {
                    let at = origin[k] + range * direction[k];
                    prop_assert!((-1e-7..=4.0 + 1e-7).contains(&at), "behind the wall at {}", at);
                }
            }
        }
    }

    #[test]
    fn the_tree_agrees_with_trying_everything(
        boxes in prop::collection::vec((prop::array::uniform2(-5.0f64..5.0), prop::array::uniform2(0.01f64..2.0), -3.0f64..3.0), 0..20),
        discs in prop::collection::vec((prop::array::uniform2(-5.0f64..5.0), 0.01f64..1.0), 0..10),
        ells in prop::collection::vec(prop::array::uniform2(-5.0f64..5.0), 0..5),
        origin in prop::array::uniform2(-6.0f64..6.0), angle in -4.0f64..4.0, along: bool,
    ) {
        let boxes = boxes.into_iter().map(|(center, size, angle)| turned(center, size, if along { 0.0 } else { angle }));
        let discs = discs.into_iter().map(|(center_m, radius_m)| Shape::Disc { center_m, radius_m });
        let world = world(boxes.chain(discs).chain(ells.into_iter().map(ell)).collect());
        let direction = if along { [0.0, 1.0] } else { unit(angle) };
        let found = world.cast(origin, direction).map(|h| h.range_m);
        let expected = brute(&world, origin, direction);
        match (found, expected) {
            (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-12, "{} {}", a, b),
            (a, b) => prop_assert_eq!(a, b),
        }
        prop_assert_eq!(to_the_bit(&world, origin, direction), by_parry(&world, origin, direction));
    }

    #[test]
    fn a_polygon_is_cast_as_the_box_it_equals(
        center in prop::array::uniform2(-2.0f64..2.0), size in prop::array::uniform2(0.1f64..2.0), turn in -3.0f64..3.0, angle in -4.0f64..4.0,
    ) {
        let shape = turned(center, size, turn);
        let polygon = Shape::Polygon { points_m: shape.corners_m() };
        let origin = [-4.0 * angle.cos(), -4.0 * angle.sin()];
        match (range(shape, origin, unit(angle)), range(polygon, origin, unit(angle))) {
            (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-6, "{} {}", a, b),
            (a, b) => prop_assert_eq!(a.is_some(), b.is_some()),
        }
    }
}
