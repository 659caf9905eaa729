//! `estimate SCENE`: the mappers' prior from a scene's ground truth, at several cell sizes.

use grid::Raster;
use mapper::estimate::{Lag, correlation, law, length_m};
use mapper::{Estimate, Prior};
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output::args::SceneOptions;
use crate::output::table::{self, Table, aligned, optional};

/// Distances at which correlations are printed, as factors on the cell size asked for.
const FACTORS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

const COLUMNS: [&str; 10] = [
    "cell_m",
    "truth",
    "occupancy",
    "correlation",
    "predicted",
    "correlation_5cm",
    "length_m",
    "length_fit_m",
    "mean_run_m",
    "complete_run_m",
];

/// The columns in a terminal of 80 columns.
const HEADS: [&str; 10] = [
    "cell",
    "truth",
    "occupancy",
    "c",
    "predicted\nc",
    "c at\n5 cm",
    "length",
    "length\nfit",
    "mean\nrun",
    "whole\nrun",
];

/// The world, sampled at points on a grid of half the cell size: at distances of whole cells, points lie at two
/// phases against the cells in every direction, and never on a wall that ends where cells do.
struct Sampled {
    points: Raster<Option<bool>>,
    found: Estimate,
}

impl Sampled {
    /// Correlation of points `distance_m` (m) apart.
    fn lag(&self, distance_m: f64) -> Option<Lag> {
        let lag = (distance_m / self.found.cell_m).round() as usize;
        let correlation = correlation(&self.points, lag)?;
        Some(Lag { distance_m, correlation })
    }

    /// Mean obstacle length by the correlation of points that far apart, m.
    fn length_m(&self, distance_m: f64) -> Option<f64> {
        length_m(self.found.occupancy?, &self.lag(distance_m)?)
    }

    /// The prior by the correlation of points that far apart.
    fn prior(&self, distance_m: f64) -> Option<Prior> {
        let correlation = law(self.found.occupancy?, self.length_m(distance_m)?, Prior::REFERENCE_M);
        Some(Prior { occupancy: self.found.occupancy?, correlation, ..Prior::default() })
    }
}

/// Prints what every estimator gives at the scene's cell size or the one asked for, at half of it, and at two and
/// four times of it. Cell sizes that the scene refuses, since memory holds no such map, are left out.
///
/// # Errors
/// The first problem with the scene.
pub fn run(options: &SceneOptions) -> Result<(), Failure> {
    let load = |cell_m| scene::load(&options.scene, cell_m, options.layout);
    let scene = load(options.grid)?;
    let cell_m = scene.grid.cell_m;
    let points = scene::truth_at_centres(load(Some(0.5 * cell_m)).as_ref().unwrap_or(&scene));
    let world = Sampled { found: Estimate::of(&points), points };
    let mut table = Table::new(&COLUMNS);
    let predicted = |distance_m| Some(law(world.found.occupancy?, world.length_m(cell_m)?, distance_m));
    for at_m in FACTORS.map(|factor| factor * cell_m) {
        if at_m > 0.9 * world.found.cell_m {
            table.push(world_row(&world, at_m, predicted(at_m)));
        }
        if let Ok(scene) = load(Some(at_m)) {
            table.push(covered_row(&Estimate::of(&scene::truth(&scene)), predicted(at_m)));
        }
    }
    table.print(options.print.format, || {
        let layout = scene.layout.map(|layout| format!(", layout {layout}")).unwrap_or_default();
        let name = format!("{}{layout}", options.scene.display());
        let cells = Estimate::of(&scene::truth(&scene));
        text(&name, cell_m, &table, [world.prior(cell_m), cells.prior()])
    })
}

/// What points of the world that far apart give; what needs all lags or whole runs only with the nearest.
fn world_row(world: &Sampled, at_m: f64, predicted: Option<f64>) -> Vec<Value> {
    let nearest = Some(&world.found).filter(|found| at_m < 1.1 * found.cell_m);
    vec![
        table::rounded(at_m),
        json!("world"),
        optional(world.found.occupancy),
        optional(world.lag(at_m).map(|lag| lag.correlation)),
        optional(predicted),
        optional(world.prior(at_m).map(|prior| prior.correlation)),
        optional(world.length_m(at_m)),
        optional(nearest.and_then(Estimate::length_fit_m)),
        optional(nearest.and_then(|found| found.mean_run_m)),
        optional(nearest.and_then(|found| found.mean_complete_run_m)),
    ]
}

/// What the cells that maps are scored on give.
fn covered_row(found: &Estimate, predicted: Option<f64>) -> Vec<Value> {
    vec![
        table::rounded(found.cell_m),
        json!("cells"),
        optional(found.occupancy),
        optional(found.correlation()),
        optional(predicted),
        optional(found.prior().map(|prior| prior.correlation)),
        optional(found.length_m()),
        optional(found.length_fit_m()),
        optional(found.mean_run_m),
        optional(found.mean_complete_run_m),
    ]
}

fn text(name: &str, cell_m: f64, table: &Table, [world, cells]: [Option<Prior>; 2]) -> String {
    let shown = |value: &Value| match value {
        Value::Null => "-".to_owned(),
        Value::String(text) => text.clone(),
        number => number.as_f64().map_or_else(String::new, |v| format!("{v:.3}")),
    };
    let rows: Vec<Vec<String>> = table.rows().iter().map(|row| row.iter().map(shown).collect()).collect();
    format!(
        "{name}: at {cell_m} m\n\n\
         the world                           {}\n\
         the cells that maps are scored on   {}\n\n{}\n\
         world: points that far apart. cells: neighbours, occupied where any part is\n\
         covered. c: correlation. predicted: c(d) = exp(-d / ((1 - p) L)) with p and L of\n\
         the world at {cell_m} m. c at 5 cm: carried there by that law. length: L by the c\n\
         beside it; length fit: over all lags with c >= 0.3. mean run: occupied, along\n\
         rows and columns, with the ends that are seen; whole run: with both ends.\n",
        options(world),
        options(cells),
        aligned(&HEADS, &rows),
    )
}

/// A prior as options of `room`.
fn options(prior: Option<Prior>) -> String {
    prior.map_or_else(
        || "no prior: all is alike, or neighbours are not".to_owned(),
        |prior| format!("--prior {:.3} --correlation {:.3}", prior.occupancy, prior.correlation),
    )
}
