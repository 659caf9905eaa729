//! A monotone recalibration of a map: what it predicts once its scale of certainty is set right.
//!
//! A map whose clamps keep every cell it has seen free at 0.12 predicts a wall every few cells, and so worse than a map that knows nothing,
//! though it may show well where the walls are. Its log odds times a slope plus a shift keep the order of its cells and set their scale:
//! calibration slope and intercept of Cox, "Two further applications of a model for binary regression", Biometrika 45, 1958.

use grid::Raster;

use crate::belief::probability::{from_log_odds, log_odds};
use crate::ray::predictive::{NOTHING, Predictive};

/// `logit p' = shift + slope logit p`, with a slope above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recalibration {
    /// Log odds that are added.
    pub shift: f64,
    /// What log odds are multiplied by, above 0.
    pub slope: f64,
}

/// A ray with its reading, kept to fit a recalibration to.
#[derive(Debug, Clone)]
pub struct FitRay {
    cells: Vec<u32>,
    /// `P(o | F_k)` of every cell.
    likelihood: Vec<f64>,
    /// `P(o | no cell of the ray is occupied)`.
    none: f64,
}

impl FitRay {
    /// The ray, or cone, that was taken up last.
    pub fn of(predictive: &Predictive) -> Self {
        let (ahead, none) = predictive.ahead();
        let (cells, likelihood) = ahead.map(|ahead| (ahead.cell as u32, ahead.likelihood)).unzip();
        Self { cells, likelihood, none }
    }
}

/// Steps of a fit, at most.
const STEPS: usize = 60;

/// Shifts and slopes of which the best are where a fit starts from, since the loss may have several minima.
const GRID: [&[f64]; 2] =
    [&[0.0, -1.0, 1.0, -2.0, 2.0, -4.0, 4.0, -6.0, 6.0], &[1.0, 0.1, 0.3, 0.6, 1.5, 2.5, 4.0, 8.0]];

/// So many of them.
const STARTS: usize = 3;

/// They are chosen by at most about so many rays.
const FEW: usize = 1000;

/// A step that gains less than this, nats per ray, is the last.
const TOLERANCE: f64 = 1e-6;

/// Shift and logarithm of the slope stay within these.
const BOUNDS: [f64; 2] = [30.0, 5.0];

/// No step is longer than this, so that none leads to where nothing changes any more.
const LONGEST: [f64; 2] = [1.0, 0.5];

impl Recalibration {
    /// What leaves a map as it is.
    pub const NONE: Self = Self { shift: 0.0, slope: 1.0 };

    /// A probability recalibrated; kept off 0 and 1 by [`EPSILON`](crate::EPSILON), before and after.
    pub fn of(&self, p: f64) -> f64 {
        from_log_odds(self.shift + self.slope * log_odds(p))
    }

    /// A map, 0 to 1, with its seen cells recalibrated; a cell that is not seen keeps the prior that it has.
    pub fn map(&self, occupancy: &Raster<f64>, seen: &Raster<bool>) -> Raster<f64> {
        let cell = |(p, seen): (&f64, &bool)| if *seen { self.of(*p) } else { *p };
        Raster::new(*occupancy.spec(), occupancy.values().iter().zip(seen.values()).map(cell).collect())
    }

    /// The recalibration under which the seen cells of a map predict these readings best: the largest likelihood by scoring steps
    /// (Berndt, Hall, Hall and Hausman 1974) with Levenberg's damping. [`NONE`](Self::NONE) without rays. O(cells on the rays) per step.
    pub fn fit(rays: &[FitRay], occupancy: &Raster<f64>, seen: &Raster<bool>) -> Self {
        let states = occupancy.values().iter().zip(seen.values());
        let cells: Vec<Cell> =
            states.map(|(p, seen)| if *seen { Cell::Seen(log_odds(*p)) } else { Cell::Unseen(*p) }).collect();
        let all: Vec<&FitRay> = rays.iter().collect();
        let some: Vec<&FitRay> = rays.iter().step_by(rays.len() / FEW + 1).collect();
        let places = GRID[0].iter().flat_map(|shift| GRID[1].iter().map(|slope| [*shift, libm::log(*slope)]));
        let mut places: Vec<(f64, [f64; 2])> = places.map(|at| (Slope::of(&some, &cells, at).loss, at)).collect();
        places.sort_by(|a, b| a.0.total_cmp(&b.0)); // stable: of places that are as good, the one that changes least
        let ends = places.iter().take(STARTS).map(|(_, start)| Slope::descend(&some, &cells, *start));
        let ends = ends.map(|at| (Slope::of(&all, &cells, at).loss, at));
        let (_, start) = ends.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, [0.0; 2]));
        let [shift, log_slope] = Slope::descend(&all, &cells, start);
        Self { shift, slope: libm::exp(log_slope) }
    }
}

