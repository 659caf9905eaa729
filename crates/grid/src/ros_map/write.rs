//! Maps for `map_server` and `nav2_map_server`: the image and the YAML file, to any writer.

use std::io::{self, Write};

use thiserror::Error;

use super::coding::{Coding, Mode, Thresholds};
use super::pixel::Pixel;
use super::png;
use crate::{GridSpec, Raster};

/// Darkness, of 255, of the three shades of map_server.
const UNKNOWN: u8 = 255 - 205;
const FREE: u8 = 255 - 254;
const OCCUPIED: u8 = 255;

/// Why a map has no image in a coding.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum EncodeError {
    /// The thresholds leave no shade for what must be written.
    #[error(
        "thresholds {} and {}: no grey of 256 between them reads back as {what}; map_server writes 0.196 and 0.65", .thresholds.free, .thresholds.occupied
    )]
    NoShade {
        /// What would be lost.
        what: String,
        /// Between these.
        thresholds: Thresholds,
    },
    /// A PGM has no transparency, by which mode `scale` knows unknown cells.
    #[error("{cells} cells are unknown: in mode scale they must be transparent, which a PGM cannot be; write a PNG")]
    NoTransparency {
        /// So many of them.
        cells: usize,
    },
}

/// The image of a map, one byte of grey per cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Shades {
    width: u32,
    height: u32,
    /// Top row first; `None` is transparent.
    pixels: Vec<Option<u8>>,
    /// The shade that transparent pixels have.
    behind: u8,
}

impl Shades {
    /// The shades by which `coding` says this occupancy (0 to 1, `None` unknown; row 0 the lowest).
    ///
    /// What is read back is, in mode `trinary`, the state of every cell; in `scale` and `raw` its occupancy to a whole
    /// percent, rounded so that the state stays where a whole percent has it. In `raw` nothing is negated.
    ///
    /// ```
    /// use grid::ros_map::{Coding, Mode, Shades};
    /// let spec = grid::GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 3, height: 1 };
    /// let map = grid::Raster::new(spec, vec![Some(0.93), None, Some(0.02)]);
    /// let mut pgm = Vec::new();
    /// Shades::of(&map, &Coding { mode: Mode::Raw, ..Coding::default() })?.pgm(&mut pgm)?;
    /// assert_eq!(pgm, b"P5\n3 1\n255\n\x5d\xff\x02");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Thresholds between which there is no shade for a cell of this map.
    ///
    /// # Panics
    /// If the map has more than 2³² columns or rows.
    pub fn of(occupancy: &Raster<Option<f32>>, coding: &Coding) -> Result<Self, EncodeError> {
        let spec = occupancy.spec();
        let palette = Palette::of(coding);
        let mut pixels = Vec::with_capacity(spec.cells());
        for row in occupancy.values().chunks_exact(spec.width).rev() {
            for &cell in row {
                pixels.push(palette.shade(coding, cell)?);
            }
        }
        let [width, height] = [spec.width, spec.height].map(|n| u32::try_from(n).expect("a side of a map"));
        Ok(Self { width, height, pixels, behind: palette.unknown.ok().unwrap_or_default() })
    }

    /// Writes a binary PGM.
    ///
    /// # Errors
    /// Transparent cells, as [`EncodeError::NoTransparency`] inside; whatever the writer reports.
    pub fn pgm(&self, mut out: impl Write) -> io::Result<()> {
        let cells = self.transparent();
        if cells > 0 {
            return Err(io::Error::new(io::ErrorKind::InvalidInput, EncodeError::NoTransparency { cells }));
        }
        write!(out, "P5\n{} {}\n255\n", self.width, self.height)?;
        out.write_all(&self.pixels.iter().map(|pixel| pixel.unwrap_or(self.behind)).collect::<Vec<u8>>())
    }

    /// Writes a PNG: grey, or in colours with transparency if there are transparent cells, since the decoders of the
    /// servers trip over grey with transparency.
    ///
    /// # Errors
    /// Whatever the writer reports.
    pub fn png(&self, out: impl Write) -> io::Result<()> {
        let transparent = self.transparent() > 0;
        let bytes: Vec<u8> = if transparent {
            let rgba = |pixel: &Option<u8>| {
                let grey = pixel.unwrap_or(self.behind);
                [grey, grey, grey, if pixel.is_some() { 255 } else { 0 }]
            };
            self.pixels.iter().flat_map(rgba).collect()
        } else {
            self.pixels.iter().map(|pixel| pixel.unwrap_or(self.behind)).collect()
        };
        png::write(out, self.width, self.height, transparent, &bytes)
    }

    fn transparent(&self) -> usize {
        self.pixels.iter().filter(|pixel| pixel.is_none()).count()
    }
}

