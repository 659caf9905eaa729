//! Plain text or gzip, told by the first bytes.

use std::io::{self, BufRead, BufReader, Cursor, Read};

use flate2::bufread::MultiGzDecoder;

/// The text of `source`, decompressed where it begins as gzip does, member after member.
///
/// # Errors
/// A source that cannot be read. Compressed data that are cut or damaged are an error when the reader gets there.
pub(crate) fn text<'a>(source: impl Read + Send + 'a) -> io::Result<Box<dyn BufRead + Send + 'a>> {
    const MAGIC: [u8; 2] = [0x1f, 0x8b];
    let mut source = BufReader::with_capacity(1 << 16, source);
    let mut start = Vec::with_capacity(MAGIC.len());
    source.by_ref().take(MAGIC.len() as u64).read_to_end(&mut start)?;
    let gzip = start == MAGIC;
    let whole = Cursor::new(start).chain(source);
    Ok(if gzip { Box::new(BufReader::with_capacity(1 << 16, MultiGzDecoder::new(whole))) } else { Box::new(whole) })
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn gzip(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(text).expect("memory");
        encoder.finish().expect("memory")
    }

    fn all(bytes: &[u8]) -> (Vec<u8>, io::Result<usize>) {
        let mut out = Vec::new();
        let end = text(bytes).and_then(|mut text| text.read_to_end(&mut out));
        (out, end)
    }

    #[test]
    fn plain_and_compressed_text_are_the_same() {
        let two = [gzip(b"one\n"), gzip(b"two\n")].concat();
        for (bytes, expected) in
            [(&b""[..], &b""[..]), (b"\x1f", b"\x1f"), (b"one\n", b"one\n"), (&gzip(b""), b""), (&two, b"one\ntwo\n")]
        {
            let (out, end) = all(bytes);
            assert_eq!((out.as_slice(), end.ok()), (expected, Some(expected.len())));
        }
    }

    #[test]
    fn what_stands_before_damage_is_read_and_the_damage_is_an_error() {
        let text = b"some text, some more text\n".repeat(9);
        let whole = gzip(&text);
        let (out, end) = all(&whole[..whole.len() - 4]);
        assert!(out == text && end.is_err());
        let (out, end) = all(&[whole.as_slice(), b"garbage"].concat());
        assert!(out == text && end.is_err());
        let mut flipped = whole;
        let at = flipped.len() - 6; // within the checksum
        flipped[at] ^= 1;
        assert!(all(&flipped).1.is_err());
    }
}