/// A cell as the fit sees it.
#[derive(Clone, Copy)]
enum Cell {
    /// Log odds of a cell that is recalibrated.
    Seen(f64),
    /// Probability of one that is not.
    Unseen(f64),
}

/// The loss at a shift and a logarithm of the slope, and how it changes with them.
struct Slope {
    /// `-ln P` of all readings, nats.
    loss: f64,
    gradient: [f64; 2],
    /// Sum of the outer products of the readings' gradients: `xx`, `xy`, `yy`.
    information: [f64; 3],
}

impl Slope {
    /// Goes down from a place; where that ends.
    fn descend(rays: &[&FitRay], cells: &[Cell], mut at: [f64; 2]) -> [f64; 2] {
        let (mut here, mut damping) = (Self::of(rays, cells, at), 1e-3);
        for _ in 0..STEPS {
            let to = here.step(at, damping);
            let there = Self::of(rays, cells, to);
            let gain = here.loss - there.loss;
            if gain > 0.0 {
                (at, here, damping) = (to, there, (0.1 * damping).max(1e-6));
            } else {
                damping *= 10.0;
            }
            if (0.0..=TOLERANCE * rays.len() as f64).contains(&gain) || damping > 1e6 {
                break;
            }
        }
        at
    }

    fn of(rays: &[&FitRay], cells: &[Cell], at: [f64; 2]) -> Self {
        let slope = libm::exp(at[1]);
        let mut sum = Self { loss: 0.0, gradient: [0.0; 2], information: [0.0; 3] };
        for ray in rays {
            let (loss, [x, y]) = ray.loss(cells, at[0], slope);
            sum.loss += loss;
            sum.gradient[0] += x;
            sum.gradient[1] += y;
            sum.information = [sum.information[0] + x * x, sum.information[1] + x * y, sum.information[2] + y * y];
        }
        sum
    }

    /// Where a damped step leads: neither where nothing changes, nor past the bounds.
    fn step(&self, at: [f64; 2], damping: f64) -> [f64; 2] {
        let [xx, mut xy, yy] = self.information;
        let more = damping * (xx + yy) + f64::MIN_POSITIVE;
        let (xx, yy) = (xx + more, yy + more);
        let is_held = |k: usize| at[k] * -self.gradient[k].signum() >= BOUNDS[k];
        let [x, y] = std::array::from_fn(|k| if is_held(k) { 0.0 } else { self.gradient[k] });
        if is_held(0) || is_held(1) {
            xy = 0.0;
        }
        let determinant = xx * yy - xy * xy;
        let step = [(yy * x - xy * y) / determinant, (xx * y - xy * x) / determinant];
        std::array::from_fn(|k| (at[k] - step[k].clamp(-LONGEST[k], LONGEST[k])).clamp(-BOUNDS[k], BOUNDS[k]))
    }
}

impl FitRay {
    /// `-ln P(reading | map)`, and its derivatives by the shift and by the logarithm of the slope.
    fn loss(&self, cells: &[Cell], shift: f64, slope: f64) -> (f64, [f64; 2]) {
        let (mut sum, mut clear) = (0.0, 1.0);
        let (mut sum_by, mut clear_by) = ([0.0; 2], [0.0; 2]);
        for (cell, likelihood) in self.cells.iter().zip(&self.likelihood) {
            let (p, by) = match cells[*cell as usize] {
                Cell::Unseen(p) => (p, [0.0; 2]),
                Cell::Seen(log_odds) => {
                    let p = from_log_odds(shift + slope * log_odds);
                    let change = p * (1.0 - p);
                    (p, [change, change * slope * log_odds])
                }
            };
            sum += clear * p * likelihood;
            for k in 0..2 {
                sum_by[k] += (clear_by[k] * p + clear * by[k]) * likelihood;
                clear_by[k] = clear_by[k] * (1.0 - p) - clear * by[k];
            }
            clear *= 1.0 - p;
            if clear < NOTHING {
                (clear, clear_by) = (0.0, [0.0; 2]);
                break;
            }
        }
        let total = (sum + clear * self.none).max(f64::MIN_POSITIVE);
        (-libm::log(total), std::array::from_fn(|k| -(sum_by[k] + clear_by[k] * self.none) / total))
    }
}

