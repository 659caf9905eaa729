//! How a number lies in an NPY file.

/// What kind of number it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    Bool,
    Float,
    Signed,
    Unsigned,
}

/// The type of an array's values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Number {
    pub(super) kind: Kind,
    /// Bytes of one, 1 to 8.
    pub(super) bytes: usize,
    big_endian: bool,
}

impl Number {
    /// The type that numpy calls `descr`, such as `<f4`.
    pub(super) fn of(descr: &str) -> Option<Self> {
        let mut chars = descr.chars();
        let big_endian = match chars.next()? {
            '<' | '|' | '=' => false,
            '>' => true,
            _ => return None,
        };
        let (kind, bytes) = match (chars.next()?, chars.as_str()) {
            ('b', "1") => (Kind::Bool, 1),
            ('f', "2") => (Kind::Float, 2),
            ('f', "4") => (Kind::Float, 4),
            ('f', "8") => (Kind::Float, 8),
            (kind @ ('i' | 'u'), bytes @ ("1" | "2" | "4" | "8")) => {
                (if kind == 'i' { Kind::Signed } else { Kind::Unsigned }, bytes.parse().ok()?)
            }
            _ => return None,
        };
        Some(Self { kind, bytes, big_endian })
    }

    /// A value as messages quote it, in single precision at most.
    pub(super) fn shown(&self, value: f64) -> String {
        if self.kind == Kind::Float { (value as f32).to_string() } else { value.to_string() }
    }

    /// The number in so many bytes. Integers beyond 2⁵³ are rounded: no occupancy is near them.
    pub(super) fn value(&self, bytes: &[u8]) -> f64 {
        let mut wide = [0; 8];
        wide[..bytes.len()].copy_from_slice(bytes);
        if self.big_endian {
            wide[..bytes.len()].reverse();
        }
        let bits = u64::from_le_bytes(wide);
        match (self.kind, self.bytes) {
            (Kind::Float, 2) => half(bits as u16),
            (Kind::Float, 4) => f64::from(f32::from_bits(bits as u32)),
            (Kind::Float, _) => f64::from_bits(bits),
            (Kind::Signed, bytes) => {
                let unused = 64 - 8 * bytes as u32;
                ((bits << unused).cast_signed() >> unused) as f64
            }
            (Kind::Bool | Kind::Unsigned, _) => bits as f64,
        }
    }
}

/// A number in half precision (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let (sign, exponent, fraction) = (bits >> 15, i32::from(bits >> 10 & 0x1f), f64::from(bits & 0x3ff));
    let size = match exponent {
        0 => fraction / 1024.0 * libm::exp2(-14.0),
        31 if fraction > 0.0 => f64::NAN,
        31 => f64::INFINITY,
        _ => (1.0 + fraction / 1024.0) * libm::exp2(f64::from(exponent - 15)),
    };
    if sign == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn value(descr: &str, bytes: &[u8]) -> f64 {
        let number = Number::of(descr).expect("a type");
        assert_eq!(number.bytes, bytes.len());
        number.value(bytes)
    }

    #[test]
    fn half_precision() {
        // IEEE 754: 1, -2, the largest, the smallest above 0, a third, infinity.
        let table = [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0001, libm::exp2(-24.0)),
            (0x3555, 0.333_251_953_125),
        ];
        for (bits, expected) in table {
            assert!((half(bits) - expected).abs() <= 0.0, "{bits:x}");
            assert!((value(">f2", &bits.to_be_bytes()) - expected).abs() <= 0.0);
        }
        assert!(half(0x7c01).is_nan() && half(0xfc00) == f64::NEG_INFINITY);
    }

    #[test]
    fn what_is_no_number() {
        for descr in ["", "<", "f4", "<c8", "<f16", "|S3", "<M8", "|O", "<i3", "<U4", "é"] {
            assert_eq!(Number::of(descr), None, "{descr}");
        }
    }

    proptest! {
        #[test]
        fn every_type_in_both_byte_orders(whole: i32, share: f64) {
            let small = whole as i16;
            for (descr, le, expected) in [
                ("f8", share.to_le_bytes().to_vec(), share),
                ("f4", (share as f32).to_le_bytes().to_vec(), f64::from(share as f32)),
                ("i8", i64::from(whole).to_le_bytes().to_vec(), f64::from(whole)),
                ("i4", whole.to_le_bytes().to_vec(), f64::from(whole)),
                ("u4", whole.to_le_bytes().to_vec(), f64::from(whole.cast_unsigned())),
                ("i2", small.to_le_bytes().to_vec(), f64::from(small)),
                ("u2", small.to_le_bytes().to_vec(), f64::from(small.cast_unsigned())),
                ("i1", vec![small as u8], f64::from(small as i8)),
                ("u1", vec![small as u8], f64::from(small as u8)),
            ] {
                let be: Vec<u8> = le.iter().rev().copied().collect();
                prop_assert_eq!(value(&format!("<{descr}"), &le).to_bits(), expected.to_bits());
                prop_assert_eq!(value(&format!(">{descr}"), &be).to_bits(), expected.to_bits());
            }
        }
    }
}
