//! For which paper pictures are made: `--svg`, `--dpi` and `--width`, and their files.

use std::io::Write as _;

use clap::Args;
use serde::Serialize;

use super::{Drawing, encode, raster, svg};
use crate::failure::Failure;
use crate::output::args::number;
use crate::output::folder::Staging;

/// Units of a drawing to an inch: a letter of 20 units has 7.2 points, and 1400 units are as wide as a page's text.
const UNITS_PER_INCH: f64 = 200.0;

const MM_PER_INCH: f64 = 25.4;

/// Most pixels of a picture: they take 300 MB.
const MOST_PIXELS: f64 = 1e8;

/// How pictures are made.
#[derive(Debug, Clone, Copy, PartialEq, Args, Serialize)]
#[command(next_help_heading = "Pictures")]
pub struct Paper {
    /// Write every picture as SVG too, for print and for editing
    #[arg(long)]
    pub svg: bool,
    /// Pixels per inch of the PNG files; letters are 7 points high whatever it is
    #[arg(long, value_name = "N", default_value_t = Paper::DPI, allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(50..=1200))]
    pub dpi: u32,
    /// Width of a picture on paper in mm, 60 to 1000: panels are laid out anew, letters keep their size [default: as the picture needs]
    #[arg(long = "width", value_name = "MM", allow_negative_numbers = true, value_parser = width)]
    pub width_mm: Option<f64>,
}

fn width(text: &str) -> Result<f64, String> {
    number(text, "from 60 to 1000, in mm", |v| (60.0..=1000.0).contains(&v))
}

impl Default for Paper {
    fn default() -> Self {
        Self { svg: false, dpi: Self::DPI, width_mm: None }
    }
}

impl Paper {
    const DPI: u32 = 200;

    /// What was asked for, as records hold it; nothing where nothing was.
    pub fn asked(&self) -> Option<Self> {
        (*self != Self::default()).then_some(*self)
    }

    /// How wide a picture is to be, in units; `natural` where nothing was asked for.
    pub fn width(&self, natural: f64) -> f64 {
        self.width_mm.map_or(natural, |mm| (mm / MM_PER_INCH * UNITS_PER_INCH).round())
    }

    /// The files of pictures that are named by their PNG.
    pub fn files(&self, names: &[&str]) -> Vec<String> {
        let vector = names.iter().filter(|name| self.svg && name.ends_with(".png"));
        names.iter().map(|name| (*name).to_owned()).chain(vector.map(|name| vector_name(name))).collect()
    }

    /// The drawing as PNG.
    ///
    /// # Errors
    /// More pixels than are taken.
    pub fn png(&self, drawing: &Drawing) -> Result<Vec<u8>, Failure> {
        let scale = f64::from(self.dpi) / UNITS_PER_INCH;
        let [width, height] = [drawing.width, drawing.height].map(|side| (side * scale).round());
        if width * height > MOST_PIXELS {
            return Err(Failure::BadInput(format!(
                "--dpi {}: a picture would have {width} x {height} pixels: at most {MOST_PIXELS:e} are drawn; choose a lower one, \
                 or --svg",
                self.dpi
            )));
        }
        encode::png(&raster::pixels(drawing, scale)?, self.dpi)
    }

    /// The drawing as SVG.
    ///
    /// # Errors
    /// None but a defect.
    pub fn svg(drawing: &Drawing) -> Result<String, Failure> {
        svg::text(drawing, MM_PER_INCH / UNITS_PER_INCH)
    }

    /// Writes the drawing as `name`, which ends in `.png`, and as SVG if asked to; gives the PNG.
    ///
    /// # Errors
    /// More pixels than are taken; whatever the system reports.
    pub fn save(&self, staging: &mut Staging, name: &str, drawing: &Drawing) -> Result<Vec<u8>, Failure> {
        let bytes = self.png(drawing)?;
        staging.write(name, |out| out.write_all(&bytes))?;
        if self.svg {
            let text = Self::svg(drawing)?;
            staging.write(&vector_name(name), |out| out.write_all(text.as_bytes()))?;
        }
        Ok(bytes)
    }
}

fn vector_name(name: &str) -> String {
    format!("{}.svg", name.trim_end_matches(".png"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_width_on_paper_is_one_of_units() {
        let paper = Paper { width_mm: Some(127.0), ..Paper::default() };
        let widths = [paper.width(5.0), Paper::default().width(5.0)].map(|width| width.round() as i64);
        assert_eq!(widths, [1000, 5]);
        assert!(["59", "1001", "wide", "nan"].map(width).iter().all(Result::is_err));
    }

    #[test]
    fn a_picture_has_a_second_file_on_request() {
        let paper = Paper { svg: true, ..Paper::default() };
        assert_eq!(paper.files(&["a.png", "t.csv"]), ["a.png", "t.csv", "a.svg"]);
        assert_eq!(Paper::default().files(&["a.png", "t.csv"]), ["a.png", "t.csv"]);
    }

    #[test]
    fn pixels_follow_the_resolution_and_have_a_bound() {
        let drawing = Drawing::new(100.0, 40.0);
        let size = |dpi| {
            let bytes = Paper { dpi, ..Paper::default() }.png(&drawing).expect("drawn");
            [16, 20].map(|at| u32::from_be_bytes(std::array::from_fn(|k| bytes[at + k])))
        };
        assert_eq!([size(200), size(300)], [[100, 40], [150, 60]]);
        let large = Paper { dpi: 1200, ..Paper::default() }.png(&Drawing::new(5000.0, 5000.0));
        assert!(large.is_err_and(|error| error.to_string().contains("--dpi 1200")));
    }
}
