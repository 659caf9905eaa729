//! The oracles of the batch mappers: all 2^9 maps of 3 x 3 cells, with a handful of rays.

use std::sync::Arc;

use grid::{DigitalLine, GridSpec};
use mapper::gibbs::field::BlockField;
use mapper::{Field, ForwardEm, Gibbs, Mapper as _, Model, Mrf, Prior, Sampling, Unmixed, mrf};
use proptest::prelude::*;
use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use sensor::{Kernel as _, Pose, Scan, Stereo};

/// Cells of half a metre seen by a camera whose noise spans several of them.
const STEREO: Stereo = Stereo { focal_baseline: 15.0, disparity_sigma: 3.0, correct_match: 0.8, max_disparity: 60.0 };

fn setup(width: usize, height: usize) -> Model {
    let grid = GridSpec { cell_m: 0.5, origin_m: [0.0; 2], width, height };
    let prior = Prior { occupancy: 0.2, ..Prior::default() };
    Model { prior, ..Model::new(grid, Arc::new(STEREO)) }
}

/// Swept until nothing moves.
const CLOSE: Field = Field { sweeps: 400, tolerance: 1e-9, ..Field::TUNED };

/// One ray: x, y, heading, reading.
type Look = [f64; 4];

fn scan(&[x_m, y_m, theta_rad, reading]: &Look) -> Scan {
    let pose = Pose { x_m, y_m, theta_rad };
    Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(reading)] }
}

/// The rays as an oracle sees them: cells, likelihood of each as the first occupied one, and of none.
struct Rays(Vec<(Vec<usize>, Vec<f64>, f64)>);

impl Rays {
    fn new(setup: &Model, looks: &[Look]) -> Self {
        let p = setup.prior.occupancy;
        // P(E_{j+1} | not E_j), from the correlation of Eq. (16).
        let onset = p * (1.0 - setup.prior.neighbour_correlation(setup.grid.cell_m));
        let mut line = DigitalLine::default();
        let rays = looks.iter().map(|look| {
            let ray = scan(look).rays().next().expect("one ray");
            line.trace(&setup.grid, ray.origin_m, ray.direction, f64::INFINITY);
            let mut likelihood = vec![0.0; line.len()];
            STEREO.likelihood(look[3], 0.0, line.ranges(), &mut likelihood);
            let from_m = *line.ranges().last().expect("never empty");
            let chord_m = setup.grid.cell_m / (ray.direction[0].abs() + ray.direction[1].abs());
            let beyond = mapper::past_the_map::PastTheMap { from_m, chord_m, onset };
            (line.cells().to_vec(), likelihood, mapper::past_the_map::likelihood(&STEREO, look[3], 0.0, &beyond))
        });
        Self(rays.collect())
    }

    /// The same where a cell is occupied if an obstacle covers any part of it: the surface is parallel to the face through which the ray enters, at a
    /// depth of up to a cell behind it. Sums over cells the share of these depths that the ray meets in each.
    fn with_surfaces(setup: &Model, looks: &[Look]) -> Self {
        let mut rays = Self::new(setup, looks);
        let mut line = DigitalLine::default();
        for ((cells, likelihood, none), look) in rays.0.iter_mut().zip(looks) {
            let ray = scan(look).rays().next().expect("one ray");
            line.trace(&setup.grid, ray.origin_m, ray.direction, f64::INFINITY);
            let [x, y] = ray.direction;
            let column = |k: usize| setup.grid.column_row(cells[k]).0;
            let of_surface = |first: usize| {
                if first == 0 {
                    return likelihood[0];
                }
                let from = line.ranges()[first];
                let to = from + setup.grid.cell_m / if column(first) == column(first - 1) { y.abs() } else { x.abs() };
                let share = |a: f64, b: f64| (b.min(to) - a.max(from)).max(0.0) / (to - from);
                let of_cells =
                    (first..cells.len()).map(|k| likelihood[k] * share(line.ranges()[k], line.ranges()[k + 1]));
                of_cells.sum::<f64>() + *none * share(line.ranges()[cells.len()], f64::INFINITY)
            };
            *likelihood = (0..cells.len()).map(of_surface).collect();
        }
        rays
    }

