//! Occupancy in few bits, for films of maps: levels of log odds on the same side of every threshold as the map.
//!
//! A level is a byte. Levels lie closest at even odds and farther apart towards certainty, `l = 2 sinh(k DELTA)`: as far
//! apart, nearly, as probabilities are that can be told apart. Counts of cells above or below a threshold of crate
//! `score` are therefore exact, whatever a level loses of the probability itself.

use std::sync::OnceLock;

use score::threshold::{DECIDED_OCCUPIED, HELD_FREE, HELD_OCCUPIED, SAVED_OCCUPIED};

/// Steps between even odds and the farthest level on either side.
const HALF: i32 = 90;

/// How close the levels are.
const DELTA: f64 = 0.025;

/// The part of a step by which a cell may leave its level before it changes it: half a step is the nearest level, more
/// keeps noise from being written down.
const SLACK: f64 = 0.75;

/// Step of the fine log odds, nats.
pub const FINE: f64 = 1e-3;

/// Farthest fine log odds: beyond, log loss is clipped.
const FINE_MOST: f64 = 9_300.0;

/// Thresholds of crate `score`: the last probability of the lower side.
fn thresholds() -> [f64; 4] {
    // Held free is below 0.2, which itself is not; the others are exceeded.
    [HELD_FREE.next_down(), HELD_OCCUPIED, SAVED_OCCUPIED, DECIDED_OCCUPIED]
}

/// The table of the levels.
pub struct Levels {
    /// Log odds of every level, rising, nats.
    pub log_odds: Vec<f64>,
    /// The probability above which level `k + 1` is meant, and up to which level `k`.
    edges: Vec<f64>,
    /// The probabilities within which a cell keeps its level: above the first, up to the second.
    kept: Vec<[f64; 2]>,
}

/// The levels.
pub fn levels() -> &'static Levels {
    static LEVELS: OnceLock<Levels> = OnceLock::new();
    LEVELS.get_or_init(Levels::new)
}

fn log_odds(step: f64) -> f64 {
    2.0 * libm::sinh(step * DELTA)
}

fn probability(log_odds: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-log_odds))
}

impl Levels {
    fn new() -> Self {
        let steps = || (-HALF..=HALF).map(f64::from);
        let edge = |step: f64| {
            let [below, above] = [step, step + 1.0].map(|step| probability(log_odds(step)));
            let between = thresholds().into_iter().find(|threshold| below <= *threshold && *threshold < above);
            between.unwrap_or_else(|| probability(log_odds(step + 0.5)))
        };
        let kept = |step: f64| {
            let at = probability(log_odds(step));
            let [low, high] = [step - SLACK, step + SLACK].map(|step| probability(log_odds(step)));
            let (below, above): (Vec<f64>, Vec<f64>) = thresholds().iter().partition(|threshold| **threshold < at);
            [below.into_iter().fold(low, f64::max), above.into_iter().fold(high, f64::min)]
        };
        Self {
            log_odds: steps().map(log_odds).collect(),
            edges: steps().take(2 * HALF as usize).map(edge).collect(),
            kept: steps().map(kept).collect(),
        }
    }

    /// The level of a probability: the one it had, as long as it is near to it and on the same side of every threshold.
    pub fn of(&self, p: f64, former: Option<u8>) -> u8 {
        if let Some(former) = former
            && let [low, high] = self.kept[usize::from(former)]
            && low < p
            && p <= high
        {
            return former;
        }
        self.edges.partition_point(|edge| p > *edge) as u8
    }
}

/// Log odds of `p` in steps of [`FINE`], on the same side of every threshold as `p`.
pub fn fine(p: f64) -> i16 {
    let code = (libm::log(p / (1.0 - p)) / FINE).round().clamp(-FINE_MOST, FINE_MOST);
    let side = |threshold: f64| libm::log(threshold / (1.0 - threshold)) / FINE;
    let code = thresholds().into_iter().fold(code, |code, threshold| match p > threshold {
        true => code.max(side(threshold).floor() + 1.0),
        false => code.min((side(threshold) + 1e-9).floor()),
    });
    code as i16
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn side(p: f64) -> [bool; 4] {
        [p < 0.2, p > 0.5, p > 0.65, p > 0.8]
    }

    fn decoded(level: u8) -> f64 {
        probability(levels().log_odds[usize::from(level)])
    }

    fn decoded_fine(code: i16) -> f64 {
        1.0 / (1.0 + (-f64::from(code) * FINE).exp())
    }

    #[test]
    fn a_byte_holds_them_and_even_odds_are_one() {
        assert_eq!(levels().log_odds.len(), 181);
        assert!(levels().log_odds.is_sorted() && levels().edges.is_sorted());
        assert_eq!(levels().of(0.5, None), HALF as u8);
        assert_eq!((levels().of(0.0, None), levels().of(1.0, None)), (0, 180));
        assert!(levels().log_odds[180] > 9.21, "the loss of a wrong certainty is clipped before");
    }

    #[test]
    fn thresholds_part_levels_and_fine_steps() {
        for threshold in [0.2f64, 0.5, 0.65, 0.8] {
            for p in [threshold.next_down(), threshold, threshold.next_up()] {
                assert_eq!(side(decoded(levels().of(p, None))), side(p), "{p}");
                assert_eq!(side(decoded_fine(fine(p))), side(p), "{p}");
                for former in 0..=180 {
                    assert_eq!(side(decoded(levels().of(p, Some(former)))), side(p), "{p} from {former}");
                }
            }
        }
        assert_eq!((fine(0.0), fine(1.0), fine(0.5)), (-9300, 9300, 0));
    }

    proptest! {
        #[test]
        fn a_level_is_near_and_on_the_same_side(odds in -12.0f64..12.0, former in prop::option::of(0u8..=180)) {
            let p = probability(odds);
            let back = decoded(levels().of(p, former));
            prop_assert_eq!(side(back), side(p));
            prop_assert!((back - p).abs() <= 0.0125, "{} {}", p, back);
        }

        #[test]
        fn fine_steps_are_as_near_as_promised(odds in -9.2f64..9.2) {
            let p = probability(odds);
            let back = decoded_fine(fine(p));
            prop_assert_eq!(side(back), side(p));
            prop_assert!((back - p).abs() <= 2.6e-4, "{} {}", p, back);
        }

        #[test]
        fn what_stays_near_keeps_its_level(step in -80.0f64..80.0, drift in -0.2f64..0.2) {
            let p = probability(log_odds(step));
            let level = levels().of(p, None);
            let later = probability(log_odds(step + drift));
            prop_assume!(side(p) == side(later));
            prop_assert_eq!(levels().of(later, Some(level)), level);
        }
    }
}
