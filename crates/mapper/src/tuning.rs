//! Parameters of the rules that are compared, where they are not to be as published or fitted.

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
    /// What a hit and a miss stand for, and where a cell starts, of a rule in log odds.
    pub(crate) fn odds(&self, [hit, miss, start]: [f64; 3]) -> [f64; 3] {
        [self.hit.unwrap_or(hit), self.miss.unwrap_or(miss), self.start.unwrap_or(start)]
    }

    /// Both clamps, in their order even where only one is given and lies beyond the other.
    pub(crate) fn clamp(&self, [low, high]: [f64; 2]) -> [f64; 2] {
        match (self.clamp_low, self.clamp_high) {
            (Some(low), Some(high)) => [low, high.max(low)],
            (Some(least), None) => [least, high.max(least)],
            (None, Some(most)) => [low.min(most), most],
            (None, None) => [low, high],
        }
    }
}
