//! Drives planned on maps, against a search and an inflation written down a second time, slowly.

use grid::{GridSpec, Raster};
use proptest::prelude::*;
use score::navigation::{APART_M, Navigation, NeverSeen, Planning};

/// The side of a cell, m.
const CELL_M: f64 = 0.5;

/// A world, a map of it and what the map knows.
#[derive(Debug, Clone)]
struct Case {
    truth: Raster<Option<bool>>,
    map: Raster<f64>,
    known: Raster<bool>,
    planning: Planning,
}

fn case() -> impl Strategy<Value = Case> {
    let cell = (prop_oneof![14 => Just(Some(false)), 1 => Just(Some(true)), 1 => Just(None)], 0u32..=20, 0u32..=9);
    let planning = (0.1f64..0.9, 0.3f64..0.9, any::<bool>(), 0usize..40);
    (4usize..11, 4usize..11, planning).prop_flat_map(move |(width, height, (radius, threshold, free, pairs))| {
        let spec = GridSpec { cell_m: CELL_M, origin_m: [3.0, -1.0], width, height };
        let never_seen = if free { NeverSeen::Free } else { NeverSeen::Occupied };
        let planning = Planning { pairs, robot_radius_m: radius, threshold, never_seen };
        prop::collection::vec(cell.clone(), width * height).prop_map(move |cells| Case {
            truth: Raster::new(spec, cells.iter().map(|c| c.0).collect()),
            map: Raster::new(spec, cells.iter().map(|c| if c.1 > 18 { 0.95 } else { f64::from(c.1) / 40.0 }).collect()),
            known: Raster::new(spec, cells.iter().map(|c| c.2 > 0).collect()),
            planning,
        })
    })
}

/// Distance of a point to a solid cell or to the border, m.
fn room(solid: &[bool], spec: &GridSpec, at: [f64; 2]) -> f64 {
    let size = [spec.width, spec.height].map(|n| n as f64 * spec.cell_m);
    let from_border = (0..2).map(|k| (at[k] - spec.origin_m[k]).min(spec.origin_m[k] + size[k] - at[k]));
    let from_cell = |cell: usize| {
        let low = spec.corner(cell);
        let [x, y] = [0, 1].map(|k| (low[k] - at[k]).max(at[k] - low[k] - spec.cell_m).max(0.0));
        libm::hypot(x, y)
    };
    let cells = (0..solid.len()).filter(|cell| solid[*cell]).map(from_cell);
    cells.chain(from_border).fold(f64::INFINITY, f64::min)
}

/// The cost to every cell where the disc has room, 29 a step to the side and 41 aslant: Bellman and Ford.
fn slow_costs(stands: &[bool], spec: &GridSpec, from: usize) -> Vec<Option<u32>> {
    let mut costs: Vec<Option<u32>> = vec![None; stands.len()];
    costs[from] = stands[from].then_some(0);
    loop {
        let before = costs.clone();
        for (a, b) in (0..stands.len()).flat_map(|a| (0..stands.len()).map(move |b| (a, b))) {
            let ((ca, ra), (cb, rb)) = (spec.column_row(a), spec.column_row(b));
            let corners = [a, b, spec.index(ca, rb), spec.index(cb, ra)];
            let step = match (ca.abs_diff(cb), ra.abs_diff(rb)) {
                (0, 1) | (1, 0) => 29,
                (1, 1) => 41,
                _ => continue,
            };
            if let Some(cost) = costs[a].filter(|_| corners.iter().all(|cell| stands[*cell])) {
                costs[b] = Some(costs[b].map_or(cost + step, |other| other.min(cost + step)));
            }
        }
        if costs == before {
            return costs;
        }
    }
}

impl Case {
    fn spec(&self) -> &GridSpec {
        self.truth.spec()
    }

    fn stands(&self, solid: &[bool]) -> Vec<bool> {
        let stands = |cell| room(solid, self.spec(), self.spec().centre(cell)) > self.planning.robot_radius_m;
        (0..solid.len()).map(stands).collect()
    }

    /// What is no free place in the truth.
    fn truly_solid(&self) -> Vec<bool> {
        self.truth.values().iter().map(|cell| *cell != Some(false)).collect()
    }

