//! A Markov chain in time in every cell.

use crate::belief::probability::{from_log_odds, log_odds};
use crate::model::Model;
use crate::rules::ageing::{Ageing, AgeingIncrements};
use crate::rules::log_odds::LogOdds;

/// Occupancy that changes: Meyer-Delius, Beinhofer and Burgard, "Occupancy Grid Models for Robot Mapping in Changing Environments",
/// AAAI 2012. A cell is a hidden Markov model of two states; between looks the belief goes through the matrix of transitions, at a look
/// it is multiplied by the likelihoods of what was seen (the forward algorithm, which is exact):
///
/// ```text
/// p  <-  (1 - P(occupied -> free)) p + P(free -> occupied) (1 - p)      each second
/// p  <-  P(z | occupied) p / (P(z | occupied) p + P(z | free) (1 - p))  each look
/// ```
///
/// A look is a hit or a miss, with the likelihood ratios that the inverse model of OctoMap stands for, `hit / (1 - hit)` and
/// `miss / (1 - miss)`, its clamps left out. The transitions have the prior for their stationary distribution, so that a cell that is not
/// looked at goes back to it; times that are no whole seconds take the power of the matrix.
///
/// Not as published: the paper learns the transitions of every cell by EM, from hours of looks at the same cells. A drive looks at
/// a cell for some seconds; here all cells have the same, fixed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DynamicGrid {
    /// Share of the belief that is drawn anew from the prior in a second, above 0 and below 1: P(occupied -> free) + P(free -> occupied).
    pub renewed_per_s: f64,
    /// Hit and miss, at even odds beforehand.
    pub looks: LogOdds,
}

impl DynamicGrid {
    /// One in sixty: a cell is drawn anew once a minute. Our choice, there is no published number; fitted to nothing.
    pub const MINUTE: Self =
        Self { renewed_per_s: 1.0 / 60.0, looks: LogOdds { clamp: [0.0, 1.0], ..LogOdds::OCTOMAP } };

    /// The mapper of this rule, with a model's own hit and miss where it has any.
    pub fn mapper(self, model: &Model) -> AgeingIncrements<Transitions> {
        let rule = LogOdds { start: model.prior.marginal(), ..self.looks.tuned(&model.tuning) };
        AgeingIncrements::new(model, rule, self.transitions(model))
    }

    fn transitions(self, model: &Model) -> Transitions {
        let prior = model.prior.marginal();
        Transitions { appears: self.renewed_per_s * prior, vanishes: self.renewed_per_s * (1.0 - prior) }
    }
}

/// The matrix of transitions of a second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transitions {
    /// P(free -> occupied), above 0.
    appears: f64,
    /// P(occupied -> free), above 0.
    vanishes: f64,
}

impl Ageing for Transitions {
    /// `state` is the log odds of occupancy. The matrix has the eigenvalues 1 and `1 - appears - vanishes`, whose power is what is left of
    /// the distance from the stationary distribution.
    fn aged(&self, state: f64, time_s: f64) -> f64 {
        if time_s <= 0.0 {
            return state;
        }
        let changes = self.appears + self.vanishes;
        let (stationary, left) = (self.appears / changes, libm::pow(1.0 - changes, time_s));
        log_odds(stationary + (from_log_odds(state) - stationary) * left)
    }

