//! A map as a picture of its own: a pixel for every cell, north up, without a frame.

use grid::Raster;

use super::encode;
use super::ink;
use super::raster::Pixels;
use crate::failure::Failure;

/// What a picture without a frame is stored with, pixels per inch: a page scales it.
const DPI: u32 = 200;

/// Most pixels to a side: of a larger map several cells share a pixel.
const MOST: usize = 2000;

/// The map in greys, as PNG; cells that were not seen are as the prior. Where cells share a pixel it has the most occupied of them, so that
/// thin walls stay.
///
/// # Errors
/// An encoder that fails.
pub fn png(map: &Raster<f64>, seen: &Raster<bool>, prior: f64) -> Result<Vec<u8>, Failure> {
    let spec = map.spec();
    let step = spec.width.max(spec.height).div_ceil(MOST).max(1);
    let [width, height] = [spec.width, spec.height].map(|side| side.div_ceil(step));
    let shown = |cell: usize| if seen[cell] { map[cell] } else { prior };
    let mut colours = Vec::with_capacity(width * height);
    for row in (0..height).rev() {
        for column in 0..width {
            let rows = row * step..((row + 1) * step).min(spec.height);
            let columns = column * step..((column + 1) * step).min(spec.width);
            let cells = rows.flat_map(|row| columns.clone().map(move |column| row * spec.width + column));
            // A pixel with anything seen in it is no longer the prior's.
            let known = cells.clone().any(|cell| seen[cell]);
            let p = cells.filter(|cell| !known || seen[*cell]).map(shown).fold(0.0, f64::max);
            colours.push(ink::occupancy(p, prior));
        }
    }
    encode::png(&Pixels { width, height, colours }, DPI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;

    fn read(bytes: &[u8]) -> (u32, u32, Vec<u8>) {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().expect("a header");
        let mut pixels = vec![0; reader.output_buffer_size().expect("a size")];
        let info = reader.next_frame(&mut pixels).expect("pixels");
        (info.width, info.height, pixels.chunks_exact(3).map(|rgb| rgb[0]).collect())
    }

    #[test]
    fn the_top_row_is_the_northernmost_and_what_is_not_seen_is_the_prior() {
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0, 0.0], width: 2, height: 2 };
        let map = Raster::new(spec, vec![0.0, 1.0, 1.0, 0.0]);
        let seen = Raster::new(spec, vec![true, true, false, true]);
        let (width, height, greys) = read(&png(&map, &seen, 0.2).expect("drawn"));
        assert_eq!((width, height), (2, 2));
        assert_eq!(greys, [ink::occupancy(0.2, 0.2).0, 255, 255, 0]);
    }

    #[test]
    fn a_wall_of_one_cell_stays_in_a_map_of_many() {
        let spec = GridSpec { cell_m: 0.1, origin_m: [0.0, 0.0], width: 3 * MOST, height: 3 };
        let wall = |cell: usize| if cell % spec.width == 10 { 1.0 } else { 0.0 };
        let map = Raster::new(spec, (0..spec.cells()).map(wall).collect());
        let seen = Raster::new(spec, vec![true; spec.cells()]);
        let (width, height, greys) = read(&png(&map, &seen, 0.2).expect("drawn"));
        assert_eq!((width as usize, height), (MOST, 1));
        assert_eq!((greys[2], greys[3], greys[4]), (255, 0, 255));
    }
}
