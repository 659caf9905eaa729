//! What is suspicious about a map that can be read.

use std::fmt;
use std::path::{Path, PathBuf};

use strict::{Place, excerpt};

use super::coding::{Coding, Mode};
use super::description::Places;
use super::pixel::Pixel;

/// Something about a map that is read, but probably not as it was meant. Printed as one line: place, value, count, what to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// Pixels of the shade that map savers write for unknown cells are read as something else.
    UnknownIsRead {
        /// Where the threshold or mode stands that causes it, if there is a YAML file.
        place: Option<Place>,
        /// The image.
        image: PathBuf,
        /// The key that causes it.
        key: &'static str,
        /// Its value.
        value: String,
        /// What such a pixel is read as.
        read_as: &'static str,
        /// How many pixels have the shade.
        pixels: usize,
        /// How many pixels there are.
        of: usize,
        /// What to do.
        remedy: &'static str,
    },
    /// Pixels of mode raw with shades that mean nothing there, 101 to 254: they are unknown.
    NoPercent {
        /// Where the mode stands, if there is a YAML file.
        place: Option<Place>,
        /// The image.
        image: PathBuf,
        /// How many pixels have such a shade.
        pixels: usize,
        /// How many pixels there are.
        of: usize,
    },
    /// Pixels of the shade that unknown cells have in an inverted image, and none of the shade that they have otherwise.
    Inverted {
        /// Where `negate` stands, if there is a YAML file.
        place: Option<Place>,
        /// The image.
        image: PathBuf,
        /// Whether `negate` is set.
        negate: bool,
        /// How many pixels have the shade.
        pixels: usize,
        /// How many pixels there are.
        of: usize,
    },
    /// Cells so large that their side was probably not given in metres.
    Coarse {
        /// Where the resolution stands.
        place: Place,
        /// The resolution, m.
        resolution_m: f64,
    },
    /// Bytes behind the last pixel of an image.
    LeftOver {
        /// The image.
        image: PathBuf,
        /// How many bytes.
        bytes: usize,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shown = |path: &PathBuf| excerpt(&path.display().to_string(), usize::MAX);
        let at = |place: &Option<Place>, image| place.as_ref().map_or_else(|| shown(image), Place::to_string);
        match self {
            Self::UnknownIsRead { place, image, key, value, read_as, pixels, of, remedy } => write!(
                f,
                "{}: {key} = {value}: {pixels} of {of} pixels have the shade 205, which map savers write for unknown cells, and are read as {read_as}; {remedy}",
                at(place, image)
            ),
            Self::NoPercent { place, image, pixels, of } => write!(
                f,
                "{}: mode = raw: {pixels} of {of} pixels have shades from 101 to 254, which mean nothing in mode raw, and are read as unknown; use mode trinary or scale if the image shows shades of darkness",
                at(place, image)
            ),
            Self::Inverted { place, image, negate, pixels, of } => {
                let (now, shade, other) = if *negate { (1, 205, 0) } else { (0, 50, 1) };
                write!(
                    f,
                    "{}: negate = {now}: {pixels} of {of} pixels have the shade {shade}, which unknown cells have in an image for negate = {other}; write negate: {other} if occupied cells are {}",
                    at(place, image),
                    if *negate { "black" } else { "white" }
                )
            }
            Self::Coarse { place, resolution_m } => {
                write!(f, "{place}: resolution = {resolution_m}: cells of {resolution_m} m; give metres, such as 0.05")
            }
            Self::LeftOver { image, bytes } => write!(
                f,
                "{}: {bytes} bytes follow the last pixel and are not read; save the map again if its header does not fit its pixels",
                shown(image)
            ),
        }
    }
}

/// Counts shades while an image is read.
#[derive(Default)]
pub(super) struct Tally {
    /// Of the shade of unknown cells, and of the two shades beside it.
    unknown: usize,
    beside: usize,
    /// The same in an inverted image.
    inverted: usize,
    beside_inverted: usize,
    transparent: usize,
    /// Of mode raw: shades above 100 but white.
    no_percent: usize,
    pixels: usize,
}

impl Tally {
    pub(super) fn add(&mut self, pixel: Pixel, coding: &Coding) {
        self.pixels += 1;
        if pixel.opacity == 0 {
            self.transparent += 1;
            return;
        }
        let shade = shade(pixel);
        let dark = if coding.negate { shade } else { 255 - shade };
        self.unknown += usize::from(dark == UNKNOWN);
        self.beside += usize::from(dark == UNKNOWN - 1 || dark == UNKNOWN + 1);
        self.inverted += usize::from(255 - dark == UNKNOWN);
        self.beside_inverted += usize::from((255 - dark).abs_diff(UNKNOWN) == 1);
        self.no_percent += usize::from((101..255).contains(&shade));
    }

    /// What is suspicious about the shades of an image, whose YAML file has its values at `places`.
    pub(super) fn warnings(&self, coding: &Coding, image: &Path, places: Option<&Places>) -> Vec<Warning> {
        let (image, of) = (image.to_owned(), self.pixels);
        let place = |of: fn(&Places) -> &Place| places.map(|places| of(places).clone());
        if coding.mode == Mode::Raw {
            let place = place(|places| &places.mode);
            let pixels = self.no_percent;
            return if pixels > 0 { vec![Warning::NoPercent { place, image, pixels, of }] } else { Vec::new() };
        }
        let inverted = self.unknown == 0 && self.inverted > 0 && self.inverted >= 2 * self.beside_inverted;
        if inverted && coding.mode == Mode::Trinary {
            let (place, negate, pixels) = (place(|places| &places.negate), coding.negate, self.inverted);
            return vec![Warning::Inverted { place, image, negate, pixels, of }];
        }
        // A map in many shades has as many pixels of its neighbours.
        let saved = self.unknown > 0 && self.unknown >= 2 * self.beside;
        let white = 255;
        let brightness = if coding.negate { UNKNOWN } else { white - UNKNOWN };
        let read = coding.occupancy(Pixel::grey(brightness, white));
        let read_as = match coding.thresholds.state(read) {
            Some(true) => "occupied",
            _ => "free",
        };
        let (place, key, value, remedy) = match (coding.mode, read_as) {
            (Mode::Scale, _) => (
                place(|places| &places.mode),
                "mode",
                "scale".to_owned(),
                "use mode trinary, or make unknown cells transparent",
            ),
            (_, "occupied") => (
                place(|places| &places.occupied_thresh),
                "occupied_thresh",
                coding.thresholds.occupied.to_string(),
                "write 0.65 as map savers do, unless they are known to be occupied",
            ),
            _ => (
                place(|places| &places.free_thresh),
                "free_thresh",
                coding.thresholds.free.to_string(),
                "write 0.196 as map savers do, unless they are known to be free",
            ),
        };
        if !saved || read.is_none() || coding.mode == Mode::Scale && self.transparent > 0 {
            return Vec::new();
        }
        vec![Warning::UnknownIsRead { place, image, key, value, read_as, pixels: self.unknown, of, remedy }]
    }
}

/// The darkness, of 255, of unknown cells.
const UNKNOWN: u32 = 255 - 205;

/// The brightness of a pixel, of 255, to the nearest.
fn shade(pixel: Pixel) -> u32 {
    let (brightness, white) = (u64::from(pixel.brightness), u64::from(pixel.white));
    ((2 * 255 * brightness + white) / (2 * white)) as u32
}
