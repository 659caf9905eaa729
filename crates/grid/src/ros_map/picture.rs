//! The image of a map.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use image::{DynamicImage, ImageDecoder as _, ImageError, ImageFormat, ImageReader};

use strict::{LONGEST_REPORT, excerpt};

use super::RosMapError;
use super::netpbm::{self, Defect};

/// Enough for half a kilometre square at 5 cm; what is larger is a damaged header more often than
/// a map, and would take gigabytes while it is decoded.
pub(super) const MAX_PIXELS: u64 = 100_000_000;

/// One pixel as the map rules see it. Whole numbers, so that a value at a threshold stays there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pixel {
    /// A shade of grey, from 0 for black to `white`; colours count as their mean.
    pub(super) brightness: u32,
    /// The brightest value.
    pub(super) white: u32,
    /// From 0 for transparent to [`Pixel::OPAQUE`].
    pub(super) opacity: u16,
}

impl Pixel {
    /// The opacity of a pixel that hides what is behind it.
    pub(super) const OPAQUE: u16 = u16::MAX;

    pub(super) fn is_opaque(self) -> bool {
        self.opacity == Self::OPAQUE
    }
}

/// An image with a `T` per pixel, top row first.
pub(super) struct Picture<T> {
    /// Pixels along x.
    pub(super) width: usize,
    /// Pixels along y.
    pub(super) height: usize,
    /// Row by row.
    pub(super) pixels: Vec<T>,
}

/// Reads a PGM (or another of the netpbm family) or PNG and takes `of` of every pixel.
pub(super) fn read<T>(path: &Path, of: impl Fn(Pixel) -> T) -> Result<Picture<T>, RosMapError> {
    let unreadable = |source| RosMapError::Unreadable { path: path.into(), source };
    let file = File::open(path).map_err(unreadable)?;
    let length = file.metadata().map_err(unreadable)?.len();
    read_from(BufReader::new(file), length, path, of)
}

/// The same from what is open already and has so many bytes.
pub(super) fn read_from<T>(
    mut file: impl BufRead + Seek,
    length: u64,
    path: &Path,
    of: impl Fn(Pixel) -> T,
) -> Result<Picture<T>, RosMapError> {
    let unreadable = |source| RosMapError::Unreadable { path: path.into(), source };
    let damaged = |at, problem| RosMapError::DamagedImage { path: path.into(), at, problem };
    // The first bytes say what it is; a name can be wrong.
    let binary = match file.fill_buf().map_err(unreadable)? {
        [b'P', b'2', ..] => Some(false),
        [b'P', b'5', ..] => Some(true),
        _ => None,
    };
    let picture = match binary {
        Some(binary) => file.read_exact(&mut [0; 2]).map_err(Defect::Io).and_then(|()| netpbm::read(binary, file, of)),
        None => decode(file, length, of),
    };
    picture.map_err(|defect| match defect {
        Defect::Io(source) => unreadable(source),
        Defect::Damaged(at, problem) => damaged(at, problem),
        Defect::Size(width, height) => RosMapError::ImageSize { path: path.into(), width, height, limit: MAX_PIXELS },
    })
}

/// Reads a PNG, or a netpbm image that is not grey, of so many bytes.
fn decode<T>(file: impl BufRead + Seek, length: u64, of: impl Fn(Pixel) -> T) -> Result<Picture<T>, Defect> {
    let damaged = |problem: String| Defect::Damaged(None, problem);
    let decoding = |error: ImageError| damaged(excerpt(&error.to_string().replace('\n', " "), LONGEST_REPORT));
    let mut reader = ImageReader::new(file).with_guessed_format().map_err(Defect::Io)?;
    // PNG packs by a factor of 1032 at most; both put 8 black or white pixels into a byte.
    let most_per_byte = match reader.format() {
        Some(ImageFormat::Pnm) => 8,
        Some(ImageFormat::Png) => 8 * 1032,
        Some(other) => return Err(damaged(format!("it is a {other:?} image"))),
        None => return Err(damaged("its first bytes are those of no known image".into())),
    };
    // The bound below is tighter than the decoder's own.
    reader.no_limits();
    let decoder = reader.into_decoder().map_err(decoding)?;
    let (width, height) = decoder.dimensions();
    let count = u64::from(width) * u64::from(height);
    if !(1..=MAX_PIXELS).contains(&count) {
        return Err(Defect::Size(width, height));
    }
    if count > length.saturating_mul(most_per_byte) {
        return Err(damaged(format!(
            "its header promises {width} x {height} pixels, more than {length} bytes can hold"
        )));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(decoding)?;
    Ok(Picture { width: width as usize, height: height as usize, pixels: pixels(image).map(of).collect() })
}

/// The pixels in the order of the file.
fn pixels(image: DynamicImage) -> Box<dyn Iterator<Item = Pixel>> {
    let grey = |brightness, white| Pixel { brightness, white, opacity: Pixel::OPAQUE };
    match image {
        DynamicImage::ImageLuma8(image) => Box::new(image.into_raw().into_iter().map(move |v| grey(v.into(), 255))),
        DynamicImage::ImageLuma16(image) => Box::new(image.into_raw().into_iter().map(move |v| grey(v.into(), 65535))),
        // 16 bits hold 8 without rounding.
        other => {
            let colours = other.into_rgba16();
            Box::new((0..colours.len() / 4).map(move |i| of_channels(&colours.as_raw()[4 * i..4 * i + 4])))
        }
    }
}

/// map_server averages the opacity in with the colours, which turns opaque grey (unknown) into
/// free; here a pixel is as bright as its colours, and how opaque it is says whether it counts.
fn of_channels(rgba: &[u16]) -> Pixel {
    let brightness = rgba[..3].iter().map(|&c| u32::from(c)).sum();
    Pixel { brightness, white: 3 * u32::from(u16::MAX), opacity: rgba[3] }
}
