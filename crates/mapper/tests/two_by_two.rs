//! The oracles of the ablations: occlusion and continuity, each on or off, against all 2^N states.

use std::sync::Arc;

use grid::GridSpec;
use mapper::{
    Chain, ConventionalRule, Mapper, Model, NoOcclusion, Prior, RayPosterior, Reconciliation, Visibility, bayes,
    no_occlusion,
};
use proptest::prelude::*;
use sensor::{Kernel as _, Pose, Scan, Stereo};

/// Marginals by enumeration of the states of a chain, `weight(states)` being the likelihood of each,
/// and the joint `P(E_j, E_{j+1})` of every pair.
fn enumerate(chain: &Chain, weight: impl Fn(u32) -> f64) -> (Vec<f64>, Vec<f64>, f64) {
    let n = chain.len();
    let (mut marginals, mut both, mut evidence) = (vec![0.0; n], vec![0.0; n - 1], 0.0);
    for states in 0..1u32 << n {
        let occupied = |j: usize| states >> j & 1 == 1;
        let mut probability = if occupied(0) { chain.occupied(0) } else { 1.0 - chain.occupied(0) };
        for j in 0..n - 1 {
            let go = if occupied(j) { chain.stays_occupied(j) } else { chain.becomes_occupied(j) };
            probability *= if occupied(j + 1) { go } else { 1.0 - go };
        }
        let weighted = probability * weight(states);
        evidence += weighted;
        (0..n).filter(|&j| occupied(j)).for_each(|j| marginals[j] += weighted);
        (0..n - 1).filter(|&j| occupied(j) && occupied(j + 1)).for_each(|j| both[j] += weighted);
    }
    marginals.iter_mut().chain(&mut both).for_each(|p| *p /= evidence);
    (marginals, both, evidence)
}

prop_compose! {
    fn chains()(n in 1usize..=12)(
        marginal in prop::collection::vec(prop_oneof![8 => 0.01f64..0.99, 1 => Just(1e-6), 1 => Just(1.0 - 1e-6)], n),
        shares in prop::collection::vec(prop_oneof![8 => 0.0f64..1.0, 1 => Just(0.0), 1 => Just(1.0)], n - 1),
        unaries in prop::collection::vec([0.001f64..1.0, 0.001f64..1.0], n),
    ) -> (Chain, Vec<[f64; 2]>) {
        let both = |p: f64, q: f64, s: f64| { let low = (p + q - 1.0).max(0.0); low + s * (p.min(q) - low) };
        let pairs = marginal.windows(2).zip(shares).map(|(p, share)| both(p[0], p[1], share)).collect();
        (Chain::new(marginal, pairs), unaries)
    }
}

/// A row of cells, a camera in the first, and one scan per reading.
fn row(width: usize, prior: Prior, reconciliation: Reconciliation) -> Model {
    let grid = GridSpec { cell_m: 0.2, origin_m: [0.0; 2], width, height: 1 };
    Model { prior, reconciliation, ..Model::new(grid, Arc::new(Stereo::default())) }
}

fn scan(reading: f64) -> Scan {
    let pose = Pose { x_m: 0.05, y_m: 0.1, theta_rad: 0.0 };
    Scan { sensor: 0, time_s: 0.0, pose, bearings_rad: vec![0.0], readings: vec![Some(reading)] }
}

