//! Paired statistics against slow definitions, and the interval against its promise.

use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;
use score::{Comparison, Interval, RESAMPLES};

/// Compares differences with zero.
fn against_zero(differences: &[f64]) -> Comparison {
    Comparison::of(differences, &vec![0.0; differences.len()]).expect("valid")
}

/// Sum of the ranks of the positive differences and of all ranks but those of zeros: each rank by
/// counting, a tie one half.
fn rank_sums(differences: &[f64]) -> (f64, Vec<f64>) {
    let rank = |d: &f64| {
        let (below, tied) = differences.iter().fold((0, 0), |(below, tied), other| {
            (below + usize::from(other.abs() < d.abs()), tied + usize::from(other.abs().to_bits() == d.abs().to_bits()))
        });
        below as f64 + 0.5 * (tied + 1) as f64
    };
    let ranks = differences.iter().filter(|d| d.abs() > 0.0).map(rank).collect();
    (differences.iter().filter(|d| **d > 0.0).map(rank).sum(), ranks)
}

/// The share of all 2^n choices of signs whose rank sum is at least as far from the middle.
fn p_of_all_signs(differences: &[f64]) -> f64 {
    let (positive, ranks) = rank_sums(differences);
    let middle = 0.5 * ranks.iter().sum::<f64>();
    let as_far = (0u32..1 << ranks.len()).filter(|signs| {
        let sum: f64 = ranks.iter().enumerate().filter(|(k, _)| signs >> k & 1 == 1).map(|(_, rank)| rank).sum();
        (sum - middle).abs() >= (positive - middle).abs()
    });
    as_far.count() as f64 / f64::from(1u32 << ranks.len())
}

/// All n^n resamples of n differences, as sorted sums.
fn all_resamples(differences: &[f64]) -> Vec<f64> {
    let n = differences.len();
    let sum = |mut code: usize| {
        (0..n).fold(0.0, |sum, _| {
            let d = differences[code % n];
            code /= n;
            sum + d
        })
    };
    let mut sums: Vec<f64> = (0..n.pow(n as u32)).map(sum).collect();
    sums.sort_by(f64::total_cmp);
    sums
}

/// Standard normal quantile by stepping along the density: crude, and not the one under test.
fn crude_quantile(p: f64) -> f64 {
    let (mut x, mut sum, step) = (-8.0f64, 0.0, 1e-4);
    while sum < p {
        sum += step * (-0.5 * (x + 0.5 * step) * (x + 0.5 * step)).exp() / std::f64::consts::TAU.sqrt();
        x += step;
    }
    x
}

/// Levels of the ends of a BCa interval, from the formula as Efron and Tibshirani (1993) print it
/// (Eqs. 14.9 to 14.15), with all resamples and a jackknife that leaves out one pair after another.
fn levels(differences: &[f64], sums: &[f64]) -> [f64; 2] {
    let n = differences.len() as f64;
    let total: f64 = differences.iter().sum();
    let below = sums.iter().filter(|s| **s < total - 1e-9).count() as f64;
    let equal = sums.iter().filter(|s| (**s - total).abs() <= 1e-9).count() as f64;
    let bias = crude_quantile((below + 0.5 * equal) / sums.len() as f64);
    let without: Vec<f64> = differences.iter().map(|d| (total - d) / (n - 1.0)).collect();
    let centre = without.iter().sum::<f64>() / n;
    let power = |k: i32| without.iter().map(|w| (centre - w).powi(k)).sum::<f64>();
    let acceleration = power(3) / (6.0 * power(2).powf(1.5));
    [-1.96, 1.96].map(|z| 0.5 * libm::erfc(-(bias + (bias + z) / (1.0 - acceleration * (bias + z))) / 2.0f64.sqrt()))
}