    /// Likelihood of all readings given the map whose bits are the cells.
    fn likelihood(&self, map: u32) -> f64 {
        let rays = self.0.iter().map(|(cells, likelihood, none)| {
            cells.iter().position(|&cell| map >> cell & 1 == 1).map_or(*none, |first| likelihood[first])
        });
        rays.product()
    }
}

/// Product over cells of the prior.
fn independent_prior(p: f64, cells: usize, map: u32) -> f64 {
    (0..cells).map(|cell| if map >> cell & 1 == 1 { p } else { 1.0 - p }).product()
}

/// The field of [`Mrf`]: the prior times `P(a, b) / (P(a) P(b))` for every pair of neighbours.
fn field(setup: &Model, coupling: f64, map: u32) -> f64 {
    let p = setup.prior.occupancy;
    let cells = setup.grid.cells();
    let marginal = |on: bool| if on { p } else { 1.0 - p };
    let mut weight = independent_prior(p, cells, map);
    for a in 0..cells {
        for b in setup.grid.neighbours(a).map(|n| n.cell).filter(|&b| b > a) {
            let (on, other) = (map >> a & 1 == 1, map >> b & 1 == 1);
            let covariance = coupling * p * (1.0 - p) * if on == other { 1.0 } else { -1.0 };
            weight *= 1.0 + covariance / (marginal(on) * marginal(other));
        }
    }
    weight
}

fn marginals(cells: usize, weight: impl Fn(u32) -> f64) -> Vec<f64> {
    let mut sums = vec![0.0; cells];
    let mut total = 0.0;
    for map in 0..1u32 << cells {
        let weight = weight(map);
        total += weight;
        (0..cells).filter(|cell| map >> cell & 1 == 1).for_each(|cell| sums[cell] += weight);
    }
    sums.iter().map(|sum| sum / total).collect()
}

/// Rays from random places of the map in random directions, with readings that need not agree.
fn random_looks(rng: &mut ChaCha8Rng, rays: usize) -> Vec<Look> {
    let look = |_| {
        let heading = std::f64::consts::TAU * rng.random::<f64>();
        [1.5 * rng.random::<f64>(), 1.5 * rng.random::<f64>(), heading, 8.0 + 40.0 * rng.random::<f64>()]
    };
    (0..rays).map(look).collect()
}

fn looks() -> impl Strategy<Value = Vec<Look>> {
    let look = (0.0f64..1.5, 0.0f64..1.5, 0.0f64..std::f64::consts::TAU, 4.0f64..60.0);
    prop::collection::vec(look.prop_map(|(x, y, heading, reading)| [x, y, heading, reading]), 1..12)
}

