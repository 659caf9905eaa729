//! A mapper of your own in twenty lines: count how often each cell was passed and how often it was hit.
//!
//! `cargo run -p mapper --example own_mapper`

use grid::{DigitalLine, GridSpec, Raster};
use mapper::Mapper;
use sensor::{Pose, Scan, Stereo};

struct Counting {
    occupancy: Raster<f64>,
    looks: Vec<[u32; 2]>, // passed, hit
}

impl Mapper for Counting {
    fn integrate(&mut self, scan: &Scan) {
        let mut line = DigitalLine::default();
        for ray in scan.rays() {
            let Some(disparity) = ray.reading else { continue };
            let range = Stereo::default().range(disparity, ray.bearing_rad);
            line.trace(self.occupancy.spec(), ray.origin_m, ray.direction, range);
            for (k, &cell) in line.cells().iter().enumerate() {
                self.looks[cell][usize::from(k + 1 == line.len())] += 1;
                let [passed, hit] = self.looks[cell].map(f64::from);
                self.occupancy[cell] = (hit + 0.1) / (passed + hit + 1.0);
            }
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }
}

fn main() {
    let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 40, height: 1 };
    let mut map = Counting { occupancy: Raster::filled(spec, 0.1), looks: vec![[0; 2]; spec.cells()] };
    let pose = Pose { x_m: 0.0, y_m: 0.02, theta_rad: 0.0 };
    map.integrate(&Scan {
        sensor: 0,
        time_s: 0.0,
        pose,
        bearings_rad: vec![0.0; 3],
        readings: vec![Some(9.8), Some(10.1), None],
    });
    assert!(map.occupancy()[10] < 0.05 && map.occupancy()[30] > 0.3);
}

#[cfg(test)]
mod tests {
    #[test]
    fn it_does_what_the_guide_says() {
        super::main();
    }
}
