//! The rule in use today, as the paper states it: every cell for itself, Eqs. (22)-(26).

use grid::{DigitalLine, Raster};
use sensor::{Placement, Scan, SensorModel};

use crate::belief::probability::{EPSILON, bayes};
use crate::fit::{Candidate, Fit, Fitted, Setting, numbers};
use crate::mapper::{Mapper, Work};
use crate::memory::Held;
use crate::model::{Model, Sensors};
use crate::tuning::Tuning;

/// The rule for one cell and one reading.
///
/// Cells whose interval of readings meets `o ± w` count as seen occupied, Eqs. (23) and (24); nearer
/// cells as seen free, Eqs. (25) and (26); cells behind are left alone. The densities of the paper
/// become probabilities of the bin `o ± w`, so that (23) and (24) compare like with like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ConventionalRule {
    /// `w`: half the bin of a reading, in the reading's unit; above 0.
    pub half_width: f64,
    /// Least and largest probability of a cell after an update, kept within [`EPSILON`] of 0 and 1.
    pub clamp: [f64; 2],
}

impl Default for ConventionalRule {
    /// As the paper has it: a bin of 1 px, and no clamps but those of every mapper.
    fn default() -> Self {
        Self { half_width: 0.5, clamp: [EPSILON, 1.0 - EPSILON] }
    }
}

impl ConventionalRule {
    /// Bin and clamps as the `tune` command fits them on the tuning scenes, which are not the scenes
    /// that results are reported on: the least log loss that the rule can reach. It gets there by
    /// never being surer of an obstacle than 0.4.
    pub const TUNED: Self = Self { half_width: 0.45, clamp: [0.005, 0.4] };

    /// Candidates and choice.
    pub(crate) const FIT: Fit = Fit {
        mapper: "conventional-tuned",
        built_in: || Candidate::of(Self::TUNED),
        tried: || {
            let clamps = || LOWS.iter().flat_map(|&low| HIGHS.map(|high| [low, high]));
            let rules = |half_width| clamps().map(move |clamp| Self { half_width, clamp });
            Candidate::all(HALF_WIDTHS.into_iter().flat_map(rules))
        },
    };

    /// Likelihoods of the reading if the cell in the chord `enter ..= exit` (m) is occupied and if
    /// it is free; none for a cell behind the reading.
    pub fn likelihoods(
        &self,
        sensor: &(impl SensorModel + ?Sized),
        reading: f64,
        bearing: f64,
        enter: f64,
        exit: f64,
    ) -> Option<[f64; 2]> {
        let correct = sensor.correct_match();
        let bin = || sensor.bin_probability(reading, self.half_width, bearing, enter, exit);
        match sensor.placement(reading, self.half_width, bearing, enter, exit) {
            Placement::Within => {
                let false_match = sensor.false_match_probability(reading, self.half_width);
                let occupied = correct * bin() + (1.0 - correct) * false_match; // Eqs. (21), (23)
                Some([occupied, 1.0 - correct]) // Eq. (24)
            }
            Placement::Nearer => Some([1.0 - correct, correct * (1.0 - bin())]), // Eqs. (25), (26)
            Placement::Behind => None,
        }
    }

    /// [`likelihoods`](Self::likelihoods) of all chords along a ray that are not behind the reading, to the bit: chord `k` is
    /// `ranges[k] ..= ranges[k + 1]`.
    pub(crate) fn along(
        &self,
        sensor: &(impl SensorModel + ?Sized),
        reading: f64,
        bearing: f64,
        ranges: &[f64],
        along: &mut Along,
    ) {
        let Along { bins, likelihoods } = along;
        likelihoods.clear();
        bins.resize(bins.len().max(ranges.len() - 1), 0.0);
        let bins = &mut bins[..ranges.len() - 1];
        let within = sensor.bins(reading, self.half_width, bearing, ranges, bins);
        let correct = sensor.correct_match();
        let nearer = bins[..within.start].iter();
        likelihoods.extend(nearer.map(|bin| [1.0 - correct, correct * (1.0 - bin)])); // Eqs. (25), (26)
        if within.is_empty() {
            return;
        }
        let false_match = (1.0 - correct) * sensor.false_match_probability(reading, self.half_width);
        let within = bins[within].iter();
        likelihoods.extend(within.map(|bin| [correct * bin + false_match, 1.0 - correct])); // Eqs. (21), (23), (24)
    }

