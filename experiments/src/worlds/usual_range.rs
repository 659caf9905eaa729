//! The range within which nearly all readings of a log lie.

/// Ranges are counted in steps of this, m.
const STEP_M: f64 = 0.1;

/// Number of steps; what lies beyond is counted in one more.
const STEPS: usize = 2000;

/// Share of the readings that lie within the usual range.
const WITHIN: f64 = 0.99;

/// Ranges that were read, counted. A false match of a camera, or an echo from a mountain, can say any range, so that a map of all of them
/// would be of any size.
#[derive(Debug, Clone)]
pub struct Ranges {
    counts: Vec<u64>,
}

impl Default for Ranges {
    fn default() -> Self {
        Self { counts: vec![0; STEPS + 1] }
    }
}

impl Ranges {
    /// Counts one more, m.
    pub fn add(&mut self, range_m: f64) {
        self.counts[((range_m / STEP_M) as usize).min(STEPS)] += 1;
    }

    /// The range within which 99 of 100 lie, m, up to a whole step.
    pub fn usual_m(&self) -> f64 {
        let all: u64 = self.counts.iter().sum();
        let mut sum = 0;
        let within = self.counts.iter().position(|count| {
            sum += count;
            sum as f64 >= WITHIN * all as f64
        });
        STEP_M * (within.unwrap_or(0) + 1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_in_a_hundred_lies_beyond() {
        let mut ranges = Ranges::default();
        assert!(ranges.usual_m() <= 2.0 * STEP_M, "nothing was read");
        (0..99).for_each(|_| ranges.add(3.07));
        ranges.add(15_000.0);
        assert!((ranges.usual_m() - 3.1).abs() < 1e-12);
        ranges.add(15_000.0);
        assert!((ranges.usual_m() - 200.1).abs() < 1e-9, "two in a hundred");
    }
}
