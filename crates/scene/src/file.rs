//! From a scene file to a [`Scene`]: the one door at which everything is checked.

pub(crate) mod camera;
pub(crate) mod edit;
mod family;
mod fit;
pub mod limits;
mod map;
mod obstacles;
pub(crate) mod plan;
mod polygon;
mod regions;
mod route;
pub(crate) mod table;

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use grid::excerpt::{LONGEST_REPORT, excerpt};
use toml::Spanned;
use toml::de::DeTable;

pub(crate) use family::{is_family, parse_family};

use crate::{Place, Problem, Scene, SceneError};
use table::{Limit, METRES, Source, Table};

/// No scene is longer; `/dev/zero` is.
const MAX_BYTES: u64 = 16 << 20;

/// Side of a cell, m, where neither the file nor the caller says another.
const DEFAULT_CELL_M: f64 = 0.05;

const CELL: Limit = Limit {
    min: 1e-4,
    max: 1e3,
    bound: "a cell size in m, 0.0001 to 1000",
    remedy: "give the side of a cell, such as 0.05",
};

const KEYS: [&str; 17] = [
    "name",
    "description",
    "bounds",
    "grid",
    "wall",
    "box",
    "disc",
    "polygon",
    "map",
    "plan",
    "waypoints",
    "route",
    "stage",
    "region",
    "camera",
    "sensor",
    "robot",
];

/// Reads a file as text, at most 16 MiB of UTF-8.
///
/// # Errors
/// A file that cannot be read, or that is no such text.
pub fn read(path: &Path) -> Result<String, SceneError> {
    let file = path.display().to_string();
    let mut bytes = Vec::new();
    let opened = File::open(path).and_then(|f| f.take(MAX_BYTES + 1).read_to_end(&mut bytes));
    opened.map_err(|source| SceneError::Unreadable { file: file.clone(), source })?;
    let not_text = |problem: String, line, column| SceneError::Invalid {
        place: Place { file: file.clone(), line, column },
        problem: Box::new(Problem::NotText(problem)),
    };
    if bytes.len() as u64 > MAX_BYTES {
        return Err(not_text("more than 16 MiB".to_owned(), 1, 1));
    }
    String::from_utf8(bytes).map_err(|error| {
        let good = error.utf8_error().valid_up_to();
        let before = String::from_utf8_lossy(&error.as_bytes()[..good]).into_owned();
        let place = Source::new(&file, &before).place(good);
        not_text(format!("byte {:#04x} is no UTF-8", error.as_bytes()[good]), place.line, place.column)
    })
}

/// Parses a file's text as TOML.
///
/// # Errors
/// The first thing that is no TOML.
pub fn open<'a>(text: &'a str, file: &'a str) -> Result<(Source<'a>, Spanned<DeTable<'a>>), SceneError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let source = Source::new(file, text);
    let document = DeTable::parse(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        let report = error.message().lines().collect::<Vec<_>>().join("; ");
        source.error(offset, Problem::Syntax(excerpt(&report, LONGEST_REPORT)))
    })?;
    Ok((source, document))
}

