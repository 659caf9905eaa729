//! Images as the map rules see them.

use std::io;

/// Enough for half a kilometre square at 5 cm; what is larger is a damaged header more often than
/// a map, and would take gigabytes while it is decoded.
pub(super) const MAX_PIXELS: u64 = 100_000_000;

/// One pixel. Whole numbers, so that a value at a threshold stays there.
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

    /// An opaque shade of grey.
    pub(super) fn grey(brightness: u32, white: u32) -> Self {
        Self { brightness, white, opacity: Self::OPAQUE }
    }

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
    /// Bytes behind the last pixel that nothing reads.
    pub(super) left_over: usize,
}

/// What is wrong with an image.
#[derive(Debug)]
pub(super) enum Defect {
    /// The system.
    Io(io::Error),
    /// The content, with line and column where the file is text.
    Damaged(Option<(usize, usize)>, String),
    /// No pixels, or too many.
    Size(u32, u32),
}

/// Refuses images without pixels and those that are too large.
pub(super) fn sized(width: u32, height: u32) -> Result<usize, Defect> {
    match u64::from(width) * u64::from(height) {
        count @ 1..=MAX_PIXELS => Ok(count as usize),
        _ => Err(Defect::Size(width, height)),
    }
}
