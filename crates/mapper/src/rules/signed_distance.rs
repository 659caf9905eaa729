//! Truncated signed distance: how far is a cell in front of the surface, on the average of all rays?
//!
//! Curless and Levoy, "A volumetric method for building complex models from range images", SIGGRAPH 1996; Newcombe et al.,
//! "KinectFusion", ISMAR 2011. As Voxblox has it (Oleynikova, Taylor, Fehr, Siegwart and Nieto, IROS 2017): `tsdf_integrator.cc`
//! and the defaults of its ROS wrapper, at the revision of 2020.

use std::cell::OnceCell;

use grid::{DigitalLine, GridSpec, Raster};
use sensor::Scan;

use crate::belief::probability::bounded;
use crate::fit::{Candidate, Fit, Fitted, Setting, numbers};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::{Model, Sensors};
use crate::tuning::Tuning;

/// How distances are averaged and what they say of occupancy.
///
/// A ray that reads `z` tells a cell whose centre lies at `c` along it the distance `d = z - c`, positive in front, with weight
/// `w = z^-n`: the variance of depth grows as its square (`n = 2`, Voxblox) or, by stereo, as its fourth power. Behind the surface the
/// weight falls to nothing from one cell to the truncation. A cell keeps the weighted mean, cut to the truncation after every ray.
///
/// A signed distance is no occupancy. It is read as
///
/// ```text
/// p = low + (high - low) / (1 + exp((d - cell / 2) / width))
/// ```
///
/// since a cell is occupied where the surface lies in it or in front of it; the three numbers are fitted on the tuning scenes for the
/// values of the program too.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignedDistance {
    /// Distance that distances are cut to, in cells; above 1.
    pub truncation_cells: f64,
    /// `n`.
    pub weight_power: f64,
    /// A reading beyond this clears up to it, m.
    pub max_range_m: f64,
    /// `width`, in cells; above 0.
    pub width_cells: f64,
    /// `low` and `high`.
    pub clamp: [f64; 2],
}

impl SignedDistance {
    /// The defaults of Voxblox: four cells, the square of the depth, 5 m.
    pub const VOXBLOX: Self =
        Self { truncation_cells: 4.0, weight_power: 2.0, max_range_m: 5.0, width_cells: 1.0, clamp: [0.002, 0.8] };

    /// What the `tune` command finds best on the tuning scenes, which are not the scenes that results are reported on.
    pub const TUNED: Self = Self { truncation_cells: 8.0, clamp: [0.005, 0.6], ..Self::VOXBLOX };

    /// The rule with the values given.
    pub fn tuned(self, tuning: &Tuning) -> Self {
        Self { clamp: tuning.clamp(self.clamp), ..self }
    }

    /// Read-outs of a rule.
    fn read_out(rule: Self) -> impl Iterator<Item = Self> {
        let widths = [0.5, 1.0, 2.0].map(move |width_cells| Self { width_cells, ..rule });
        let read = |low| [0.4, 0.6, 0.8, 0.95].map(move |high| [low, high]);
        let clamps = move || [0.002, 0.005, 0.01].into_iter().flat_map(read);
        widths.into_iter().flat_map(move |rule| clamps().map(move |clamp| Self { clamp, ..rule }))
    }

    /// The read-out of the program's map.
    pub(crate) const VOXBLOX_FIT: Fit = Fit {
        mapper: "tsdf",
        built_in: || Candidate::of(Self::VOXBLOX),
        tried: || Candidate::all(Self::read_out(Self::VOXBLOX)),
    };

    /// Truncation and weight too.
    pub(crate) const FIT: Fit = Fit {
        mapper: "tsdf-tuned",
        built_in: || Candidate::of(Self::TUNED),
        tried: || {
            let truncated = [4.0, 8.0, 16.0].map(|truncation_cells| Self { truncation_cells, ..Self::VOXBLOX });
            let weighed = |rule: Self| [1.0, 2.0, 4.0].map(|weight_power| Self { weight_power, ..rule });
            Candidate::all(truncated.into_iter().flat_map(weighed).flat_map(Self::read_out))
        },
    };

    /// Weight of a distance (m), of cells of side `cell_m`, where it is `weight` in front of the surface.
    fn weight(&self, weight: f64, distance_m: f64, cell_m: f64) -> f64 {
        let truncation_m = self.truncation_cells * cell_m;
        let behind = (truncation_m + distance_m) / (truncation_m - cell_m);
        if distance_m < -cell_m { weight * behind.max(0.0) } else { weight }
    }

    /// What a signed distance says.
    fn occupancy(&self, distance_m: f64, cell_m: f64) -> f64 {
        let [low, high] = self.clamp;
        let behind = (distance_m - 0.5 * cell_m) / (self.width_cells * cell_m);
        bounded(low + (high - low) / (1.0 + libm::exp(behind)))
    }
}

/// Weights add up to this at most.
const MOST_WEIGHT: f64 = 1e4;

/// A cell with less was not seen.
const LEAST_WEIGHT: f64 = 1e-6;

/// A reading below this is not used, m.
const MIN_RANGE_M: f64 = 0.1;

