//! Text, plain or compressed, told by the first bytes; what is no text is named.

mod foreign;

use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::Path;

use bzip2::read::MultiBzDecoder;
use flate2::bufread::MultiGzDecoder;
use strict::Opened;

use crate::error::LogError;

/// Bytes from which the kind of a file is told.
const START: usize = 4096;

/// What follows the first four bytes of bzip2: a block, or the end.
const BLOCKS: [[u8; 6]; 2] = [*b"1AY&SY", *b"\x17\x72\x45\x38\x50\x90"];

/// Opens a file; with `again`, one that can be read more than once.
pub(crate) fn file(path: &Path, again: bool) -> Result<Opened, LogError> {
    let place = || path.display().to_string();
    let file = strict::opened(path).map_err(|source| LogError::Unreadable { place: place(), source })?;
    match &file {
        file if file.is_folder() => Err(LogError::Folder { place: place() }),
        file if again && !file.is_file() => Err(LogError::Pipe { place: place() }),
        _ => Ok(file),
    }
}

/// The text of `source`, decompressed where it begins as gzip or bzip2 do, member after member; `place` names it in messages.
///
/// # Errors
/// A source that cannot be read, or that is something else by its first bytes. Compressed data that are cut or damaged are an
/// error when the reader gets there.
pub(crate) fn text<'a>(source: impl Read + Send + 'a, place: &str) -> Result<Box<dyn BufRead + Send + 'a>, LogError> {
    let named = |source| LogError::Interrupted { place: place.to_owned(), line: 0, source };
    let (start, whole) = peeked(source).map_err(named)?;
    let (start, text): (Vec<u8>, Box<dyn BufRead + Send + 'a>) = if start.starts_with(&[0x1f, 0x8b]) {
        let (start, text) = peeked(MultiGzDecoder::new(BufReader::with_capacity(1 << 16, whole))).map_err(named)?;
        (start, Box::new(text))
    } else if start.starts_with(b"BZh") && BLOCKS.iter().any(|block| start.get(4..10) == Some(block)) {
        let (start, text) = peeked(MultiBzDecoder::new(whole)).map_err(named)?;
        (start, Box::new(text))
    } else {
        (start, Box::new(whole))
    };
    match foreign::named(&start) {
        Some((what, remedy)) => Err(LogError::Foreign { place: place.to_owned(), what, remedy }),
        None => Ok(text),
    }
}

/// The first bytes, and all of them again. An error behind the first bytes is one of the reader.
fn peeked<'a>(source: impl Read + Send + 'a) -> io::Result<(Vec<u8>, impl BufRead + Send + 'a)> {
    let mut source = BufReader::with_capacity(1 << 16, source);
    let mut start = Vec::with_capacity(START);
    let mut failure = None;
    if let Err(error) = source.by_ref().take(START as u64).read_to_end(&mut start) {
        if start.is_empty() {
            return Err(error);
        }
        failure = Some(error);
    }
    let all = Cursor::new(start.clone()).chain(BufReader::new(Failing { failure }).chain(source));
    Ok((start, all))
}

/// Gives an error once.
struct Failing {
    failure: Option<io::Error>,
}

impl Read for Failing {
    fn read(&mut self, _buffer: &mut [u8]) -> io::Result<usize> {
        self.failure.take().map_or(Ok(0), Err)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use bzip2::write::BzEncoder;
    use flate2::write::GzEncoder;

    use super::*;

    fn gzip(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(text).expect("memory");
        encoder.finish().expect("memory")
    }

    fn bzip2(text: &[u8]) -> Vec<u8> {
        let mut encoder = BzEncoder::new(Vec::new(), bzip2::Compression::fast());
        encoder.write_all(text).expect("memory");
        encoder.finish().expect("memory")
    }

    fn all(bytes: &[u8]) -> (Vec<u8>, Result<usize, String>) {
        let mut out = Vec::new();
        let end = text(bytes, "a.log").map_err(|error| error.to_string());
        let end = end.and_then(|mut text| text.read_to_end(&mut out).map_err(|error| error.to_string()));
        (out, end)
    }

    #[test]
    fn plain_and_compressed_text_are_the_same() {
        let long = b"FLASER of many lines\n".repeat(1000);
        for packed in [gzip, bzip2] {
            let two = [packed(b"one\n"), packed(b"two\n")].concat();
            for (bytes, expected) in [
                (&b""[..], &b""[..]),
                (b"\x1f", b"\x1f"),
                (b"BZh", b"BZh"),
                (b"one\n", b"one\n"),
                (&packed(b""), b""),
                (&two, b"one\ntwo\n"),
                (&packed(&long), &long),
            ] {
                let (out, end) = all(bytes);
                assert_eq!((out.as_slice(), end), (expected, Ok(expected.len())));
            }
        }
    }

    #[test]
    fn what_stands_before_damage_is_read_and_the_damage_is_an_error() {
        let text = b"some text, some more text\n".repeat(900);
        let whole = gzip(&text);
        let (out, end) = all(&whole[..whole.len() - 4]);
        assert!(out == text && end.is_err());
        let (out, end) = all(&[whole.as_slice(), b"garbage"].concat());
        assert!(out == text && end.is_err());
        let mut flipped = whole;
        let at = flipped.len() - 6; // within the checksum
        flipped[at] ^= 1;
        assert!(all(&flipped).1.is_err());
        let whole = bzip2(&text);
        assert!(all(&whole[..whole.len() - 4]).1.is_err());
        assert!(all(&[&whole[..40], b"garbage"].concat()).1.is_err());
    }

    #[test]
    fn what_is_compressed_is_named_as_if_it_were_plain() {
        for packed in [gzip, bzip2] {
            let end = all(&packed(b"VERTEX_SE2 0 0 0 0\n")).1.expect_err("a graph");
            assert!(end.contains("a pose graph"), "{end}");
        }
    }
}
