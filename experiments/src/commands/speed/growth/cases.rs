//! What is measured to see how time grows, in cells of 5 cm.

use std::sync::Arc;

use grid::GridSpec;
use mapper::Model;
use sensor::{Camera, Pose, Scan, Stereo};

use super::curve::{Against, Sizes};
use crate::commands::speed::hall::{Hall, RAYS, SCANS};
use crate::commands::speed::scans::ScanSet;
use crate::failure::Failure;

/// Side of a cell, m.
const CELL_M: f64 = 0.05;

/// Depth, m, of the wall that the scan sees in maps of every size: inside the smallest, which reaches 2.5 m.
const DEPTH_M: f64 = 2.0;

/// Scans of the drive are taken in steps of so many, round and round, so that the first of them are spread over it like
/// all: prime to their number.
const STRIDE: usize = 139;

/// A map to be made, and what from.
pub(super) struct GrowthCase {
    /// Empty map and belief.
    pub(super) setup: Model,
    /// The scans to map.
    pub(super) scans: Vec<Scan>,
    /// What stands along the axis: one size, or numbers of scans to look at the clock after.
    pub(super) sizes: Vec<f64>,
}

impl GrowthCase {
    /// The cases of one axis, the smallest first.
    pub(super) fn all(against: Against, sizes: &Sizes, hall: &Hall) -> Result<Vec<Self>, Failure> {
        let around = |set: &ScanSet| set.grid(CELL_M).map_err(Failure::Internal);
        Ok(match against {
            Against::CellsPerRay => sizes.cells_per_ray.iter().map(|&cells| row(cells)).collect(),
            Against::MapCells => sizes.map_cells.iter().map(|&cells| square(cells)).collect(),
            Against::RaysPerScan => {
                let grid = around(&hall.scans())?;
                let case = |&rays: &usize| Self::new(grid, vec![hall.scan(rays)], vec![rays as f64]);
                sizes.rays_per_scan.iter().map(case).collect()
            }
            Against::Scans => {
                let set = hall.scans();
                let grid = around(&set)?;
                let most = sizes.scans.iter().copied().max().unwrap_or(0).min(SCANS);
                let scans = (0..most).map(|k| set.scans[k * STRIDE % SCANS].clone()).collect();
                vec![Self::new(grid, scans, sizes.scans.iter().map(|&scans| scans as f64).collect())]
            }
        })
    }

    fn new(grid: GridSpec, scans: Vec<Scan>, sizes: Vec<f64>) -> Self {
        let setup = Model::new(grid, Arc::new(Stereo::default()));
        Self { setup, scans, sizes }
    }
}

/// A row of cells, and a ray along it that ends in the middle of the last.
fn row(cells: usize) -> GrowthCase {
    let grid = GridSpec { cell_m: CELL_M, origin_m: [0.0; 2], width: cells, height: 1 };
    let mut set = ScanSet::default();
    set.begin(Pose { x_m: 0.5 * CELL_M, y_m: 0.5 * CELL_M, theta_rad: 0.0 });
    set.ray(0.0, Some(CELL_M * cells.saturating_sub(1) as f64));
    GrowthCase::new(grid, set.scans, vec![cells as f64])
}

/// A square map with the sensor in its middle, in front of a wall.
fn square(cells: usize) -> GrowthCase {
    let side = (cells as f64).sqrt().round() as usize;
    let grid = GridSpec { cell_m: CELL_M, origin_m: [-0.5 * CELL_M * side as f64; 2], width: side, height: side };
    let mut set = ScanSet::default();
    set.begin(Pose { x_m: 0.3 * CELL_M, y_m: 0.3 * CELL_M, theta_rad: 0.0 });
    let camera = Camera { columns: RAYS, field_of_view_rad: std::f64::consts::FRAC_PI_2 };
    for bearing in camera.bearings_rad() {
        set.ray(bearing, Some(DEPTH_M / libm::cos(bearing)));
    }
    GrowthCase::new(grid, set.scans, vec![(side * side) as f64])
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::DigitalLine;

    #[test]
    fn the_ray_along_a_row_ends_in_its_last_cell() {
        for cells in [100, 10_000] {
            let case = row(cells);
            let reading = case.scans[0].readings[0].expect("seen");
            let range = Stereo::default().range(reading, 0.0);
            let mut line = DigitalLine::default();
            line.trace(&case.setup.grid, [0.025; 2], [1.0, 0.0], range);
            assert_eq!(line.len(), cells);
            assert!((line.ranges()[cells] - range).abs() < 1e-9, "inside the map");
        }
    }

    #[test]
    fn the_scans_of_the_drive_are_all_there_in_another_order() {
        let hall = Hall::new().expect("valid");
        let case = GrowthCase::all(Against::Scans, &Sizes::default(), &hall).expect("small").remove(0);
        let times = |scans: &[Scan]| {
            let mut times: Vec<f64> = scans.iter().map(|scan| scan.time_s).collect();
            times.sort_by(f64::total_cmp);
            times
        };
        assert_eq!(times(&case.scans), times(&hall.scans().scans));
        assert!(case.scans[1].time_s > 1.0);
    }

    #[test]
    fn every_reading_lies_on_the_smallest_map() {
        let case = square(10_000);
        assert!(case.scans[0].readings.iter().all(Option::is_some));
        for ray in case.scans[0].rays() {
            let range = DEPTH_M / libm::cos(ray.bearing_rad);
            let end = [0, 1].map(|k| ray.origin_m[k] + range * ray.direction[k]);
            assert!(case.setup.grid.locate(end).is_some(), "{end:?}");
        }
    }
}
