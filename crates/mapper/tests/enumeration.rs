//! The oracle of the exact ray posterior: the sum over all 2^N states of the ray, Eq. (2).

use mapper::{Chain, Joint, RayPosterior, exact};
use proptest::prelude::*;

/// Posterior joints, marginals and evidence by enumeration.
struct Enumerated {
    evidence: f64,
    marginals: Vec<f64>,
    pairs: Vec<Joint>,
}

fn enumerate(chain: &Chain, likelihood: &[f64], none: f64) -> Enumerated {
    let n = chain.len();
    let mut out = Enumerated { evidence: 0.0, marginals: vec![0.0; n], pairs: vec![Joint::default(); n - 1] };
    for states in 0..1u32 << n {
        let occupied = |j: usize| states >> j & 1 == 1;
        let mut weight = if occupied(0) { chain.occupied(0) } else { 1.0 - chain.occupied(0) };
        for j in 0..n - 1 {
            let (t, u) = (chain.stays_occupied(j), chain.becomes_occupied(j));
            weight *= match (occupied(j), occupied(j + 1)) {
                (true, true) => t,
                (true, false) => 1.0 - t,
                (false, true) => u,
                (false, false) => 1.0 - u,
            };
        }
        weight *= (0..n).find(|&j| occupied(j)).map_or(none, |first| likelihood[first]);
        out.evidence += weight;
        for j in 0..n {
            out.marginals[j] += if occupied(j) { weight } else { 0.0 };
        }
        for (j, pair) in out.pairs.iter_mut().enumerate() {
            *match (occupied(j), occupied(j + 1)) {
                (true, true) => &mut pair.ee,
                (true, false) => &mut pair.ef,
                (false, true) => &mut pair.fe,
                (false, false) => &mut pair.ff,
            } += weight;
        }
    }
    let normalise = 1.0 / out.evidence;
    out.marginals.iter_mut().for_each(|m| *m *= normalise);
    out.pairs.iter_mut().for_each(|pair| *pair = pair.scaled(normalise));
    out
}

/// A joint of two cells with given marginals: `share` 0 is the least, 1 the most positive one.
fn both(p: f64, q: f64, share: f64) -> f64 {
    let (low, high) = ((p + q - 1.0).max(0.0), p.min(q));
    low + share * (high - low)
}

prop_compose! {
    /// Chains with their own prior and correlation in every cell, the bounds included.
    fn chains()(n in 1usize..=14)(
        marginal in prop::collection::vec(prop_oneof![8 => 0.001f64..0.999, 1 => Just(1e-6), 1 => Just(1.0 - 1e-6)], n),
        shares in prop::collection::vec(prop_oneof![8 => 0.0f64..1.0, 1 => Just(0.0), 1 => Just(1.0)], n - 1),
        // Hits in front, inside and behind: from one sharp peak to all alike.
        likelihood in prop::collection::vec(prop_oneof![4 => 0.003f64..0.004, 1 => 0.1f64..2.0, 1 => Just(0.0)], n),
        none in 0.001f64..0.7,
    ) -> (Chain, Vec<f64>, f64) {
        let pairs = marginal.windows(2).zip(shares).map(|(p, share)| both(p[0], p[1], share)).collect();
        (Chain::new(marginal, pairs), likelihood, none)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 512, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn transitions_are_the_joint_given_the_nearer_cell(p in 0.01f64..0.99, q in 0.01f64..0.99, share in 0.0f64..1.0) {
        let chain = Chain::new(vec![p, q], vec![both(p, q, share)]);
        let Joint { ee, ef, fe, ff } = chain.joint(0);
        prop_assert!((chain.stays_occupied(0) - ee / (ee + ef)).abs() < 1e-13);
        prop_assert!((chain.becomes_occupied(0) - fe / (fe + ff)).abs() < 1e-13);
        prop_assert!((ee + ef - p).abs() < 1e-15 && (ee + fe - q).abs() < 1e-15 && (ee + ef + fe + ff - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_fast_posterior_is_the_sum_over_all_states((chain, likelihood, none) in chains()) {
        let slow = enumerate(&chain, &likelihood, none);
        let mut fast = RayPosterior::default();
        exact::posterior(&chain, &likelihood, none, &mut fast);
        if slow.evidence < f64::MIN_POSITIVE {
            // Impossible under the model: no state that has any probability explains the reading.
            prop_assert!(fast.evidence < f64::MIN_POSITIVE);
            prop_assert_eq!(&fast.pairs, &(0..chain.len() - 1).map(|j| chain.joint(j)).collect::<Vec<_>>());
            return Ok(());
        }
        prop_assert!((fast.evidence / slow.evidence - 1.0).abs() < 1e-12);
        for (f, s) in fast.marginals().iter().zip(&slow.marginals) {
            prop_assert!((f - s).abs() < 1e-12, "{f} {s}");
        }
        for (f, s) in fast.pairs.iter().zip(&slow.pairs) {
            for (f, s) in [(f.ee, s.ee), (f.ef, s.ef), (f.fe, s.fe), (f.ff, s.ff)] {
                prop_assert!((f - s).abs() < 1e-12, "{f} {s}");
            }
        }
    }

    #[test]
    fn neighbouring_pairs_agree_and_add_up_to_one((chain, likelihood, none) in chains()) {
        let mut fast = RayPosterior::default();
        exact::posterior(&chain, &likelihood, none, &mut fast);
        for pair in &fast.pairs {
            prop_assert!((pair.total() - 1.0).abs() < 1e-12);
            prop_assert!([pair.ee, pair.ef, pair.fe, pair.ff].iter().all(|p| *p >= 0.0));
        }
        for pairs in fast.pairs.windows(2) {
            prop_assert!((pairs[0].second() - pairs[1].first()).abs() < 1e-12);
        }
    }

    #[test]
    fn a_reading_equally_likely_everywhere_says_nothing((chain, _, none) in chains()) {
        let mut fast = RayPosterior::default();
        exact::posterior(&chain, &vec![none; chain.len()], none, &mut fast);
        for (j, p) in fast.marginals().iter().enumerate() {
            prop_assert!((p - chain.occupied(j)).abs() < 1e-12);
        }
    }
}