    /// What a planner keeps off.
    fn held_solid(&self) -> Vec<bool> {
        let obstacle = |cell: usize| match self.known[cell] {
            true => self.map[cell] > self.planning.threshold,
            false => self.planning.never_seen == NeverSeen::Occupied,
        };
        (0..self.truth.values().len()).map(|cell| self.truth[cell].is_none() || obstacle(cell)).collect()
    }

    /// The least room along a path, by walking along it.
    fn room_along(&self, solid: &[bool], path: &[[f64; 2]]) -> f64 {
        let along = path.windows(2).flat_map(|leg| {
            (0..=100).map(move |k| [0, 1].map(|i| leg[0][i] + f64::from(k) / 100.0 * (leg[1][i] - leg[0][i])))
        });
        along.map(|at| room(solid, self.spec(), at)).fold(f64::INFINITY, f64::min)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pairs_are_free_and_joined_and_far_apart(case in case()) {
        let stands = case.stands(&case.truly_solid());
        let places = Navigation::new(&case.truth, case.planning).places();
        prop_assert!(places.len() <= case.planning.pairs);
        let cells: Vec<[usize; 2]> = places.iter().map(|pair| pair.map(|at| case.spec().locate(at).expect("inside"))).collect();
        for (number, [from, to]) in cells.iter().enumerate() {
            prop_assert!(stands[*from] && slow_costs(&stands, case.spec(), *from)[*to].is_some());
            let [[ax, ay], [bx, by]] = places[number];
            prop_assert!(libm::hypot(ax - bx, ay - by) >= APART_M);
            prop_assert!(!cells[..number].contains(&[*from, *to]), "twice");
        }
        // None only where there is none.
        if case.planning.pairs > 0 && places.is_empty() {
            let far = |a: usize, b: usize| {
                let ([ax, ay], [bx, by]) = (case.spec().centre(a), case.spec().centre(b));
                libm::hypot(ax - bx, ay - by) >= APART_M
            };
            let starts: Vec<usize> = (0..stands.len()).filter(|cell| stands[*cell]).collect();
            let joined = |from: usize| {
                let costs = slow_costs(&stands, case.spec(), from);
                starts.iter().any(|&to| costs[to].is_some() && far(from, to))
            };
            prop_assert!(starts.len() > 20 || !starts.iter().any(|&from| joined(from)));
        }
        prop_assert_eq!(places, Navigation::new(&case.truth, case.planning).places(), "the same again");
    }

    #[test]
    fn plans_are_those_of_a_slow_search(case in case()) {
        let navigation = Navigation::new(&case.truth, case.planning);
        let (solid, truly) = (case.held_solid(), case.truly_solid());
        let (held, free) = (case.stands(&solid), case.stands(&truly));
        let plans = navigation.plans(&case.map, &case.known).expect("valid");
        prop_assert_eq!(plans.len(), navigation.pairs());
        for (plan, pair) in plans.iter().zip(navigation.places()) {
            let [from, to] = pair.map(|at| case.spec().locate(at).expect("inside"));
            let cost = slow_costs(&held, case.spec(), from)[to];
            prop_assert_eq!(plan.is_some(), cost.is_some());
            let Some((plan, cost)) = plan.as_ref().zip(cost) else { continue };
            let shortest = slow_costs(&free, case.spec(), from)[to].expect("a pair");
            prop_assert!((plan.detour - f64::from(cost) / f64::from(shortest)).abs() < 1e-12);
            // One way or the other: the path leads from one place to the other, is as long as it costs, and keeps off.
            let ends = [plan.path_m[0], plan.path_m[plan.path_m.len() - 1]];
            prop_assert!(ends == pair || ends == [pair[1], pair[0]]);
            let length: f64 = plan.path_m.windows(2).map(|leg| libm::hypot(leg[1][0] - leg[0][0], leg[1][1] - leg[0][1])).sum();
            prop_assert!((length / (f64::from(cost) / 29.0 * CELL_M) - 1.0).abs() < 4e-4);
            prop_assert!(case.room_along(&solid, &plan.path_m) >= navigation.clearance_m());
        }
    }

    #[test]
    fn the_truth_as_a_map_reaches_all_by_shortest_ways_and_a_full_map_none(case in case()) {
        let navigation = Navigation::new(&case.truth, case.planning);
        let solid = case.truly_solid();
        let metrics = |map: Raster<f64>| {
            let clear = |path: &[[f64; 2]]| case.room_along(&solid, path) >= navigation.clearance_m();
            let found = navigation.metrics(&map, &map.map(|_| true), clear).expect("valid");
            prop_assert_eq!(found.map(|m| m.name), ["reached", "colliding", "detour"]);
            Ok(found.map(|m| (m.value, m.support)))
        };
        let pairs = navigation.pairs();
        let share = |value| ((pairs > 0).then_some(value), pairs);
        let truth = metrics(case.truth.map(|cell| if *cell == Some(true) { 1.0 } else { 0.0 }))?;
        prop_assert_eq!(truth, [share(1.0), share(0.0), share(1.0)]);
        prop_assert_eq!(metrics(case.truth.map(|_| 1.0))?, [share(0.0), share(0.0), (None, 0)]);
        // An empty map plans every pair, no way longer than the shortest one; what does not collide is reached.
        let [reached, colliding, detour] = metrics(case.truth.map(|_| 0.0))?;
        if let (Some(reached), Some(colliding)) = (reached.0, colliding.0) {
            prop_assert!((reached + colliding - 1.0).abs() < 1e-12);
        }
        prop_assert!(detour.0.is_none_or(|detour| detour <= 1.0 + 1e-12));
    }
}

#[test]
fn an_empty_map_leads_through_walls() {
    let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 40, height: 30 };
    // A wall in the middle with a door at its end.
    let wall = |cell: usize| spec.column_row(cell).0 == 20 && spec.column_row(cell).1 < 22;
    let truth = Raster::new(spec, (0..spec.cells()).map(|cell| Some(wall(cell))).collect());
    let bold = Planning { never_seen: NeverSeen::Free, ..Planning::default() };
    let navigation = Navigation::new(&truth, bold);
    assert_eq!(navigation.pairs(), 200);
    let solid: Vec<bool> = truth.values().iter().map(|cell| *cell == Some(true)).collect();
    let clear = |path: &[[f64; 2]]| {
        let walk = |leg: &[[f64; 2]]| {
            (0..=200).all(|k| {
                let at = [0, 1].map(|i| leg[0][i] + f64::from(k) / 200.0 * (leg[1][i] - leg[0][i]));
                room(&solid, &spec, at) >= navigation.clearance_m()
            })
        };
        path.windows(2).all(walk)
    };
    let of = |p: f64, known: bool| {
        let metrics = navigation.metrics(&truth.map(|_| p), &truth.map(|_| known), clear).expect("valid");
        metrics.map(|metric| metric.value)
    };
    let [reached, colliding, detour] = of(0.1, true).map(|value| value.expect("pairs"));
    assert!(colliding > 0.3 && reached > 0.2 && detour <= 1.0, "{reached} {colliding} {detour}");
    assert_eq!(of(0.9, false), of(0.1, true), "what was never seen is free, whatever its probability");
    let wary = Navigation::new(&truth, Planning::default());
    let nothing = wary.metrics(&truth.map(|_| 0.1), &truth.map(|_| false), |_| true).expect("valid");
    assert_eq!(nothing.map(|metric| metric.value), [Some(0.0), Some(0.0), None]);
}

