//! What a mapper has done and what it holds, for those who measure speed.

use std::cell::OnceCell;

use grid::{DigitalLine, Raster};

use crate::ray::RayUpdate;
use crate::{Chain, Moments, PairwiseGrid, RayPosterior};

/// What a mapper has done since it was made, and the memory that it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Cells that its rays were updated over, a cell once for every ray that it was updated for; 0 of a mapper that
    /// does not count.
    pub cells: u64,
    /// Memory, bytes: the map, the readings of a mapper that keeps them, and the working state that is kept from one
    /// scan to the next.
    pub bytes: usize,
}

impl Work {
    /// Of a mapper that does not count and holds nothing but the map that it shows.
    pub fn uncounted(occupancy: &Raster<f64>) -> Self {
        Self { cells: 0, bytes: occupancy.held() }
    }
}

/// Memory behind a value.
pub(crate) trait Held {
    /// Bytes on the heap.
    fn held(&self) -> usize;
}

impl<T> Held for Vec<T> {
    fn held(&self) -> usize {
        self.capacity() * size_of::<T>()
    }
}

impl<T> Held for Raster<T> {
    fn held(&self) -> usize {
        size_of_val(self.values())
    }
}

/// What is made when it is asked for.
impl<T: Held> Held for OnceCell<T> {
    fn held(&self) -> usize {
        self.get().map_or(0, Held::held)
    }
}

impl Held for DigitalLine {
    fn held(&self) -> usize {
        size_of_val(self.cells()) + size_of_val(self.ranges())
    }
}

impl Held for Chain {
    fn held(&self) -> usize {
        (2 * self.len()).saturating_sub(1) * size_of::<f64>()
    }
}

impl Held for RayPosterior {
    fn held(&self) -> usize {
        self.pairs.held() + self.scratch.held()
    }
}

impl Held for RayUpdate {
    fn held(&self) -> usize {
        self.line.held() + self.chain.held() + self.likelihood.held() + self.posterior.held()
    }
}

impl Held for PairwiseGrid {
    fn held(&self) -> usize {
        self.marginal.held() + self.both.held()
    }
}

impl Held for Moments {
    fn held(&self) -> usize {
        self.cell.held() + self.edge.held() + self.touched.held()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use grid::GridSpec;
    use sensor::{Pose, Scan, Stereo};

    use crate::Mapper;
    use crate::catalogue::{MAPPERS, Setup};

    /// Three rays along a row of 40 cells: two readings of 15 / 10 = 1.5 m, in cell 30, and none.
    #[test]
    fn every_mapper_that_counts_counts_rays_times_cells() {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 1 };
        let sensor = Arc::new(Stereo::default());
        let setup = Setup::new(grid, sensor);
        let pose = Pose { x_m: 0.01, y_m: 0.025, theta_rad: 0.0 };
        let readings = vec![Some(10.0), None, Some(10.0)];
        let scan = Scan { time_s: 0.0, pose, bearings_rad: vec![0.0; 3], readings };
        for entry in MAPPERS {
            let mut mapper = (entry.build)(&setup);
            assert_eq!(mapper.work().cells, 0, "{}: nothing done", entry.name);
            mapper.integrate(&scan);
            assert!(mapper.work().bytes >= 40 * 8, "{}: {:?}", entry.name, mapper.work());
            let expected = match entry.name {
                "forward-em" | "mrf" | "prior" => 0, // they do not count
                name if name.starts_with("log-odds") => 2 * 31,
                "conventional" | "conventional-tuned" => 2 * 32, // up to 15 / 9.5 = 1.57 m
                _ => 2 * 40,
            };
            assert_eq!(mapper.work().cells, expected, "{}", entry.name);
            mapper.integrate(&scan);
            assert_eq!(mapper.work().cells, 2 * expected, "{}: since it was made", entry.name);
        }
    }

    #[test]
    fn memory_grows_with_the_map() {
        let bytes = |width| {
            let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height: 10 };
            let sensor = Arc::new(Stereo::default());
            let setup = Setup::new(grid, sensor);
            let shown = |mapper: &dyn Mapper| {
                mapper.occupancy();
                mapper.work().bytes
            };
            MAPPERS.iter().map(|entry| shown(&*(entry.build)(&setup))).collect::<Vec<_>>()
        };
        for (small, large) in bytes(1000).into_iter().zip(bytes(10_000)) {
            assert!(large > 9 * small && large < 11 * small, "{small} {large}");
        }
    }
}
