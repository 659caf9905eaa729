use std::path::Path;

use super::*;
use crate::geometry::distance;
use grid::GridSpec;
use grid::ros_map;
use proptest::prelude::*;

/// `#` occupied, `.` free, `?` unknown; the first line is the top.
fn drawn(cell_m: f64, text: &[&str]) -> Raster<Option<bool>> {
    let spec = GridSpec { cell_m, origin_m: [-1.0, 2.0], width: text[0].len(), height: text.len() };
    let state = |c: char| match c {
        '#' => Some(true),
        '.' => Some(false),
        _ => None,
    };
    Raster::new(spec, text.iter().rev().flat_map(|line| line.chars().map(state)).collect())
}

/// Two rooms of 6 by 5 cells of 0.2 m with a door of three cells, and a door of one cell to a third.
const ROOMS: [&str; 7] = [
    "####################",
    "#......#......#....#",
    "#.............#....#",
    "#..................#",
    "#.............#....#",
    "#......#......#....#",
    "####################",
];

fn options(radius_m: f64) -> SurveyOptions {
    let mut options = SurveyOptions { clearance_m: 0.01, ..SurveyOptions::default() };
    options.robot.radius_m = radius_m;
    options
}

/// Distance of a point to the square of a cell, m.
fn gap(spec: &GridSpec, cell: usize, at: [f64; 2]) -> f64 {
    let low = spec.corner(cell);
    let nearest = [0, 1].map(|k| at[k].clamp(low[k], low[k] + spec.cell_m));
    distance(nearest, at)
}

/// Slow reference: the least distance of a point to what is not free, the outside included.
fn room_at(cells: &Raster<Option<bool>>, at: [f64; 2]) -> f64 {
    let spec = cells.spec();
    let solid = (0..spec.cells()).filter(|&cell| cells[cell] != Some(false)).map(|cell| gap(spec, cell, at));
    let size = [spec.width, spec.height].map(|n| n as f64 * spec.cell_m);
    let border = (0..2).flat_map(|k| [at[k] - spec.origin_m[k], spec.origin_m[k] + size[k] - at[k]]);
    solid.chain(border).fold(f64::INFINITY, f64::min)
}

/// The same along a leg, sampled.
fn room_along(cells: &Raster<Option<bool>>, from: [f64; 2], to: [f64; 2]) -> f64 {
    let samples = (distance(from, to) / (0.02 * cells.spec().cell_m)).ceil().max(1.0) as usize;
    let at = |k: usize| [0, 1].map(|a| from[a] + k as f64 / samples as f64 * (to[a] - from[a]));
    (0..=samples).map(|k| room_at(cells, at(k))).fold(f64::INFINITY, f64::min)
}

#[test]
fn the_robot_goes_through_the_door_that_is_wide_enough_and_through_no_other() {
    let cells = drawn(0.2, &ROOMS);
    let column = |stop: &[f64; 2]| ((stop[0] + 1.0) / 0.2) as usize;
    let reach = |radius| {
        let survey = survey(&cells, &SurveyOptions { range_m: 0.8, ..options(radius) }).expect("a route");
        let columns: Vec<usize> =
            (0..20).filter(|&c| (0..7).any(|r| survey.floor[survey.floor.spec().index(c, r)])).collect();
        (columns[0], columns[columns.len() - 1], survey)
    };
    // The door on the right is 0.2 m wide, the one on the left 0.6 m: with 0.01 m to spare, 0.09 and 0.29 m just fit.
    let (low, high, all) = reach(0.09);
    assert_eq!((low, high), (1, 18));
    assert!(all.seen > 0.95 && !all.cut, "{}", all.seen);
    assert!([0..7, 8..14, 15..19].iter().all(|room| all.stops_m.iter().any(|s| room.contains(&column(s)))));
    for (radius, doors) in [(0.091, 1), (0.29, 1), (0.291, 0)] {
        let (low, high, some) = reach(radius);
        let between = |from: usize, to: usize| some.stops_m.iter().any(|s| (from..to).contains(&column(s)));
        // The floor goes as far through a door that is too narrow as round a corner: four steps from where the robot gets.
        assert!(low >= 1 && high < 17, "{radius}: {low} {high}");
        assert!(!between(14, 20) && (between(0, 7) && between(7, 14)) == (doors == 1), "{radius}: {:?}", some.stops_m);
    }
}

