//! Whole numbers, small ones in few bits.

use super::coder::{Coder, Model};

/// Longest number, bits.
const LENGTH: usize = 24;

/// Lengths that are told apart when the next number is guessed.
const CONTEXTS: usize = 9;

/// Signed numbers of one kind that follow each other: a number is expected to be about as long as the one before.
#[derive(Debug, Clone)]
pub(super) struct Numbers {
    zero: [Model; CONTEXTS],
    negative: [Model; CONTEXTS],
    longer: [[Model; LENGTH]; CONTEXTS],
    bits: [[Model; LENGTH]; LENGTH],
    former: usize,
}

impl Default for Numbers {
    fn default() -> Self {
        let model = Model::default();
        Self {
            zero: [model; CONTEXTS],
            negative: [model; CONTEXTS],
            longer: [[model; LENGTH]; CONTEXTS],
            bits: [[model; LENGTH]; LENGTH],
            former: 0,
        }
    }
}

impl Numbers {
    /// Codes a number of less than 2^24.
    pub(super) fn code(&mut self, coder: &mut impl Coder, value: i32) -> i32 {
        let context = self.former.min(CONTEXTS - 1);
        if coder.bit(&mut self.zero[context], value == 0) {
            self.former = 0;
            return 0;
        }
        let negative = coder.bit(&mut self.negative[context], value < 0);
        // Elias gamma: how many bits follow the first, then those.
        let size = value.unsigned_abs();
        let told = size.checked_ilog2().unwrap_or(0) as usize;
        let mut length = 0;
        while length + 1 < LENGTH && coder.bit(&mut self.longer[context][length], length < told) {
            length += 1;
        }
        let mut found = 1u32;
        for place in (0..length).rev() {
            found = found << 1 | u32::from(coder.bit(&mut self.bits[length][place], size >> place & 1 == 1));
        }
        self.former = length + 1;
        if negative { -(found as i32) } else { found as i32 }
    }
}

/// Numbers of which some may be missing, each coded as its difference from the one before that is there.
#[derive(Debug, Clone, Default)]
pub(super) struct Series {
    missing: [Model; 2],
    differences: Numbers,
    was_missing: bool,
    former: i32,
}

impl Series {
    pub(super) fn code(&mut self, coder: &mut impl Coder, value: Option<i32>) -> Option<i32> {
        self.was_missing = coder.bit(&mut self.missing[usize::from(self.was_missing)], value.is_none());
        if self.was_missing {
            return None;
        }
        self.former += self.differences.code(coder, value.unwrap_or(0) - self.former);
        Some(self.former)
    }
}

#[cfg(test)]
mod tests {
    use super::super::coder::{Decoder, Encoder};
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_come_back(values in prop::collection::vec(prop::option::of(-(1 << 22)..(1i32 << 22)), 0..300)) {
            let (mut encoder, mut series) = (Encoder::new(), Series::default());
            values.iter().for_each(|value| { series.code(&mut encoder, *value); });
            let bytes = encoder.finish();
            let (mut decoder, mut series) = (Decoder::new(&bytes), Series::default());
            for value in &values {
                prop_assert_eq!(series.code(&mut decoder, None), *value);
            }
        }
    }

    #[test]
    fn small_numbers_take_few_bits() {
        let (mut encoder, mut numbers) = (Encoder::new(), Numbers::default());
        (0..8000).for_each(|k| {
            numbers.code(&mut encoder, [0, 1, -1, 2][k % 4]);
        });
        assert!(encoder.finish().len() < 2500);
    }
}