#[test]
fn what_cannot_be_planned_on_is_refused() {
    let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 30, height: 20 };
    let truth = Raster::filled(spec, Some(false));
    let navigation = Navigation::new(&truth, Planning::default());
    let plans =
        |map: Raster<f64>, known: Raster<bool>| navigation.plans(&map, &known).expect_err("refused").to_string();
    let (map, known) = (truth.map(|_| 0.1), truth.map(|_| true));
    let other = GridSpec { width: 29, ..spec };
    assert!(plans(Raster::filled(other, 0.1), known.clone()).starts_with("the map has 29 x 20 cells"));
    assert!(plans(map.clone(), Raster::filled(other, true)).starts_with("the mask of known cells has 29 x 20 cells"));
    assert!(plans(map.map(|_| f64::NAN), known).contains("NaN in cell 0"));
}

#[test]
fn no_pairs_are_no_values() {
    let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 30, height: 20 };
    let truth = Raster::filled(spec, Some(false));
    for planning in
        [Planning { pairs: 0, ..Planning::default() }, Planning { robot_radius_m: 1.5, ..Planning::default() }]
    {
        let navigation = Navigation::new(&truth, planning);
        let metrics = navigation.metrics(&truth.map(|_| 0.1), &truth.map(|_| true), |_| true).expect("valid");
        assert_eq!(metrics.map(|metric| (metric.value, metric.support)), [(None, 0); 3]);
    }
}