fn bits(map: &[bool]) -> u32 {
    map.iter().enumerate().map(|(cell, &on)| u32::from(on) << cell).sum()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn em_ends_where_no_flip_helps_and_never_goes_down(looks in looks()) {
        let setup = setup(3, 3);
        let mut mapper = ForwardEm::new(&setup);
        looks.iter().for_each(|look| mapper.integrate(&scan(look)));
        mapper.settle();
        let rays = Rays::new(&setup, &looks);
        let objective = |map: u32| (independent_prior(0.2, 9, map) * rays.likelihood(map)).ln();
        let map = bits(mapper.map().values());
        for cell in 0..9 {
            prop_assert!(objective(map ^ (1 << cell)) <= objective(map) + 2e-6, "cell {cell} of {map:b}");
        }
        for pair in mapper.objectives().windows(2) {
            prop_assert!(pair[1] >= pair[0] - 1e-9, "{:?}", mapper.objectives());
        }
        let empty = 9.0 * 0.8f64.ln();
        prop_assert!((mapper.objectives().last().expect("solved") + empty - objective(map)).abs() < 1e-6);
        // The residual: each cell with the others as they are.
        for cell in 0..9 {
            let [on, off] = [map | 1 << cell, map & !(1 << cell)].map(|map| objective(map).exp());
            prop_assert!((mapper.occupancy()[cell] - (on / (on + off)).clamp(1e-6, 1.0 - 1e-6)).abs() < 1e-7);
        }
    }

    #[test]
    fn one_ray_on_a_row_of_uncoupled_cells_is_exact(look in (0.0f64..0.5, 2.0f64..60.0), width in 1usize..=10) {
        let setup = setup(width, 1);
        let looks = [[look.0, 0.25, 0.0, look.1]];
        let mut mapper = Mrf::new(&setup, Field { coupling: 0.0, ..CLOSE });
        mapper.integrate(&scan(&looks[0]));
        mapper.settle();
        let rays = Rays::new(&setup, &looks);
        let exact = marginals(width, |map| independent_prior(0.2, width, map) * rays.likelihood(map));
        for (p, exact) in mapper.occupancy().values().iter().zip(exact) {
            prop_assert!((p - exact).abs() < 1e-7, "{p} {exact}");
        }
    }

    #[test]
    fn rays_of_one_cell_on_a_coupled_row_are_exact(readings in prop::collection::vec(8.0f64..60.0, 8), coupling in 0.0f64..0.9) {
        // Every camera looks over the upper border: its ray says one thing of one cell, and a chain has no loops.
        let setup = setup(8, 1);
        let looks: Vec<Look> = (0..8).map(|x| [0.5 * f64::from(x) + 0.25, 0.1, std::f64::consts::FRAC_PI_2, readings[x as usize]]).collect();
        let mut mapper = Mrf::new(&setup, Field { coupling, ..CLOSE });
        looks.iter().for_each(|look| mapper.integrate(&scan(look)));
        mapper.settle();
        prop_assert!(mapper.sweeps() < CLOSE.sweeps);
        let rays = Rays::new(&setup, &looks);
        let exact = marginals(8, |map| field(&setup, coupling, map) * rays.likelihood(map));
        for (p, exact) in mapper.occupancy().values().iter().zip(exact) {
            prop_assert!((p - exact).abs() < 1e-7, "{p} {exact}");
        }
    }

    #[test]
    fn messages_of_a_ray_are_the_sum_over_all_states(
        cells in prop::collection::vec((0.001f64..0.999, 0.003f64..1.0), 1..=10), none in 0.003f64..1.0,
    ) {
        let (occupied, likelihood): (Vec<f64>, Vec<f64>) = cells.into_iter().unzip();
        let n = occupied.len();
        let mut messages = vec![0.0; n];
        mrf::ray_messages(&occupied, &likelihood, none, &mut messages);
        for cell in 0..n {
            let mut sums = [0.0; 2];
            for map in 0..1u32 << n {
                let others = (0..n).filter(|&k| k != cell).map(|k| if map >> k & 1 == 1 { occupied[k] } else { 1.0 - occupied[k] });
                let first = (0..n).find(|&k| map >> k & 1 == 1).map_or(none, |k| likelihood[k]);
                sums[(map >> cell & 1) as usize] += others.product::<f64>() * first;
            }
            prop_assert!((messages[cell] - (sums[1] / sums[0]).ln()).abs() < 1e-11);
        }
    }
}

#[test]
fn em_finds_the_best_map_nine_times_in_ten() {
    let setup = setup(3, 3);
    let mut rng = ChaCha8Rng::seed_from_u64(3);
    let best = (0..500).filter(|_| {
        let looks = random_looks(&mut rng, 8);
        let mut mapper = ForwardEm::new(&setup);
        looks.iter().for_each(|look| mapper.integrate(&scan(look)));
        mapper.settle();
        let rays = Rays::new(&setup, &looks);
        let objective = |map: u32| (independent_prior(0.2, 9, map) * rays.likelihood(map)).ln();
        let found = objective(bits(mapper.map().values()));
        (0..1 << 9).all(|map| objective(map) <= found + 1e-6)
    });
    let best = best.count();
    assert!(best >= 450, "{best} of 500");
}

#[test]
fn loopy_beliefs_stay_near_the_exact_marginals() {
    let setup = setup(3, 3);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let (mut sum, mut worst, mut cells) = (0.0, 0.0f64, 0.0);
    for _ in 0..300 {
        let looks = random_looks(&mut rng, 6);
        let mut mapper = Mrf::new(&setup, Field::TUNED);
        looks.iter().for_each(|look| mapper.integrate(&scan(look)));
        mapper.settle();
        let rays = Rays::new(&setup, &looks);
        let exact = marginals(9, |map| field(&setup, Field::TUNED.coupling, map) * rays.likelihood(map));
        for (p, exact) in mapper.occupancy().values().iter().zip(exact) {
            sum += (p - exact).abs();
            worst = worst.max((p - exact).abs());
            cells += 1.0;
        }
    }
    assert!(sum / cells < 0.02 && worst < 0.3, "mean {} worst {worst}", sum / cells);
}

