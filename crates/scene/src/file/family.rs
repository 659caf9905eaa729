//! A family file: `[generate]`, and the tables that its scenes take over.

use std::path::Path;

use strict::{Error, Limit, Table, open};

use super::findings::Findings;
use super::limits::{CLEARANCE, COVERED, OBSTACLE, OPENING, PACE, PEOPLE, SHARE, SIDE, SPREAD, THICKNESS};
use super::{camera, cells, odometry, sensors};
use crate::generate::people::PEOPLE_M_S;
use crate::generate::{Kind, Plan};
use crate::{Family, SceneError};

const KEYS: [&str; 8] = ["name", "description", "generate", "grid", "camera", "sensor", "robot", "odometry"];

/// Tables of a scene that a family gives to each of its own.
const CARRIED: [&str; 5] = ["grid", "camera", "sensor", "robot", "odometry"];

/// Longest name: with a hyphen and a layout number of up to 20 digits it is a scene's name of 32.
const LONGEST_NAME: usize = 11;

const COMMON: [&str; 12] = [
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
    "people_per_100_m2",
    "people_speed_m_s",
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
        Self::examine(text, path).map_err(strict::first)
    }

    /// As [`parse`](Self::parse), for those who would rather mend all of a file at once.
    ///
    /// # Errors
    /// Every problem with the text, at least one; not what would only follow from another.
    pub fn examine(text: &str, path: &Path) -> Result<Self, Vec<SceneError>> {
        let file = path.display().to_string();
        let (source, document) = open(text, &file).map_err(|error| vec![error.into()])?;
        let mut found = Findings::default();
        let family = checked(&Table::new(&source, "the family", 0, document.get_ref()), path, &mut found);
        found.or(family)
    }
}

/// Checks a family file's table.
fn checked(root: &Table, path: &Path, found: &mut Findings) -> Option<Family> {
    found.only(root, &KEYS);
    let name = found.take(root.name("name"));
    if let Some(value) = root.get("name").filter(|_| name.as_ref().is_some_and(|name| name.len() > LONGEST_NAME)) {
        let bound = format!("at most {LONGEST_NAME} characters");
        found.add(root.refuse("name", value, &bound, "the number of the layout is added to it"));
    }
    let description = found.take(root.text("description")).flatten().unwrap_or_default();
    let section = found.take(root.section("generate"));
    if let Some(None) = section {
        found.add(root.missing("[generate]", "[generate] with kind = \"clutter\" and sizes"));
    }
    let plan = section.flatten().and_then(|table| plan(&table, found));
    let bounds = plan.as_ref().map(|plan| [[0.0; 2], plan.size_m.map(|[_, most]| most)]);
    cells::read(root, bounds, None, cells::DEFAULT_M, found);
    camera::camera(root, found);
    camera::matcher(root, found);
    odometry::read(root, found);
    let robot_radius_m = camera::robot(root, found).radius_m;
    sensors::read(root, robot_radius_m, found);
    let carried = carried(root);
    let place = root.place_of("generate");
    Some(Family { name: name?, description, plan: plan?, robot_radius_m, carried, path: path.to_owned(), place })
}

/// The tables that scenes take over, each with its heading.
fn carried(root: &Table) -> Vec<(String, Vec<(String, String)>)> {
    let tables = CARRIED.iter().flat_map(|section| {
        let one = root.section(section).ok().flatten().map(|table| (format!("[{section}]"), table.verbatim()));
        let several = root.list(section).unwrap_or_default();
        one.into_iter().chain(several.into_iter().map(move |table| (format!("[[{section}]]"), table.verbatim())))
    });
    tables.collect()
}

fn plan(table: &Table, found: &mut Findings) -> Option<Plan> {
    let kinds = "\"clutter\", \"corridor\", \"hall\" or \"two-rooms\"";
    let Some(kind) = table.get("kind") else {
        found.add(table.missing("kind", &format!("`kind = ...`, {kinds}")));
        return None;
    };
    let openings: &[&str] = match kind.get_ref().as_str() {
        Some("clutter" | "hall") => &[],
        Some("corridor") => &["passage", "door"],
        Some("two-rooms") => &["door"],
        _ => {
            found.add(table.refuse("kind", kind, kinds, "name the kind of place"));
            return None;
        }
    };
    found.only(table, &[&COMMON, openings].concat());
    let (width, height) = (found.take(range(table, "width", &SIDE)), found.take(range(table, "height", &SIDE)));
    let least = height.map_or(f64::INFINITY, |[least, _]| least);
    let kind = match kind.get_ref().as_str() {
        Some("corridor") => {
            let passage = found.take(within(table, "passage", least));
            let door = found.take(range(table, "door", &OPENING));
            passage.zip(door).map(|(passage_m, door_m)| Kind::Corridor { passage_m, door_m })
        }
        Some("two-rooms") => found.take(within(table, "door", least)).map(|door_m| Kind::TwoRooms { door_m }),
        Some("hall") => Some(Kind::Hall),
        _ => Some(Kind::Clutter),
    };
    let obstacle_m = found.take(table.number("obstacle_size", &OBSTACLE));
    let mut or =
        |key, limit: &Limit, default| found.take(table.optional_number(key, limit)).flatten().unwrap_or(default);
    let spread = or("obstacle_spread", &SPREAD, 0.5);
    let [discs, along_walls] = [or("discs", &SHARE, 0.25), or("along_walls", &SHARE, 0.3)];
    let [clearance_m, wall_m] = [or("clearance", &CLEARANCE, 0.1), or("wall_thickness", &THICKNESS, 0.1)];
    let covered = found.take(table.number("covered", &COVERED));
    let people_per_100_m2 = match table.get("people_per_100_m2") {
        None => None,
        Some(_) => found.take(range(table, "people_per_100_m2", &PEOPLE)),
    };
    let people_m_s = match table.get("people_speed_m_s") {
        None => Some(PEOPLE_M_S),
        Some(_) => found.take(range(table, "people_speed_m_s", &PACE)),
    };
    Some(Plan {
        kind: kind?,
        size_m: [width?, height?],
        obstacle_m: obstacle_m?,
        spread,
        covered: covered?,
        discs,
        along_walls,
        clearance_m,
        wall_m,
        people_per_100_m2,
        people_m_s: people_m_s?,
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
