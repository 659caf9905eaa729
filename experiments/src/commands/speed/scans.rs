//! The scans that all mappers map, and the cells that their rays visit.

use std::sync::Arc;

use clap::ValueEnum;
use grid::{DigitalLine, GridSpec};
use mapper::Sensors;
use sensor::{Laser, Pose, Scan};

pub use super::carrier::Carrier;

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
#[derive(Debug, Clone)]
pub struct ScanSet {
    /// In the order in which they are mapped; those of one time stand together by rising numbers of their sensors.
    pub scans: Vec<Scan>,
    /// Range of every ray of every scan, m; of a ray without a reading or an echo, NaN.
    ranges_m: Vec<f64>,
    /// Lower-left and upper-right corner of all poses and ends of ranges, or of the map that counts, m; none before the first pose.
    extent_m: Option<[[f64; 2]; 2]>,
    /// Ranges beyond this do not make the map larger, m.
    reach_m: f64,
    /// What took the scans, by number; one at least.
    sensors: Vec<Carrier>,
}

/// Cells from the sensor to the end of every range, both included: what rays and grid ask of every mapper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Visited {
    /// Four-connected cells, one for every ray that crosses it; of a cone, those along its axis.
    pub cells: u64,
    /// Those of them that a ray enters by more than rounding, up to where unseen space is opaque: a mapper that updates fewer has not
    /// done its work.
    pub owed: u64,
    /// Rays with a reading that is a range.
    pub rays: u64,
}

impl Default for ScanSet {
    /// No scans yet, of the paper's camera, which is given ranges.
    fn default() -> Self {
        Self::of(vec![Carrier::by_ranges("camera")])
    }
}

impl ScanSet {
    /// No scans yet, of these sensors, one at least.
    pub fn of(sensors: Vec<Carrier>) -> Self {
        Self { scans: Vec::new(), ranges_m: Vec::new(), extent_m: None, reach_m: f64::INFINITY, sensors }
    }

    /// The same on a map that covers poses, and what is read up to this range, m.
    pub fn within(self, reach_m: f64) -> Self {
        Self { reach_m, ..self }
    }

    /// No scans yet, of a laser that sees so far, m.
    pub fn of_laser(max_range_m: f64) -> Self {
        Self::of(vec![Carrier::new("laser", Arc::new(Laser { max_range_m, ..Laser::default() }))])
    }

    /// What took the scans.
    pub fn sensors(&self) -> Sensors {
        Sensors::new(self.sensors.iter().map(|carrier| carrier.model.clone()).collect())
    }

    /// What the sensors are called, by number.
    pub fn called(&self) -> impl ExactSizeIterator<Item = &str> {
        self.sensors.iter().map(|carrier| carrier.called.as_str())
    }

    /// The scans of one of the sensors alone, which keeps its number.
    pub fn of_sensor(&self, number: usize) -> Self {
        let mut alone = Self { extent_m: self.extent_m, ..Self::of(self.sensors.clone()) };
        let mut first = 0;
        for scan in &self.scans {
            let rays = first..first + scan.readings.len();
            first = rays.end;
            if scan.sensor == number {
                alone.scans.push(scan.clone());
                alone.ranges_m.extend_from_slice(&self.ranges_m[rays]);
            }
        }
        alone
    }

    /// The next scan of the first sensor, from this pose, without rays yet, a second after the last.
    pub fn begin(&mut self, pose: Pose) {
        self.begin_of(0, self.scans.len() as f64, pose);
    }

    fn begin_of(&mut self, sensor: usize, time_s: f64, pose: Pose) {
        self.fit();
        self.scans.push(Scan { sensor, time_s, pose, ..Scan::default() });
        self.reach(pose.position_m());
    }

    /// The next scan, as its sensor is given its readings.
    ///
    /// # Panics
    /// If there is no such sensor.
    pub fn add(&mut self, scan: &Scan) {
        self.begin_of(scan.sensor, scan.time_s, scan.pose);
        for (&bearing_rad, &reading) in scan.bearings_rad.iter().zip(&scan.readings) {
            self.ray(bearing_rad, reading);
        }
    }

    /// One more ray of the scan that was begun last, by what its sensor is given: a range (m) or a disparity (px). A range that a camera
    /// cannot see gives no reading; an infinite one is no echo.
    pub fn ray(&mut self, bearing_rad: f64, given: Option<f64>) {
        let number = self.scans.last().map_or(0, |scan| scan.sensor);
        let (reading, range_m) = self.sensors[number].read(bearing_rad, given);
        self.push(bearing_rad, reading, range_m);
    }

