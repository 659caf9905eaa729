//! The oracle of readings from cones: the sum over all states of all chains; and what chains leave out, by all states of small maps.

use std::sync::Arc;

use grid::GridSpec;
use mapper::cone::{Part, likelihoods};
use mapper::{Chain, Dynamic, FastVisibility, Mapper, Model, PairwiseGrid, RayPosterior, Renewal, Visibility, exact};
use proptest::prelude::*;
use sensor::{Pose, Scan, Sonar};

/// A chain with its ranges and likelihoods.
#[derive(Debug, Clone)]
struct Given {
    chain: Chain,
    ranges: Vec<f64>,
    likelihood: Vec<f64>,
}

prop_compose! {
    fn given()(n in 1usize..5)(
        marginal in prop::collection::vec(prop_oneof![8 => 0.001f64..0.999, 1 => Just(1e-6), 1 => Just(1.0 - 1e-6)], n),
        shares in prop::collection::vec(prop_oneof![8 => 0.0f64..1.0, 1 => Just(0.0), 1 => Just(1.0)], n - 1),
        // Whole numbers too, so that cells of several chains lie at one range.
        steps in prop::collection::vec(prop_oneof![Just(1.0), 0.1f64..2.0], n),
        likelihood in prop::collection::vec(prop_oneof![4 => 0.003f64..0.004, 2 => 0.1f64..2.0, 1 => Just(0.0)], n),
    ) -> Given {
        let both = marginal.windows(2).zip(&shares).map(|(pair, share)| {
            let (low, high) = ((pair[0] + pair[1] - 1.0f64).max(0.0), pair[0].min(pair[1]));
            low + share * (high - low)
        });
        let chain = Chain::new(marginal.clone(), both.collect());
        let ranges = steps.iter().scan(0.0, |at, step| { let range = *at; *at += step; Some(range) }).collect();
        Given { chain, ranges, likelihood }
    }
}

/// Probability of a state of a chain, a bit to each cell.
fn weight(chain: &Chain, state: u32) -> f64 {
    let occupied = |j: usize| state >> j & 1 == 1;
    let first = if occupied(0) { chain.occupied(0) } else { 1.0 - chain.occupied(0) };
    (0..chain.len() - 1).fold(first, |weight, j| {
        let (t, u) = (chain.stays_occupied(j), chain.becomes_occupied(j));
        weight
            * match (occupied(j), occupied(j + 1)) {
                (true, true) => t,
                (true, false) => 1.0 - t,
                (false, true) => u,
                (false, false) => 1.0 - u,
            }
    })
}

/// Evidence, and every chain's marginals, by all states of all chains together.
fn enumerate(all: &[Given], none: f64) -> (f64, Vec<Vec<f64>>) {
    let sizes: Vec<usize> = all.iter().map(|given| given.chain.len()).collect();
    let mut evidence = 0.0;
    let mut marginals: Vec<Vec<f64>> = sizes.iter().map(|size| vec![0.0; *size]).collect();
    for code in 0..1u32 << sizes.iter().sum::<usize>() {
        let mut rest = code;
        let states: Vec<u32> = sizes
            .iter()
            .map(|size| {
                let state = rest & ((1 << size) - 1);
                rest >>= size;
                state
            })
            .collect();
        let prior: f64 = all.iter().zip(&states).map(|(given, state)| weight(&given.chain, *state)).product();
        // The nearest occupied cell; of several at one range that of the first chain.
        let hit = |(l, state): (usize, &u32)| (*state > 0).then(|| (l, state.trailing_zeros() as usize));
        let nearest = states
            .iter()
            .enumerate()
            .filter_map(hit)
            .min_by(|(l, j), (m, k)| all[*l].ranges[*j].total_cmp(&all[*m].ranges[*k]));
        let joint = prior * nearest.map_or(none, |(l, k)| all[l].likelihood[k]);
        evidence += joint;
        for (marginals, state) in marginals.iter_mut().zip(&states) {
            marginals.iter_mut().enumerate().filter(|(k, _)| state >> k & 1 == 1).for_each(|(_, p)| *p += joint);
        }
    }
    marginals.iter_mut().flatten().for_each(|p| *p /= evidence);
    (evidence, marginals)
}

proptest! {
    #[test]
    fn chains_of_a_cone_are_the_sum_over_all_their_states(all in prop::collection::vec(given(), 1..4), none in 0.001f64..0.01) {
        let parts: Vec<Part> = all.iter().map(|Given { chain, ranges, likelihood }| Part { chain, ranges, likelihood }).collect();
        let (evidence, marginals) = enumerate(&all, none);
        for ((given, own), expected) in all.iter().zip(likelihoods(&parts, none)).zip(&marginals) {
            let mut posterior = RayPosterior::default();
            exact::posterior(&given.chain, &own.cells, own.none, &mut posterior);
            prop_assert!((posterior.evidence / evidence - 1.0).abs() < 1e-10, "{} {evidence}", posterior.evidence);
            for (found, expected) in posterior.marginals().iter().zip(expected) {
                prop_assert!((found - expected).abs() < 1e-10, "{found} {expected}");
            }
        }
    }

    /// A cone without width is a ray.
    #[test]
    fn one_chain_is_the_ray_itself(given in given(), none in 0.001f64..0.01) {
        let Given { chain, ranges, likelihood } = &given;
        let own = likelihoods(&[Part { chain, ranges, likelihood }], none);
        prop_assert_eq!(&own[0].cells, likelihood);
        prop_assert!(own[0].none.to_bits() == none.to_bits());
    }
}

