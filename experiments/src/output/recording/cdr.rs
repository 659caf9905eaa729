//! Common Data Representation (OMG, Version 1, little-endian): how ROS 2 writes messages.

/// A message that grows. Numbers stand at multiples of their size, counted from behind the header.
pub(super) struct Cdr(Vec<u8>);

/// The encapsulation header: plain CDR, little-endian.
const HEADER: [u8; 4] = [0, 1, 0, 0];

impl Cdr {
    pub(super) fn new() -> Self {
        Self(HEADER.to_vec())
    }

    pub(super) fn finish(self) -> Vec<u8> {
        self.0
    }

    fn aligned(&mut self, size: usize) {
        let behind = (self.0.len() - HEADER.len()) % size;
        if behind > 0 {
            self.0.resize(self.0.len() + size - behind, 0);
        }
    }

    pub(super) fn bool(&mut self, value: bool) {
        self.0.push(u8::from(value));
    }

    pub(super) fn u8(&mut self, value: u8) {
        self.0.push(value);
    }

    pub(super) fn u32(&mut self, value: u32) {
        self.aligned(4);
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn i32(&mut self, value: i32) {
        self.aligned(4);
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn f32(&mut self, value: f32) {
        self.aligned(4);
        self.0.extend(value.to_le_bytes());
    }

    pub(super) fn f64(&mut self, value: f64) {
        self.aligned(8);
        self.0.extend(value.to_le_bytes());
    }

    /// With its length, and the zero that ends it.
    pub(super) fn text(&mut self, text: &str) {
        self.u32(text.len() as u32 + 1);
        self.0.extend(text.as_bytes());
        self.0.push(0);
    }

    /// A sequence of bytes.
    pub(super) fn bytes(&mut self, bytes: impl ExactSizeIterator<Item = u8>) {
        self.u32(bytes.len() as u32);
        self.0.extend(bytes);
    }

    /// A sequence of numbers.
    pub(super) fn f32s(&mut self, values: impl ExactSizeIterator<Item = f32>) {
        self.u32(values.len() as u32);
        values.for_each(|value| self.f32(value));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_at_multiples_of_their_size() {
        let mut cdr = Cdr::new();
        cdr.u8(7);
        cdr.u32(1);
        cdr.text("ab");
        cdr.f64(1.0);
        let bytes = cdr.finish();
        let expected = [
            &[0, 1, 0, 0][..],
            &[7, 0, 0, 0],
            &[1, 0, 0, 0],
            &[3, 0, 0, 0, b'a', b'b', 0],
            &[0],
            &1.0f64.to_le_bytes(),
        ];
        assert_eq!(bytes, expected.concat());
    }
}
