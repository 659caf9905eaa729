//! PNG files: of indexed colours, which are a half to a third as large as those of true colour.

use std::collections::BTreeMap;

use super::ink::Colour;
use super::raster::Pixels;
use crate::failure::Failure;

/// Most colours of a file.
const MOST: usize = 256;

/// A picture as PNG, with its resolution in pixels per inch.
///
/// # Errors
/// An encoder that fails.
pub(super) fn png(pixels: &Pixels, dpi: u32) -> Result<Vec<u8>, Failure> {
    let (palette, indices) = indexed(&pixels.colours);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, pixels.width as u32, pixels.height as u32);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.iter().flat_map(|c| [c.0, c.1, c.2]).collect::<Vec<u8>>());
    let per_metre = (f64::from(dpi) / 0.0254).round() as u32;
    let dims = png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter };
    encoder.set_pixel_dims(Some(dims));
    encoder.set_compression(png::Compression::High);
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header().map_err(Failure::internal)?;
    writer.write_image_data(&indices).map_err(Failure::internal)?;
    writer.finish().map_err(Failure::internal)?;
    Ok(bytes)
}

/// The most frequent colours, and of every pixel the number of the one that comes nearest.
fn indexed(colours: &[Colour]) -> (Vec<Colour>, Vec<u8>) {
    let mut counts: BTreeMap<Colour, usize> = BTreeMap::new();
    colours.iter().for_each(|colour| *counts.entry(*colour).or_default() += 1);
    let mut palette: Vec<(Colour, usize)> = counts.into_iter().collect();
    palette.sort_by_key(|(colour, count)| (std::cmp::Reverse(*count), *colour));
    let kept: Vec<Colour> = palette.iter().take(MOST).map(|(colour, _)| *colour).collect();
    let nearest = |colour: Colour| (0..kept.len()).min_by_key(|k| kept[*k].off(colour)).unwrap_or(0) as u8;
    let numbers: BTreeMap<Colour, u8> = palette.iter().map(|(colour, _)| (*colour, nearest(*colour))).collect();
    let indices = colours.iter().map(|colour| numbers[colour]).collect();
    (kept, indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_to_256_colours_are_kept_as_they_are() {
        let colours: Vec<Colour> = (0..=255).map(|k| Colour(k, 255 - k, 7)).collect();
        let (palette, indices) = indexed(&colours);
        let back: Vec<Colour> = indices.iter().map(|k| palette[usize::from(*k)]).collect();
        assert_eq!(back, colours);
    }

    #[test]
    fn rare_colours_give_way_to_those_next_to_them() {
        let mut colours: Vec<Colour> = (0..=255).flat_map(|k| [Colour(k, k, k); 3]).collect();
        colours.push(Colour(100, 101, 100));
        let (palette, indices) = indexed(&colours);
        assert_eq!(palette.len(), 256);
        assert_eq!(palette[usize::from(indices[768])], Colour(100, 100, 100));
    }

    #[test]
    fn a_file_is_read_back() {
        let pixels = Pixels { width: 2, height: 1, colours: vec![Colour(1, 2, 3), Colour::WHITE] };
        let bytes = png(&pixels, 300).expect("encoded");
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().expect("a header");
        assert_eq!(reader.info().pixel_dims.map(|dims| dims.xppu), Some(11_811));
        let mut read = vec![0; 6];
        reader.next_frame(&mut read).expect("pixels");
        assert_eq!(read, [1, 2, 3, 255, 255, 255]);
    }
}
