//! What there is to choose from.

use std::fmt;

use clap::ValueEnum;
use mapper::{Conventional, ConventionalRule, EPSILON, FastVisibility, Field, Mapper, Model, Mrf, Reconciliation};

/// A mapper with parameters to fit, by its name in the catalogue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Tuned {
    /// the least squares with or without edges on no ray
    Visibility,
    /// bin and clamps
    ConventionalTuned,
    /// coupling and damping
    Mrf,
}

/// A mapper with its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Candidate {
    /// The paper's method, by what becomes of edges on no ray.
    Visibility(Reconciliation),
    /// The conventional rule.
    Conventional(ConventionalRule),
    /// The field over the whole map.
    Mrf(Field),
}

/// Half of the bin of a reading, px.
const HALF_WIDTHS: [f64; 6] = [0.25, 0.35, 0.4, 0.45, 0.5, 0.7];

/// Least and largest probabilities; the first and the last are those of every mapper.
const LOWS: [f64; 5] = [EPSILON, 0.005, 0.01, 0.02, 0.05];
const HIGHS: [f64; 7] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0 - EPSILON];

/// Correlations of neighbours. A map is unstable from 1/3 on: the last shows the cliff before it.
const COUPLINGS: [f64; 8] = [0.0, 0.1, 0.15, 0.2, 0.225, 0.25, 0.27, 0.3];

impl Tuned {
    /// Everything that is fitted, in the order of tables.
    pub const ALL: [Self; 3] = [Self::Visibility, Self::ConventionalTuned, Self::Mrf];

    /// Its name in the catalogue.
    pub fn name(self) -> &'static str {
        match self {
            Self::Visibility => "visibility",
            Self::ConventionalTuned => "conventional-tuned",
            Self::Mrf => "mrf",
        }
    }

    /// Whether it takes all scans at once, and so costs much.
    pub fn is_batch(self) -> bool {
        self == Self::Mrf
    }

    /// What the catalogue has.
    pub fn built_in(self) -> Candidate {
        match self {
            Self::Visibility => Candidate::Visibility(Reconciliation::default()),
            Self::ConventionalTuned => Candidate::Conventional(ConventionalRule::TUNED),
            Self::Mrf => Candidate::Mrf(Field::TUNED),
        }
    }

    /// The grid of parameters; of candidates that are equally good the first is chosen.
    pub fn candidates(self) -> Vec<Candidate> {
        match self {
            Self::Visibility => [Reconciliation::AllEdges, Reconciliation::Touched].map(Candidate::Visibility).to_vec(),
            Self::ConventionalTuned => {
                let clamps = || LOWS.iter().flat_map(|&low| HIGHS.map(|high| [low, high]));
                let rules = |half_width| clamps().map(move |clamp| ConventionalRule { half_width, clamp });
                HALF_WIDTHS.into_iter().flat_map(rules).map(Candidate::Conventional).collect()
            }
            Self::Mrf => COUPLINGS.map(|coupling| Candidate::Mrf(Field { coupling, ..Field::TUNED })).to_vec(),
        }
    }
}

impl fmt::Display for Tuned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl Candidate {
    /// The columns of [`parameters`](Self::parameters); half widths in px.
    pub const PARAMETERS: [&'static str; 5] = ["half_width_px", "clamp_low", "clamp_high", "coupling", "damping"];

    /// The unseen map.
    pub fn build(self, setup: &Model) -> Box<dyn Mapper> {
        match self {
            Self::Visibility(reconciliation) => {
                Box::new(FastVisibility::visibility(&Model { reconciliation, ..setup.clone() }))
            }
            Self::Conventional(rule) => Box::new(Conventional::with(setup, rule)),
            Self::Mrf(field) => Box::new(Mrf::new(setup, field)),
        }
    }

    /// The conventional rule with these parameters, if it is one.
    pub fn rule(self) -> Option<ConventionalRule> {
        if let Self::Conventional(rule) = self { Some(rule) } else { None }
    }

    /// What becomes of edges on no ray, where that is the parameter.
    pub fn reconciliation(self) -> Option<&'static str> {
        match self {
            Self::Visibility(Reconciliation::AllEdges) => Some("all-edges"),
            Self::Visibility(Reconciliation::Touched) => Some("touched"),
            Self::Conventional(_) | Self::Mrf(_) => None,
        }
    }

    /// The parameters that are numbers; none where a mapper has no such parameter.
    pub fn parameters(self) -> [Option<f64>; 5] {
        match self {
            Self::Visibility(_) => [None; 5],
            Self::Conventional(ConventionalRule { half_width, clamp: [low, high] }) => {
                [Some(half_width), Some(low), Some(high), None, None]
            }
            Self::Mrf(field) => [None, None, None, Some(field.coupling), Some(field.damping)],
        }
    }

    /// The parameters that lie at an end of what was tried, so that better ones may lie beyond. An end beyond which
    /// there is nothing is none.
    pub fn at_border(self, tried: &[Self]) -> Vec<&'static str> {
        let last = |value: f64| value <= EPSILON || (1.0 - EPSILON..=1.0).contains(&value);
        let at_border = |&number: &usize| {
            let Some(own) = self.parameters()[number] else { return false };
            let values = || tried.iter().filter_map(|candidate| candidate.parameters()[number]);
            let (below, above) = (values().any(|v| v < own), values().any(|v| v > own));
            below != above && !last(own)
        };
        (0..5).filter(at_border).map(|number| Self::PARAMETERS[number]).collect()
    }
}

impl fmt::Display for Candidate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Visibility(_) => f.write_str(self.reconciliation().unwrap_or_default()),
            Self::Conventional(ConventionalRule { half_width, clamp: [low, high] }) => {
                write!(f, "w {half_width} px, {low} to {high}")
            }
            Self::Mrf(Field { coupling, damping, .. }) => write!(f, "coupling {coupling}, damping {damping}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_catalogue_and_of_the_command_line() {
        for tuned in Tuned::ALL {
            assert!(mapper::catalogue::find(tuned.name()).is_some(), "{tuned}");
            assert_eq!(Tuned::from_str(tuned.name(), false), Ok(tuned));
        }
    }

    #[test]
    fn what_is_built_in_is_among_the_candidates_and_all_differ() {
        for tuned in Tuned::ALL {
            let candidates = tuned.candidates();
            assert!(candidates.contains(&tuned.built_in()), "{tuned}");
            for (k, candidate) in candidates.iter().enumerate() {
                assert!(!candidates[..k].contains(candidate), "{candidate} twice");
            }
        }
    }

    #[test]
    fn ends_of_the_grid_are_borders_unless_nothing_lies_beyond() {
        let rule = |half_width, low, high| Candidate::Conventional(ConventionalRule { half_width, clamp: [low, high] });
        let tried = Tuned::ConventionalTuned.candidates();
        assert_eq!(rule(0.5, 0.02, 0.9).at_border(&tried), [""; 0]);
        assert_eq!(rule(0.25, 0.02, 0.2).at_border(&tried), ["half_width_px", "clamp_high"]);
        assert_eq!(rule(0.5, EPSILON, 1.0 - EPSILON).at_border(&tried), [""; 0]);
        let fields = Tuned::Mrf.candidates();
        assert_eq!(fields[0].at_border(&fields), [""; 0], "no coupling below 0; one damping is no grid");
        assert_eq!(fields[7].at_border(&fields), ["coupling"]);
    }
}