    fn occupied(&self, state: f64) -> f64 {
        from_log_odds(state)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::mapper::Mapper as _;
    use crate::rules::ageing::tests::{CELL, eagerly, model, scan};

    /// The likelihood of a look if the cell is free (0) and occupied (1), up to a factor.
    fn likelihood(look: Option<bool>) -> [f64; 2] {
        match look {
            Some(true) => [0.3, 0.7],
            Some(false) => [0.6, 0.4],
            None => [1.0, 1.0],
        }
    }

    /// P(occupied at the last look | all looks), looks a second apart, summed over all 2^n paths of states.
    fn by_paths(looks: &[Option<bool>], prior: f64, [appears, vanishes]: [f64; 2]) -> f64 {
        let becomes = [[1.0 - appears, appears], [vanishes, 1.0 - vanishes]];
        let mut ends = [0.0; 2];
        for path in 0..1usize << looks.len() {
            let state = |at: usize| path >> at & 1;
            let mut p = [1.0 - prior, prior][state(0)];
            for (at, look) in looks.iter().enumerate() {
                p *= likelihood(*look)[state(at)];
                p *= if at > 0 { becomes[state(at - 1)][state(at)] } else { 1.0 };
            }
            ends[state(looks.len() - 1)] += p;
        }
        ends[1] / (ends[0] + ends[1])
    }

    proptest! {
        #[test]
        fn the_filter_is_the_sum_over_all_paths(
            looks in prop::collection::vec(prop::option::of(any::<bool>()), 1..11), renewed_per_s in 0.001f64..0.99,
        ) {
            let (rule, model) = (DynamicGrid { renewed_per_s, ..DynamicGrid::MINUTE }, model());
            let mut mapper = rule.mapper(&model);
            for (at, look) in looks.iter().enumerate() {
                mapper.integrate(&scan(at as f64, *look));
            }
            let expected = by_paths(&looks, 0.1, [renewed_per_s * 0.1, renewed_per_s * 0.9]);
            prop_assert!((mapper.occupancy()[CELL] - expected).abs() < 1e-9, "{} and {expected}", mapper.occupancy()[CELL]);
        }

        /// What is aged when it is looked at is what is aged with every scan, in every cell, whatever times do.
        #[test]
        fn lazily_is_eagerly(
            looks in prop::collection::vec((0.0f64..60.0, prop::option::of(any::<bool>())), 1..40), in_order in any::<bool>(),
        ) {
            let mut looks = looks;
            if in_order {
                looks.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            let (rule, model) = (DynamicGrid::MINUTE, model());
            let mut mapper = rule.mapper(&model);
            looks.iter().for_each(|(time_s, look)| mapper.integrate(&scan(*time_s, *look)));
            let started = LogOdds { start: 0.1, ..rule.looks };
            let eager = eagerly(&looks, started, &rule.transitions(&model), [0.7, 0.4].map(log_odds));
            for (cell, (lazy, eager)) in mapper.occupancy().values().iter().zip(&eager).enumerate() {
                prop_assert!((lazy - eager).abs() < 1e-9, "cell {cell}: {lazy} and {eager}");
            }
        }

        /// Chapman and Kolmogorov: the time in two parts is the time.
        #[test]
        fn ageing_twice_is_ageing_for_the_sum(p in 0.001f64..0.999, times in prop::array::uniform2(0.0f64..100.0)) {
            let transitions = DynamicGrid::MINUTE.transitions(&model());
            let [first, second] = times;
            let twice = transitions.aged(transitions.aged(log_odds(p), first), second);
            let once = transitions.aged(log_odds(p), first + second);
            prop_assert!((from_log_odds(twice) - from_log_odds(once)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_second_is_the_matrix_and_what_is_not_looked_at_goes_back_to_the_prior() {
        let transitions = Transitions { appears: 0.05, vanishes: 0.2 };
        let after = from_log_odds(transitions.aged(log_odds(0.7), 1.0));
        assert!((after - (0.8 * 0.7 + 0.05 * 0.3)).abs() < 1e-12, "{after}");
        let mut mapper = DynamicGrid::MINUTE.mapper(&model());
        mapper.integrate(&scan(0.0, Some(true)));
        assert!((mapper.occupancy()[CELL] - 0.7 / (0.7 + 0.3 * 9.0)).abs() < 1e-12);
        mapper.integrate(&scan(1e4, None));
        assert!(mapper.occupancy().values().iter().all(|p| (p - 0.1).abs() < 1e-12));
    }

    #[test]
    fn a_door_that_opens_is_found_open() {
        let (mut chain, model) = (DynamicGrid::MINUTE.mapper(&model()), model());
        let unbounded = LogOdds { clamp: [0.0, 1.0], ..LogOdds::OCTOMAP };
        let mut still = crate::ConstantIncrements::new(&model, unbounded);
        for (second, look) in
            [(0..120, true), (120..135, false)].into_iter().flat_map(|(time, hit)| time.map(move |t| (t, hit)))
        {
            chain.integrate(&scan(f64::from(second), Some(look)));
            still.integrate(&scan(f64::from(second), Some(look)));
        }
        assert!(chain.occupancy()[CELL] < 0.05 && still.occupancy()[CELL] > 0.99);
    }
}
