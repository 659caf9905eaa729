//! Text with one kind of line end.

use std::io::{self, Read};

/// Reads text whose lines end in any of the three ways as one whose lines all end in `\n`, the last too: the CSV
/// reader's count of lines is then that of an editor.
pub(super) struct Lines<R> {
    source: R,
    /// The last byte of the source so far; a line end before the first.
    last: u8,
}

impl<R> Lines<R> {
    pub(super) fn new(source: R) -> Self {
        Self { source, last: b'\n' }
    }
}

impl<R: Read> Read for Lines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            let read = self.source.read(buffer)?;
            if read == 0 {
                let open = ![b'\n', b'\r'].contains(&self.last) && !buffer.is_empty();
                if open {
                    (buffer[0], self.last) = (b'\n', b'\n');
                }
                return Ok(usize::from(open));
            }
            let mut kept = 0;
            for at in 0..read {
                let byte = buffer[at];
                if byte != b'\n' || self.last != b'\r' {
                    buffer[kept] = if byte == b'\r' { b'\n' } else { byte };
                    kept += 1;
                }
                self.last = byte;
            }
            if kept > 0 {
                return Ok(kept);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives a byte at a time.
    struct Dripping<'a>(&'a [u8]);

    impl Read for Dripping<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.0.read(&mut buffer[..1])
        }
    }

    #[test]
    fn every_line_ends_alike_however_it_is_read() {
        for (text, expected) in [
            ("", ""),
            ("a", "a\n"),
            ("a\nb\n", "a\nb\n"),
            ("a\r\nb\r\n", "a\nb\n"),
            ("a\rb", "a\nb\n"),
            ("\r\n\r\n\n\r", "\n\n\n\n"),
        ] {
            let (mut whole, mut dripping) = (String::new(), String::new());
            Lines::new(text.as_bytes()).read_to_string(&mut whole).expect("text");
            Lines::new(Dripping(text.as_bytes())).read_to_string(&mut dripping).expect("text");
            assert_eq!((whole.as_str(), dripping.as_str()), (expected, expected), "{text:?}");
        }
    }
}
