//! A family file: `[generate]`, and the tables that its scenes take over.

use std::path::Path;

use strict::{Error, Limit, Table, open};

use super::limits::{CLEARANCE, COVERED, OBSTACLE, OPENING, SHARE, SIDE, SPREAD, THICKNESS};
use super::{camera, cells};
use crate::generate::{Kind, Plan};
use crate::{Family, SceneError};

const KEYS: [&str; 7] = ["name", "description", "generate", "grid", "camera", "sensor", "robot"];

/// Tables of a scene that a family gives to each of its own.
const CARRIED: [&str; 4] = ["grid", "camera", "sensor", "robot"];

/// Longest name: with a hyphen and a layout number of up to 20 digits it is a scene's name of 32.
const LONGEST_NAME: usize = 11;

const COMMON: [&str; 10] = [
    "kind",
    "width",
    "height",
    "obstacle_size",
    "obstacle_spread",
    "covered",
    "discs",
    "along_walls",
    "clearance",
    "wall_thickness",
];

/// Whether a text is a family file rather than a scene's.
pub(crate) fn is_family(text: &str) -> bool {
    open(text, "").is_ok_and(|(_, document)| document.get_ref().get("generate").is_some())
}

impl Family {
    /// Reads and checks the family file at `path`.
    ///
    /// # Errors
    /// A file that cannot be read, and the first problem with its content.
    pub fn load(path: &Path) -> Result<Self, SceneError> {
        Self::parse(&strict::read(path)?, path)
    }

    /// Checks the family that `text` describes; `path` is named in messages.
    ///
    /// # Errors
    /// The first problem with the text.
    pub fn parse(text: &str, path: &Path) -> Result<Self, SceneError> {
        let file = path.display().to_string();
        let (source, document) = open(text, &file)?;
        checked(&Table::new(&source, "the family", 0, document.get_ref()), path)
    }
}

/// Checks a family file's table.
fn checked(root: &Table, path: &Path) -> Result<Family, SceneError> {
    root.only(&KEYS)?;
    let name = root.name("name")?;
    if let Some(value) = root.get("name").filter(|_| name.len() > LONGEST_NAME) {
        let bound = format!("at most {LONGEST_NAME} characters");
        return Err(root.refuse("name", value, &bound, "the number of the layout is added to it").into());
    }
    let description = root.text("description")?.unwrap_or_default();
    let Some(table) = root.section("generate")? else {
        return Err(root.missing("[generate]", "[generate] with kind = \"clutter\" and sizes").into());
    };
    let plan = plan(&table)?;
    cells::read(root, [[0.0; 2], plan.size_m.map(|[_, most]| most)], None, cells::DEFAULT_M)?;
    camera::camera(root)?;
    camera::matcher(root)?;
    let robot_radius_m = camera::robot(root)?.radius_m;
    let mut carried = Vec::new();
    for section in CARRIED {
        if let Some(table) = root.section(section)? {
            carried.push((section, table.verbatim()));
        }
    }
    let place = root.place_of("generate");
    Ok(Family { name, description, plan, robot_radius_m, carried, path: path.to_owned(), place })
}

fn plan(table: &Table) -> Result<Plan, Error> {
    let kinds = "\"clutter\", \"corridor\", \"hall\" or \"two-rooms\"";
    let Some(kind) = table.get("kind") else { return Err(table.missing("kind", &format!("`kind = ...`, {kinds}"))) };
    let openings: &[&str] = match kind.get_ref().as_str() {
        Some("clutter" | "hall") => &[],
        Some("corridor") => &["passage", "door"],
        Some("two-rooms") => &["door"],
        _ => return Err(table.refuse("kind", kind, kinds, "name the kind of place")),
    };
    table.only(&[&COMMON, openings].concat())?;
    let or = |key, limit: &Limit, default| Ok::<_, Error>(table.optional_number(key, limit)?.unwrap_or(default));
    let size_m = [range(table, "width", &SIDE)?, range(table, "height", &SIDE)?];
    let kind = match kind.get_ref().as_str() {
        Some("corridor") => Kind::Corridor {
            passage_m: within(table, "passage", size_m[1][0])?,
            door_m: range(table, "door", &OPENING)?,
        },
        Some("two-rooms") => Kind::TwoRooms { door_m: within(table, "door", size_m[1][0])? },
        Some("hall") => Kind::Hall,
        _ => Kind::Clutter,
    };
    Ok(Plan {
        kind,
        size_m,
        obstacle_m: table.number("obstacle_size", &OBSTACLE)?,
        spread: or("obstacle_spread", &SPREAD, 0.5)?,
        covered: table.number("covered", &COVERED)?,
        discs: or("discs", &SHARE, 0.25)?,
        along_walls: or("along_walls", &SHARE, 0.3)?,
        clearance_m: or("clearance", &CLEARANCE, 0.1)?,
        wall_m: or("wall_thickness", &THICKNESS, 0.1)?,
    })
}

/// Two numbers, the least first.
fn range(table: &Table, key: &str, limit: &Limit) -> Result<[f64; 2], Error> {
    let [least, most] = table.required_pair(key, limit)?;
    match table.get(key) {
        Some(value) if least > most => Err(table.refuse(key, value, limit.bound, limit.remedy)),
        _ => Ok([least, most]),
    }
}

/// Widths of an opening in a place that is at least `height_m` high: what would be wider than the place is refused.
fn within(table: &Table, key: &str, height_m: f64) -> Result<[f64; 2], Error> {
    let [least, most] = range(table, key, &OPENING)?;
    match table.get(key) {
        Some(value) if most >= height_m => {
            let bound = format!("less than the least height of the place, {height_m} m");
            Err(table.refuse(key, value, &bound, "make it narrower, or the place higher"))
        }
        _ => Ok([least, most]),
    }
}

#[cfg(test)]
mod tests;
