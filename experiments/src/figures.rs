//! Pictures, in the paper's layout.
//!
//! Every function returns the bytes of a PNG. Maps are drawn cell by cell on whole pixels, with a
//! bundled font, so that a picture is the same on every machine.

pub mod calibration;
pub mod chart;
pub mod ink;
pub mod maps;
mod mark;
pub mod panel;
pub mod profiles;
pub mod regions;
pub mod scene;
pub mod timeline;

use plotters::prelude::*;

use crate::failure::Failure;

/// An area of a picture to draw on.
pub type Area<'a> = DrawingArea<BitMapBackend<'a>, plotters::coord::Shift>;

/// Draws a picture of the given size and gives it as PNG.
///
/// # Errors
/// A drawing that fails.
pub fn png(size: (u32, u32), draw: impl FnOnce(&Area) -> Result<(), Failure>) -> Result<Vec<u8>, Failure> {
    ink::register_font()?;
    let mut pixels = vec![255; size.0 as usize * size.1 as usize * 3];
    {
        let area = BitMapBackend::with_buffer(&mut pixels, size).into_drawing_area();
        area.fill(&WHITE).map_err(Failure::internal)?;
        draw(&area)?;
        area.present().map_err(Failure::internal)?;
    }
    encode(&pixels, size)
}

fn encode(pixels: &[u8], (width, height): (u32, u32)) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().map_err(Failure::internal)?;
    writer.write_image_data(pixels).map_err(Failure::internal)?;
    writer.finish().map_err(Failure::internal)?;
    Ok(bytes)
}
