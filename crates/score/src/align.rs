//! Where a map lies best: the shift and turn by which it agrees with the truth.

mod field;
mod step;

use grid::{Frame, NoMemory, Raster};
use serde::Serialize;

use field::Field;
use step::{Level, Look, Place};

/// Cells along a side of the truth at which the search begins, at most.
const COARSEST: f64 = 96.0;

/// Cells of the finest level, at most: more only cost time, since a place is known to a small part of a cell.
const FINEST: usize = 2_000_000;

/// Places of the first search from which steps are taken.
const STARTS: usize = 4;

/// Steps at a cell size, at most.
const STEPS: usize = 12;

/// A step this short ends them, cells.
const SHORT: f64 = 0.003;

/// What moving must gain in squared correlation: less is rounding.
const GAIN: f64 = 1e-5;

/// How far a map may be moved.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct AlignBound {
    /// Its middle, as far as the truth's middle is meant, in any direction, m.
    pub shift_m: f64,
    /// Either way, rad; 0 if it must not turn.
    pub turn_rad: f64,
}

/// Where a map agrees best with the truth: the world turns about `pivot_m` by `turn_rad` and then moves by `shift_m`, and the map with it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Alignment {
    /// The middle of the truth, m.
    pub pivot_m: [f64; 2],
    /// How far the map is moved, m.
    pub shift_m: [f64; 2],
    /// By how much it is turned, counter-clockwise, rad.
    pub turn_rad: f64,
    /// Whether it would have gone on beyond the bound.
    pub at_bound: bool,
}

impl Alignment {
    /// The frame of the map there.
    pub fn of(&self, map: &Frame) -> Frame {
        map.moved(self.pivot_m, self.shift_m, self.turn_rad)
    }
}

