//! `[[wall]]`, `[[box]]`, `[[disc]]` and `[[polygon]]`.

use strict::{Error, Limit, Table};

use super::bounds::within;
use super::points::{LENGTH, METRES, point};
use super::polygon;
use crate::geometry::{distance, minus};
use crate::{Obstacle, Origin, SceneError, Shape};

const SIZE: Limit = Limit {
    min: 1e-6,
    max: METRES,
    bound: "two positive lengths in m, 0.000001 to 1000000",
    remedy: "give [width, height], both above 0",
};

const ROTATION: Limit = Limit {
    min: -360.0,
    max: 360.0,
    bound: "an angle in degrees, -360 to 360",
    remedy: "give it counter-clockwise from x",
};

const TEXTURE: Limit = Limit {
    min: 0.0,
    max: 1.0,
    bound: "a number from 0 to 1",
    remedy: "1 is a surface full of edges, 0 one that gives no reading",
};

type Read = fn(&Table) -> Result<Shape, SceneError>;

/// Every obstacle of the file, walls first.
pub(super) fn read(root: &Table, bounds: [[f64; 2]; 2]) -> Result<Vec<Obstacle>, SceneError> {
    let kinds: [(&'static str, Read); 4] = [("wall", wall), ("box", rectangle), ("disc", disc), ("polygon", outline)];
    let mut obstacles = Vec::new();
    for (kind, shape) in kinds {
        for (k, table) in root.list(kind)?.iter().enumerate() {
            let shape = shape(table)?;
            let texture = texture(table)?;
            within(shape.extent_m(), bounds, || table.element()).map_err(|p| SceneError::at(table.place(), p))?;
            obstacles.push(Obstacle {
                shape,
                texture,
                origin: Origin { kind, number: k + 1, line: table.place().line },
            });
        }
    }
    Ok(obstacles)
}

pub(super) fn texture(table: &Table) -> Result<f64, Error> {
    Ok(table.optional_number("texture", &TEXTURE)?.unwrap_or(1.0))
}

/// A wall reaches half its thickness beyond its ends: walls that meet in a point close the corner.
fn wall(table: &Table) -> Result<Shape, SceneError> {
    table.only(&["from", "to", "thickness", "texture"])?;
    let (from, to) = (point(table, "from")?, point(table, "to")?);
    let half = 0.5 * table.number("thickness", &LENGTH)?;
    let length = distance(from, to);
    if length < LENGTH.min {
        let value = table.get("to").ok_or_else(|| table.missing("to", "the wall's other end"))?;
        return Err(table
            .refuse("to", value, "apart from `from`, by at least 0.000001 m", "give the wall's other end")
            .into());
    }
    let center_m = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    Ok(Shape::Box { center_m, half_m: [0.5 * length + half, half], axis: minus(to, from).map(|v| v / length) })
}

fn rectangle(table: &Table) -> Result<Shape, SceneError> {
    table.only(&["center", "size", "rotation_deg", "texture"])?;
    let center_m = point(table, "center")?;
    let half_m = table.required_pair("size", &SIZE)?.map(|s| 0.5 * s);
    let degrees = table.optional_number("rotation_deg", &ROTATION)?.unwrap_or(0.0);
    let (sin, cos) = libm::sincos(degrees.to_radians());
    Ok(Shape::Box { center_m, half_m, axis: [cos, sin] })
}

fn disc(table: &Table) -> Result<Shape, SceneError> {
    table.only(&["center", "radius", "texture"])?;
    Ok(Shape::Disc { center_m: point(table, "center")?, radius_m: table.number("radius", &LENGTH)? })
}

fn outline(table: &Table) -> Result<Shape, SceneError> {
    table.only(&["points", "texture"])?;
    Ok(Shape::Polygon { points_m: polygon::points(table)? })
}
