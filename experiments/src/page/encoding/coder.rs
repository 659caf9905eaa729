//! An adaptive binary range coder, as LZMA has it: a bit costs what it surprises.
//!
//! Coding and decoding are one piece of code over the trait [`Coder`]: an [`Encoder`] writes the bit that it is given, a
//! [`Decoder`] takes no notice of it and gives the one that was written. The page decodes with
//! `experiments/templates/viewer/decode.js`.

/// Bits of a probability.
const BITS: u32 = 11;

/// How fast a model follows: the share of the way that a bit moves it is two to the minus this.
const PACE: u32 = 5;

/// Below this the range takes in another byte.
const SMALL: u32 = 1 << 24;

/// What is expected of a bit: the probability of a zero.
#[derive(Debug, Clone, Copy)]
pub(super) struct Model(u16);

impl Default for Model {
    fn default() -> Self {
        Self(1 << (BITS - 1))
    }
}

impl Model {
    /// The part of a range that a zero has.
    fn bound(self, range: u32) -> u32 {
        (range >> BITS) * u32::from(self.0)
    }

    fn learn(&mut self, bit: bool) {
        match bit {
            true => self.0 -= self.0 >> PACE,
            false => self.0 += ((1 << BITS) - self.0) >> PACE,
        }
    }
}

/// Writes or reads bits. Both narrow a range bit by bit; where in it they are is their own.
pub(super) trait Coder {
    /// The range that is left.
    fn range(&mut self) -> &mut u32;

    /// Tells, or takes note, on which side of `bound` the bit is, and moves above it if it is a one.
    fn side(&mut self, bound: u32, bit: bool) -> bool;

    /// Moves a byte out or in.
    fn byte(&mut self);

    /// The bit that stands here: the one given where it is written, the one found where it is read.
    fn bit(&mut self, model: &mut Model, bit: bool) -> bool {
        let bound = model.bound(*self.range());
        let bit = self.side(bound, bit);
        let range = self.range();
        *range = if bit { *range - bound } else { bound };
        model.learn(bit);
        while *self.range() < SMALL {
            *self.range() <<= 8;
            self.byte();
        }
        bit
    }
}

/// Writes.
pub(super) struct Encoder {
    low: u64,
    range: u32,
    /// A byte that a carry may still change, and how many of 255 follow it.
    cache: u8,
    pending: u64,
    bytes: Vec<u8>,
}

impl Encoder {
    pub(super) fn new() -> Self {
        Self { low: 0, range: u32::MAX, cache: 0, pending: 1, bytes: Vec::new() }
    }

    /// Everything that was written.
    pub(super) fn finish(mut self) -> Vec<u8> {
        (0..5).for_each(|_| self.byte());
        self.bytes
    }
}

impl Coder for Encoder {
    fn range(&mut self) -> &mut u32 {
        &mut self.range
    }

    fn side(&mut self, bound: u32, bit: bool) -> bool {
        self.low += if bit { u64::from(bound) } else { 0 };
        bit
    }

    fn byte(&mut self) {
        if self.low < 0xff00_0000 || self.low > u64::from(u32::MAX) {
            let carry = (self.low >> 32) as u8;
            let mut byte = self.cache;
            for _ in 0..self.pending {
                self.bytes.push(byte.wrapping_add(carry));
                byte = 0xff;
            }
            self.pending = 0;
            self.cache = (self.low >> 24) as u8;
        }
        self.pending += 1;
        self.low = (self.low & 0x00ff_ffff) << 8;
    }
}

/// Reads; past the end it reads zeros.
pub(super) struct Decoder<'a> {
    code: u32,
    range: u32,
    bytes: std::slice::Iter<'a, u8>,
}

impl<'a> Decoder<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        let mut decoder = Self { code: 0, range: u32::MAX, bytes: bytes.iter() };
        (0..5).for_each(|_| decoder.byte());
        decoder
    }
}

impl Coder for Decoder<'_> {
    fn range(&mut self) -> &mut u32 {
        &mut self.range
    }

    fn side(&mut self, bound: u32, _: bool) -> bool {
        let bit = self.code >= bound;
        self.code -= if bit { bound } else { 0 };
        bit
    }

    fn byte(&mut self) {
        self.code = self.code << 8 | u32::from(self.bytes.next().copied().unwrap_or(0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bits_come_back(bits in prop::collection::vec((0usize..3, any::<bool>()), 0..3000), rare: bool) {
            // Runs of equal bits drive models to their bounds, and carries through runs of 255.
            let bits: Vec<(usize, bool)> = bits.into_iter().enumerate().map(|(k, (m, b))| (m, b && (!rare || k % 97 == 0))).collect();
            let (mut encoder, mut models) = (Encoder::new(), [Model::default(); 3]);
            bits.iter().for_each(|(model, bit)| { encoder.bit(&mut models[*model], *bit); });
            let bytes = encoder.finish();
            let (mut decoder, mut models) = (Decoder::new(&bytes), [Model::default(); 3]);
            for (model, bit) in &bits {
                prop_assert_eq!(decoder.bit(&mut models[*model], false), *bit);
            }
            prop_assert!(!rare || bytes.len() <= 12 + bits.len() / 20);
        }
    }
}
