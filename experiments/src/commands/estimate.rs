//! `estimate SCENE`: the mappers' prior from a scene's ground truth, at several cell sizes.

use grid::Raster;
use mapper::estimate::{Lag, correlation, law, length_m};
use mapper::{Estimate, Prior};
use serde_json::json;

use crate::failure::Failure;
use crate::output::table::{Table, aligned, optional, rounded};
use crate::worlds::scenes::SceneOptions;

/// Distances at which correlations are printed, as factors on the cell size asked for.
const FACTORS: [f64; 4] = [0.5, 1.0, 2.0, 4.0];

/// The columns after cell size and what is looked at.
const FOUND: [&str; 8] = [
    "occupancy",
    "correlation",
    "predicted",
    "correlation_5cm",
    "length_m",
    "length_fit_m",
    "mean_run_m",
    "complete_run_m",
];

/// What is found at a cell size: its side in m, what is looked at, and the values of [`FOUND`].
type Found = (f64, &'static str, [Option<f64>; FOUND.len()]);

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
    let mut rows: Vec<Found> = Vec::new();
    let predicted = |distance_m| Some(law(world.found.occupancy?, world.length_m(cell_m)?, distance_m));
    for at_m in FACTORS.map(|factor| factor * cell_m) {
        if at_m > 0.9 * world.found.cell_m {
            rows.push(of_world(&world, at_m, predicted(at_m)));
        }
        if let Ok(scene) = load(Some(at_m)) {
            rows.push(of_cells(&Estimate::of(&scene::truth(&scene)), predicted(at_m)));
        }
    }
    let table = Table::of(&rows, &[("cell_m", &|row| rounded(row.0)), ("truth", &|row| json!(row.1))]);
    let table = table.with(&rows, &FOUND, |row, number| optional(row.2[number]));
    table.print(options.print.format, || {
        let layout = scene.layout.map(|layout| format!(", layout {layout}")).unwrap_or_default();
        let name = format!("{}{layout}", options.scene.display());
        let cells = Estimate::of(&scene::truth(&scene));
        text(&name, cell_m, &rows, [world.prior(cell_m), cells.prior()])
    })
}

/// What points of the world that far apart give; what needs all lags or whole runs only with the nearest.
fn of_world(world: &Sampled, at_m: f64, predicted: Option<f64>) -> Found {
    let nearest = Some(&world.found).filter(|found| at_m < 1.1 * found.cell_m);
    let found = [
        world.found.occupancy,
        world.lag(at_m).map(|lag| lag.correlation),
        predicted,
        world.prior(at_m).map(|prior| prior.correlation),
        world.length_m(at_m),
        nearest.and_then(Estimate::length_fit_m),
        nearest.and_then(|found| found.mean_run_m),
        nearest.and_then(|found| found.mean_complete_run_m),
    ];
    (at_m, "world", found)
}

/// What the cells that maps are scored on give.
fn of_cells(found: &Estimate, predicted: Option<f64>) -> Found {
    let values = [
        found.occupancy,
        found.correlation(),
        predicted,
        found.prior().map(|prior| prior.correlation),
        found.length_m(),
        found.length_fit_m(),
        found.mean_run_m,
        found.mean_complete_run_m,
    ];
    (found.cell_m, "cells", values)
}

fn text(name: &str, cell_m: f64, rows: &[Found], [world, cells]: [Option<Prior>; 2]) -> String {
    let shown = |value: &Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3}"));
    let row = |(cell_m, truth, found): &Found| {
        [shown(&Some(*cell_m)), (*truth).to_owned()].into_iter().chain(found.iter().map(shown)).collect()
    };
    let rows: Vec<Vec<String>> = rows.iter().map(row).collect();
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
