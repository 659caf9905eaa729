//! `[[region]]`.

use strict::Table;

use super::bounds::within;
use super::points::{LENGTH, ordered, point};
use super::route;
use crate::{Area, Region, SceneError};

/// Names that scoring gives to regions of its own.
const TAKEN: [&str; 6] = ["visible", "surface", "shell", "hidden", "observable", "all"];

pub(super) fn read(root: &Table, bounds: [[f64; 2]; 2]) -> Result<Vec<Region>, SceneError> {
    let tables = root.list("region")?;
    let mut regions: Vec<Region> = Vec::new();
    for table in &tables {
        table.only(&["name", "center", "radius", "min", "max", "claims"])?;
        let name = table.name("name")?;
        if let Some(first) = regions.iter().position(|r| r.name == name) {
            return Err(route::duplicate(table, name, tables[first].place().line));
        }
        if let Some(value) = table.get("name").filter(|_| TAKEN.contains(&name.as_str())) {
            let bound = format!("none of {}", TAKEN.join(", "));
            return Err(table.refuse("name", value, &bound, "scoring uses these for its own regions").into());
        }
        let area = area(table)?;
        within(area.extent_m(), bounds, || table.element()).map_err(|p| SceneError::at(table.place(), p))?;
        let claims = table.flag("claims")?;
        regions.push(Region { name, area, claims });
    }
    Ok(regions)
}

fn area(table: &Table) -> Result<Area, strict::Error> {
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
        return Err(strict::Error::Invalid { place: table.place_of(key), problem: Box::new(problem) });
    }
    if disc {
        return Ok(Area::Disc { center_m: point(table, "center")?, radius_m: table.number("radius", &LENGTH)? });
    }
    if !has("min") && !has("max") {
        return Err(table.missing("center", "center and radius for a disc, or min and max for a rectangle"));
    }
    let (min_m, max_m) = (point(table, "min")?, point(table, "max")?);
    ordered(table, "max", [min_m, max_m])?;
    Ok(Area::Rectangle { min_m, max_m })
}
