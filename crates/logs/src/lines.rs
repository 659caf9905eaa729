//! Lines of a text, with a bound on their length.

use std::io::{self, BufRead, ErrorKind};

use memchr::memchr2;

/// A longer line is damaged, and no more of it than this is kept. Bytes.
pub const LONGEST_LINE: usize = 1 << 20;

/// Splits a text into lines that end in `\n`, `\r\n` or `\r`, or with the text.
///
/// Lines are bytes: host names in old logs are not always UTF-8.
pub(crate) struct Lines<R> {
    source: R,
    line: Vec<u8>,
    number: u64,
    /// The line before ended in `\r`, to which a `\n` may belong.
    after_return: bool,
}

/// One line without its end.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Line<'a> {
    Text(&'a [u8]),
    TooLong,
}

const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(source: R) -> Self {
        Self { source, line: Vec::new(), number: 0, after_return: false }
    }

    /// Number of the line that was given last, from 1.
    pub(crate) fn number(&self) -> u64 {
        self.number
    }

    /// The next line and its number, from 1; none at the end.
    pub(crate) fn next(&mut self) -> io::Result<Option<(u64, Line<'_>)>> {
        self.line.clear();
        let (mut begun, mut too_long) = (false, false);
        loop {
            let buffer = match self.source.fill_buf() {
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                other => other?,
            };
            let Some(&first) = buffer.first() else {
                if begun {
                    break;
                }
                return Ok(None);
            };
            if self.after_return && first == b'\n' {
                self.after_return = false;
                self.source.consume(1);
                continue;
            }
            self.after_return = false;
            begun = true;
            let end = memchr2(b'\n', b'\r', buffer);
            let piece = &buffer[..end.unwrap_or(buffer.len())];
            if self.line.len() + piece.len() > LONGEST_LINE {
                too_long = true;
            } else if !too_long {
                self.line.extend_from_slice(piece);
            }
            let used = piece.len() + usize::from(end.is_some());
            self.after_return = end.is_some_and(|at| buffer[at] == b'\r');
            self.source.consume(used);
            if end.is_some() {
                break;
            }
        }
        self.number += 1;
        if too_long {
            return Ok(Some((self.number, Line::TooLong)));
        }
        let mut line = self.line.as_slice();
        if self.number == 1 {
            line = line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line);
        }
        Ok(Some((self.number, Line::Text(line))))
    }
}

#[cfg(test)]
mod tests {
    use std::io::{BufReader, Read};

    use super::*;
    use proptest::prelude::*;

    fn lines(source: impl BufRead) -> Vec<Option<Vec<u8>>> {
        let mut lines = Lines::new(source);
        let mut all = Vec::new();
        while let Some((_, line)) = lines.next().expect("memory can be read") {
            all.push(match line {
                Line::Text(text) => Some(text.to_vec()),
                Line::TooLong => None,
            });
        }
        assert_eq!(lines.number(), all.len() as u64);
        all
    }

    #[test]
    fn every_kind_of_end_is_one() {
        for (text, expected) in [
            (&b""[..], vec![]),
            (b"a", vec!["a"]),
            (b"a\nb\n", vec!["a", "b"]),
            (b"a\r\n\r\nb\rc", vec!["a", "", "b", "c"]),
            (b"\n\r\r\n", vec!["", "", ""]),
            (b"\xef\xbb\xbfa\n", vec!["a"]),
        ] {
            let expected: Vec<_> = expected.iter().map(|line| Some(line.as_bytes().to_vec())).collect();
            assert_eq!(lines(text), expected, "{text:?}");
        }
    }

    #[test]
    fn a_line_too_long_is_skipped_and_the_next_is_whole() {
        let endless = io::repeat(b'7').take(3 * LONGEST_LINE as u64);
        let text = BufReader::new(endless.chain(&b"\nb"[..]));
        assert_eq!(lines(text), [None, Some(b"b".to_vec())]);
        let longest = BufReader::new(io::repeat(b'7').take(LONGEST_LINE as u64));
        assert_eq!(lines(longest).first().and_then(|line| line.as_ref().map(Vec::len)), Some(LONGEST_LINE));
    }

    proptest! {
        #[test]
        fn how_the_source_is_buffered_makes_no_difference(text in "[a-c\r\n]{0,60}", capacity in 1usize..9) {
            // Slow reference: one kind of end, then split.
            let mut expected: Vec<_> = text.replace("\r\n", "\n").replace('\r', "\n").split('\n').map(str::to_owned).collect();
            if expected.last().is_some_and(String::is_empty) {
                expected.pop();
            }
            let expected: Vec<_> = expected.into_iter().map(|line| Some(line.into_bytes())).collect();
            prop_assert_eq!(lines(BufReader::with_capacity(capacity, text.as_bytes())), expected);
        }
    }
}