#[test]
fn what_cannot_be_driven_is_refused_with_the_reason() {
    let refusal = |cells: &Raster<Option<bool>>, options: &SurveyOptions| {
        survey(cells, options).expect_err("refused").to_string()
    };
    assert!(
        refusal(&drawn(0.2, &["??", "#?"]), &options(0.2))
            .starts_with("none of its 4 cells is free (1 are occupied, 3 unknown)")
    );
    assert!(
        refusal(&drawn(0.2, &["###", "###"]), &options(0.2))
            .starts_with("none of its 6 cells is free (6 are occupied, 0 unknown)")
    );
    let single = drawn(1.0, &["###", "#.#", "###"]);
    assert!(refusal(&single, &options(0.3)).contains("cannot move anywhere among 1 free cells of 1 m"));
    assert!(
        refusal(&single, &options(0.6))
            .contains("a robot of radius 0.6 m with 0.01 m to spare fits nowhere among 1 free")
    );
    assert!(refusal(&drawn(0.2, &ROOMS), &options(5.0)).contains("give a smaller --radius"));
    assert!(refusal(&drawn(0.2, &["."]), &options(1e3)).contains("fits nowhere"));
    let start = SurveyOptions { start_m: Some([0.0, 2.1]), ..options(0.19) };
    let message = refusal(&drawn(0.2, &ROOMS), &start);
    assert!(
        message.starts_with("start 0,2.1: must lie in the largest space")
            && message.contains("the nearest place there is "),
        "{message}"
    );
}

#[test]
fn a_start_is_kept_and_a_length_too() {
    let cells = drawn(0.2, &ROOMS);
    let asked = SurveyOptions { start_m: Some([-0.5, 2.7]), max_length_m: Some(1.5), ..options(0.19) };
    let survey = survey(&cells, &asked).expect("a route");
    assert!(distance(survey.stops_m[0], [-0.5, 2.7]) < 1e-12);
    assert!(survey.cut && survey.length_m > 1.2 && survey.length_m < 1.502, "{}", survey.length_m);
}

/// The space in closed form: each cell by its distance to each other.
fn slow_clear(cells: &Raster<Option<bool>>, needed_m: f64) -> Vec<bool> {
    let spec = cells.spec();
    (0..spec.cells()).map(|cell| room_at(cells, spec.centre(cell)) >= needed_m - 1e-6 * spec.cell_m).collect()
}

/// Slow reference of what the camera sees: every ray walked in small steps.
fn slow_seen(cells: &Raster<Option<bool>>, survey: &Survey, options: &SurveyOptions) -> f64 {
    let spec = cells.spec();
    let mut seen = vec![false; spec.cells()];
    for at in crate::drive::course::undisturbed(&survey.stops_m, &options.robot) {
        for bearing in options.camera.bearings_rad() {
            let (from, direction) = (at.pose.position_m(), at.pose.direction(bearing));
            let step = 0.002 * spec.cell_m;
            for k in 0..(options.range_m / step) as usize {
                let point = [0, 1].map(|a| from[a] + (k as f64 + 0.5) * step * direction[a]);
                let Some(cell) = spec.locate(point).filter(|&cell| cells[cell] == Some(false)) else { break };
                seen[cell] |= survey.floor[cell];
            }
        }
    }
    let count = |set: &[bool]| set.iter().filter(|&&v| v).count() as f64;
    count(&seen) / count(survey.floor.values())
}

#[test]
fn what_is_claimed_to_be_seen_is_what_the_camera_sees() {
    let cells = drawn(0.2, &ROOMS);
    for range_m in [0.6, 1.5, 4.0] {
        let mut options = SurveyOptions { range_m, ..options(0.19) };
        options.camera.columns = 30;
        options.robot.scan_interval_s = 1.5;
        let survey = survey(&cells, &options).expect("a route");
        let counted = slow_seen(&cells, &survey, &options);
        assert!((survey.seen - counted).abs() < 0.02, "{range_m}: {} {counted}", survey.seen);
    }
}