/// Ranges at which the ray of [`scan`] crosses the row.
fn ranges(width: usize) -> Vec<f64> {
    (0..=width).map(|k| (0.2 * k as f64 - 0.05).max(0.0)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_occlusion_is_the_sum_over_all_states((chain, unaries) in chains()) {
        let weight = |states: u32| unaries.iter().enumerate().map(|(j, u)| u[usize::from(states >> j & 1 == 0)]).product();
        let (marginals, both, evidence) = enumerate(&chain, weight);
        let mut fast = RayPosterior::default();
        no_occlusion::posterior(&chain, &unaries, &mut fast);
        prop_assert!((fast.evidence / evidence - 1.0).abs() < 1e-11);
        for (f, s) in fast.marginals().iter().zip(&marginals) {
            prop_assert!((f - s).abs() < 1e-12, "{f} {s}");
        }
        for (f, s) in fast.pairs.iter().zip(&both) {
            prop_assert!((f.ee - s).abs() < 1e-12 && (f.total() - 1.0).abs() < 1e-12, "{f:?} {s}");
        }
    }

    #[test]
    fn independent_is_the_sum_over_all_states_of_independent_cells(
        readings in prop::collection::vec(0.5f64..40.0, 1..4), width in 1usize..=10, occupancy in 0.02f64..0.9,
        correlation in 0.0f64..1.0,
    ) {
        let mut mapper = Visibility::independent(&row(width, Prior { occupancy, correlation, ..Prior::default() }, Reconciliation::AllEdges));
        let ranges = ranges(width);
        for &reading in &readings {
            // The prior of this scan: independent cells with the marginals so far.
            let marginal = mapper.occupancy().values().to_vec();
            let pairs = marginal.windows(2).map(|p| p[0] * p[1]).collect();
            mapper.integrate(&scan(reading));
            let mut likelihood = vec![0.0; width];
            Stereo::default().likelihood(reading, 0.0, &ranges, &mut likelihood);
            let beyond = mapper::past_the_map::PastTheMap { from_m: ranges[width], chord_m: 0.2, onset: occupancy };
            let none = mapper::past_the_map::likelihood(&Stereo::default(), reading, 0.0, &beyond);
            let first = |states: u32| (0..width).find(|&j| states >> j & 1 == 1).map_or(none, |j| likelihood[j]);
            let (expected, _, _) = enumerate(&Chain::new(marginal, pairs), first);
            for (cell, (p, expected)) in mapper.occupancy().values().iter().zip(&expected).enumerate() {
                prop_assert!((p - expected.clamp(1e-6, 1.0 - 1e-6)).abs() < 1e-11, "cell {cell}: {p} {expected}");
            }
            for cell in 1..width {
                let joint = mapper.pairs().joint(cell - 1, cell);
                prop_assert!((joint.ee - joint.first() * joint.second()).abs() < 1e-14, "no joint remembers");
            }
        }
    }
}

#[test]
fn without_correlation_no_occlusion_is_the_conventional_rule() {
    let prior = Prior { correlation: 0.0, ..Prior::default() };
    let setup = row(12, prior, Reconciliation::Touched);
    let mut chained = NoOcclusion::new(&setup);
    chained.integrate(&scan(10.0));
    let ranges = ranges(12);
    for (cell, &p) in chained.occupancy().values().iter().enumerate() {
        let rule = ConventionalRule::default();
        let likelihoods = rule.likelihoods(&Stereo::default(), 10.0, 0.0, ranges[cell], ranges[cell + 1]);
        let alone = likelihoods.map_or(0.1, |l| bayes(0.1, l));
        assert!((p - alone).abs() < 1e-12, "cell {cell}: {p} {alone}");
    }
}

#[test]
fn unaries_that_rule_everything_out_change_nothing() {
    // The second cell must be what the first one is, and they are seen to differ.
    let chain = Chain::new(vec![0.5, 0.5], vec![0.5]);
    let mut out = RayPosterior::default();
    no_occlusion::posterior(&chain, &[[1.0, 0.0], [0.0, 1.0]], &mut out);
    assert_eq!(out.pairs, [chain.joint(0)]);
    assert_eq!(out.evidence.to_bits(), 0.0f64.to_bits());
    no_occlusion::posterior(&chain, &[[0.0, 0.0], [0.0, 0.0]], &mut out);
    assert!((out.first - 0.5).abs() < 1e-15, "two zeros say nothing");
}

#[test]
fn occlusion_keeps_what_lies_behind_and_continuity_what_lies_beside() {
    // A wall is certain at 2 m; a false reading says 5 m. Only mappers that know of occlusion keep cells behind.
    let setup = row(40, Prior::default(), Reconciliation::AllEdges);
    let mut with: [Box<dyn Mapper>; 2] =
        [Box::new(Visibility::exact(&setup)), Box::new(Visibility::independent(&setup))];
    let mut without: Box<dyn Mapper> = Box::new(NoOcclusion::new(&setup));
    let far = 25; // 4.95 to 5.15 m
    for mapper in with.iter_mut().chain([&mut without]) {
        for _ in 0..6 {
            mapper.integrate(&scan(7.5));
        }
    }
    let before = with.each_ref().map(|mapper| mapper.occupancy()[far]);
    let believed = without.occupancy()[far];
    for mapper in with.iter_mut().chain([&mut without]) {
        mapper.integrate(&scan(3.0));
    }
    for (mapper, before) in with.iter().zip(before) {
        assert!((mapper.occupancy()[far] - before).abs() < 0.02, "{before} {}", mapper.occupancy()[far]);
    }
    assert!(without.occupancy()[far] > believed + 0.05, "{believed} {}", without.occupancy()[far]);
}