impl Fitted for SignedDistance {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        numbers([
            ("truncation_cells", self.truncation_cells),
            ("weight_power", self.weight_power),
            ("max_range_m", self.max_range_m),
            ("width_cells", self.width_cells),
            ("clamp_low", self.clamp[0]),
            ("clamp_high", self.clamp[1]),
        ])
    }

    fn label(&self) -> String {
        let Self { truncation_cells: cells, weight_power: n, max_range_m, width_cells, clamp: [low, high] } = self;
        format!("t {cells}, z^-{n}, {max_range_m} m: {width_cells}, {low}..{high}")
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(SignedDistances::new(model, *self))
    }
}

/// The mapper with this rule. O(cells up to the reading and the truncation) per ray.
///
/// Weights take ranges for depths, which only a camera has. Beams without echo and readings without a range say nothing.
/// A cell that was not seen reports the prior.
#[derive(Clone)]
pub struct SignedDistances {
    rule: SignedDistance,
    prior: f64,
    spec: GridSpec,
    /// Signed distance (m) and weight of every cell.
    state: Vec<[f64; 2]>,
    sensors: Sensors,
    line: DigitalLine,
    cells: u64,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
}

impl SignedDistances {
    /// The unseen map.
    pub fn new(model: &Model, rule: SignedDistance) -> Self {
        Self {
            rule,
            prior: model.prior.marginal(),
            spec: model.grid,
            state: vec![[0.0; 2]; model.grid.cells()],
            sensors: model.sensors.clone(),
            line: DigitalLine::default(),
            cells: 0,
            occupancy: OnceCell::new(),
        }
    }

    /// Takes a distance (m) into the mean of a cell.
    fn add(&mut self, cell: usize, distance_m: f64, weight: f64) {
        let truncation_m = self.rule.truncation_cells * self.spec.cell_m;
        let [mean, sum] = &mut self.state[cell];
        let total = *sum + weight;
        if total >= LEAST_WEIGHT {
            *mean = ((*mean * *sum + distance_m * weight) / total).clamp(-truncation_m, truncation_m);
            *sum = total.min(MOST_WEIGHT);
        }
    }
}