/// The prior of [`Gibbs`] from the map alone: blocks of 3 x 3 cells looked up cell by cell, the border's own cells beyond it.
fn blocks(setup: &Model, field: &BlockField, map: u32) -> f64 {
    let GridSpec { width, height, .. } = setup.grid;
    let weight = |centre: usize| {
        let (column, row) = setup.grid.column_row(centre);
        let on = |bit: &usize| {
            let x = (column + bit % 3).saturating_sub(1).min(width - 1);
            let y = (row + bit / 3).saturating_sub(1).min(height - 1);
            map >> setup.grid.index(x, y) & 1 == 1
        };
        field.weight((0..9).filter(on).map(|bit| 1 << bit).sum())
    };
    (0..setup.grid.cells()).map(weight).sum::<f64>().exp()
}

/// All 2^9 maps, a dozen rays, a soft field and long chains: marginals agree within the error of their effective draws, and the chains with
/// each other.
#[test]
fn gibbs_samples_the_posterior() {
    let setup = setup(3, 3);
    let plain = Sampling {
        weight: 1.0,
        leak: 0.0,
        strength: 0.3,
        sweeps: 4000,
        most: 4000,
        unmixed: Unmixed::Shown,
        ..Sampling::TUNED
    };
    let field = plain.field(&setup);
    let mut rng = ChaCha8Rng::seed_from_u64(27);
    let mut farthest: f64 = 0.0;
    for _ in 0..12 {
        let looks = random_looks(&mut rng, 12);
        let rays = Rays::with_surfaces(&setup, &looks);
        let exact = marginals(9, |map| rays.likelihood(map) * blocks(&setup, &field, map));
        let mut mapper = Gibbs::new(&setup, plain);
        looks.iter().for_each(|look| mapper.integrate(&scan(look)));
        mapper.settle();
        let mixing = mapper.mixing().expect("solved");
        assert!(mixing.is_enough() && mapper.fault().is_none(), "{mixing}");
        for (p, exact) in mapper.occupancy().values().iter().zip(&exact) {
            assert!((p - exact).abs() < 0.03, "{p} {exact}: {mixing}");
            farthest = farthest.max((p - 0.2).abs());
        }
    }
    assert!(farthest > 0.3, "the readings say something: {farthest}");
}

/// Draws follow from the seed alone, whatever the number of threads.
#[test]
fn gibbs_is_the_same_for_any_threads() {
    let setup = setup(6, 5);
    let looks = random_looks(&mut ChaCha8Rng::seed_from_u64(4), 40);
    let map = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let sampling = Sampling { seed, sweeps: 50, most: 100, unmixed: Unmixed::Shown, ..Sampling::TUNED };
            let mut mapper = Gibbs::new(&setup, sampling);
            looks.iter().for_each(|look| mapper.integrate(&scan(look)));
            mapper.settle();
            mapper.occupancy().values().iter().map(|p| p.to_bits()).collect::<Vec<_>>()
        })
    };
    assert_eq!(map(1, 1), map(3, 1));
    assert_ne!(map(1, 1), map(1, 2));
}

/// Two answers to one question that single steps do not lead between: there is no map, and it is said why; `Shown` has one.
#[test]
fn gibbs_refuses_where_chains_do_not_agree() {
    let setup = setup(6, 6);
    let looks = random_looks(&mut ChaCha8Rng::seed_from_u64(9), 30);
    let mapped = |unmixed| {
        let hasty = Sampling { strength: 2.0, sweeps: 10, most: 10, unmixed, ..Sampling::TUNED };
        let mut mapper = Gibbs::new(&setup, hasty);
        looks.iter().for_each(|look| mapper.integrate(&scan(look)));
        mapper.settle();
        mapper
    };
    let (refused, shown) = (mapped(Unmixed::Refused), mapped(Unmixed::Shown));
    assert!(!refused.mixing().expect("solved").is_enough(), "ten sweeps are too few");
    let fault = refused.fault().expect("refused");
    assert!(fault.starts_with("the chains do not agree: 4 chains of 10 sweeps: R-hat "), "{fault}");
    assert!(refused.occupancy().values().iter().all(|p| (p - 0.2).abs() < 1e-12), "the prior");
    assert!(shown.fault().is_none() && shown.mixing() == refused.mixing());
    assert!(shown.occupancy().values().iter().any(|p| (p - 0.2).abs() > 0.1));
}
