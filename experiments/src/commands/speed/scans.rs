//! The scans that all mappers map, and the cells that their rays visit.

use std::sync::Arc;

use clap::ValueEnum;
use grid::{DigitalLine, GridSpec};
use sensor::{InverseModel as _, Laser, Pose, Scan, SensorModel, Stereo};

/// The map reaches so much farther than all poses and ranges, m.
const MARGIN_M: f64 = 1.0;

/// Maps of more cells are taken for a mistake: they would need more than 2 GB for each mapper.
pub const MOST_CELLS: usize = 25_000_000;

/// Share of a range that rounding may take from it: its last cell counts as owed only if the ray goes farther into it.
const ROUNDING: f64 = 1e-9;

/// Cells along a ray after which a mapper may stop: of independent cells that are occupied with probability 0.1, as the prior of
/// `speed` has them, so many let less than 1e-4 of the ray through. What lies behind changes no map by more than rounding.
const OPAQUE_CELLS: usize = 87;

/// What the mappers take the readings for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Kernel {
    /// the camera of the paper, which reads the noise-free disparity of every range
    #[default]
    Stereo,
    /// a laser, which reads the range
    Laser,
}

/// Scans, with the ranges that their readings stand for.
#[derive(Debug, Clone, Default)]
pub struct ScanSet {
    /// In the order in which they are mapped.
    pub scans: Vec<Scan>,
    /// Range of every ray of every scan, m; of a ray without a reading or an echo, NaN.
    ranges_m: Vec<f64>,
    /// Lower-left and upper-right corner of all poses and ends of ranges, m; none before the first pose.
    extent_m: Option<[[f64; 2]; 2]>,
    stereo: Stereo,
    /// None of scans that the camera takes.
    laser: Option<Laser>,
}

/// Cells from the sensor to the end of every range, both included: what rays and grid ask of every mapper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Visited {
    /// Four-connected cells, one for every ray that crosses it.
    pub cells: u64,
    /// Those of them that a ray enters by more than rounding, up to where unseen space is opaque: a mapper that updates fewer has not
    /// done its work.
    pub owed: u64,
    /// Rays with a reading that is a range.
    pub rays: u64,
}

impl ScanSet {
    /// No scans yet, of a laser that sees so far, m.
    pub fn of_laser(max_range_m: f64) -> Self {
        Self { laser: Some(Laser { max_range_m, ..Laser::default() }), ..Self::default() }
    }

    /// What took the scans.
    pub fn sensor(&self) -> Arc<dyn SensorModel> {
        match self.laser {
            Some(laser) => Arc::new(laser),
            None => Arc::new(self.stereo),
        }
    }

    /// The next scan, from this pose, without rays yet.
    pub fn begin(&mut self, pose: Pose) {
        self.fit();
        self.scans.push(Scan { time_s: self.scans.len() as f64, pose, ..Scan::default() });
        self.reach(pose.position_m());
    }

    /// One more ray of the scan that was begun last. A range (m) that the camera cannot see gives no reading; an
    /// infinite one is no echo.
    pub fn ray(&mut self, bearing_rad: f64, range_m: Option<f64>) {
        let stereo = self.stereo;
        let seen = |range: f64| Some(stereo.disparity(range, bearing_rad)).filter(|d| *d <= stereo.max_disparity);
        let reading = match self.laser {
            Some(_) => range_m,
            None => range_m.filter(|range| range.is_finite()).and_then(seen),
        };
        self.push(bearing_rad, reading, range_m.filter(|range| range.is_finite()));
    }

    /// As [`ray`](Self::ray), by its disparity, px.
    pub fn disparity(&mut self, bearing_rad: f64, disparity: Option<f64>) {
        let reading = disparity.filter(|disparity| *disparity <= self.stereo.max_disparity);
        let range_m = reading.and_then(|disparity| self.stereo.range_of(disparity, bearing_rad));
        self.push(bearing_rad, reading, range_m);
    }

    fn push(&mut self, bearing_rad: f64, reading: Option<f64>, range_m: Option<f64>) {
        let Some(scan) = self.scans.last_mut() else { return };
        scan.bearings_rad.push(bearing_rad);
        scan.readings.push(reading);
        self.ranges_m.push(range_m.filter(|_| reading.is_some()).unwrap_or(f64::NAN));
        if let Some(range) = range_m {
            let (at, along) = (scan.pose.position_m(), scan.pose.direction(bearing_rad));
            self.reach([0, 1].map(|k| at[k] + range * along[k]));
        }
    }

    /// Gives back the memory that the last scan does not need.
    fn fit(&mut self) {
        if let Some(scan) = self.scans.last_mut() {
            scan.bearings_rad.shrink_to_fit();
            scan.readings.shrink_to_fit();
        }
    }

    fn reach(&mut self, [x, y]: [f64; 2]) {
        let [low, high] = self.extent_m.unwrap_or([[x, y]; 2]);
        self.extent_m = Some([[low[0].min(x), low[1].min(y)], [high[0].max(x), high[1].max(y)]]);
    }

    /// Number of rays, with a reading or without.
    pub fn rays(&self) -> usize {
        self.ranges_m.len()
    }