impl Mapper for SignedDistances {
    fn integrate(&mut self, scan: &Scan) {
        let sensor = std::sync::Arc::clone(self.sensors.of(scan));
        let (rule, cell_m) = (self.rule, self.spec.cell_m);
        let truncation_m = rule.truncation_cells * cell_m;
        for ray in scan.rays() {
            let point = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad));
            let Some(range_m) = point.filter(|range| *range >= MIN_RANGE_M) else { continue };
            let until_m = match range_m > rule.max_range_m {
                true => (range_m - truncation_m).clamp(0.0, rule.max_range_m),
                false => range_m + truncation_m,
            };
            let weight = libm::pow(range_m, -rule.weight_power);
            self.line.trace(&self.spec, ray.origin_m, ray.direction, until_m);
            for k in 0..self.line.len() {
                let cell = self.line.cells()[k];
                let [x, y] = self.spec.centre(cell);
                let along_m = (x - ray.origin_m[0]) * ray.direction[0] + (y - ray.origin_m[1]) * ray.direction[1];
                let distance_m = range_m - along_m;
                self.add(cell, distance_m, rule.weight(weight, distance_m, cell_m));
            }
            self.cells += self.line.len() as u64;
        }
        self.occupancy.take();
    }

    fn occupancy(&self) -> &Raster<f64> {
        self.occupancy.get_or_init(|| {
            let of = |[distance_m, weight]: &[f64; 2]| match *weight >= LEAST_WEIGHT {
                true => self.rule.occupancy(*distance_m, self.spec.cell_m),
                false => self.prior,
            };
            Raster::new(self.spec, self.state.iter().map(of).collect())
        })
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    fn leaves_out(&self) -> bool {
        self.rule.max_range_m.is_finite()
    }

    fn work(&self) -> Work {
        Work { cells: self.cells, bytes: self.state.held() + self.line.held() + self.occupancy.held() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sensor::{Laser, Pose, Ray};
    use std::sync::Arc;

    const SPEC: GridSpec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 30, height: 30 };

    fn mapped(rule: SignedDistance, scans: &[Scan]) -> SignedDistances {
        let mut mapper = SignedDistances::new(&Model::new(SPEC, Arc::new(Laser::default())), rule);
        scans.iter().for_each(|scan| mapper.integrate(scan));
        mapper
    }

    fn along(reading: f64) -> Scan {
        let pose = Pose { x_m: 0.0, y_m: 1.55, theta_rad: 0.0 };
        Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(reading)] }
    }

    /// A ray of 2 m along a row, then one of 1 m: weights 1/4 and 1.
    #[test]
    fn two_rays_by_hand() {
        let mapper = mapped(SignedDistance::VOXBLOX, &[along(2.0), along(1.0)]);
        let at = |column: usize| mapper.state[SPEC.index(column, 15)];
        let near =
            |a: [f64; 2], b: [f64; 2]| assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12, "{a:?}");
        // 0.95 m: 1.05 m in front, cut to 0.4 m, then 0.05 m in front: (0.4 / 4 + 0.05) / (5 / 4).
        near(at(9), [0.12, 1.25]);
        // 1.25 m: 0.25 m behind the second, weight (0.4 - 0.25) / (0.4 - 0.1) = 1/2: (0.4 / 4 - 0.25 / 2) / (3 / 4).
        near(at(12), [-0.025 / 0.75, 0.75]);
        near(at(16), [0.35, 0.25]); // beyond the truncation of the second
        near(at(22), [-0.25, 0.125]);
        near(at(24), [0.0; 2]);
    }

    #[test]
    fn far_readings_clear_up_to_the_range_and_no_farther() {
        let rule = SignedDistance { max_range_m: 1.5, ..SignedDistance::VOXBLOX };
        let mapper = mapped(rule, &[along(2.5)]);
        let row = (0..30).map(|column| mapper.state[SPEC.index(column, 15)]);
        let cleared: Vec<bool> = row.map(|[d, w]| (d - 0.4).abs() < 1e-12 && (w - 0.16).abs() < 1e-12).collect();
        assert!(cleared[..15].iter().all(|c| *c) && !cleared[15..].iter().any(|c| *c), "{cleared:?}");
        assert!(mapped(rule, &[along(0.09)]).state.iter().all(|[_, w]| w.abs() < 1e-15), "too near");
    }

    #[test]
    fn occupancy_falls_with_the_distance_from_high_to_low() {
        let rule = SignedDistance { width_cells: 0.5, clamp: [0.1, 0.7], ..SignedDistance::VOXBLOX };
        assert!((rule.occupancy(0.05, 0.1) - 0.4).abs() < 1e-12, "half a cell in front");
        assert!((rule.occupancy(-5.0, 0.1) - 0.7).abs() < 1e-12 && (rule.occupancy(5.0, 0.1) - 0.1).abs() < 1e-12);
        assert!((rule.occupancy(0.1, 0.1) - (0.1 + 0.6 / (1.0 + 1f64.exp()))).abs() < 1e-12);
    }

    /// Where a ray enters and leaves a cell, by its four sides.
    fn chord(ray: &Ray, cell: usize) -> Option<[f64; 2]> {
        let corner = SPEC.corner(cell);
        let spans = [0, 1].map(|a| {
            let [one, other] = [corner[a], corner[a] + 0.1].map(|line| (line - ray.origin_m[a]) / ray.direction[a]);
            [one.min(other), one.max(other)]
        });
        let [enter, exit] = [spans[0][0].max(spans[1][0]).max(0.0), spans[0][1].min(spans[1][1])];
        (enter < exit).then_some([enter, exit])
    }

    proptest! {
        /// Cell by cell, asked about every ray.
        #[test]
        fn cells_hold_the_mean_of_what_rays_tell(
            at in prop::array::uniform2(0.11f64..2.89), theta_rad in -4.0f64..4.0, power in 0.0f64..4.0, max_range_m in 0.5f64..4.0,
            rays in prop::collection::vec((-1.0f64..1.0, prop::option::of(0.05f64..4.0)), 1..12), cells in 1.5f64..6.0,
        ) {
            let pose = Pose { x_m: at[0], y_m: at[1], theta_rad };
            let (bearings_rad, readings): (Vec<f64>, Vec<Option<f64>>) = rays.into_iter().unzip();
            let scan = Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings };
            let rule = SignedDistance { truncation_cells: cells, weight_power: power, max_range_m, ..SignedDistance::VOXBLOX };
            let mapper = mapped(rule, std::slice::from_ref(&scan));
            let t = 0.1 * cells;
            for cell in 0..SPEC.cells() {
                let (mut mean, mut sum, mut doubtful) = (0.0f64, 0.0f64, false);
                for ray in scan.rays() {
                    let (Some(z), Some([enter, exit])) = (ray.reading.filter(|z| *z >= 0.1), chord(&ray, cell)) else { continue };
                    let end = if z <= max_range_m { z + t } else { (z - t).max(0.0).min(max_range_m) };
                    doubtful |= (enter - end).abs() < 1e-9 || exit - enter < 1e-9;
                    if enter >= end {
                        continue;
                    }
                    let centre = SPEC.centre(cell);
                    let d = z - (centre[0] - at[0]) * ray.direction[0] - (centre[1] - at[1]) * ray.direction[1];
                    let full = 1.0 / z.powf(power);
                    let w = if d >= -0.1 { full } else { (full * (t + d) / (t - 0.1)).max(0.0) };
                    if sum + w >= 1e-6 {
                        mean = ((mean * sum + d * w) / (sum + w)).min(t).max(-t);
                        sum += w;
                    }
                }
                if !doubtful {
                    let [found, weight] = mapper.state[cell];
                    prop_assert!((found - mean).abs() < 1e-9 && (weight - sum).abs() < 1e-9 * sum.max(1.0), "{cell}");
                    let p = if sum > 0.0 { 0.002 + 0.798 / (1.0 + ((mean - 0.05) / 0.1).exp()) } else { 0.1 };
                    prop_assert!((mapper.occupancy()[cell] - p).abs() < 1e-9);
                }
            }
        }
    }
}