/// Checks a scene file's text.
pub(crate) fn parse(text: &str, path: &Path, cell_m: Option<f64>) -> Result<Scene, SceneError> {
    let name = path.display().to_string();
    let (source, document) = open(text, &name)?;
    let root = Table::new(&source, "the scene", 0, document.get_ref());
    if root.get("generate").is_some() {
        return Err(source.error(root.offset_of("generate"), Problem::IsFamily));
    }
    root.only(&KEYS)?;

    let name = root.name("name")?;
    let description = root.text("description")?.unwrap_or_default();
    if root.get("map").is_some() && root.get("plan").is_some() {
        return Err(source.error(root.offset_of("plan"), Problem::MapAndPlan));
    }
    let map = map::read(&root, path)?;
    let plan = plan::read(&root, path)?;
    let extent_m = map.as_ref().map(|map| map.extent_m()).or(plan.as_ref().map(|plan| plan.extent_m()));
    let bounds_m = bounds(&root, extent_m)?;
    let grid = grid_spec(&root, bounds_m, cell_m, map.as_ref().map_or(DEFAULT_CELL_M, |map| map.cell_m()))?;
    let (known, mut obstacles) = match (map, plan) {
        (Some(map), _) => (Some(map.known()), map.obstacles(bounds_m)),
        (_, Some(plan)) => (Some(plan.known(&grid)), plan.obstacles(bounds_m)),
        _ => (None, Vec::new()),
    };
    obstacles.extend(obstacles::read(&root, bounds_m)?);
    let robot = camera::robot(&root)?;
    let waypoints = route::waypoints(&root, bounds_m)?;
    fit::room_for_robot(&root, &waypoints, &obstacles, &robot)?;
    let stops = route::stops(&root, &waypoints)?;
    let stages = route::stages(&root, &waypoints, &stops)?;
    let regions = regions::read(&root, bounds_m)?;
    let camera = camera::camera(&root)?;
    let matcher = camera::matcher(&root)?;
    Ok(Scene {
        name,
        description,
        layout: None,
        bounds_m,
        grid,
        obstacles,
        known,
        waypoints,
        stops,
        stages,
        regions,
        camera,
        matcher,
        robot,
    })
}

/// `[bounds]`, which the extent of a map or plan may stand in for.
fn bounds(root: &Table, extent_m: Option<[[f64; 2]; 2]>) -> Result<[[f64; 2]; 2], SceneError> {
    let Some(table) = root.section("bounds")? else {
        return extent_m.ok_or_else(|| root.missing("[bounds]", "[bounds] with min = [x, y] and max = [x, y] in m"));
    };
    table.only(&["min", "max"])?;
    let bounds = [table.point("min")?, table.point("max")?];
    table.ordered("max", bounds)?;
    Ok(bounds)
}

/// The cells that cover the bounds, if memory holds them.
fn grid_spec(
    root: &Table,
    bounds_m: [[f64; 2]; 2],
    given: Option<f64>,
    default: f64,
) -> Result<grid::GridSpec, SceneError> {
    let section = root.section("grid")?;
    let in_file = match &section {
        Some(table) => {
            table.only(&["cell"])?;
            table.optional_number("cell", &CELL)?
        }
        None => None,
    };
    let at = section.as_ref().map_or_else(|| root.offset_of("bounds"), |table| table.offset_of("cell"));
    let element = if given.is_some() { "the cell size asked for in place of the file's" } else { "[grid]" };
    let cell_m = given.or(in_file).unwrap_or(default);
    if !CELL.allows(cell_m) {
        return Err(root.source().error(
            at,
            Problem::Value {
                element: element.to_owned(),
                key: "cell".to_owned(),
                value: cell_m.to_string(),
                bound: CELL.bound.to_owned(),
                remedy: CELL.remedy.to_owned(),
            },
        ));
    }
    fit::grid(bounds_m, cell_m, element).map_err(|problem| root.source().error(at, problem))
}

/// Refuses what reaches out of the bounds by more than rounding.
fn within(extent: [[f64; 2]; 2], bounds: [[f64; 2]; 2], element: impl Fn() -> String) -> Result<(), Problem> {
    const ROUNDING_M: f64 = 1e-9;
    let outside = (0..2).any(|k| extent[0][k] < bounds[0][k] - ROUNDING_M || extent[1][k] > bounds[1][k] + ROUNDING_M);
    if outside { Err(Problem::OutsideBounds { element: element(), extent, bounds }) } else { Ok(()) }
}

/// A positive length.
const LENGTH: Limit = Limit {
    min: 1e-6,
    max: METRES,
    bound: "a positive length in m, 0.000001 to 1000000",
    remedy: "give a length such as 0.4",
};

#[cfg(test)]
mod tests;