    /// This rule, made for the paper's camera with its bin of 1 px, for another sensor and cells of side `cell_m` (m):
    /// the same share of that sensor's bin.
    pub fn for_sensor(self, sensor: &(impl SensorModel + ?Sized), cell_m: f64) -> Self {
        Self { half_width: self.half_width * (sensor.half_bin(cell_m) / 0.5), ..self }
    }

    /// The rule of every sensor of a model: [`for_sensor`](Self::for_sensor), with the values of the model's tuning.
    pub(crate) fn for_sensors(self, model: &Model) -> Vec<Self> {
        let cell_m = model.grid.cell_m;
        model.sensors.iter().map(|sensor| self.for_sensor(&**sensor, cell_m).tuned(&model.tuning)).collect()
    }

    /// The rule with the values given.
    pub fn tuned(self, tuning: &Tuning) -> Self {
        Self { half_width: tuning.half_width.unwrap_or(self.half_width), clamp: tuning.clamp(self.clamp) }
    }

    /// Eq. (22) within the clamps of this rule.
    pub fn update(&self, p: f64, likelihoods: [f64; 2]) -> f64 {
        let [low, high] = self.clamp;
        bayes(p, likelihoods).clamp(low.max(EPSILON), high.min(1.0 - EPSILON))
    }

    /// The same for some cells of a map.
    fn update_cells(&self, map: &mut [f64], cells: &[usize], likelihoods: impl Iterator<Item = [f64; 2]>) {
        for (&cell, likelihoods) in cells.iter().zip(likelihoods) {
            let p = &mut map[cell];
            *p = self.update(*p, likelihoods);
        }
    }
}

/// What a reading says of the chords along its ray. A buffer to fill again and again.
#[derive(Clone, Default)]
pub(crate) struct Along {
    bins: Vec<f64>,
    /// Likelihoods of the reading if a chord's cell is occupied and if it is free, of all that are not behind it.
    pub(crate) likelihoods: Vec<[f64; 2]>,
}

impl Held for Along {
    fn held(&self) -> usize {
        self.bins.held() + self.likelihoods.held()
    }
}

/// Half of the bin of a reading, px.
const HALF_WIDTHS: [f64; 6] = [0.25, 0.35, 0.4, 0.45, 0.5, 0.7];

/// Least and largest probabilities; the first and the last are those of every mapper.
const LOWS: [f64; 5] = [EPSILON, 0.005, 0.01, 0.02, 0.05];
const HIGHS: [f64; 7] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0 - EPSILON];

impl Fitted for ConventionalRule {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        let Self { half_width, clamp: [low, high] } = *self;
        numbers([("half_width_px", half_width), ("clamp_low", low), ("clamp_high", high)])
    }

    fn label(&self) -> String {
        let Self { half_width, clamp: [low, high] } = self;
        format!("w {half_width} px, {low} to {high}")
    }

    /// With the bin of every sensor.
    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(Conventional::for_sensors(model, *self))
    }
}

/// The conventional occupancy update: neither occlusion nor continuity. O(cells up to the reading)
/// per ray.
#[derive(Clone)]
pub struct Conventional {
    occupancy: Raster<f64>,
    sensors: Sensors,
    /// The rule of every sensor.
    rules: Vec<ConventionalRule>,
    line: DigitalLine,
    along: Along,
    cells: u64,
}

impl Conventional {
    /// The rule of the paper, with the bin of every sensor.
    pub fn new(model: &Model) -> Self {
        Self::for_sensors(model, ConventionalRule::default())
    }

    /// A rule made for the paper's camera, with the bin of every sensor.
    pub fn for_sensors(model: &Model, rule: ConventionalRule) -> Self {
        Self { rules: rule.for_sensors(model), ..Self::with(model, rule) }
    }

    /// The rule with other parameters, as they are, whatever the sensor.
    pub fn with(model: &Model, rule: ConventionalRule) -> Self {
        Self {
            occupancy: Raster::filled(model.grid, model.prior.marginal()),
            sensors: model.sensors.clone(),
            rules: vec![rule; model.sensors.iter().len()],
            line: DigitalLine::default(),
            along: Along::default(),
            cells: 0,
        }
    }
}

