//! What there is to fit: every mapper of the catalogue that has parameters to choose from.

use std::fmt;

use mapper::catalogue::{FITS, Kind, find};
use mapper::{Candidate, ConventionalRule, EPSILON, Fit, Setting};

/// A mapper with parameters to fit.
#[derive(Clone, Copy)]
pub struct Tuned(&'static Fit);

impl Tuned {
    /// Everything that is fitted, in the order of tables.
    pub fn all() -> Vec<Self> {
        FITS.iter().map(Self).collect()
    }

    /// The one of the given name.
    ///
    /// # Errors
    /// A name that there is not, with those that there are.
    pub fn parse(name: &str) -> Result<Self, String> {
        let all = Self::all();
        let known = || all.iter().map(|tuned| tuned.name());
        all.iter().copied().find(|tuned| tuned.name() == name.trim()).ok_or_else(|| {
            let (nearest, all) = (strict::nearest(name, known()), known().collect::<Vec<_>>().join(", "));
            format!("must be a mapper with parameters to fit; the nearest is '{nearest}', all are: {all}")
        })
    }

    /// Its name in the catalogue.
    pub fn name(self) -> &'static str {
        self.0.mapper
    }

    /// Whether it takes all scans at once, and so costs much.
    pub fn is_batch(self) -> bool {
        find(self.name()).is_some_and(|entry| entry.kind == Kind::Batch)
    }

    /// What the catalogue has.
    pub fn built_in(self) -> Candidate {
        (self.0.built_in)()
    }

    /// The grid of parameters; of candidates that are equally good the first is chosen.
    pub fn candidates(self) -> Vec<Candidate> {
        (self.0.tried)()
    }
}

impl PartialEq for Tuned {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl fmt::Display for Tuned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Debug for Tuned {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Names of all parameters: the columns of a table.
pub fn parameters() -> Vec<&'static str> {
    let mut names = Vec::new();
    for candidate in Tuned::all().into_iter().map(Tuned::built_in) {
        names.extend(candidate.parameters.iter().map(|(name, _)| *name));
    }
    let mut seen = std::collections::BTreeSet::new();
    names.retain(|name| seen.insert(*name));
    names
}

/// The conventional rule of a candidate, if it is nothing but that.
pub fn rule(candidate: &Candidate) -> Option<ConventionalRule> {
    let number = |name| candidate.number(name);
    let clamp = [number("clamp_low")?, number("clamp_high")?];
    Some(ConventionalRule { half_width: number("half_width_px")?, clamp })
}

/// The parameters that lie at an end of what was tried, so that better ones may lie beyond. An end beyond which
/// there is nothing is none.
pub fn at_border(candidate: &Candidate, tried: &[Candidate]) -> Vec<&'static str> {
    let least = |value: f64| value <= EPSILON;
    let last = |name: &str, value: f64| value == f64::INFINITY || name.starts_with("clamp") && value >= 1.0 - EPSILON;
    let at_border = |(name, own): &(&'static str, Setting)| {
        let Setting::Number(own) = *own else { return None };
        let values = || tried.iter().filter_map(|candidate| candidate.number(name));
        let (below, above) = (values().any(|v| v < own), values().any(|v| v > own));
        (below != above && !least(own) && !last(name, own)).then_some(*name)
    };
    candidate.parameters.iter().filter_map(at_border).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mapper::Fitted as _;

    #[test]
    fn names_are_those_of_the_catalogue_and_of_the_command_line() {
        for tuned in Tuned::all() {
            assert!(mapper::catalogue::find(tuned.name()).is_some(), "{tuned}");
            assert_eq!(Tuned::parse(tuned.name()), Ok(tuned));
        }
        let refused = Tuned::parse("conventionel-tuned").expect_err("unknown");
        assert!(refused.contains("the nearest is 'conventional-tuned', all are: visibility, "), "{refused}");
    }

    #[test]
    fn what_is_built_in_is_among_the_candidates_and_all_differ() {
        for tuned in Tuned::all() {
            let candidates = tuned.candidates();
            assert!(candidates.contains(&tuned.built_in()), "{tuned}");
            for (k, candidate) in candidates.iter().enumerate() {
                assert!(!candidates[..k].contains(candidate), "{candidate} twice");
            }
        }
    }

    #[test]
    fn ends_of_the_grid_are_borders_unless_nothing_lies_beyond() {
        let of = |half_width, low, high| Candidate::of(ConventionalRule { half_width, clamp: [low, high] });
        let tried = Tuned::parse("conventional-tuned").expect("known").candidates();
        let none: [&str; 0] = [];
        assert_eq!(at_border(&of(0.5, 0.02, 0.9), &tried), none);
        assert_eq!(at_border(&of(0.25, 0.02, 0.2), &tried), ["half_width_px", "clamp_high"]);
        assert_eq!(at_border(&of(0.5, EPSILON, 1.0 - EPSILON), &tried), none);
        let fields = Tuned::parse("mrf").expect("known").candidates();
        assert_eq!(at_border(&fields[0], &fields), none, "no coupling below 0; one damping is no grid");
        assert_eq!(at_border(&fields[7], &fields), ["coupling"]);
        let cuts = Tuned::parse("conventional-cut").expect("known").candidates();
        assert_eq!(at_border(&cuts[0], &cuts), ["max_range_m"]);
        assert_eq!(at_border(cuts.last().expect("some"), &cuts), none, "all readings");
    }

    #[test]
    fn only_the_conventional_rule_is_one() {
        let rule_of = |name: &str| rule(&Tuned::parse(name).expect("known").built_in());
        assert_eq!(rule_of("conventional-tuned"), Some(ConventionalRule::TUNED));
        let others = Tuned::all().into_iter().filter(|tuned| tuned.name() != "conventional-tuned");
        assert!(others.into_iter().all(|tuned| rule(&tuned.built_in()).is_none()));
        assert_eq!(ConventionalRule::TUNED.label(), "w 0.45 px, 0.005 to 0.4");
    }
}
