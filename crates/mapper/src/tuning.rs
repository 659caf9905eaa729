//! Parameters of the rules that are compared, where they are not to be as published or fitted.

use crate::{ConventionalRule, Field, LogOdds};

/// Values in the place of a rule's own; none leaves a value as it is. A rule ignores what it does not have.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tuning {
    /// Half the bin of a reading of the conventional rules, in the reading's unit; above 0.
    pub half_width: Option<f64>,
    /// Least probability of a cell of the conventional and log-odds rules, 0 to 1.
    pub clamp_low: Option<f64>,
    /// Largest probability of such a cell, 0 to 1; at least the least.
    pub clamp_high: Option<f64>,
    /// Probability that a hit stands for in the log-odds rules, 0 to 1.
    pub hit: Option<f64>,
    /// Probability that a miss stands for in the log-odds rules, 0 to 1.
    pub miss: Option<f64>,
    /// Probability that the log-odds rules start an unknown cell from, 0 to 1.
    pub start: Option<f64>,
    /// Correlation of two neighbours of the field that knew of no others, 0 to 1.
    pub coupling: Option<f64>,
    /// Share of a message of the field that is kept from the sweep before, 0 up to but not including 1.
    pub damping: Option<f64>,
    /// Most sweeps of the field; at least 1.
    pub sweeps: Option<usize>,
}

impl Tuning {
    /// A conventional rule with these values.
    pub fn conventional(&self, rule: ConventionalRule) -> ConventionalRule {
        ConventionalRule { half_width: self.half_width.unwrap_or(rule.half_width), clamp: self.clamp(rule.clamp) }
    }

    /// A log-odds rule with these values.
    pub fn log_odds(&self, rule: LogOdds) -> LogOdds {
        LogOdds {
            hit: self.hit.unwrap_or(rule.hit),
            miss: self.miss.unwrap_or(rule.miss),
            start: self.start.unwrap_or(rule.start),
            clamp: self.clamp(rule.clamp),
            ..rule
        }
    }

    /// A field with these values.
    pub fn field(&self, field: Field) -> Field {
        Field {
            coupling: self.coupling.unwrap_or(field.coupling),
            damping: self.damping.unwrap_or(field.damping),
            sweeps: self.sweeps.unwrap_or(field.sweeps),
            ..field
        }
    }

    /// Both clamps, in their order even where only one is given and lies beyond the other.
    fn clamp(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        match (self.clamp_low, self.clamp_high) {
            (Some(low), Some(high)) => [low, high.max(low)],
            (Some(least), None) => [least, high.max(least)],
            (None, Some(most)) => [low.min(most), most],
            (None, None) => [low, high],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_given_changes_nothing() {
        let none = Tuning::default();
        assert_eq!(none.conventional(ConventionalRule::TUNED), ConventionalRule::TUNED);
        assert_eq!(none.log_odds(LogOdds::OCTOMAP), LogOdds::OCTOMAP);
        assert_eq!(none.field(Field::TUNED), Field::TUNED);
    }

    #[test]
    fn each_value_takes_its_place() {
        let tuning = Tuning {
            half_width: Some(0.7),
            clamp_high: Some(0.002),
            hit: Some(0.9),
            miss: Some(0.3),
            start: Some(0.1),
            coupling: Some(0.3),
            damping: Some(0.0),
            sweeps: Some(7),
            ..Tuning::default()
        };
        let rule = tuning.conventional(ConventionalRule::TUNED);
        assert_eq!(rule, ConventionalRule { half_width: 0.7, clamp: [0.002, 0.002] });
        let increments = tuning.log_odds(LogOdds::OCTOMAP);
        assert_eq!(increments, LogOdds { hit: 0.9, miss: 0.3, start: 0.1, clamp: [0.002, 0.002], ..LogOdds::OCTOMAP });
        assert_eq!(tuning.field(Field::TUNED), Field { coupling: 0.3, damping: 0.0, sweeps: 7, ..Field::TUNED });
    }
}