/// The shades that a coding gives states and percents; each is proved by reading it.
struct Palette {
    percent: Vec<Result<u8, EncodeError>>,
    occupied: Result<u8, EncodeError>,
    free: Result<u8, EncodeError>,
    unknown: Result<u8, EncodeError>,
}

impl Palette {
    fn of(coding: &Coding) -> Self {
        let Thresholds { occupied, free } = coding.thresholds;
        let shade = |dark: u8| if coding.negate { dark } else { 255 - dark };
        let read = |brightness: u8, mode| {
            let pixel = Pixel::grey(brightness.into(), 255);
            Coding { mode, ..*coding }.occupancy(pixel)
        };
        let choose = |what: &dyn Fn() -> String, mode, wanted: Option<f32>, shades: &[u8]| {
            let found = shades.iter().copied().find(|&s| read(s, mode) == wanted);
            found.ok_or_else(|| EncodeError::NoShade { what: what(), thresholds: coding.thresholds })
        };
        let between = |share: f64| (255.0 * (free + share * (occupied - free))).round() as u8;
        let trinary =
            |what: &str, wanted, darks: [u8; 2]| choose(&|| what.to_owned(), Mode::Trinary, wanted, &darks.map(shade));
        let percent = (0..=100_u8).map(|v| {
            let shades = match (coding.mode, v) {
                (Mode::Raw, _) => [v, v],
                (_, 0) => [shade(0), shade(0)],
                (_, 100) => [shade(255), shade(255)],
                _ => [shade(between(f64::from(v) / 100.0)); 2],
            };
            choose(&|| format!("{v} %"), coding.mode, Some((f64::from(v) / 100.0) as f32), &shades)
        });
        Self {
            percent: percent.collect(),
            occupied: trinary("occupied", Some(1.0), [OCCUPIED, OCCUPIED]),
            free: trinary("free", Some(0.0), [FREE, 0]),
            unknown: trinary("unknown", None, [UNKNOWN, between(0.5)]),
        }
    }

    /// The shade of a cell; `None` is transparent.
    fn shade(&self, coding: &Coding, cell: Option<f32>) -> Result<Option<u8>, EncodeError> {
        let chosen = match (coding.mode, cell) {
            (Mode::Trinary, _) => match coding.thresholds.state(cell) {
                Some(true) => &self.occupied,
                Some(false) => &self.free,
                None => &self.unknown,
            },
            (Mode::Raw, None) => &Ok(255),
            (Mode::Scale, None) => return Ok(None),
            (_, Some(occupancy)) => &self.percent[usize::from(percent(occupancy, &coding.thresholds))],
        };
        chosen.clone().map(Some)
    }
}

/// The nearest whole percent, or the one on the other side where only that leaves the cell in its state.
fn percent(occupancy: f32, thresholds: &Thresholds) -> u8 {
    let exact = f64::from(occupancy).clamp(0.0, 1.0) * 100.0;
    let nearest = exact.round();
    let other = if nearest > exact { exact.floor() } else { exact.ceil() };
    let state = |percent: f64| thresholds.state(Some((percent / 100.0) as f32));
    let wanted = thresholds.state(Some(occupancy));
    let chosen = if state(nearest) != wanted && state(other) == wanted { other } else { nearest };
    chosen as u8
}

/// The YAML file of a map: `image` is the name of its image beside the file, `yaw_rad` as in [`RosMap`](super::RosMap).
pub fn describe(spec: &GridSpec, yaw_rad: f64, coding: &Coding, image: &str) -> String {
    let Coding { mode, negate, thresholds } = coding;
    let negate = u8::from(*negate && *mode != Mode::Raw);
    let [x, y] = spec.origin_m;
    let [cell, x, y, yaw, occupied, free] =
        [spec.cell_m, x, y, yaw_rad, thresholds.occupied, thresholds.free].map(number);
    format!(
        "image: {}\nmode: {}\nresolution: {cell}\norigin: [{x}, {y}, {yaw}]\nnegate: {negate}\noccupied_thresh: {occupied}\nfree_thresh: {free}\n",
        name(image),
        mode.name(),
    )
}

/// Every digit, and a point: some readers take `1e-7` for a text.
fn number(value: f64) -> String {
    let text = value.to_string();
    if text.contains('.') { text } else { text + ".0" }
}

/// A text that YAML could take for something else stands in quotes.
fn name(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let an_image = text.ends_with(".pgm") || text.ends_with(".png");
    if an_image && text.chars().all(plain) && text.starts_with(|c: char| c.is_ascii_alphanumeric()) {
        return text.to_owned();
    }
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04x}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
}
