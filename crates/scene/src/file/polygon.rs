//! `points` of a polygon: a simple outline, turned counter-clockwise.

use strict::Table;

use crate::geometry::{crossing, distance, signed_area};
use crate::{Problem, SceneError};

use super::points::POINT;

/// Sides are checked pair by pair, and rays try every side.
const MOST_POINTS: usize = 1000;

/// Points nearer than this are taken for the same one, m.
const SMALLEST_M: f64 = 1e-6;

pub(super) fn points(table: &Table) -> Result<Vec<[f64; 2]>, SceneError> {
    const KEY: &str = "points";
    let example = "`points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]`, the corners in order";
    let value = table.get(KEY).ok_or_else(|| table.missing(KEY, example))?;
    let bound = "a list of 3 to 1000 points [x, y] in m";
    let items = value.get_ref().as_array().filter(|items| (3..=MOST_POINTS).contains(&items.len()));
    let items =
        items.ok_or_else(|| table.refuse(KEY, value, bound, "list the corners in order, the first only once"))?;
    let mut points = Vec::with_capacity(items.len());
    for (k, item) in items.iter().enumerate() {
        points.push(table.pair(&format!("point {}", k + 1), item, &POINT)?);
    }
    for (k, item) in items.iter().enumerate() {
        let next = (k + 1) % points.len();
        if distance(points[k], points[next]) < SMALLEST_M {
            let bound = format!("apart from point {}, by at least 0.000001 m", next + 1);
            return Err(table.refuse(&format!("point {}", k + 1), item, &bound, "list every corner once").into());
        }
    }
    if let Some((first, second)) = crossing(&points) {
        let at = items[second].span().start;
        let problem = Problem::Crossing { element: table.element(), first: first + 1, second: second + 1 };
        return Err(SceneError::at(table.source().place(at), problem));
    }
    let area = signed_area(&points);
    if area < 0.0 {
        points.reverse();
    }
    if area.abs() < SMALLEST_M * SMALLEST_M {
        return Err(table
            .refuse(KEY, value, "the corners of a polygon with an area", "the points lie on one line")
            .into());
    }
    Ok(points)
}