#[test]
fn unknown_cells_are_kept_off_as_walls_are() {
    let holed: Vec<String> = ROOMS.iter().map(|line| line.replace('#', "?")).collect();
    let holed = drawn(0.2, &holed.iter().map(String::as_str).collect::<Vec<_>>());
    let route = |cells| survey(cells, &options(0.19)).expect("a route");
    assert_eq!(route(&holed), route(&drawn(0.2, &ROOMS)));
}

#[test]
fn a_robots_own_map_is_covered() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/maps/UMA_236_237.yaml");
    let cells = ros_map::read(&path).expect("a map").cells();
    let options = SurveyOptions::default();
    let once = survey(&cells, &options).expect("a route");
    assert!(once.seen > 0.97, "{}", once.seen);
    assert!(once.stops_m.len() < 60 && once.length_m < 60.0, "{} {}", once.stops_m.len(), once.length_m);
    let single = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    assert_eq!(single.install(|| survey(&cells, &options)).expect("a route"), once, "whatever the number of threads");
}

fn random_maps() -> impl Strategy<Value = Raster<Option<bool>>> {
    let cell = prop_oneof![12 => Just(Some(false)), 1 => Just(Some(true)), 1 => Just(None)];
    (1usize..16, 1usize..16, prop::sample::select(vec![0.05, 0.3, 1.0])).prop_flat_map(
        move |(width, height, cell_m)| {
            let spec = GridSpec { cell_m, origin_m: [0.3, -7.0], width, height };
            prop::collection::vec(cell.clone(), width * height).prop_map(move |cells| Raster::new(spec, cells))
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn the_space_is_the_largest_part_of_what_the_slow_reference_finds(cells in random_maps(), needed in 0.05f64..3.0) {
        let needed_m = needed * cells.spec().cell_m;
        let (space, slow) = (Space::new(&cells, needed_m), slow_clear(&cells, needed_m));
        for cell in space.drivable() {
            prop_assert!(slow[cell], "cell {}", cell);
            for next in cells.spec().neighbours(cell) {
                prop_assert_eq!(space.holds(next.cell), slow[next.cell], "no part ends beside a clear cell");
            }
        }
        prop_assert_eq!(space.drivable().count() > 0, slow.contains(&true));
    }

    #[test]
    fn a_leg_is_clear_exactly_if_sampling_says_so(cells in random_maps(), needed in 0.05f64..3.0, ends in prop::array::uniform2(any::<prop::sample::Index>())) {
        let spec = *cells.spec();
        let space = Space::new(&cells, needed * spec.cell_m);
        let [from, to] = ends.map(|end| end.index(spec.cells()));
        let room = room_along(&cells, spec.centre(from), spec.centre(to)) / spec.cell_m;
        // Samples are up to 0.01 cells off the place where the leg is narrowest.
        if space.leg(from, to) {
            prop_assert!(room >= needed - 1e-5, "{} < {}", room, needed);
        } else {
            prop_assert!(room < needed + 0.011, "{} >= {}", room, needed);
        }
    }

    #[test]
    fn steps_are_clear(cells in random_maps(), needed in 0.05f64..3.0) {
        let space = Space::new(&cells, needed * cells.spec().cell_m);
        for cell in space.drivable() {
            for (to, _) in space.ways().steps(cell) {
                prop_assert!(space.leg(cell, to), "{} {}", cell, to);
            }
        }
    }

    #[test]
    fn a_map_is_refused_or_its_route_is_clear(cells in random_maps(), radius in 0.1f64..1.5) {
        let mut options = options((radius * cells.spec().cell_m).max(0.001));
        options.camera.columns = 8;
        let Ok(survey) = survey(&cells, &options) else { return Ok(()) };
        prop_assert!(survey.stops_m.len() >= 2);
        prop_assert!(survey.seen > 0.0 && survey.seen <= 1.0);
        for leg in survey.stops_m.windows(2) {
            prop_assert!(distance(leg[0], leg[1]) > 0.01);
            let room = room_along(&cells, leg[0], leg[1]);
            // To the millimetre.
            prop_assert!(room >= options.robot.radius_m + options.clearance_m - 1e-3, "{:?}: {}", leg, room);
        }
    }
}
