//! Compressed bytes, of which no more is unpacked than they may be.

use std::io::{self, BufRead, BufReader, Read};

use bzip2::read::MultiBzDecoder;
use lz4_flex::frame::FrameDecoder as Lz4;
use ruzstd::decoding::errors::{FrameDecoderError, ReadFrameHeaderError};
use ruzstd::decoding::{BlockDecodingStrategy, FrameDecoder};

use crate::MOST_BYTES;

/// How bytes are compressed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packing {
    None,
    Bzip2,
    Lz4,
    Zstd,
}

/// What zstd begins with.
pub(crate) const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

impl Packing {
    /// The name that bags give it; none for one that is not known.
    pub(crate) fn named(name: &str) -> Option<Self> {
        match name {
            "" | "none" => Some(Self::None),
            "bz2" => Some(Self::Bzip2),
            "lz4" => Some(Self::Lz4),
            "zstd" => Some(Self::Zstd),
            _ => None,
        }
    }

    /// The bytes as they were, as far as those of a cut chunk go.
    pub(crate) fn partly(self, packed: Vec<u8>) -> Vec<u8> {
        let mut out = Vec::new();
        // What was unpacked before the error stays.
        let _ = match self {
            Self::None => return packed,
            Self::Bzip2 => MultiBzDecoder::new(&packed[..]).take(MOST_BYTES).read_to_end(&mut out),
            Self::Lz4 => Lz4::new(&packed[..]).take(MOST_BYTES).read_to_end(&mut out),
            Self::Zstd => Zstd::new(&packed[..]).take(MOST_BYTES).read_to_end(&mut out),
        };
        out
    }

    /// The bytes as they were, which are `expected` in number where that is known.
    pub(crate) fn unpack(self, packed: Vec<u8>, expected: Option<u64>) -> Result<Vec<u8>, String> {
        let bound = expected.unwrap_or(MOST_BYTES);
        if bound > MOST_BYTES {
            return Err(format!("claims {bound} bytes, of which no chunk has more than {MOST_BYTES}"));
        }
        let mut out = Vec::new();
        let read = match self {
            Self::None => {
                out = packed;
                Ok(0)
            }
            Self::Bzip2 => MultiBzDecoder::new(&packed[..]).take(bound + 1).read_to_end(&mut out),
            Self::Lz4 => Lz4::new(&packed[..]).take(bound + 1).read_to_end(&mut out),
            Self::Zstd => Zstd::new(&packed[..]).take(bound + 1).read_to_end(&mut out),
        };
        read.map_err(|error| format!("cannot be unpacked ({})", in_one_line(&error)))?;
        match expected {
            Some(expected) if expected != out.len() as u64 => {
                let (some, more) = (out.len(), if out.len() as u64 > expected { "more" } else { "less" });
                Err(format!("unpacks to {some} bytes, {more} than the {expected} that it claims"))
            }
            None if out.len() as u64 > MOST_BYTES => Err(format!("unpacks to more than {MOST_BYTES} bytes")),
            _ => Ok(out),
        }
    }
}

/// An error of a decoder, without line breaks.
fn in_one_line(error: &io::Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Frames of zstd, one behind the other.
pub(crate) struct Zstd<R: Read> {
    source: BufReader<R>,
    decoder: FrameDecoder,
    within: bool,
}

impl<R: Read> Zstd<R> {
    pub(crate) fn new(source: R) -> Self {
        Self { source: BufReader::with_capacity(1 << 16, source), decoder: FrameDecoder::new(), within: false }
    }

    /// Begins the next frame, or passes over one that is to be skipped; false at the end.
    fn begin(&mut self) -> io::Result<bool> {
        if self.source.fill_buf()?.is_empty() {
            return Ok(false);
        }
        match self.decoder.init(&mut self.source) {
            Ok(()) => self.within = true,
            Err(FrameDecoderError::ReadFrameHeaderError(ReadFrameHeaderError::SkipFrame { length, .. })) => {
                io::copy(&mut self.source.by_ref().take(u64::from(length)), &mut io::sink())?;
            }
            Err(error) => return Err(io::Error::other(error)),
        }
        Ok(true)
    }

    fn end(&mut self) -> io::Result<()> {
        self.within = false;
        let stated = self.decoder.get_checksum_from_data();
        if stated.is_some() && stated != self.decoder.get_calculated_checksum() {
            return Err(io::Error::other("the checksum does not fit"));
        }
        Ok(())
    }
}

impl<R: Read> Read for Zstd<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            if !self.within {
                if !self.begin()? {
                    return Ok(0);
                }
                continue;
            }
            let count = self.decoder.read(buffer)?;
            if count > 0 || buffer.is_empty() {
                return Ok(count);
            }
            if self.decoder.is_finished() {
                self.end()?;
            } else {
                let one = BlockDecodingStrategy::UptoBlocks(1);
                self.decoder.decode_blocks(&mut self.source, one).map_err(io::Error::other)?;
            }
        }
    }
}
