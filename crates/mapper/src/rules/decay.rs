//! Constant increments that are forgotten exponentially.

use crate::belief::probability::{from_log_odds, log_odds};
use crate::model::Model;
use crate::rules::ageing::{Ageing, AgeingIncrements};
use crate::rules::log_odds::LogOdds;

/// Evidence that fades: `S <- S exp(-t / time_constant_s)` between looks, a constant added at each, and
/// `ln(p / (1 - p)) = ln(prior / (1 - prior)) + S`, so that a cell that is not looked at goes back to the prior.
///
/// The habit of costmaps in a world that moves. The spatio-temporal voxel layer (Macenski, Tsai and Feinberg, "Spatio-temporal voxel
/// layer: A view on robot perception for the dynamic world", IJARS 17(2), 2020) gives every voxel a decay time, and has a linear and
/// an exponential model of it. Increments and clamps are those of OctoMap, at even odds as there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Decay {
    /// What evidence is divided by e in, s, above 0.
    pub time_constant_s: f64,
    /// The increments and clamps; evidence starts from none, whatever [`LogOdds::start`] says.
    pub increments: LogOdds,
}

impl Decay {
    /// 15 s, the decay time of the voxel layer's example configuration (`voxel_decay`).
    pub const STVL: Self = Self { time_constant_s: 15.0, increments: LogOdds::OCTOMAP };

    /// The mapper of this rule, with a model's own increments and clamps where it has any.
    pub fn mapper(self, model: &Model) -> AgeingIncrements<Fading> {
        let rule = LogOdds { start: 0.5, ..self.increments.tuned(&model.tuning) };
        AgeingIncrements::new(model, rule, self.fading(model))
    }

    fn fading(self, model: &Model) -> Fading {
        Fading { time_constant_s: self.time_constant_s, prior: log_odds(model.prior.marginal()) }
    }
}

/// How evidence fades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fading {
    time_constant_s: f64,
    /// Log odds of the prior.
    prior: f64,
}

impl Ageing for Fading {
    fn aged(&self, evidence: f64, time_s: f64) -> f64 {
        evidence * libm::exp(-time_s / self.time_constant_s)
    }

    fn occupied(&self, evidence: f64) -> f64 {
        from_log_odds(self.prior + evidence)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::mapper::Mapper as _;
    use crate::rules::ageing::tests::{CELL, eagerly, model, scan};

    #[test]
    fn two_looks_by_hand() {
        let mut mapper = Decay { time_constant_s: 10.0, ..Decay::STVL }.mapper(&model());
        mapper.integrate(&scan(0.0, Some(true)));
        mapper.integrate(&scan(5.0, Some(false)));
        let evidence = (0.7f64 / 0.3).ln() * (-0.5f64).exp() + (0.4f64 / 0.6).ln();
        let odds = evidence.exp() / 9.0; // the prior is 0.1
        assert!((mapper.occupancy()[CELL] - odds / (1.0 + odds)).abs() < 1e-12);
        mapper.integrate(&scan(1e4, None));
        assert!(mapper.occupancy().values().iter().all(|p| (p - 0.1).abs() < 1e-12), "all is forgotten");
    }

    #[test]
    fn where_no_time_passes_it_is_the_plain_rule() {
        let (mut decaying, model) = (Decay::STVL.mapper(&model()), model());
        let mut plain = crate::ConstantIncrements::new(&model, LogOdds::OCTOMAP);
        for look in [true, true, false, true] {
            decaying.integrate(&scan(3.0, Some(look)));
            plain.integrate(&scan(3.0, Some(look)));
        }
        let odds = |p: f64| p / (1.0 - p);
        for cell in 0..=CELL {
            assert!((odds(decaying.occupancy()[cell]) * 9.0 - odds(plain.occupancy()[cell])).abs() < 1e-9, "{cell}");
        }
    }

    proptest! {
        /// What is aged when it is looked at is what is aged with every scan, in every cell, whatever times do.
        #[test]
        fn lazily_is_eagerly(
            looks in prop::collection::vec((0.0f64..60.0, prop::option::of(any::<bool>())), 1..40), in_order in any::<bool>(),
            time_constant_s in 0.5f64..100.0,
        ) {
            let mut looks = looks;
            if in_order {
                looks.sort_by(|a, b| a.0.total_cmp(&b.0));
            }
            let (decay, model) = (Decay { time_constant_s, ..Decay::STVL }, model());
            let mut mapper = decay.mapper(&model);
            looks.iter().for_each(|(time_s, look)| mapper.integrate(&scan(*time_s, *look)));
            let step = [0.7, 0.4].map(log_odds);
            let eager = eagerly(&looks, LogOdds::OCTOMAP, &decay.fading(&model), step);
            for (cell, (lazy, eager)) in mapper.occupancy().values().iter().zip(&eager).enumerate() {
                prop_assert!((lazy - eager).abs() < 1e-9, "cell {cell}: {lazy} and {eager}");
            }
        }
    }
}
