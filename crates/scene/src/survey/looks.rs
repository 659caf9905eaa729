//! Short legs that turn the camera to what the robot would pass by.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::{PI, TAU};

use super::plan::{Progress, SurveyOptions, Watch};
use super::route::stops_m;
use super::sight::Sight;
use super::space::Space;
use super::viewpoints::WORTH;
use crate::geometry::minus;

/// Directions tried at a stop.
const DIRECTIONS: usize = 24;

/// Length of a leg that turns the camera, m, or two cells where these are longer.
const LEG_M: f64 = 0.15;

/// Turning shows more than the looks were made for, so that the rest is looked at again.
const ROUNDS: usize = 3;

/// A stop, and whether the leg to it is there for the look along it.
#[derive(Clone, Copy)]
struct Step {
    cell: usize,
    look: bool,
}

/// What is not yet seen of the floor from a stop, and the legs that could be driven there.
struct Place {
    cell: usize,
    unseen: Vec<(usize, f64)>,
    legs: Vec<(usize, f64)>,
}

/// The route with looks added at its stops, where they show enough that the camera would miss.
pub(super) fn add(
    space: &Space,
    sight: &Sight,
    route: Vec<usize>,
    options: &SurveyOptions,
    progress: Watch,
) -> Vec<usize> {
    let spec = *space.spec();
    let least = WORTH * sight.range_m() * sight.range_m() / spec.cell_area_m2();
    let cells = |steps: &[Step]| steps.iter().map(|step| step.cell).collect::<Vec<_>>();
    let mut steps: Vec<Step> = route.into_iter().map(|cell| Step { cell, look: false }).collect();
    for round in 0..ROUNDS {
        progress(Progress { step: "turning the camera", done: round, of: ROUNDS });
        let seen = sight.seen_on(&stops_m(&spec, &cells(&steps), None).0, options);
        let looks = choose(space, sight, &steps, seen, least, options.camera.field_of_view_rad);
        if looks.is_empty() {
            break;
        }
        for (at, to) in looks {
            insert(space, &mut steps, at, to);
        }
    }
    cells(&steps)
}

/// The looks that show the most, as the cells from which and to which to drive.
fn choose(
    space: &Space,
    sight: &Sight,
    steps: &[Step],
    mut seen: Vec<bool>,
    least: f64,
    field_of_view_rad: f64,
) -> Vec<(usize, usize)> {
    let mut stops: Vec<usize> = steps.iter().filter(|step| !step.look).map(|step| step.cell).collect();
    stops.sort_unstable();
    stops.dedup();
    let mut looker = sight.looker();
    let bearing = |from, to| {
        let [x, y] = minus(space.spec().centre(to), space.spec().centre(from));
        libm::atan2(y, x)
    };
    let places = stops.into_iter().filter_map(|cell| {
        let mut unseen = sight.around(cell, &mut looker);
        unseen.retain(|&cell| !seen[cell]);
        if (unseen.len() as f64) < least {
            return None;
        }
        let unseen = unseen.into_iter().map(|to| (to, bearing(cell, to))).collect();
        let legs = legs(space, cell).into_iter().map(|to| (to, bearing(cell, to))).collect();
        Some(Place { cell, unseen, legs })
    });
    let places: Vec<Place> = places.collect();
    let within = |a: f64, b: f64| {
        let off = (a - b).abs();
        off.min(TAU - off) <= 0.5 * field_of_view_rad.min(TAU - PI)
    };
    let best = |place: &Place, seen: &[bool]| {
        let left: Vec<f64> = place.unseen.iter().filter(|(cell, _)| !seen[*cell]).map(|(_, b)| *b).collect();
        let gain = |leg: &(usize, f64)| left.iter().filter(|&&b| within(b, leg.1)).count();
        (0..place.legs.len()).map(|k| (gain(&place.legs[k]), Reverse(k))).max()
    };
    let mut looks = Vec::new();
    let entries = (0..places.len()).filter_map(|k| Some((best(&places[k], &seen)?.0, Reverse(k))));
    let mut queue: BinaryHeap<(usize, Reverse<usize>)> = entries.collect();
    while let Some((_, Reverse(k))) = queue.pop() {
        let place = &places[k];
        let Some((gain, Reverse(leg))) = best(place, &seen) else { continue };
        if (gain as f64) < least {
            continue;
        }
        if gain >= queue.peek().map_or(0, |(next, _)| *next) {
            let (to, along) = place.legs[leg];
            place.unseen.iter().filter(|(_, b)| within(*b, along)).for_each(|(cell, _)| seen[*cell] = true);
            looks.push((place.cell, to));
        }
        queue.push((gain, Reverse(k)));
    }
    looks
}

/// Ends of the short legs that can be driven from a cell.
fn legs(space: &Space, from: usize) -> Vec<usize> {
    let spec = space.spec();
    let length_m = LEG_M.max(2.0 * spec.cell_m);
    let end = |k: usize| {
        let (sin, cos) = libm::sincos(k as f64 * TAU / DIRECTIONS as f64);
        let [x, y] = spec.centre(from);
        spec.locate([x + length_m * cos, y + length_m * sin])
    };
    let clear = |&to: &usize| to != from && space.holds(to) && space.leg(from, to);
    let mut ends: Vec<usize> = (0..DIRECTIONS).filter_map(end).filter(clear).collect();
    ends.dedup();
    ends
}

/// Puts a leg from `at` to `to` where the route first stops at `at`, and back if the way on asks for it.
fn insert(space: &Space, steps: &mut Vec<Step>, at: usize, to: usize) {
    let Some(k) = steps.iter().position(|step| step.cell == at && !step.look) else { return };
    let on = steps.get(k + 1);
    let back = on.is_some_and(|next| next.look || next.cell == to || !space.leg(to, next.cell));
    let look = [Step { cell: to, look: true }, Step { cell: at, look: false }];
    steps.splice(k + 1..k + 1, look.into_iter().take(if back { 2 } else { 1 }));
}
