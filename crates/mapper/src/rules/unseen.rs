//! The lower bound: a map that has seen nothing.

use grid::Raster;
use sensor::Scan;

use crate::mapper::Mapper;
use crate::model::Model;

/// Holds the prior whatever it is shown: what a map is worth before the first reading. O(1) per scan.
#[derive(Clone)]
pub struct Unseen {
    occupancy: Raster<f64>,
}

impl Unseen {
    /// The prior everywhere.
    pub fn new(model: &Model) -> Self {
        Self { occupancy: Raster::filled(model.grid, model.prior.marginal()) }
    }
}

impl Mapper for Unseen {
    fn integrate(&mut self, _scan: &Scan) {}

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::belief::prior::Prior;
    use grid::GridSpec;
    use sensor::{Pose, Stereo};
    use std::sync::Arc;

    #[test]
    fn readings_do_not_move_it() {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 1 };
        let prior = Prior { occupancy: 0.3, ..Prior::default() };
        let sensor = Arc::new(Stereo::default());
        let mut mapper = Unseen::new(&Model { prior, ..Model::new(grid, sensor) });
        let pose = Pose { x_m: 0.0, y_m: 0.02, theta_rad: 0.0 };
        mapper.integrate(&Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(10.0)] });
        assert!(mapper.occupancy().values().iter().all(|p| (p - 0.3).abs() < 1e-15));
    }
}
