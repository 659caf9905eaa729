//! Parameters of rules that are fitted on worlds: what there is to choose from, and what was chosen.

use std::sync::Arc;

use crate::mapper::Mapper;
use crate::model::Model;

/// A mapper with parameters to fit.
pub struct Fit {
    /// Its name in the catalogue.
    pub mapper: &'static str,
    /// What the catalogue has: the best of those tried.
    pub built_in: fn() -> Candidate,
    /// The grid of parameters; of candidates that are equally good the first is chosen.
    pub tried: fn() -> Vec<Candidate>,
}

/// A mapper with its parameters.
#[derive(Clone)]
pub struct Candidate {
    /// The parameters in a few words.
    pub label: String,
    /// The parameters by name, with their units.
    pub parameters: Vec<(&'static str, Setting)>,
    build: Arc<Make>,
}

/// Makes the unseen map.
type Make = dyn Fn(&Model) -> Box<dyn Mapper> + Send + Sync;

/// The value of a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Setting {
    /// A number in the unit that the parameter's name says; infinite where a bound is none.
    Number(f64),
    /// A word.
    Word(&'static str),
}

/// A rule as plain values.
pub trait Fitted: Copy + Send + Sync + 'static {
    /// The parameters that are fitted, by name.
    fn parameters(&self) -> Vec<(&'static str, Setting)>;

    /// The same in a few words.
    fn label(&self) -> String;

    /// The unseen map of the rule as it is.
    fn mapper(&self, model: &Model) -> Box<dyn Mapper>;
}

impl Candidate {
    /// A rule as a candidate.
    pub fn of(rule: impl Fitted) -> Self {
        let build = move |model: &Model| rule.mapper(model);
        Self { label: rule.label(), parameters: rule.parameters(), build: Arc::new(build) }
    }

    /// Rules as candidates.
    pub fn all<R: Fitted>(rules: impl IntoIterator<Item = R>) -> Vec<Self> {
        rules.into_iter().map(Self::of).collect()
    }

    /// The unseen map.
    pub fn build(&self, model: &Model) -> Box<dyn Mapper> {
        (self.build)(model)
    }

    /// The value of a parameter; none of one that the rule does not have.
    pub fn get(&self, parameter: &str) -> Option<Setting> {
        self.parameters.iter().find(|(name, _)| *name == parameter).map(|(_, value)| *value)
    }

    /// The value of a parameter that is a number.
    pub fn number(&self, parameter: &str) -> Option<f64> {
        match self.get(parameter) {
            Some(Setting::Number(number)) => Some(number),
            _ => None,
        }
    }
}

impl PartialEq for Candidate {
    /// The same parameters.
    fn eq(&self, other: &Self) -> bool {
        self.parameters == other.parameters
    }
}

impl std::fmt::Debug for Candidate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.label)
    }
}

impl std::fmt::Display for Candidate {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.label)
    }
}

/// Numbers by name.
pub(crate) fn numbers<const N: usize>(named: [(&'static str, f64); N]) -> Vec<(&'static str, Setting)> {
    named.map(|(name, number)| (name, Setting::Number(number))).to_vec()
}
