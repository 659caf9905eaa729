use super::*;
use nalgebra::{DMatrix, Matrix3};
use proptest::prelude::*;

fn renewal() -> impl Strategy<Value = Renewal> {
    (prop::array::uniform3(0.0f64..3.0), prop::array::uniform3(0.01f64..1.0), 0.0f64..0.5).prop_map(
        |(rates_per_s, shares, turnover_per_s)| {
            let all: f64 = shares.iter().sum();
            Renewal { rates_per_s, shares: shares.map(|share| share / all), turnover_per_s, step_s: 0.0 }
        },
    )
}

fn kinds() -> impl Strategy<Value = Kinds<f64>> {
    prop::array::uniform3(1e-6f64..1.0).prop_map(|kinds| kinds.map(|kind| kind / kinds.iter().sum::<f64>()))
}

fn place() -> impl Strategy<Value = Place> {
    (1e-6f64..0.999_999, kinds(), kinds()).prop_map(|(occupied, e, f)| Place { occupied, kinds: [e, f] })
}

/// Occupancy and kind as one chain of six states in continuous time: occupied of each kind, then free of each.
fn chain(renewal: &Renewal, prior: f64) -> DMatrix<f64> {
    let drawn = [prior, 1.0 - prior];
    let mut rate = DMatrix::zeros(2 * KINDS, 2 * KINDS);
    for from in 0..2 * KINDS {
        let (x, kind) = (from / KINDS, from % KINDS);
        for (y, share) in drawn.into_iter().enumerate() {
            rate[(y * KINDS + kind, from)] += renewal.rates_per_s[kind] * share;
        }
        for (other, share) in renewal.shares.into_iter().enumerate() {
            rate[(x * KINDS + other, from)] += renewal.turnover_per_s * share;
        }
        rate[(from, from)] -= renewal.rates_per_s[kind] + renewal.turnover_per_s;
    }
    rate
}

fn states(place: &Place) -> [f64; 2 * KINDS] {
    let masses = [place.occupied, 1.0 - place.occupied];
    let mut states = [0.0; 2 * KINDS];
    states.iter_mut().enumerate().for_each(|(k, state)| *state = masses[k / KINDS] * place.kinds[k / KINDS][k % KINDS]);
    states
}

proptest! {
    #[test]
    fn what_is_kept_is_the_exponential_of_its_generator(renewal in renewal(), seconds in 0.0f64..40.0) {
        let generator = Matrix3::from_fn(|to, from| {
            let leaves = if to == from { renewal.rates_per_s[from] + renewal.turnover_per_s } else { 0.0 };
            renewal.turnover_per_s * renewal.shares[to] - leaves
        });
        let expected = (generator * seconds).exp();
        let kept = renewal.over(seconds).kept;
        for to in 0..KINDS {
            for from in 0..KINDS {
                prop_assert!((kept[to][from] - expected[(to, from)]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_place_is_the_chain_of_its_states(renewal in renewal(), place in place(), prior in 0.01f64..0.9, seconds in 0.0f64..30.0) {
        let expected = (chain(&renewal, prior) * seconds).exp() * DMatrix::from_column_slice(2 * KINDS, 1, &states(&place));
        let found = states(&renewal.over(seconds).place(&place, prior));
        for (k, found) in found.into_iter().enumerate() {
            prop_assert!((found - expected[(k, 0)]).abs() < 1e-11, "{found} {}", expected[(k, 0)]);
        }
    }

    #[test]
    fn two_times_are_one_after_the_other(renewal in renewal(), place in place(), prior in 0.01f64..0.9, a in 0.0f64..9.0, b in 0.0f64..9.0) {
        let once = states(&renewal.over(a + b).place(&place, prior));
        let twice = states(&renewal.over(b).place(&renewal.over(a).place(&place, prior), prior));
        prop_assert!(once.iter().zip(twice).all(|(once, twice)| (once - twice).abs() < 1e-12));
    }

    /// The classes compete: looks at a place over time, against every path of its occupancy and kind.
    #[test]
    fn a_history_is_the_sum_over_all_paths(
        renewal in renewal(), prior in 0.01f64..0.9,
        looks in prop::collection::vec((0.0f64..5.0, 0.01f64..1.0, 0.01f64..1.0), 1..5),
    ) {
        let mut place = Place { occupied: prior, kinds: [renewal.shares; 2] };
        for &(seconds, occupied, free) in &looks {
            place = renewal.over(seconds).place(&place, prior);
            let p = place.occupied;
            place.occupied = occupied * p / (occupied * p + free * (1.0 - p));
        }
        let steps: Vec<DMatrix<f64>> = looks.iter().map(|look| (chain(&renewal, prior) * look.0).exp()).collect();
        let start = states(&Place { occupied: prior, kinds: [renewal.shares; 2] });
        let mut ends = [0.0; 2 * KINDS];
        let paths = (2 * KINDS).pow(looks.len() as u32 + 1);
        for path in 0..paths {
            let state = |k: u32| path / (2 * KINDS).pow(k) % (2 * KINDS);
            let mut weight = start[state(0)];
            for (k, (step, look)) in (0..).zip(steps.iter().zip(&looks)) {
                weight *= step[(state(k + 1), state(k))] * if state(k + 1) < KINDS { look.1 } else { look.2 };
            }
            ends[state(looks.len() as u32)] += weight;
        }
        let all: f64 = ends.iter().sum();
        for (found, end) in states(&place).into_iter().zip(ends) {
            prop_assert!((found - end / all).abs() < 1e-10, "{found} {}", end / all);
        }
    }
}

#[test]
fn no_time_changes_nothing_and_much_of_it_everything() {
    let renewal =
        Renewal { rates_per_s: [1e-5, 3e-3, 0.5], shares: [0.9, 0.08, 0.02], turnover_per_s: 1e-3, step_s: 0.0 };
    let place = Place { occupied: 0.8, kinds: [[0.5, 0.3, 0.2], [0.1, 0.2, 0.7]] };
    for seconds in [0.0, -5.0] {
        let same = states(&renewal.over(seconds).place(&place, 0.1));
        assert!(same.iter().zip(states(&place)).all(|(a, b)| (a - b).abs() < 1e-15));
    }
    let after = renewal.over(1e9).place(&place, 0.1);
    assert!((after.occupied - 0.1).abs() < 1e-12);
    assert!(after.kinds.iter().flatten().zip([0.9, 0.08, 0.02].repeat(2)).all(|(a, b)| (a - b).abs() < 1e-12));
}
