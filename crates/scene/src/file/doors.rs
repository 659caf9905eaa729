//! `[[door]]`: a leaf that turns about its hinge.

use strict::{Error, LONGEST_VALUE, Table, excerpt, hint, number};

use super::findings::Findings;
use super::limits::{ANGLE, LEAF, LEAF_THICKNESS, PERIOD, PROBABILITY, SWING};
use super::movers::few;
use super::obstacles::texture;
use super::points::point;
use crate::{Door, Opening, Origin, Problem, SceneError, StagePlan};

const KEYS: [&str; 11] = [
    "hinge",
    "length",
    "thickness",
    "closed_deg",
    "open_deg",
    "swing_s",
    "open_s",
    "open_during",
    "period_s",
    "open_chance",
    "texture",
];

const THICKNESS_M: f64 = 0.04;
const SWING_S: f64 = 2.0;

/// The least and the widest angle between shut and open, degrees.
const SWEEP_DEG: [f64; 2] = [1.0, 350.0];

/// Every door of the file.
pub(super) fn read(root: &Table, stages: &[StagePlan], found: &mut Findings) -> Vec<Door> {
    let tables = found.take(few(root, "door")).unwrap_or_default();
    let doors = tables.iter().enumerate().map(|(k, table)| door(table, k + 1, stages, found));
    doors.collect::<Vec<_>>().into_iter().flatten().collect()
}

fn door(table: &Table, number: usize, stages: &[StagePlan], found: &mut Findings) -> Option<Door> {
    found.only(table, &KEYS);
    let hinge_m = found.take(point(table, "hinge"));
    let length_m = found.take(table.number("length", &LEAF));
    let thickness_m = found.take(table.optional_number("thickness", &LEAF_THICKNESS));
    let closed_deg = found.take(table.number("closed_deg", &ANGLE));
    let open_deg = found.take(table.number("open_deg", &ANGLE));
    let swing_s = found.take(table.optional_number("swing_s", &SWING));
    let (opening, texture) = (opening(table, stages, found), found.take(texture(table)));
    let (closed_deg, open_deg) = (closed_deg?, open_deg?);
    let sweep_deg = (open_deg - closed_deg).abs();
    if let Some(value) = table.get("open_deg").filter(|_| !(SWEEP_DEG[0]..=SWEEP_DEG[1]).contains(&sweep_deg)) {
        let bound = format!("{} to {} degrees from closed_deg = {closed_deg}", SWEEP_DEG[0], SWEEP_DEG[1]);
        found.add(table.refuse("open_deg", value, &bound, "the leaf turns from closed_deg to open_deg"));
        return None;
    }
    Some(Door {
        hinge_m: hinge_m?,
        length_m: length_m?,
        thickness_m: thickness_m?.unwrap_or(THICKNESS_M),
        closed_rad: closed_deg.to_radians(),
        open_rad: open_deg.to_radians(),
        swing_s: swing_s?.unwrap_or(SWING_S),
        opening: opening?,
        texture: texture?,
        origin: Origin { kind: "door", number, line: table.place().line },
    })
}

/// When it is open: by exactly one of three ways to say so.
fn opening(table: &Table, stages: &[StagePlan], found: &mut Findings) -> Option<Opening> {
    let way = |key: &&str| table.get(key).is_some();
    let given: Vec<&str> = ["open_s", "open_during", "period_s", "open_chance"].into_iter().filter(way).collect();
    match given[..] {
        ["open_s"] => found.take(times(table)).map(Opening::Times),
        ["open_during"] => during(table, stages, found).map(Opening::Stages),
        ["period_s" | "open_chance", ..] if !given.contains(&"open_s") && !given.contains(&"open_during") => {
            let period_s = found.take(table.number("period_s", &PERIOD));
            let chance = found.take(table.number("open_chance", &PROBABILITY));
            Some(Opening::Chance { period_s: period_s?, chance: chance? })
        }
        [] => {
            let example = "`open_s = [[10.0, 20.0]]`, open_during = [\"STAGE\"], or period_s and open_chance";
            found.add(table.missing("open_s", example));
            None
        }
        [first, second, ..] => {
            let value = table.get(second)?;
            let remedy = "a door has times of being open, stages, or a chance in every period";
            found.add(table.refuse(second, value, &format!("left out beside {first}"), remedy));
            None
        }
        [_] => None,
    }
}

/// `open_s`: pairs of times, in order.
fn times(table: &Table) -> Result<Vec<[f64; 2]>, Error> {
    const KEY: &str = "open_s";
    const BOUND: &str = "a list of pairs [from, to] in s, 0 to 1000000, each after the one before";
    let value = table.get(KEY).ok_or_else(|| table.missing(KEY, "a list of times"))?;
    let remedy = "write it like [[10.0, 20.0], [45.0, 60.0]], or [] for a door that stays shut";
    let items = value.get_ref().as_array().ok_or_else(|| table.refuse(KEY, value, BOUND, remedy))?;
    let (mut times, mut last_s) = (Vec::with_capacity(items.len()), 0.0);
    for item in items {
        let refused = || table.refuse(KEY, item, BOUND, remedy);
        let ends = item.get_ref().as_array().filter(|ends| ends.len() == 2).ok_or_else(refused)?;
        let (Some(from), Some(to)) = (number(&ends[0]), number(&ends[1])) else { return Err(refused()) };
        if !(last_s <= from && from < to && to <= 1e6) {
            return Err(refused());
        }
        times.push([from, to]);
        last_s = to;
    }
    Ok(times)
}

/// `open_during`: names of stages.
fn during(table: &Table, stages: &[StagePlan], found: &mut Findings) -> Option<Vec<usize>> {
    let names = found.take(table.strings("open_during", "names of stages", "[\"a\"]"))?;
    let before = found.count();
    let open: Vec<usize> =
        names.iter().filter_map(|(name, value)| found.take(stage(table, stages, name, value.span().start))).collect();
    (found.count() == before).then_some(open)
}

/// The stage of a name.
pub(super) fn stage(table: &Table, stages: &[StagePlan], name: &str, at: usize) -> Result<usize, SceneError> {
    stages.iter().position(|stage| stage.name == name).ok_or_else(|| {
        let known: Vec<&str> = stages.iter().map(|stage| stage.name.as_str()).collect();
        let problem = Problem::UnknownStage {
            element: table.element(),
            name: excerpt(name, LONGEST_VALUE),
            hint: hint(name, &known),
            known: super::route::listed(&known),
        };
        SceneError::at(table.source().place(at), problem)
    })
}
