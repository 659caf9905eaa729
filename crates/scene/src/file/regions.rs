//! `[[region]]`.

use strict::Table;

use super::bounds::within;
use super::findings::Findings;
use super::points::{LENGTH, ordered, point};
use super::route;
use crate::{Area, Region, SceneError};

/// Names that scoring gives to regions of its own.
const TAKEN: [&str; 6] = ["visible", "surface", "shell", "hidden", "observable", "all"];

pub(super) fn read(root: &Table, bounds: [[f64; 2]; 2], found: &mut Findings) -> Vec<Region> {
    let tables = found.take(root.list("region")).unwrap_or_default();
    let mut regions: Vec<Region> = Vec::new();
    let mut names: Vec<(String, usize)> = Vec::new();
    for table in &tables {
        found.only(table, &["name", "center", "radius", "min", "max", "claims"]);
        let name = found.take(table.name("name"));
        if let Some(name) = &name {
            found.take(free_name(table, name, &names));
            names.push((name.clone(), table.place().line));
        }
        let area = area(table, found);
        if let Some(area) = &area {
            let within = within(area.extent_m(), bounds, || table.element());
            found.take(within.map_err(|problem| SceneError::at(table.place(), problem)));
        }
        let claims = found.take(table.flag("claims"));
        if let (Some(name), Some(area), Some(claims)) = (name, area, claims) {
            regions.push(Region { name, area, claims });
        }
    }
    regions
}

/// Refuses the name of another region, or of one that scoring has.
fn free_name(table: &Table, name: &str, names: &[(String, usize)]) -> Result<(), SceneError> {
    if let Some((_, line)) = names.iter().find(|(other, _)| other == name) {
        return Err(route::duplicate(table, name.to_owned(), *line));
    }
    match table.get("name").filter(|_| TAKEN.contains(&name)) {
        Some(value) => {
            let bound = format!("none of {}", TAKEN.join(", "));
            Err(table.refuse("name", value, &bound, "scoring uses these for its own regions").into())
        }
        None => Ok(()),
    }
}

fn area(table: &Table, found: &mut Findings) -> Option<Area> {
    let has = |key| table.get(key).is_some();
    let disc = has("center") || has("radius");
    if disc && (has("min") || has("max")) {
        let key = if has("min") { "min" } else { "max" };
        let problem = strict::Problem::UnknownKey {
            element: table.element(),
            key: key.to_owned(),
            hint: " beside a disc".to_owned(),
            known: "center and radius for a disc, min and max for a rectangle".to_owned(),
        };
        found.add(strict::Error::Invalid { place: table.place_of(key), problem: Box::new(problem) });
        return None;
    }
    if disc {
        let center_m = found.take(point(table, "center"));
        let radius_m = found.take(table.number("radius", &LENGTH));
        return Some(Area::Disc { center_m: center_m?, radius_m: radius_m? });
    }
    if !has("min") && !has("max") {
        found.add(table.missing("center", "center and radius for a disc, or min and max for a rectangle"));
        return None;
    }
    let (min, max) = (found.take(point(table, "min")), found.take(point(table, "max")));
    let (min_m, max_m) = (min?, max?);
    found.take(ordered(table, "max", [min_m, max_m]))?;
    Some(Area::Rectangle { min_m, max_m })
}
