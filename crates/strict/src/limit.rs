//! Ranges of numbers.

/// A range that a number must lie in.
pub struct Limit {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// What the value must be, with its unit and range.
    pub bound: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

impl Limit {
    /// Whether a value lies in the range; what is no number does not.
    pub fn allows(&self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }
}
