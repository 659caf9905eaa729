//! `[[chair]]`: what stands elsewhere later.

use strict::{Error, Table};

use super::doors::stage;
use super::findings::Findings;
use super::limits::{ANGLE, MOMENT};
use super::movers::few;
use super::obstacles::{disc, rectangle, texture};
use super::points::point;
use crate::{Chair, ChairMove, Due, Origin, SceneError, Shape, StagePlan};

const KEYS: [&str; 6] = ["center", "size", "radius", "rotation_deg", "moves", "texture"];

/// More moves of one chair than this are refused.
const MOST_MOVES: usize = 1000;

/// Every chair of the file.
pub(super) fn read(root: &Table, stages: &[StagePlan], found: &mut Findings) -> Vec<Chair> {
    let tables = found.take(few(root, "chair")).unwrap_or_default();
    let chairs = tables.iter().enumerate().map(|(k, table)| chair(table, k + 1, stages, found));
    chairs.collect::<Vec<_>>().into_iter().flatten().collect()
}

fn chair(table: &Table, number: usize, stages: &[StagePlan], found: &mut Findings) -> Option<Chair> {
    found.only(table, &KEYS);
    let shape = shape(table, found);
    let texture = found.take(texture(table));
    let moves = moves(table, stages, shape.as_ref(), found);
    let origin = Origin { kind: "chair", number, line: table.place().line };
    Some(Chair { shape: shape?, moves: moves?, texture: texture?, origin })
}

/// A rectangle with a size, or a disc with a radius.
fn shape(table: &Table, found: &mut Findings) -> Option<Shape> {
    let round = table.get("radius").is_some();
    for key in ["size", "rotation_deg"] {
        if let Some(value) = table.get(key).filter(|_| round) {
            let remedy = "a chair is a disc with a radius or a box with a size and a rotation";
            found.add(table.refuse(key, value, "left out beside `radius`", remedy));
            return None;
        }
    }
    if round { disc(table, found) } else { rectangle(table, found) }
}

/// `moves`: where it stands later.
fn moves(table: &Table, stages: &[StagePlan], first: Option<&Shape>, found: &mut Findings) -> Option<Vec<ChairMove>> {
    const KEY: &str = "moves";
    const EXAMPLE: &str = "[{ at_s = 30.0, to_m = [1.0, 2.0], turn_deg = 20.0 }]";
    let Some(value) = table.get(KEY) else {
        found.add(table.missing(KEY, &format!("`moves = {EXAMPLE}`; what never moves is a [[box]] or [[disc]]")));
        return None;
    };
    let items = value.get_ref().as_array().filter(|items| (1..=MOST_MOVES).contains(&items.len()));
    let Some(items) = items else {
        let bound = format!("a list of 1 to {MOST_MOVES} moves");
        found.add(table.refuse(KEY, value, &bound, &format!("write it like {EXAMPLE}")));
        return None;
    };
    let (before, mut moves): (usize, Vec<ChairMove>) = (found.count(), Vec::new());
    let mut shape = first.cloned();
    for (k, item) in items.iter().enumerate() {
        let Some(entries) = item.get_ref().as_table() else {
            let bound = "a table such as { at_s = 30.0, to_m = [1.0, 2.0] }";
            found.add(table.refuse(&format!("move {}", k + 1), item, bound, "write a table in braces"));
            continue;
        };
        let element = format!("{}, move {}", table.element(), k + 1);
        let entry = Table::new(table.source(), &element, item.span().start, entries);
        found.only(&entry, &["at_s", "after_stage", "to_m", "turn_deg"]);
        let due = found.take(due(&entry, stages, moves.last().map(|last| last.due)));
        let to_m = found.take(point(&entry, "to_m"));
        let turn_deg = found.take(entry.optional_number("turn_deg", &ANGLE));
        let (Some(due), Some(to_m), Some(turn_deg), Some(from)) = (due, to_m, turn_deg, &shape) else { continue };
        let placed = placed(from, to_m, turn_deg.unwrap_or(0.0));
        shape = Some(placed.clone());
        moves.push(ChairMove { due, shape: placed });
    }
    (found.count() == before && first.is_some()).then_some(moves)
}

/// When a move is due: after the one before it, `last`, and before the drive ends.
fn due(table: &Table, stages: &[StagePlan], last: Option<Due>) -> Result<Due, SceneError> {
    if let (Some(_), Some(value)) = (table.get("at_s"), table.get("after_stage")) {
        let remedy = "a move is due at a time or after a stage; take one of them out";
        return Err(table.refuse("after_stage", value, "left out beside at_s", remedy).into());
    }
    let Some(value) = table.get("after_stage") else {
        let at_s = table.number("at_s", &MOMENT)?;
        return match (last, table.get("at_s")) {
            (Some(Due::At(last_s)), Some(value)) if at_s <= last_s => {
                let bound = format!("later than the move before it, at {last_s} s");
                Err(table.refuse("at_s", value, &bound, "put the moves in the order of their times").into())
            }
            _ => Ok(Due::At(at_s)),
        };
    };
    let refused = |bound: &str, remedy: &str| -> Error { table.refuse("after_stage", value, bound, remedy) };
    let name = value.get_ref().as_str().ok_or_else(|| refused("the name of a stage", "write it in quotes"))?;
    let number = stage(table, stages, name, value.span().start)?;
    if number + 1 == stages.len() {
        return Err(refused("a stage after which the robot drives on", "the drive ends with the last stage").into());
    }
    match last {
        Some(Due::AfterStage(last)) if number <= last => {
            let bound = format!("a later stage than that of the move before it, \"{}\"", stages[last].name);
            Err(refused(&bound, "put the moves in the order of the stages").into())
        }
        _ => Ok(Due::AfterStage(number)),
    }
}

/// The shape with its middle at `to_m`, turned by so many degrees.
fn placed(shape: &Shape, to_m: [f64; 2], turn_deg: f64) -> Shape {
    match shape {
        Shape::Box { half_m, axis: [c, s], .. } => {
            let (sin, cos) = libm::sincos(turn_deg.to_radians());
            Shape::Box { center_m: to_m, half_m: *half_m, axis: [c * cos - s * sin, s * cos + c * sin] }
        }
        Shape::Disc { radius_m, .. } => Shape::Disc { center_m: to_m, radius_m: *radius_m },
        other @ Shape::Polygon { .. } => other.clone(),
    }
}
