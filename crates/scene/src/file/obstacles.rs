//! `[[wall]]`, `[[box]]`, `[[disc]]` and `[[polygon]]`.

use sensor::SensorKind;
use strict::{Error, Limit, Table};

use super::bounds::within;
use super::findings::Findings;
use super::limits::SHARE;
use super::points::{LENGTH, METRES, point};
use super::polygon;
use crate::geometry::{distance, minus};
use crate::{Obstacle, Origin, SceneError, SeenBy, Shape};

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

type Read = fn(&Table, &mut Findings) -> Option<Shape>;

/// Every obstacle of the file, walls first.
pub(super) fn read(root: &Table, bounds: [[f64; 2]; 2], found: &mut Findings) -> Vec<Obstacle> {
    let kinds: [(&'static str, Read); 4] = [("wall", wall), ("box", upright), ("disc", round), ("polygon", outline)];
    let mut obstacles = Vec::new();
    for (kind, shape) in kinds {
        for (k, table) in found.take(root.list(kind)).unwrap_or_default().iter().enumerate() {
            let shape = shape(table, found);
            let texture = found.take(texture(table));
            let seen_by = seen_by(table, found);
            let (Some(shape), Some(texture)) = (shape, texture) else { continue };
            let within = within(shape.extent_m(), bounds, || table.element());
            found.take(within.map_err(|problem| SceneError::at(table.place(), problem)));
            let origin = Origin { kind, number: k + 1, line: table.place().line };
            obstacles.push(Obstacle { shape, texture, seen_by, origin });
        }
    }
    obstacles
}

pub(super) fn texture(table: &Table) -> Result<f64, Error> {
    Ok(table.optional_number("texture", &TEXTURE)?.unwrap_or(1.0))
}

/// `seen_by = { laser = 0.2 }`: shares of the readings that end on the obstacle, 1 of the kinds that are not named.
fn seen_by(table: &Table, found: &mut Findings) -> SeenBy {
    let mut seen_by = SeenBy::ALL;
    let Some(value) = table.get("seen_by") else { return seen_by };
    let Some(shares) = value.get_ref().as_table() else {
        let bound = "a table of shares by kind of sensor";
        found.add(table.refuse("seen_by", value, bound, "write it like { laser = 0.2, stereo = 0.0 }"));
        return seen_by;
    };
    let element = format!("{}: seen_by", table.element());
    let shares = Table::new(table.source(), &element, value.span().start, shares);
    found.only(&shares, &SensorKind::ALL.map(SensorKind::name));
    for kind in SensorKind::ALL {
        let share = found.take(shares.optional_number(kind.name(), &SHARE)).flatten();
        seen_by = share.map_or(seen_by, |share| seen_by.with(kind, share));
    }
    seen_by
}

/// A wall reaches half its thickness beyond its ends: walls that meet in a point close the corner.
fn wall(table: &Table, found: &mut Findings) -> Option<Shape> {
    found.only(table, &["from", "to", "thickness", "texture", "seen_by"]);
    let (from, to) = (found.take(point(table, "from")), found.take(point(table, "to")));
    let thickness = found.take(table.number("thickness", &LENGTH));
    let (from, to, half) = (from?, to?, 0.5 * thickness?);
    let length = distance(from, to);
    if length < LENGTH.min {
        let value = table.get("to")?;
        let bound = "apart from `from`, by at least 0.000001 m";
        found.add(table.refuse("to", value, bound, "give the wall's other end"));
        return None;
    }
    let center_m = [0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])];
    Some(Shape::Box { center_m, half_m: [0.5 * length + half, half], axis: minus(to, from).map(|v| v / length) })
}

fn upright(table: &Table, found: &mut Findings) -> Option<Shape> {
    found.only(table, &["center", "size", "rotation_deg", "texture", "seen_by"]);
    rectangle(table, found)
}

/// A rectangle from its middle, size and rotation.
pub(super) fn rectangle(table: &Table, found: &mut Findings) -> Option<Shape> {
    let center_m = found.take(point(table, "center"));
    let size = found.take(table.required_pair("size", &SIZE));
    let degrees = found.take(table.optional_number("rotation_deg", &ROTATION));
    let (sin, cos) = libm::sincos(degrees?.unwrap_or(0.0).to_radians());
    Some(Shape::Box { center_m: center_m?, half_m: size?.map(|s| 0.5 * s), axis: [cos, sin] })
}

fn round(table: &Table, found: &mut Findings) -> Option<Shape> {
    found.only(table, &["center", "radius", "texture", "seen_by"]);
    disc(table, found)
}

/// A disc from its middle and radius.
pub(super) fn disc(table: &Table, found: &mut Findings) -> Option<Shape> {
    let center_m = found.take(point(table, "center"));
    let radius_m = found.take(table.number("radius", &LENGTH));
    Some(Shape::Disc { center_m: center_m?, radius_m: radius_m? })
}

fn outline(table: &Table, found: &mut Findings) -> Option<Shape> {
    found.only(table, &["points", "texture", "seen_by"]);
    found.take(polygon::points(table)).map(|points_m| Shape::Polygon { points_m })
}