/// Finds the place within the bound at which a map agrees best with the truth: the greatest correlation, where both are known, of both smoothed
/// by a Gaussian of a cell.
///
/// From coarse cells to fine ones: a search over the bound at the coarsest, then steps of Gauss and Newton at each (Lucas and Kanade 1981). A map of
/// which nothing says where it lies, such as one without obstacles, stays.
///
/// # Errors
/// Memory that the system does not give.
pub fn align(
    (map, from): (&Raster<Option<f32>>, &Frame),
    (truth, onto): (&Raster<Option<bool>>, &Frame),
    bound: &AlignBound,
) -> Result<Alignment, NoMemory> {
    let pivot = onto.middle();
    let sides_m = sides(onto, from, bound);
    let mut places = vec![Place::default()];
    for (number, side_m) in sides_m.iter().enumerate() {
        let mut level = level(map, from, truth, onto, *side_m, bound.turn_rad > 0.0)?;
        if number == 0 {
            places = searched(&mut level, bound);
        }
        let mut found: Vec<(f64, Place)> =
            places.iter().filter_map(|place| settled(&mut level, *place, bound)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        // One of several is chosen where cells are finer by half.
        found.truncate(if number == 0 { STARTS } else { 1 });
        let best = found.first().map_or(f64::INFINITY, |found| found.0);
        places = found.into_iter().map(|(_, place)| place).collect();
        let stay = level.look(&Place::default());
        if places.is_empty() || number + 1 == sides_m.len() && stay.is_some_and(|stay| best > stay.error - GAIN) {
            places = vec![Place::default()];
        }
    }
    let Place { shift_m, turn_rad } = places[0];
    let near = |value: f64, limit: f64| limit > 0.0 && value.abs() > 0.999 * limit;
    let at_bound = near(libm::hypot(shift_m[0], shift_m[1]), bound.shift_m) || near(turn_rad, bound.turn_rad);
    Ok(Alignment { pivot_m: pivot, shift_m, turn_rad, at_bound })
}

/// Cell sizes from the coarsest to the finest, m.
fn sides(onto: &Frame, from: &Frame, bound: &AlignBound) -> Vec<f64> {
    let spec = &onto.spec;
    let most = (spec.cells() as f64 / FINEST as f64).sqrt().max(1.0);
    let finest = (spec.cell_m * most).max(from.spec.cell_m);
    let longest_m = spec.width.max(spec.height) as f64 * spec.cell_m;
    // No coarser than walls and rooms, unless the world is so large.
    let coarsest = (0.5 * bound.shift_m).max(longest_m / COARSEST).min(longest_m / 8.0).max(finest);
    let halvings = (coarsest / finest).log2().round() as i32;
    (0..=halvings).rev().map(|k| finest * libm::pow(2.0, f64::from(k))).collect()
}

fn level(
    map: &Raster<Option<f32>>,
    from: &Frame,
    truth: &Raster<Option<bool>>,
    onto: &Frame,
    side_m: f64,
    turns: bool,
) -> Result<Level, NoMemory> {
    let factor = |frame: &Frame| ((side_m / frame.spec.cell_m).round() as usize).max(1);
    let map = Field::of(map, from, factor(from), |share| *share)?;
    let state = |cell: &Option<bool>| cell.map(|occupied| f32::from(u8::from(occupied)));
    let truth = Field::of(truth, onto, factor(onto), state)?;
    Ok(Level::new(map, truth, onto.middle(), turns))
}

/// The best places of a net over the bound, a cell apart.
fn searched(level: &mut Level, bound: &AlignBound) -> Vec<Place> {
    let cell_m = level.cell_m();
    let steps = |reach_m: f64| (reach_m / cell_m).ceil() as i32;
    let (across, around) = (steps(bound.shift_m), steps(bound.turn_rad * level.radius_m()));
    let part = |k: i32, of: i32, reach: f64| if of == 0 { 0.0 } else { reach * f64::from(k) / f64::from(of) };
    let mut found = Vec::new();
    for turn in -around..=around {
        for (x, y) in (-across..=across).flat_map(|y| (-across..=across).map(move |x| (x, y))) {
            let shift_m = [part(x, across, bound.shift_m), part(y, across, bound.shift_m)];
            let place = Place { shift_m, turn_rad: part(turn, around, bound.turn_rad) };
            if libm::hypot(shift_m[0], shift_m[1]) <= bound.shift_m * (1.0 + 1e-9)
                && let Some(look) = level.look(&place)
            {
                found.push((look.error, place));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(STARTS);
    // Where the map is said to lie is never left out.
    found.into_iter().map(|(_, place)| place).chain([Place::default()]).collect()
}

/// Where steps from a place lead to, and the error there; `None` beside the truth. A step that leads to a worse place is halved.
fn settled(level: &mut Level, start: Place, bound: &AlignBound) -> Option<(f64, Place)> {
    let Look { mut error, next } = level.look(&start)?;
    let (mut best, mut next) = (start, within(next, bound));
    for _ in 0..STEPS {
        let moved = libm::hypot(next.shift_m[0] - best.shift_m[0], next.shift_m[1] - best.shift_m[1])
            + (next.turn_rad - best.turn_rad).abs() * level.radius_m();
        if moved < SHORT * level.cell_m() {
            break;
        }
        match level.look(&next) {
            Some(look) if look.error < error => (error, best, next) = (look.error, next, within(look.next, bound)),
            _ => next = halfway(&best, &next),
        }
    }
    Some((error, best))
}

fn halfway(a: &Place, b: &Place) -> Place {
    let middle = |a: f64, b: f64| 0.5 * (a + b);
    let shift_m = [0, 1].map(|k| middle(a.shift_m[k], b.shift_m[k]));
    Place { shift_m, turn_rad: middle(a.turn_rad, b.turn_rad) }
}

/// The nearest place within the bound.
fn within(place: Place, bound: &AlignBound) -> Place {
    let length = libm::hypot(place.shift_m[0], place.shift_m[1]);
    let by = if length > bound.shift_m { bound.shift_m / length } else { 1.0 };
    let turn_rad = place.turn_rad.clamp(-bound.turn_rad, bound.turn_rad);
    Place { shift_m: place.shift_m.map(|v| by * v), turn_rad }
}

/// Columns and rows of the truth by which a map should be moved, from where it is said to lie and up to a cell; `None` where nothing says so.
///
/// # Errors
/// Memory that the system does not give.
pub(crate) fn nudge(
    (map, from): (&Raster<Option<f32>>, &Frame),
    (truth, onto): (&Raster<Option<bool>>, &Frame),
) -> Result<Option<[f64; 2]>, NoMemory> {
    let side_m = onto.spec.cell_m.max(from.spec.cell_m);
    let mut level = level(map, from, truth, onto, side_m, false)?;
    let Some(stay) = level.look(&Place::default()) else { return Ok(None) };
    let bound = AlignBound { shift_m: side_m, turn_rad: 0.0 };
    let found = settled(&mut level, Place::default(), &bound).filter(|(error, _)| *error < stay.error - GAIN);
    let (sin, cos) = libm::sincos(-onto.yaw_rad);
    Ok(found.map(|(_, Place { shift_m: [x, y], .. })| {
        [cos * x - sin * y, sin * x + cos * y].map(|metres| metres / onto.spec.cell_m)
    }))
}
