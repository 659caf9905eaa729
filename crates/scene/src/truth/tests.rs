use std::path::Path;

use super::*;
use crate::{World, drive};
use proptest::prelude::*;

const SPEC: GridSpec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 20, height: 20 };

fn occupied(shape: &Shape) -> Raster<bool> {
    let mut truth = Raster::filled(SPEC, Some(false));
    occupy(&mut truth, shape);
    truth.map(|cell| *cell == Some(true))
}

fn count(raster: &Raster<bool>) -> usize {
    raster.values().iter().filter(|&&v| v).count()
}

fn upright(low: [f64; 2], high: [f64; 2]) -> Shape {
    let center_m = [0, 1].map(|k| 0.5 * (low[k] + high[k]));
    Shape::Box { center_m, half_m: [0, 1].map(|k| 0.5 * (high[k] - low[k])), axis: [1.0, 0.0] }
}

#[test]
fn touching_a_cell_is_not_covering_it() {
    assert_eq!(count(&occupied(&upright([0.3, 0.4], [0.7, 0.6]))), 8);
    assert_eq!(count(&occupied(&upright([0.3, 0.4], [0.7 + 1e-6, 0.6]))), 10, "a sliver covers");
    assert_eq!(count(&occupied(&upright([0.71, 0.42], [0.72, 0.43]))), 1, "a speck within one cell");
    assert_eq!(count(&occupied(&Shape::Disc { center_m: [0.5, 0.5], radius_m: 0.1 })), 4);
    assert_eq!(count(&occupied(&Shape::Disc { center_m: [0.55, 0.55], radius_m: 0.05 })), 1);
}

#[test]
fn a_shape_that_covers_everything() {
    assert_eq!(count(&occupied(&upright([-5.0, -5.0], [5.0, 5.0]))), 400);
    assert_eq!(count(&occupied(&Shape::Disc { center_m: [1.0, 1.0], radius_m: 9.0 })), 400);
}

#[test]
fn shapes_beyond_the_grid_cover_nothing_of_it() {
    assert_eq!(count(&occupied(&upright([2.0, 0.0], [3.0, 1.0]))), 0);
    assert_eq!(count(&occupied(&upright([-3.0, -3.0], [0.0, 0.0]))), 0);
}

fn shapes() -> impl Strategy<Value = Shape> {
    let at = || prop::array::uniform2(0.0f64..2.0);
    let boxes = (at(), prop::array::uniform2(0.02f64..0.5), -3.0f64..3.0)
        .prop_map(|(center_m, half_m, a)| Shape::Box { center_m, half_m, axis: [a.cos(), a.sin()] });
    let discs = (at(), 0.02f64..0.8).prop_map(|(center_m, radius_m)| Shape::Disc { center_m, radius_m });
    let ells = (at(), 0.2f64..1.0).prop_map(|([x, y], s)| {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.9, 0.2], [0.3, 0.3], [0.2, 1.0], [0.0, 1.0]];
        Shape::Polygon { points_m: points.iter().map(|[u, v]| [x + s * u, y + s * v]).collect() }
    });
    prop_oneof![boxes, discs, ells]
}

proptest! {
    #[test]
    fn agrees_with_dense_sampling(shape in shapes()) {
        let occupied = occupied(&shape);
        let n = 25;
        for cell in 0..SPEC.cells() {
            let corner = SPEC.corner(cell);
            let mut nearest = f64::INFINITY;
            for i in 0..n * n {
                let offset = [i % n, i / n].map(|k| (f64::from(k) + 0.5) / f64::from(n) * SPEC.cell_m);
                nearest = nearest.min(shape.distance_m([corner[0] + offset[0], corner[1] + offset[1]]));
            }
            // A sampled point inside proves the cell occupied; no point within half a step's
            // diagonal, with room for rounding, proves it free.
            if nearest <= 0.0 {
                prop_assert!(occupied[cell], "cell {} holds a covered point", cell);
            } else if nearest > 0.75 * SPEC.cell_m / f64::from(n) {
                prop_assert!(!occupied[cell], "cell {} is {} m away", cell, nearest);
            }
        }
    }
}

#[test]
fn every_ray_ends_in_an_occupied_cell() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/room.toml");
    for cell_m in [0.05, 0.037, 0.1] {
        let scene = Scene::load(&path, Some(cell_m)).expect("the room");
        let (truth, world) = (truth(&scene), World::new(&scene));
        let drive = drive(&scene).expect("a free way");
        let mut rays = 0;
        for at in drive.poses.iter().step_by(7) {
            for bearing in scene.camera.bearings_rad() {
                let direction = at.pose.direction(bearing);
                let hit = world.cast(at.pose.position_m(), direction).expect("a closed room");
                let end = [0, 1].map(|k| at.pose.position_m()[k] + (hit.range_m + 1e-6) * direction[k]);
                let cell = scene.grid.locate(end).expect("inside");
                assert_eq!(truth[cell], Some(true), "{:?} {bearing} {hit:?}", at.pose);
                rays += 1;
            }
        }
        assert!(rays > 4000, "{rays}");
    }
}

/// Boxes of known size at random: sampled at centres they keep share and size, covered cells add one to each side.
#[test]
fn centres_sample_the_world_and_covered_cells_enlarge_it() {
    let mut text = "name = \"t\"\nbounds = { min = [0, 0], max = [40, 40] }\nwaypoints = { A = [0.3, 0.3], B = [0.6, 0.3] }\nroute.stops = [\"A\", \"B\"]\n".to_owned();
    for k in 0..400 {
        // Golden-ratio steps: every phase of box against cell comes up evenly.
        let [x, y] = [0.618_033_988, 0.754_877_666].map(|step: f64| 0.3 * (f64::from(k) * step).fract());
        let at = [1.2 + 1.9 * f64::from(k % 20) + x, 1.2 + 1.9 * f64::from(k / 20) + y];
        text += &format!("[[box]]\ncenter = [{}, {}]\nsize = [0.4, 0.4]\n", at[0], at[1]);
    }
    for cell_m in [0.05, 0.1, 0.2] {
        let scene = Scene::parse(&text, Path::new("t.toml"), Some(cell_m)).expect("valid");
        let area = |truth: Raster<Option<bool>>| {
            truth.values().iter().filter(|&&v| v == Some(true)).count() as f64 * cell_m * cell_m / 400.0
        };
        let (centres, covered) = (area(truth_at_centres(&scene)), area(truth(&scene)));
        assert!((centres / 0.16 - 1.0).abs() < 0.03, "{cell_m}: {centres}");
        assert!((covered / (0.4 + cell_m).powi(2) - 1.0).abs() < 0.03, "{cell_m}: {covered}");
    }
}
