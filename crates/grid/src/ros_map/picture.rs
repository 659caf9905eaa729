//! The image of a map, of whatever kind its first bytes are.

use std::io::Read as _;
use std::path::Path;

use super::error::RosMapError;
use super::pixel::{Defect, MAX_PIXELS, Picture, Pixel};
use super::{netpbm, png};

/// No image is longer: as text, the largest one takes a fourth of it.
const MAX_BYTES: u64 = 2 << 30;

/// Kinds of images that are not read, by their first bytes.
const OTHERS: [(&[u8], &str); 8] = [
    (b"BM", "BMP"),
    (b"\xff\xd8\xff", "JPEG"),
    (b"GIF8", "GIF"),
    (b"II*\0", "TIFF"),
    (b"MM\0*", "TIFF"),
    (b"RIFF", "WebP"),
    (b"%PDF", "PDF"),
    (b"<svg", "SVG"),
];

/// Reads a PGM (or another of the netpbm family) or PNG and takes `of` of every pixel.
pub(super) fn read<T>(path: &Path, of: impl FnMut(Pixel) -> T) -> Result<Picture<T>, RosMapError> {
    let mut bytes = Vec::new();
    let read = strict::opened(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes));
    read.map_err(|source| RosMapError::Unreadable { path: path.into(), source })?;
    read_from(&bytes, path, of)
}

/// The same from the bytes of the file; `path` is named in messages.
pub(super) fn read_from<T>(bytes: &[u8], path: &Path, of: impl FnMut(Pixel) -> T) -> Result<Picture<T>, RosMapError> {
    // The first bytes count; a name can be wrong.
    let picture = match bytes {
        _ if bytes.len() as u64 > MAX_BYTES => Err(Defect::Damaged(None, "it has more than 2 GiB".to_owned())),
        [b'P', b'1'..=b'7', ..] => netpbm::read(bytes, of),
        [0x89, b'P', b'N', b'G', ..] => png::read(bytes, of),
        _ => Err(unread(bytes)),
    };
    picture.map_err(|defect| match defect {
        Defect::Io(source) => RosMapError::Unreadable { path: path.into(), source },
        Defect::Damaged(at, problem) => RosMapError::DamagedImage { path: path.into(), at, problem },
        Defect::Size(width, height) => RosMapError::ImageSize { path: path.into(), width, height, limit: MAX_PIXELS },
    })
}

fn unread(bytes: &[u8]) -> Defect {
    let kind = OTHERS.iter().find(|(magic, _)| bytes.starts_with(magic));
    let problem = match kind {
        Some((_, kind)) => format!("it is a {kind} image"),
        None if bytes.is_empty() => "it is empty".to_owned(),
        None => "its first bytes are those of no known image".to_owned(),
    };
    Defect::Damaged(None, problem)
}
