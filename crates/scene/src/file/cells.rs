//! `[grid]`: the cells that cover the bounds.

use grid::GridSpec;
use strict::{Limit, Table};

use super::findings::Findings;
use crate::{Problem, SceneError, memory};

/// Side of a cell, m, where neither the file nor the caller says another.
pub(super) const DEFAULT_M: f64 = 0.05;

const CELL: Limit = Limit {
    min: 1e-4,
    max: 1e3,
    bound: "a cell size in m, 0.0001 to 1000",
    remedy: "give the side of a cell, such as 0.05",
};

/// The cells that cover the bounds, if there are bounds and memory holds them.
pub(super) fn read(
    root: &Table,
    bounds_m: Option<[[f64; 2]; 2]>,
    given: Option<f64>,
    default: f64,
    found: &mut Findings,
) -> Option<GridSpec> {
    let section = found.take(root.section("grid"))?;
    let mut in_file = None;
    if let Some(table) = &section {
        found.only(table, &["cell"]);
        in_file = found.take(table.optional_number("cell", &CELL))?;
    }
    let at = || section.as_ref().map_or_else(|| root.place_of("bounds"), |table| table.place_of("cell"));
    let element = if given.is_some() { "the cell size asked for in place of the file's" } else { "[grid]" };
    let cell_m = given.or(in_file).unwrap_or(default);
    if !CELL.allows(cell_m) {
        let problem = strict::Problem::Value {
            element: element.to_owned(),
            key: "cell".to_owned(),
            value: cell_m.to_string(),
            bound: CELL.bound.to_owned(),
            remedy: CELL.remedy.to_owned(),
        };
        found.add(SceneError::at(at(), Problem::File(problem)));
        return None;
    }
    found.take(covering(bounds_m?, cell_m, element).map_err(|problem| SceneError::at(at(), problem)))
}

/// The cells that cover the bounds, if memory holds what is kept per cell.
fn covering([min, max]: [[f64; 2]; 2], cell_m: f64, element: &str) -> Result<GridSpec, Problem> {
    let element = element.to_owned();
    let spec = GridSpec::covering(min, max, cell_m).map_err(|source| Problem::Grid {
        element: element.clone(),
        cell_m,
        source,
    })?;
    let cells = spec.cells();
    let (bytes, available) = (cells as u64 * memory::BYTES_PER_CELL, memory::available());
    if bytes > available {
        let (columns, rows) = (spec.width, spec.height);
        return Err(Problem::Memory { element, cell_m, columns, rows, cells, bytes, available });
    }
    Ok(spec)
}
