//! What a comparison comes to, in a word.

use std::fmt;

use serde::Serialize;

use crate::StatisticsError;

/// Which values of a metric are the better ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Better {
    /// Small ones, as of a loss.
    Lower,
    /// Large ones, as of retention.
    Higher,
}

/// The largest difference that does not matter, in the unit of the metric; above zero and finite. It
/// is a statement about what maps are for, made before looking at the results.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize)]
pub struct Margin(f64);

impl Margin {
    /// # Errors
    /// A value that is not above zero and finite.
    pub fn new(value: f64) -> Result<Self, StatisticsError> {
        if value > 0.0 && value.is_finite() { Ok(Self(value)) } else { Err(StatisticsError::Margin { value }) }
    }

    /// The value, in the unit of the metric.
    pub fn value(self) -> f64 {
        self.0
    }
}

/// What a comparison says about ours against theirs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// Ours is better.
    Better,
    /// Ours is worse.
    Worse,
    /// The difference, whatever it is, is too small to matter.
    Equivalent,
    /// The data do not tell. This is not the same as no difference.
    Undecided,
}

impl Verdict {
    /// All verdicts, in the order of tables.
    pub const ALL: [Verdict; 4] = [Self::Better, Self::Equivalent, Self::Undecided, Self::Worse];

    /// The word for it in tables and files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Better => "better",
            Self::Worse => "worse",
            Self::Equivalent => "equivalent",
            Self::Undecided => "undecided",
        }
    }

    /// The same comparison seen from the other side.
    pub fn reversed(self) -> Self {
        match self {
            Self::Better => Self::Worse,
            Self::Worse => Self::Better,
            same => same,
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_margins_that_leave_room_are_margins() {
        assert_eq!(Margin::new(0.01).map(Margin::value), Ok(0.01));
        for bad in [0.0, -0.01, f64::NAN, f64::INFINITY] {
            let message = Margin::new(bad).expect_err("refused").to_string();
            assert!(message.starts_with(&format!("equivalence margin {bad} is not above 0")), "{message}");
        }
    }

    #[test]
    fn words() {
        let words: Vec<String> = Verdict::ALL.iter().map(|v| format!("{v:<10}|")).collect();
        assert_eq!(words, ["better    |", "equivalent|", "undecided |", "worse     |"]);
        let reversed: Vec<&str> = Verdict::ALL.iter().map(|v| v.reversed().word()).collect();
        assert_eq!(reversed, ["worse", "equivalent", "undecided", "better"]);
    }
}