impl Mapper for Conventional {
    fn integrate(&mut self, scan: &Scan) {
        let sensor = &**self.sensors.of(scan);
        let rule = self.rules[scan.sensor];
        let spec = *self.occupancy.spec();
        let seen_free = [1.0 - sensor.correct_match(), sensor.correct_match()]; // Eqs. (25), (26) with an empty bin
        for ray in scan.rays() {
            let Some(reading) = ray.reading else { continue };
            let (bearing, half_width) = (ray.bearing_rad, rule.half_width);
            // A chord is at most a diagonal: no cell that matters is cut short.
            let end_m = sensor.behind_from(reading, half_width, bearing) + 3.0 * spec.cell_m;
            self.line.trace(&spec, ray.origin_m, ray.direction, end_m);
            let (cells, ranges) = (self.line.cells(), self.line.ranges());
            let clear_m = sensor.clear_until(reading, half_width, bearing);
            let clear = ranges[1..].partition_point(|exit| *exit <= clear_m);
            rule.along(sensor, reading, bearing, &ranges[clear..], &mut self.along);
            let (map, likelihoods) = (self.occupancy.values_mut(), &self.along.likelihoods);
            rule.update_cells(map, &cells[..clear], std::iter::repeat(seen_free));
            rule.update_cells(map, &cells[clear..], likelihoods.iter().copied());
            self.cells += (clear + likelihoods.len()) as u64;
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.occupancy.held() + self.line.held() + self.along.held() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::{InverseModel as _, Laser, Pose, Stereo};
    use std::sync::Arc;

    fn model(width: usize) -> Model {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height: 1 };
        Model::new(grid, Arc::new(Stereo::default()))
    }

    fn scan(reading: f64) -> Scan {
        let pose = Pose { x_m: 0.0, y_m: 0.025, theta_rad: 0.0 };
        Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(reading)] }
    }

    /// The rule cell by cell: every chord asked about by itself, to the end of the map.
    fn cell_by_cell(model: &Model, rules: &[ConventionalRule], scans: &[Scan]) -> (Raster<f64>, u64) {
        let (mut map, mut cells) = (Raster::filled(model.grid, model.prior.marginal()), 0);
        for scan in scans {
            let (sensor, rule) = (&**model.sensors.of(scan), rules[scan.sensor]);
            for ray in scan.rays() {
                let Some(reading) = ray.reading else { continue };
                let mut line = DigitalLine::default();
                line.trace(&model.grid, ray.origin_m, ray.direction, f64::INFINITY);
                for (&cell, chord) in line.cells().iter().zip(line.ranges().windows(2)) {
                    let free = chord[1] <= sensor.clear_until(reading, rule.half_width, ray.bearing_rad);
                    let seen_free = free.then_some([1.0 - sensor.correct_match(), sensor.correct_match()]);
                    let likelihoods = || rule.likelihoods(sensor, reading, ray.bearing_rad, chord[0], chord[1]);
                    let Some(likelihoods) = seen_free.or_else(likelihoods) else { break };
                    map[cell] = rule.update(map[cell], likelihoods);
                    cells += 1;
                }
            }
        }
        (map, cells)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

        /// To the bit: readings at the sensor, beyond the map and without range, none, bearings behind the camera, rays from grid lines.
        #[test]
        fn it_is_the_rule_cell_by_cell(
            (width, height) in (1usize..70, 1usize..50), at in prop::array::uniform2((0.0f64..1.0, any::<bool>())), quarter in 0usize..8,
            rays in prop::collection::vec((
                prop_oneof![6 => -1.5f64..1.5, 2 => -4.0f64..4.0, 1 => Just(0.0)],
                prop_oneof![5 => (0.0f64..5.0).prop_map(Some), 2 => (0.0f64..70.0).prop_map(Some), 1 => Just(Some(0.0)),
                    1 => Just(Some(f64::INFINITY)), 1 => Just(None)],
            ), 1..20),
            clamp in prop::sample::select(vec![[EPSILON, 1.0 - EPSILON], [0.005, 0.4], [0.2, 0.6]]), sigma in 0.02f64..0.8, which in 0usize..2,
        ) {
            let grid = GridSpec { cell_m: 0.05, origin_m: [-0.4, 3.0], width, height };
            let sensors: Vec<Arc<dyn SensorModel>> = vec![
                Arc::new(Stereo { disparity_sigma: sigma, ..Stereo::default() }),
                Arc::new(Laser { range_sigma_m: 0.1 * sigma, max_range_m: 2.0, ..Laser::default() }),
            ];
            let model = Model { sensors: Sensors::new(sensors), ..Model::new(grid, Arc::new(Stereo::default())) };
            let [x_m, y_m] = [0, 1].map(|k| {
                let cells = at[k].0 * [width, height][k] as f64;
                grid.origin_m[k] + 0.05 * if at[k].1 { cells.floor() } else { cells }
            });
            let pose = Pose { x_m, y_m, theta_rad: quarter as f64 * std::f64::consts::FRAC_PI_4 };
            let (bearings_rad, readings): (Vec<f64>, Vec<Option<f64>>) = rays.into_iter().unzip();
            let scan = |sensor| Scan { sensor, time_s: 0.0, pose, bearings_rad: bearings_rad.clone(), readings: readings.clone() };
            let scans = [scan(which), scan(1 - which)];
            let rule = ConventionalRule { clamp, ..ConventionalRule::default() };
            let mut mapper = Conventional::for_sensors(&model, rule);
            scans.iter().for_each(|scan| mapper.integrate(scan));
            let (map, cells) = cell_by_cell(&model, &rule.for_sensors(&model), &scans);
            let bits = |map: &Raster<f64>| map.values().iter().map(|p| p.to_bits()).collect::<Vec<_>>();
            prop_assert_eq!(bits(mapper.occupancy()), bits(&map));
            prop_assert_eq!(mapper.work().cells, cells);
        }
    }

    #[test]
    fn one_reading_of_ten_pixels_by_hand() {
        let mut mapper = Conventional::new(&model(60));
        mapper.integrate(&scan(10.0));
        let p = mapper.occupancy().values();
        // Cell 10 lies at 0.5 m, 27 to 30 px: nearer. Eqs. (25), (26) with an empty bin.
        assert!((p[10] - 0.1 * 0.2 / (0.1 * 0.2 + 0.9 * 0.8)).abs() < 1e-12);
        // Cell 30 begins at 1.5 m, 10 px, and spans 0.32 px: Eqs. (23), (24). The bin holds
        // Phi(1) - Phi(-1) = 0.6827 at 10 px, and a little less over the chord.
        let bin = Stereo::default().bin_probability(10.0, 0.5, 0.0, 1.5, 1.55);
        assert!(bin < 0.6827 && bin > 0.65);
        let occupied = 0.8 * bin + 0.2 / 60.0;
        assert!((p[30] - 0.1 * occupied / (0.1 * occupied + 0.9 * 0.2)).abs() < 1e-12);
        // Cells from 15 / 9.5 = 1.579 m on are behind.
        assert!((p[32] - 0.1).abs() < 1e-15);
        assert!((p[31] - 0.1).abs() > 1e-3, "1.55 m is still within");
    }

    #[test]
    fn readings_by_the_thousand_stay_off_zero_and_one() {
        let mut mapper = Conventional::new(&model(60));
        for _ in 0..5000 {
            mapper.integrate(&scan(10.0));
        }
        assert!(mapper.occupancy().values().iter().all(|p| (EPSILON..=1.0 - EPSILON).contains(p)));
    }

    #[test]
    fn clamps_hold_cells_that_readings_move_and_no_others() {
        let rule = ConventionalRule { clamp: [0.2, 0.6], ..ConventionalRule::default() };
        let mut mapper = Conventional::with(&model(60), rule);
        for _ in 0..20 {
            mapper.integrate(&scan(10.0));
        }
        let p = mapper.occupancy().values();
        assert!((p[10] - 0.2).abs() < 1e-15 && (p[30] - 0.6).abs() < 1e-15);
        assert!((p[40] - 0.1).abs() < 1e-15, "never updated: the prior, though below the clamp");
    }

    #[test]
    fn a_wider_bin_counts_more_cells_as_seen() {
        let [narrow, wide] = [0.5, 1.0].map(|half_width| {
            let mut mapper = Conventional::with(&model(60), ConventionalRule { half_width, ..Default::default() });
            mapper.integrate(&scan(10.0));
            mapper.occupancy().values().iter().filter(|p| **p > 0.1).count()
        });
        // 15 / 10.5 = 1.43 to 1.58 m, and 1.36 to 1.67 m; the outermost cells hold too little to rise.
        assert!(narrow >= 3 && wide > narrow, "{narrow} {wide}");
    }

    #[test]
    fn certain_sensors_do_not_divide_by_zero() {
        for correct_match in [0.0, 1.0] {
            let sensor = Stereo { correct_match, ..Stereo::default() };
            let mut mapper = Conventional::new(&Model { sensors: Sensors::one(Arc::new(sensor)), ..model(60) });
            mapper.integrate(&scan(10.0));
            assert!(mapper.occupancy().values().iter().all(|p| p.is_finite()));
        }
    }
}
