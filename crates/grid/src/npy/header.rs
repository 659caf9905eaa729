//! The header of an NPY file: numpy's NEP 1, formats 1.0 to 3.0.
//!
//! It is trusted with nothing: no memory is asked for by its length, and its shape is multiplied by nobody here.

use std::io::{self, Read};

/// numpy pads its headers to a multiple of 64 and needs some 120 bytes for a plain array.
const MAX_BYTES: usize = 1 << 16;

/// The values begin at a multiple of this many bytes.
const ALIGNMENT: usize = 64;

/// What the header says, none of it checked against the file.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// Type of a value, as in `<f4`.
    pub(super) descr: String,
    /// Whether the first index runs first.
    pub(super) fortran_order: bool,
    /// Sides.
    pub(super) shape: Vec<u64>,
    /// Bytes up to the first value.
    pub(super) bytes: u64,
}

impl Header {
    /// Reads a header, and not a byte more.
    ///
    /// # Errors
    /// Of kind `InvalidData` if this is none.
    pub(super) fn read(input: &mut impl Read) -> io::Result<Self> {
        let wrong = |problem: &str| io::Error::new(io::ErrorKind::InvalidData, problem.to_owned());
        let ended = |error: io::Error| match error.kind() {
            io::ErrorKind::UnexpectedEof => wrong("it ends within its header"),
            _ => error,
        };
        let mut start = [0; 8];
        input.read_exact(&mut start).map_err(ended)?;
        let [b'\x93', b'N', b'U', b'M', b'P', b'Y', version, _] = start else {
            return Err(wrong("its first bytes are not those of an NPY file"));
        };
        let width = match version {
            1 => 2,
            2 | 3 => 4,
            _ => return Err(wrong(&format!("version {version} of the format is not known"))),
        };
        let mut length = [0; 4];
        input.read_exact(&mut length[..width]).map_err(ended)?;
        let length = u32::from_le_bytes(length) as usize;
        if length > MAX_BYTES {
            return Err(wrong(&format!("its header claims {length} bytes: must be at most {MAX_BYTES}")));
        }
        let mut text = vec![0; length];
        input.read_exact(&mut text).map_err(ended)?;
        let text = String::from_utf8(text).map_err(|_| wrong("its header is no text"))?;
        let bytes = (start.len() + width + length) as u64;
        let (descr, fortran_order, shape) = dictionary(&text).ok_or_else(|| {
            wrong("its header is no {'descr': TYPE, 'fortran_order': BOOL, 'shape': (ROWS, COLUMNS)}")
        })?;
        Ok(Self { descr, fortran_order, shape, bytes })
    }
}

/// The header of a two-dimensional array of float32 in C order, little-endian, in format 1.0.
pub(super) fn of_f4(rows: usize, columns: usize) -> Vec<u8> {
    let mut text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({rows}, {columns}, ), }}");
    let before = 10; // bytes: magic, version and length
    let padded = (before + text.len() + 1).next_multiple_of(ALIGNMENT);
    text += &" ".repeat(padded - before - text.len() - 1);
    text.push('\n');
    let length = text.len() as u16; // two numbers of at most 20 digits
    [b"\x93NUMPY\x01\x00".as_slice(), &length.to_le_bytes(), text.as_bytes()].concat()
}

/// The three values of the header's dictionary, in any order; a type of several fields is no text and thus none.
fn dictionary(text: &str) -> Option<(String, bool, Vec<u64>)> {
    let (mut descr, mut order, mut shape) = (None, None, None);
    let mut rest = text.trim().strip_prefix('{')?.strip_suffix('}')?.trim_start();
    while !rest.is_empty() {
        let (key, after) = quoted(rest)?;
        rest = after.trim_start().strip_prefix(':')?.trim_start();
        match key {
            "descr" => {
                let (value, after) = quoted(rest)?;
                (descr, rest) = (Some(value.to_owned()), after);
            }
            "fortran_order" => {
                let after = |name| rest.strip_prefix(name);
                (order, rest) = match (after("True"), after("False")) {
                    (Some(after), _) => (Some(true), after),
                    (_, after) => (Some(false), after?),
                };
            }
            "shape" => {
                let (inside, after) = rest.strip_prefix('(')?.split_once(')')?;
                let sides =
                    inside.strip_suffix(',').unwrap_or(inside).split(',').filter(|side| !side.trim().is_empty());
                (shape, rest) = (Some(sides.map(|side| side.trim().parse().ok()).collect::<Option<_>>()?), after);
            }
            _ => return None,
        }
        rest = rest.trim_start();
        match rest.strip_prefix(',') {
            Some(after) => rest = after.trim_start(),
            None if rest.is_empty() => {}
            None => return None,
        }
    }
    Some((descr?, order?, shape?))
}

/// A text in quotes of either kind, and what follows it.
fn quoted(text: &str) -> Option<(&str, &str)> {
    let quote = text.chars().next().filter(|c| "'\"".contains(*c))?;
    text[1..].split_once(quote)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_as_numpy_writes_them() {
        let both = |text| dictionary(text);
        let f4 = || "<f4".to_owned();
        assert_eq!(
            both("{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }  \n"),
            Some((f4(), false, vec![3, 2]))
        );
        assert_eq!(both("{\"shape\":(7,),\"fortran_order\":True,\"descr\":\"<f4\"}"), Some((f4(), true, vec![7])));
        assert_eq!(both("{'descr': '<f4', 'fortran_order': False, 'shape': ()}"), Some((f4(), false, vec![])));
    }

    #[test]
    fn what_is_written_is_read_and_ends_where_the_values_are_aligned() {
        for (rows, columns) in [(1, 1), (160, 200), (1_000_000, 99), (usize::MAX, usize::MAX)] {
            let bytes = of_f4(rows, columns);
            let header = Header::read(&mut bytes.as_slice()).expect("our own");
            let shape = vec![rows as u64, columns as u64];
            assert_eq!(
                header,
                Header { descr: "<f4".to_owned(), fortran_order: false, shape, bytes: bytes.len() as u64 }
            );
            assert!(bytes.len().is_multiple_of(ALIGNMENT) && bytes.ends_with(b"\n"));
        }
    }

    #[test]
    fn what_is_none() {
        for text in [
            "",
            "{}",
            "{'descr': [('a', '<f4')], 'fortran_order': False, 'shape': (3, 2)}",
            "{'descr': '<f4', 'fortran_order': false, 'shape': (3, 2)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (3, -2)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 99999999999999999999)}",
            "{'descr': '<f4', 'fortran_order': False, 'shape': ((((",
            "{'descr': '<f4', 'fortran_order': False}",
            "{'descr': '<f4' 'fortran_order': False, 'shape': (1, 1)}",
            "{'é': 1}",
            "{é",
        ] {
            assert_eq!(dictionary(text), None, "{text}");
        }
    }
}