/// A value with few possible sizes, so that ties and zeros are common.
fn coarse() -> impl Strategy<Value = f64> {
    (-6i32..=6).prop_map(|d| f64::from(d) / 4.0)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn p_equals_the_share_of_all_signs(
        differences in prop_oneof![prop::collection::vec(coarse(), 2..12), prop::collection::vec(-1.0f64..2.0, 2..12)],
    ) {
        let test = against_zero(&differences).signed_rank;
        let (positive, ranks) = rank_sums(&differences);
        prop_assert_eq!((test.positive, test.zeros), (positive, differences.len() - ranks.len()));
        prop_assert!((test.positive + test.negative - ranks.iter().sum::<f64>()).abs() < 1e-12);
        prop_assert!((test.p - p_of_all_signs(&differences)).abs() < 1e-12, "{:?}", test);
    }

    /// With five different differences most of 3,125 resamples differ: the ends found must lie where
    /// the levels put them in the distribution of all resamples.
    #[test]
    fn the_interval_is_where_all_resamples_put_it(differences in prop::collection::vec(-1.0f64..2.0, 5)) {
        prop_assume!(differences.iter().any(|d| (d - differences[0]).abs() > 1e-3));
        let sums = all_resamples(&differences);
        let Interval { low, high } = against_zero(&differences).interval;
        for (end, level) in [low, high].into_iter().zip(levels(&differences, &sums)) {
            let share = |rounding: f64| sums.partition_point(|s| *s < 5.0 * end + rounding) as f64 / sums.len() as f64;
            // Five standard errors of a share among 10,000, and what the bias adds to it.
            let slack = 5.0 * (level * (1.0 - level) / RESAMPLES as f64).sqrt() + 0.006;
            prop_assert!(share(-1e-9) <= level + slack && share(1e-9) >= level - slack,
                "{} lies at {} to {}, not at {}", end, share(-1e-9), share(1e-9), level);
        }
    }

    #[test]
    fn exchanging_ours_and_theirs_changes_signs_exactly(
        pairs in prop::collection::vec((-1.0f64..2.0, prop_oneof![-1.0f64..1.0, Just(0.5)]), 2..40),
    ) {
        let (ours, theirs): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let one = Comparison::of(&ours, &theirs).expect("valid");
        let other = Comparison::of(&theirs, &ours).expect("valid");
        // Exactly: zero differs from minus zero by its sign alone.
        let same = |a: f64, b: f64| (a - b).abs() <= 0.0;
        prop_assert!(same(one.mean_difference, -other.mean_difference));
        prop_assert!(same(one.interval.low, -other.interval.high) && same(one.interval.high, -other.interval.low));
        prop_assert!(same(one.signed_rank.positive, other.signed_rank.negative));
        prop_assert!(same(one.signed_rank.p, other.signed_rank.p));
        let opposite = |a: Option<f64>, b: Option<f64>| a.zip(b).map_or(a.is_none() && b.is_none(), |(a, b)| same(a, -b));
        prop_assert!(opposite(one.rank_biserial, other.rank_biserial) && opposite(one.cohen_dz, other.cohen_dz));
    }

    #[test]
    fn the_order_of_the_pairs_does_not_matter(
        pairs in prop::collection::vec((coarse(), -1.0f64..1.0), 2..40).prop_flat_map(|p| (Just(p.clone()), Just(p).prop_shuffle())),
    ) {
        let compare = |pairs: Vec<(f64, f64)>| {
            let (ours, theirs): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
            Comparison::of(&ours, &theirs)
        };
        prop_assert_eq!(compare(pairs.0), compare(pairs.1));
    }

    #[test]
    fn a_constant_moves_the_mean_and_its_interval_alike(
        differences in prop::collection::vec(-1.0f64..2.0, 2..40), by in -3.0f64..3.0, scale in 0.1f64..9.0,
    ) {
        prop_assume!(differences.iter().any(|d| (d - differences[0]).abs() > 1e-3));
        let (one, other) = (against_zero(&differences), against_zero(&differences.iter().map(|d| scale * d + by).collect::<Vec<_>>()));
        let near = |a: f64, b: f64| (scale * a + by - b).abs() < 1e-10;
        prop_assert!(near(one.mean_difference, other.mean_difference));
        prop_assert!(near(one.interval.low, other.interval.low) && near(one.interval.high, other.interval.high));
        prop_assert!(one.interval.low <= one.mean_difference && one.mean_difference <= one.interval.high);
    }

    #[test]
    fn undefined_values_drop_their_pair_and_nothing_else(
        pairs in prop::collection::vec((prop::option::weighted(0.8, -1.0f64..2.0), prop::option::weighted(0.8, -1.0f64..2.0)), 0..30),
    ) {
        let (ours, theirs): (Vec<_>, Vec<_>) = pairs.iter().copied().unzip();
        let (a, b): (Vec<f64>, Vec<f64>) = pairs.iter().filter_map(|p| p.0.zip(p.1)).unzip();
        let dropped = pairs.len() - a.len();
        match (Comparison::of_defined(&ours, &theirs), Comparison::of(&a, &b)) {
            (Ok(found), Ok(expected)) => prop_assert_eq!(found, Comparison { dropped, ..expected }),
            (found, expected) => prop_assert!(found.is_err() && expected.is_err() && a.len() < 2),
        }
    }
}

/// Uniform between 0 and 1, neither included.
fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    (f64::from(rng.next_u32()) + 0.5) / 4_294_967_296.0
}

/// The share of 1,000 experiments of `n` pairs in which the interval holds the true mean of zero.
fn coverage(n: usize, draw: impl Fn(&mut ChaCha8Rng) -> f64) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(30);
    let mut held = 0;
    for _ in 0..1_000 {
        let differences: Vec<f64> = (0..n).map(|_| draw(&mut rng)).collect();
        let Interval { low, high } = against_zero(&differences).interval;
        held += u32::from(low <= 0.0 && 0.0 <= high);
    }
    f64::from(held) / 1_000.0
}

/// The table of the README is what this finds. Of 1,000 experiments a share of 0.95 has a standard
/// error of 0.007. The bootstrap knows nothing of Student's t and covers less than it says, the less
/// the fewer pairs and the more skewed.
#[test]
fn the_interval_covers_the_mean_as_often_as_the_readme_says() {
    let normal = |rng: &mut ChaCha8Rng| {
        let (radius, angle) = (libm::sqrt(-2.0 * libm::log(uniform(rng))), std::f64::consts::TAU * uniform(rng));
        radius * libm::cos(angle)
    };
    let exponential = |rng: &mut ChaCha8Rng| -libm::log(uniform(rng)) - 1.0;
    for (pairs, least) in [(6, 0.80), (10, 0.85), (30, 0.90), (60, 0.91)] {
        let found = [coverage(pairs, normal), coverage(pairs, exponential)];
        assert!(found.iter().all(|share| (least..0.97).contains(share)), "{found:?} of {pairs} pairs");
        let row = format!("| {pairs} | {:.3} | {:.3} |", found[0], found[1]);
        assert!(include_str!("../README.md").contains(&row), "the README lacks {row}");
    }
}

/// If signs are by chance, p is at most 0.05 in at most 5 % of experiments, with ties and zeros too.
#[test]
fn the_test_does_not_cry_wolf() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let significant = (0..4_000).filter(|_| {
        let differences: Vec<f64> = (0..14).map(|_| f64::from(rng.next_u32() % 9) - 4.0).collect();
        against_zero(&differences).signed_rank.p <= 0.05
    });
    let share = significant.count() as f64 / 4_000.0;
    assert!((0.03..0.05 + 3.0 * 0.0035).contains(&share), "{share}");
}