#[cfg(test)]
mod tests {
    use grid::GridSpec;
    use proptest::prelude::*;
    use sensor::{Laser, Pose, Scan};

    use super::*;
    use crate::Belief;

    /// Readings of rays over a strip of cells, and the rays kept of them.
    struct Strip {
        spec: GridSpec,
        laser: Laser,
        scan: Scan,
    }

    impl Strip {
        fn new(width: usize, readings: Vec<f64>) -> Self {
            let spec = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height: 3 };
            let bearings_rad = (0..readings.len()).map(|k| 0.0005 * (k as f64 - 3.0)).collect();
            let pose = Pose { x_m: 0.03, y_m: 0.15, theta_rad: 0.0 };
            let readings = readings.into_iter().map(Some).collect();
            Self { spec, laser: Laser::default(), scan: Scan { sensor: 0, time_s: 0.0, pose, bearings_rad, readings } }
        }

        fn rays(&self) -> Vec<FitRay> {
            let mut predictive = Predictive::new(self.spec, &self.laser, 0.02);
            self.scan
                .rays()
                .filter_map(|ray| if predictive.take(&ray) { Some(FitRay::of(&predictive)) } else { None })
                .collect()
        }

        /// The loss of a map by the predictive model itself.
        fn loss(&self, map: &Raster<f64>) -> f64 {
            let mut predictive = Predictive::new(self.spec, &self.laser, 0.02);
            let losses = self
                .scan
                .rays()
                .map(|ray| if predictive.take(&ray) { predictive.log_loss(Belief::Cells(map)) } else { 0.0 });
            losses.sum()
        }
    }

    fn maps() -> impl Strategy<Value = (Vec<f64>, Vec<bool>, Vec<f64>)> {
        (4usize..20).prop_flat_map(|width| {
            let cells = prop::collection::vec(0.02f64..0.98, 3 * width);
            let seen = prop::collection::vec(prop::bool::weighted(0.8), 3 * width);
            (cells, seen, prop::collection::vec(0.05f64..2.0, 2..9))
        })
    }

    /// A map that knows roughly where a wall is, and readings of that wall, some of them of things before it.
    fn walls() -> impl Strategy<Value = (Vec<f64>, Vec<bool>, Vec<f64>)> {
        (6usize..20).prop_flat_map(|width| {
            let wall = width - 3;
            let cell = move |cell: usize| {
                let far = (cell % width).abs_diff(wall);
                (0.02f64..0.3).prop_map(move |p| if far == 0 { 1.0 - p } else { p })
            };
            let cells: Vec<_> = (0..3 * width).map(cell).collect();
            let seen = prop::collection::vec(prop::bool::weighted(0.95), 3 * width);
            let hit = move |noise: f64| 0.1 * wall as f64 + 0.02 + 0.05 * noise;
            let reading = prop_oneof![4 => (-1.0f64..1.0).prop_map(hit), 1 => 0.05f64..2.0];
            (cells, seen, prop::collection::vec(reading, 160..240))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// No shift and slope of a grid predict better than those that are found.
        #[test]
        fn it_is_the_best_of_all_that_are_tried((p, seen, readings) in walls()) {
            let strip = Strip::new(p.len() / 3, readings);
            let (map, seen) = (Raster::new(strip.spec, p), Raster::new(strip.spec, seen));
            let rays = strip.rays();
            let found = Recalibration::fit(&rays, &map, &seen);
            let least = strip.loss(&found.map(&map, &seen));
            for shift in (-16..=16).map(|k| 0.5 * f64::from(k)) {
                for slope in [0.02, 0.1, 0.3, 0.6, 1.0, 1.5, 2.0, 3.0, 5.0] {
                    for other in [Recalibration { shift, slope }, Recalibration { shift: found.shift + 0.02 * shift, slope: found.slope * slope.powf(0.02) }] {
                        let loss = strip.loss(&other.map(&map, &seen));
                        prop_assert!(loss > least - 1e-3 * rays.len() as f64, "{found:?} {least}, {other:?} {loss}");
                    }
                }
            }
        }

        /// The derivatives are those of differences, the loss is that of the predictive model.
        #[test]
        fn losses_and_derivatives_are_those_of_the_model((p, seen, readings) in maps(), shift in -2.0f64..2.0, log_slope in -1.0f64..1.0) {
            let strip = Strip::new(p.len() / 3, readings);
            let (map, seen) = (Raster::new(strip.spec, p), Raster::new(strip.spec, seen));
            let states = map.values().iter().zip(seen.values());
            let cells: Vec<Cell> = states.map(|(p, seen)| if *seen { Cell::Seen(log_odds(*p)) } else { Cell::Unseen(*p) }).collect();
            let rays = strip.rays();
            let rays: Vec<&FitRay> = rays.iter().collect();
            let at = |x: f64, y: f64| Slope::of(&rays, &cells, [x, y]);
            let here = at(shift, log_slope);
            let other = Recalibration { shift, slope: libm::exp(log_slope) };
            prop_assert!((here.loss - strip.loss(&other.map(&map, &seen))).abs() < 1e-9);
            let h = 1e-5;
            let by = [
                (at(shift + h, log_slope).loss - at(shift - h, log_slope).loss) / (2.0 * h),
                (at(shift, log_slope + h).loss - at(shift, log_slope - h).loss) / (2.0 * h),
            ];
            for k in 0..2 {
                prop_assert!((by[k] - here.gradient[k]).abs() < 1e-4 * (1.0 + by[k].abs()), "{by:?} {:?}", here.gradient);
            }
        }
    }

    #[test]
    fn a_map_that_is_squeezed_is_stretched_again_and_cells_that_are_not_seen_keep_theirs() {
        // A wall at 1.25 m that is known, but told with clamps: free at 0.3, occupied at 0.6.
        let strip = Strip::new(20, (0..40).map(|k| 1.25 + 0.001 * f64::from(k - 20)).collect());
        let wall = |cell: usize| cell % 20 == 12;
        let cells = (0..60)
            .map(|cell| {
                if wall(cell) {
                    0.6
                } else if cell % 20 < 12 {
                    0.3
                } else {
                    0.1
                }
            })
            .collect();
        let map = Raster::new(strip.spec, cells);
        let seen = Raster::new(strip.spec, (0..60).map(|cell| cell % 20 <= 12).collect());
        let found = Recalibration::fit(&strip.rays(), &map, &seen);
        let after = found.map(&map, &seen);
        assert!(after[5] < 0.01 && after[12] > 0.9 && found.slope > 1.0, "{found:?}");
        assert!((after[15] - 0.1).abs() < 1e-15);
        assert!(strip.loss(&after) < strip.loss(&map) - 40.0);
    }

    #[test]
    fn of_a_map_that_says_nothing_the_share_of_occupied_cells_is_found() {
        let strip = Strip::new(20, vec![1.25; 10]);
        let map = Raster::filled(strip.spec, 0.1);
        let found = Recalibration::fit(&strip.rays(), &map, &Raster::filled(strip.spec, true));
        let p = found.of(0.1);
        assert!(p > 0.03 && p < 0.15, "{found:?}: the wall is the thirteenth cell");
        assert_eq!(Recalibration::fit(&[], &map, &Raster::filled(strip.spec, true)), Recalibration::NONE);
    }

    #[test]
    fn the_order_of_cells_is_kept() {
        let found = Recalibration { shift: -0.7, slope: 1.9 };
        let after: Vec<f64> = [0.0, 0.1, 0.12, 0.5, 0.97, 1.0].map(|p| found.of(p)).to_vec();
        assert!(after.is_sorted() && after[0] > 0.0 && after[5] < 1.0);
        assert!((Recalibration::NONE.of(0.3) - 0.3).abs() < 1e-15);
    }
}