    /// The cells of side `cell_m` (m) that cover everything.
    ///
    /// # Errors
    /// More than [`MOST_CELLS`], and no scan at all, with what to do about it.
    pub fn grid(&self, cell_m: f64) -> Result<GridSpec, String> {
        let [low, high] = self.extent_m.ok_or("no scan; give one at least")?;
        let (low, high) = (low.map(|v| v - MARGIN_M), high.map(|v| v + MARGIN_M));
        let [width, height] = [0, 1].map(|k| ((high[k] - low[k]) / cell_m).ceil());
        match GridSpec::covering(low, high, cell_m) {
            Ok(spec) if spec.cells() <= MOST_CELLS => Ok(spec),
            _ => Err(format!(
                "poses and ranges with {MARGIN_M} m around them are {width} x {height} cells of {cell_m} m; must be at most \
                 {MOST_CELLS} cells; use larger cells with --grid, or leave out what is far away"
            )),
        }
    }

    /// Counts the cells that the rays visit in the given grid. O(cells visited).
    pub fn visited(&self, spec: &GridSpec) -> Visited {
        let mut visited = Visited::default();
        let mut line = DigitalLine::default();
        let rays = self.scans.iter().flat_map(Scan::rays).zip(&self.ranges_m);
        for (ray, &range) in rays.filter(|(_, range)| !range.is_nan()) {
            line.trace(spec, ray.origin_m, ray.direction, range);
            let entered = &line.ranges()[..line.len()];
            let beyond = entered.iter().rev().take_while(|at| **at >= range * (1.0 - ROUNDING)).count();
            visited.cells += line.len() as u64;
            visited.owed += (line.len() - beyond).min(OPAQUE_CELLS) as u64;
            visited.rays += 1;
        }
        visited
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_that_the_camera_cannot_see_is_no_reading_but_is_on_the_map() {
        let mut set = ScanSet::default();
        set.begin(Pose::default());
        for (bearing, range) in [(0.0, Some(1.5)), (0.0, None), (0.0, Some(0.2)), (3.0, Some(4.0)), (0.0, Some(0.0))] {
            set.ray(bearing, range);
        }
        let readings = &set.scans[0].readings;
        assert!((readings[0].expect("seen") - 10.0).abs() < 1e-12);
        assert!(readings[1..].iter().all(Option::is_none), "{readings:?}");
        let spec = set.grid(0.1).expect("small");
        assert!((spec.origin_m[0] - (4.0 * libm::cos(3.0) - 1.0)).abs() < 1e-12);
        // From 0 to 1.5 m; the grid's lines are not at whole decimetres.
        assert_eq!(set.visited(&spec), Visited { cells: 16, owed: 16, rays: 1 });
    }

    #[test]
    fn a_laser_reads_ranges_and_what_has_no_echo_is_no_visit() {
        let mut set = ScanSet::of_laser(30.0);
        set.begin(Pose { x_m: 0.25, y_m: 0.25, theta_rad: 0.0 });
        [Some(1.0), Some(f64::INFINITY), None].into_iter().for_each(|range| set.ray(0.0, range));
        assert_eq!(set.scans[0].readings, [Some(1.0), Some(f64::INFINITY), None]);
        let spec = GridSpec { cell_m: 0.25, origin_m: [-1.125; 2], width: 12, height: 8 };
        assert_eq!((set.rays(), set.visited(&spec)), (3, Visited { cells: 5, owed: 5, rays: 1 }));
    }

    #[test]
    fn a_disparity_is_taken_as_it_is() {
        let (mut by_range, mut by_disparity) = (ScanSet::default(), ScanSet::default());
        by_range.begin(Pose::default());
        by_disparity.begin(Pose::default());
        by_range.ray(0.3, Some(1.5));
        by_disparity.disparity(0.3, by_range.scans[0].readings[0]);
        by_disparity.disparity(0.3, Some(60.5));
        assert_eq!(by_disparity.scans[0].readings, [by_range.scans[0].readings[0], None]);
        assert!((by_disparity.ranges_m[0] - 1.5).abs() < 1e-12);
    }

    #[test]
    fn a_cell_that_is_only_touched_at_the_end_of_a_range_is_not_owed() {
        let mut set = ScanSet::default();
        set.begin(Pose { x_m: 0.25, y_m: 0.25, theta_rad: 0.0 });
        set.ray(0.0, Some(1.0 + 1e-12));
        let spec = GridSpec { cell_m: 0.25, origin_m: [-1.0; 2], width: 12, height: 8 };
        assert_eq!(set.visited(&spec), Visited { cells: 5, owed: 4, rays: 1 });
    }

    #[test]
    fn what_lies_behind_opaque_space_is_not_owed() {
        let mut set = ScanSet::default();
        set.begin(Pose { x_m: 0.05, y_m: 0.05, theta_rad: 0.0 });
        set.ray(0.0, Some(9.0));
        let spec = GridSpec { cell_m: 0.1, origin_m: [-1.0; 2], width: 120, height: 20 };
        assert_eq!(set.visited(&spec), Visited { cells: 91, owed: OPAQUE_CELLS as u64, rays: 1 });
    }

    #[test]
    fn a_map_too_large_says_what_to_do() {
        let mut set = ScanSet::default();
        assert!(set.grid(0.05).is_err());
        set.begin(Pose::default());
        set.ray(0.0, Some(9e5));
        let message = set.grid(0.05).expect_err("45 million cells along x");
        assert!(message.contains("25000000") && message.contains("--grid"), "{message}");
        assert!(set.grid(1.0).is_ok());
    }
}
