//! A mapper of your own: count how often each cell was passed and how often it was hit.

use grid::{DigitalLine, Raster};
use mapper::catalogue::{Entry, Kind};
use mapper::{Mapper, Model, Sensors};
use sensor::Scan;

/// How gates call the mapper, and how they make one.
pub(crate) const COUNTING: Entry = Entry {
    name: "counting",
    summary: "the share of looks at a cell that hit it",
    source: "own-gate",
    kind: Kind::Online,
    build: &|setup| Box::new(Counting::new(setup)),
};

struct Counting {
    occupancy: Raster<f64>,
    looks: Vec<[f64; 2]>, // passed, hit
    prior: f64,
    sensors: Sensors,
    line: DigitalLine,
}

impl Counting {
    fn new(setup: &Model) -> Self {
        let prior = setup.prior.occupancy;
        Self {
            occupancy: Raster::filled(setup.grid, prior),
            looks: vec![[0.0; 2]; setup.grid.cells()],
            prior,
            sensors: setup.sensors.clone(),
            line: DigitalLine::default(),
        }
    }
}

impl Mapper for Counting {
    fn integrate(&mut self, scan: &Scan) {
        let sensor = self.sensors.of(scan);
        for ray in scan.rays() {
            let range_m = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad));
            let Some(range_m) = range_m else { continue };
            self.line.trace(self.occupancy.spec(), ray.origin_m, ray.direction, range_m);
            for (k, &cell) in self.line.cells().iter().enumerate() {
                // The last cell is hit, unless the ray leaves the map before its reading.
                let hit = k + 1 == self.line.len() && self.line.ranges()[k + 1] >= range_m - 1e-9;
                self.looks[cell][usize::from(hit)] += 1.0;
                let [passed, hits] = self.looks[cell];
                self.occupancy[cell] = (hits + self.prior) / (passed + hits + 1.0);
            }
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }
}
