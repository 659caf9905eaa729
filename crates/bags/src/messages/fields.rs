//! The fields of a message, one behind the other.

use crate::record::Encoding;

/// What is left of a message.
pub(super) struct Fields<'a> {
    bytes: &'a [u8],
    at: usize,
    form: Form,
}

/// How fields are written.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// ROS 1 (<http://wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes>): little-endian, without padding.
    Ros1,
    /// CDR: numbers stand at multiples of their size, at most `most` bytes.
    Cdr { is_big: bool, most: usize },
}

/// A field that is not there.
pub(super) type Short = String;

impl<'a> Fields<'a> {
    /// A message from its first byte on. CDR begins with four bytes that say how the rest is written.
    pub(super) fn of(encoding: Encoding, bytes: &'a [u8]) -> Result<Self, Short> {
        let form = match encoding {
            Encoding::Ros1 => return Ok(Self { bytes, at: 0, form: Form::Ros1 }),
            Encoding::Cdr => match bytes.first_chunk::<4>() {
                // CDR, and CDR of XTypes 1.2 (DDS-XTypes 1.3, table 60), which pads to four bytes at most.
                Some([0, kind @ (0 | 1), _, _]) => Form::Cdr { is_big: *kind == 0, most: 8 },
                Some([0, kind @ (6 | 7), _, _]) => Form::Cdr { is_big: *kind == 6, most: 4 },
                Some([first, second, ..]) => {
                    return Err(format!("the message begins with {first:02x} {second:02x}, which is no plain CDR"));
                }
                None => return Err(format!("the message has {} bytes, fewer than the head of CDR", bytes.len())),
            },
            Encoding::Other => return Err("the message is neither of ROS 1 nor CDR".to_owned()),
        };
        Ok(Self { bytes: &bytes[4..], at: 0, form })
    }

    /// The next bytes, behind what pads them to a multiple of `align`.
    pub(super) fn bytes(&mut self, count: usize, align: usize) -> Result<&'a [u8], Short> {
        if let Form::Cdr { most, .. } = self.form {
            self.at = self.at.next_multiple_of(align.min(most));
        }
        let end = self.at.checked_add(count);
        let found = end.and_then(|end| self.bytes.get(self.at..end)).ok_or_else(|| {
            format!(
                "the message has {} bytes, fewer than the {count} more that it claims at byte {}",
                self.bytes.len(),
                self.at
            )
        })?;
        self.at += count;
        Ok(found)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], Short> {
        let found = self.bytes(N, N)?;
        let mut bytes = [0; N];
        bytes.copy_from_slice(found);
        if matches!(self.form, Form::Cdr { is_big: true, .. }) {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub(super) fn u8(&mut self) -> Result<u8, Short> {
        self.number().map(u8::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Result<u32, Short> {
        self.number().map(u32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Result<i32, Short> {
        self.number().map(i32::from_le_bytes)
    }

    pub(super) fn f32(&mut self) -> Result<f64, Short> {
        self.number().map(|bytes| f64::from(f32::from_le_bytes(bytes)))
    }

    pub(super) fn f64(&mut self) -> Result<f64, Short> {
        self.number().map(f64::from_le_bytes)
    }

    pub(super) fn f64s<const N: usize>(&mut self) -> Result<[f64; N], Short> {
        let mut values = [0.0; N];
        for value in &mut values {
            *value = self.f64()?;
        }
        Ok(values)
    }

    /// A list of single-precision numbers with its length before it.
    pub(super) fn f32_list(&mut self) -> Result<Vec<f64>, Short> {
        let count = self.u32()? as usize;
        let is_big = matches!(self.form, Form::Cdr { is_big: true, .. });
        let bytes = self.bytes(count.saturating_mul(4), 4)?;
        let numbers = bytes.as_chunks::<4>().0.iter();
        Ok(numbers
            .map(|four| f64::from(if is_big { f32::from_be_bytes(*four) } else { f32::from_le_bytes(*four) }))
            .collect())
    }

    /// Passes over a list of double-precision numbers with its length before it.
    pub(super) fn pass_f64_list(&mut self) -> Result<(), Short> {
        match self.u32()? as usize {
            0 => Ok(()), // nothing pads an empty list
            count => self.bytes(count.saturating_mul(8), 8).map(|_| ()),
        }
    }

    /// A list of bytes with its length before it.
    pub(super) fn byte_list(&mut self) -> Result<&'a [u8], Short> {
        let count = self.u32()? as usize;
        self.bytes(count, 1)
    }

    /// A text; in CDR a byte of value 0 ends it.
    pub(super) fn text(&mut self) -> Result<String, Short> {
        let bytes = self.byte_list()?;
        let bytes = if self.form == Form::Ros1 { bytes } else { bytes.strip_suffix(&[0]).unwrap_or(bytes) };
        Ok(String::from_utf8_lossy(bytes).into_owned())
    }

    /// Whether the message is of ROS 1, whose headers have a number more.
    pub(super) fn is_ros1(&self) -> bool {
        self.form == Form::Ros1
    }
}