    fn push(&mut self, bearing_rad: f64, reading: Option<f64>, range_m: Option<f64>) {
        let Some(scan) = self.scans.last_mut() else { return };
        scan.bearings_rad.push(bearing_rad);
        scan.readings.push(reading);
        self.ranges_m.push(range_m.filter(|_| reading.is_some()).unwrap_or(f64::NAN));
        if let Some(range) = range_m.filter(|range| *range <= self.reach_m) {
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

    /// What was read counts on this map alone, as it does for the mappers of a scene: a disparity of a false match can say any range.
    pub fn on_map(&mut self, spec: &GridSpec) {
        let [x, y] = spec.origin_m;
        let far = [x + spec.width as f64 * spec.cell_m, y + spec.height as f64 * spec.cell_m];
        self.extent_m = Some([spec.origin_m, far]);
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
                 {MOST_CELLS} cells; use larger cells with --grid, or leave what is far away off the map with --reach"
            )),
        }
    }

    /// Counts the cells that the rays visit in the given grid. O(cells visited).
    pub fn visited(&self, spec: &GridSpec) -> Visited {
        let mut visited = Visited::default();
        let mut line = DigitalLine::default();
        let is_cone: Vec<bool> = self.sensors.iter().map(|carrier| carrier.model.width_rad() > 0.0).collect();
        let rays = self.scans.iter().flat_map(|scan| scan.rays().map(|ray| (ray, is_cone[scan.sensor])));
        for ((ray, is_cone), &range) in rays.zip(&self.ranges_m).filter(|(_, range)| !range.is_nan()) {
            line.trace(spec, ray.origin_m, ray.direction, range);
            let entered = &line.ranges()[..line.len()];
            let beyond = entered.iter().rev().take_while(|at| **at >= range * (1.0 - ROUNDING)).count();
            visited.cells += line.len() as u64;
            // What a rule makes of a cone besides its axis, and in what order, is its own.
            visited.owed += if is_cone { 0 } else { (line.len() - beyond).min(OPAQUE_CELLS) as u64 };
            visited.rays += 1;
        }
        visited
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sensor::{Sonar, Stereo};

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
        let mut by_range = ScanSet::default();
        let mut by_disparity = ScanSet::of(vec![Carrier::camera("camera", Stereo::default())]);
        by_range.begin(Pose::default());
        by_disparity.begin(Pose::default());
        by_range.ray(0.3, Some(1.5));
        by_disparity.ray(0.3, by_range.scans[0].readings[0]);
        by_disparity.ray(0.3, Some(60.5));
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
        let mut near = ScanSet::default().within(5.0);
        near.begin(Pose { x_m: 1.0, y_m: 1.0, theta_rad: 0.0 });
        [9e5, 4.0].into_iter().for_each(|range| near.ray(0.0, Some(range)));
        let spec = near.grid(0.5).expect("small");
        assert_eq!((spec.width, spec.height), (12, 4), "from 0 to 6 m; both rays are mapped, the one up to the border");
        assert_eq!(near.visited(&spec).rays, 2);
    }

    #[test]
    fn several_sensors_keep_their_readings_and_can_be_taken_apart() {
        let sensors = vec![
            Carrier::camera("camera", Stereo::default()),
            Carrier::new("laser", Arc::new(Laser::default())),
            Carrier::new("ring", Arc::new(Sonar::default())),
        ];
        let mut set = ScanSet::of(sensors);
        let scan = |sensor: usize, time_s: f64, readings: &[f64]| Scan {
            sensor,
            time_s,
            pose: Pose { x_m: 0.25, y_m: 0.25, theta_rad: 0.0 },
            bearings_rad: vec![0.0; readings.len()],
            readings: readings.iter().map(|reading| Some(*reading)).collect(),
        };
        // 15 px are a metre.
        let scans = [scan(0, 1.0, &[15.0, 70.0]), scan(1, 1.0, &[1.0, f64::INFINITY]), scan(2, 2.0, &[1.0])];
        scans.iter().for_each(|scan| set.add(scan));
        assert_eq!(set.scans[0].readings, [Some(15.0), None], "60 px are searched");
        assert_eq!(set.scans[1..], scans[1..]);
        let spec = GridSpec { cell_m: 0.25, origin_m: [-1.125; 2], width: 12, height: 8 };
        assert_eq!(set.visited(&spec), Visited { cells: 15, owed: 10, rays: 3 }, "a cone owes nothing");
        let apart: Vec<ScanSet> = (0..3).map(|number| set.of_sensor(number)).collect();
        let visited: Vec<u64> = apart.iter().map(|set| set.visited(&spec).cells).collect();
        assert_eq!((visited, apart[2].scans.len()), (vec![5, 5, 5], 1));
        assert_eq!(set.called().collect::<Vec<_>>(), ["camera", "laser", "ring"]);
    }
}
