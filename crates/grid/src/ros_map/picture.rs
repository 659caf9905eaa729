//! The image of a map.

use std::path::Path;

use image::{DynamicImage, ImageDecoder as _, ImageError, ImageFormat, ImageReader};

use super::RosMapError;

/// Enough for half a kilometre square at 5 cm; what is larger is a damaged header more often than
/// a map, and would take gigabytes while it is decoded.
const MAX_PIXELS: u64 = 100_000_000;

/// One pixel as the map rules see it. Whole numbers, so that a value at a threshold stays there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Pixel {
    /// A shade of grey, from 0 for black to `white`; colours count as their mean.
    Shade {
        /// How bright.
        brightness: u32,
        /// The brightest value.
        white: u32,
    },
    /// Nothing was drawn here.
    Transparent,
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
    let damaged = |problem: String| RosMapError::DamagedImage { path: path.into(), problem };
    let decoding = |error: ImageError| damaged(error.to_string().replace('\n', " "));

    // The first bytes say what it is; a name can be wrong.
    let mut reader = ImageReader::open(path).map_err(unreadable)?;
    reader.clear_format();
    let mut reader = reader.with_guessed_format().map_err(unreadable)?;
    match reader.format() {
        Some(ImageFormat::Pnm | ImageFormat::Png) => {}
        Some(other) => return Err(damaged(format!("it is a {other:?} image"))),
        None => return Err(damaged("its first bytes are those of no known image".into())),
    }
    // The bound below is tighter than the decoder's own.
    reader.no_limits();
    let decoder = reader.into_decoder().map_err(decoding)?;
    let (width, height) = decoder.dimensions();
    let count = u64::from(width) * u64::from(height);
    if !(1..=MAX_PIXELS).contains(&count) {
        return Err(RosMapError::ImageSize { path: path.into(), width, height, limit: MAX_PIXELS });
    }
    let image = DynamicImage::from_decoder(decoder).map_err(decoding)?;
    Ok(Picture { width: width as usize, height: height as usize, pixels: pixels(image).map(of).collect() })
}

/// The pixels in the order of the file.
fn pixels(image: DynamicImage) -> Box<dyn Iterator<Item = Pixel>> {
    match image {
        DynamicImage::ImageLuma8(grey) => {
            Box::new(grey.into_raw().into_iter().map(|v| Pixel::Shade { brightness: v.into(), white: 255 }))
        }
        // 16 bits hold every depth that the two formats know without rounding.
        other => {
            let colours = other.into_rgba16();
            Box::new((0..colours.len() / 4).map(move |i| of_channels(&colours.as_raw()[4 * i..4 * i + 4])))
        }
    }
}

/// map_server averages the opacity in with the colours, which turns opaque grey (unknown) into
/// free; here a pixel is as bright as its colours, and a transparent one says nothing.
fn of_channels(rgba: &[u16]) -> Pixel {
    if rgba[3] == 0 {
        return Pixel::Transparent;
    }
    Pixel::Shade { brightness: rgba[..3].iter().map(|&c| u32::from(c)).sum(), white: 3 * u32::from(u16::MAX) }
}