fn scan(readings: Vec<Option<f64>>, pose: Pose) -> Scan {
    let bearings_rad = (0..readings.len()).map(|k| 0.4 * k as f64).collect();
    Scan { pose, bearings_rad, readings, ..Scan::default() }
}

/// The fast mappers against their references, over scans of a ring that overlaps itself.
#[test]
fn fast_cones_are_those_of_the_reference() {
    let grid = GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width: 40, height: 30 };
    let model = Model::new(grid, Arc::new(Sonar { max_range_m: 3.0, ..Sonar::default() }));
    let renewal = Renewal::CHOSEN;
    let (mut fast, mut reference) = (FastVisibility::visibility(&model), Visibility::exact(&model));
    let (mut moving, mut eager) = (FastVisibility::dynamic(&model, renewal), Dynamic::new(&model, renewal));
    let (mut independent, mut slow) = (FastVisibility::independent(&model), Visibility::independent(&model));
    let scan = scan(
        vec![Some(1.2), Some(2.0), None, Some(f64::INFINITY), Some(0.7)],
        Pose { x_m: 1.7, y_m: 1.4, theta_rad: 0.3 },
    );
    let difference = |a: &PairwiseGrid, b: &PairwiseGrid| {
        (0..grid.cells()).map(|cell| (a.marginals()[cell] - b.marginals()[cell]).abs()).fold(0.0, f64::max)
    };
    for threads in [1, 3] {
        fast.integrate_on(&scan, threads);
        reference.integrate(&scan);
        let found = difference(&fast.pairs(), reference.pairs());
        assert!(found < 1e-5 * f64::from(threads as u32), "{found}");
    }
    moving.integrate(&scan);
    eager.integrate(&scan);
    assert!(difference(&moving.pairs(), eager.pairs()) < 1e-5);
    independent.integrate(&scan);
    slow.integrate(&scan);
    let found = difference(&independent.pairs(), slow.pairs());
    assert!(found < 1e-5, "{found}");
    assert!(fast.work().cells > 100);
    assert!(fast.evidence(&scan).is_some_and(f64::is_finite));
}

/// What chains leave out: three of them side by side in a field whose neighbours know of each other across chains too, by all
/// states of its cells.
#[test]
fn what_chains_do_not_know_of_each_other_is_little() {
    const LENGTH: usize = 4;
    const CHAINS: usize = 3;
    let mut largest = 0.0f64;
    // How much more likely neighbours are alike than not: not at all, and as much as e is to 1, and its square.
    for agree in [0.0, 0.5, 1.0] {
        for hit in 0..LENGTH {
            let cell = |chain: usize, k: usize| LENGTH * chain + k;
            let likelihood: Vec<f64> = (0..LENGTH).map(|k| if k == hit { 1.0 } else { 0.05 }).collect();
            let none = 0.05;
            let edges: Vec<[usize; 2]> = (0..CHAINS)
                .flat_map(|l| (0..LENGTH).map(move |k| [l, k]))
                .flat_map(|[l, k]| {
                    let along = (k + 1 < LENGTH).then(|| [cell(l, k), cell(l, k + 1)]);
                    let across = (l + 1 < CHAINS).then(|| [cell(l, k), cell(l + 1, k)]);
                    [along, across].into_iter().flatten()
                })
                .collect();
            // Of the field before and after the reading: every cell occupied, and both cells of every chain's pairs.
            let mut masses = [0.0; 2];
            let mut occupied = [[0.0; LENGTH * CHAINS]; 2];
            let mut both = [0.0; LENGTH * CHAINS];
            for state in 0..1u32 << (LENGTH * CHAINS) {
                let is = |cell: usize| state >> cell & 1 == 1;
                let alike = edges.iter().filter(|[a, b]| is(*a) == is(*b)).count();
                let prior = libm::exp(agree * alike as f64 - 1.5 * f64::from(state.count_ones()));
                let nearest = (0..LENGTH).find(|k| (0..CHAINS).any(|l| is(cell(l, *k))));
                let after = prior * nearest.map_or(none, |k| likelihood[k]);
                for (which, mass) in [prior, after].into_iter().enumerate() {
                    masses[which] += mass;
                    (0..LENGTH * CHAINS).filter(|cell| is(*cell)).for_each(|cell| occupied[which][cell] += mass);
                }
                (0..LENGTH * CHAINS - 1).filter(|cell| is(*cell) && is(*cell + 1)).for_each(|cell| both[cell] += prior);
            }
            let ranges: Vec<f64> = (0..LENGTH).map(|k| k as f64).collect();
            let chain = |l: usize| {
                let marginal = (0..LENGTH).map(|k| occupied[0][cell(l, k)] / masses[0]).collect();
                Chain::new(marginal, (0..LENGTH - 1).map(|k| both[cell(l, k)] / masses[0]).collect())
            };
            let chains: Vec<Chain> = (0..CHAINS).map(chain).collect();
            let parts: Vec<Part> =
                chains.iter().map(|chain| Part { chain, ranges: &ranges, likelihood: &likelihood }).collect();
            for (l, own) in likelihoods(&parts, none).into_iter().enumerate() {
                let mut posterior = RayPosterior::default();
                exact::posterior(&chains[l], &own.cells, own.none, &mut posterior);
                for (k, p) in posterior.marginals().iter().enumerate() {
                    let expected = occupied[1][cell(l, k)] / masses[1];
                    let apart = (p - expected).abs();
                    assert!(agree > 0.0 || apart < 1e-12, "nothing is left out where cells are independent");
                    largest = largest.max(apart);
                }
            }
        }
    }
    assert!((0.01..0.1).contains(&largest), "{largest}");
}
