//! PNG images, in their own depth.

use std::io::{self, Cursor, Write};

use png::{BitDepth, ColorType, Decoder, DecodingError, Encoder, Limits, Transformations};
use strict::{LONGEST_REPORT, excerpt};

use super::pixel::{Defect, Picture, Pixel, sized};

/// PNG packs by a factor of 1032 at most, and puts 8 black or white pixels into a byte.
const MOST_PER_BYTE: usize = 8 * 1032;

/// Reads the file `bytes` and takes `of` of every pixel.
pub(super) fn read<T>(bytes: &[u8], mut of: impl FnMut(Pixel) -> T) -> Result<Picture<T>, Defect> {
    // The bounds below are tighter than the decoder's own.
    let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), Limits { bytes: usize::MAX });
    // Palettes as colours, bits as bytes, and a transparent colour as opacity.
    decoder.set_transformations(Transformations::EXPAND);
    let mut reader = decoder.read_info().map_err(decoding)?;
    let (width, height) = (reader.info().width, reader.info().height);
    let count = sized(width, height)?;
    if count > bytes.len().saturating_mul(MOST_PER_BYTE) {
        let problem =
            format!("its header promises {width} x {height} pixels, more than {} bytes can hold", bytes.len());
        return Err(Defect::Damaged(None, problem));
    }
    if reader.info().color_type == ColorType::Indexed {
        whole_colours(reader.info().palette.as_deref().unwrap_or_default())?;
    }
    let size = reader.output_buffer_size().ok_or(Defect::Size(width, height))?;
    let mut data = vec![0; size];
    let frame = reader.next_frame(&mut data).map_err(decoding)?;
    data.truncate(frame.buffer_size());
    let channels = frame.color_type.samples();
    let pixels = match frame.bit_depth {
        BitDepth::Sixteen => {
            let wide = |pair: &[u8]| u16::from_be_bytes([pair[0], pair[1]]);
            let values = data.chunks_exact(2 * channels).map(|bytes| {
                let mut values = [0; 4];
                values.iter_mut().zip(bytes.chunks_exact(2)).for_each(|(value, pair)| *value = wide(pair));
                of(pixel(&values[..channels], u16::MAX))
            });
            values.collect()
        }
        _ => {
            let values = data.chunks_exact(channels).map(|bytes| {
                let mut values = [0; 4];
                values.iter_mut().zip(bytes).for_each(|(value, &byte)| *value = u16::from(byte));
                of(pixel(&values[..channels], 255))
            });
            values.collect()
        }
    };
    Ok(Picture { width: width as usize, height: height as usize, pixels, left_over: 0 })
}

/// A palette holds three bytes for each colour. The decoder takes that for granted, and panics where one is cut off.
fn whole_colours(palette: &[u8]) -> Result<(), Defect> {
    if palette.len().is_multiple_of(3) {
        return Ok(());
    }
    let problem = format!("its palette has {} bytes, and each colour takes three", palette.len());
    Err(Defect::Damaged(None, problem))
}

/// map_server averages the opacity in with the colours, which turns opaque grey (unknown) into
/// free; here a pixel is as bright as its colours, and its opacity decides whether it counts.
fn pixel(values: &[u16], white: u16) -> Pixel {
    let opacity = |value: u16| value * (Pixel::OPAQUE / white);
    let (sum, white) = (|values: &[u16]| values.iter().map(|&v| u32::from(v)).sum::<u32>(), u32::from(white));
    match *values {
        [grey] => Pixel::grey(grey.into(), white),
        [grey, alpha] => Pixel { opacity: opacity(alpha), ..Pixel::grey(grey.into(), white) },
        [red, green, blue, alpha] => {
            Pixel { brightness: sum(&[red, green, blue]), white: 3 * white, opacity: opacity(alpha) }
        }
        _ => Pixel::grey(sum(values), 3 * white),
    }
}

fn decoding(error: DecodingError) -> Defect {
    match error {
        DecodingError::IoError(source) if source.kind() != io::ErrorKind::UnexpectedEof => Defect::Io(source),
        other => Defect::Damaged(None, excerpt(&other.to_string().replace('\n', " "), LONGEST_REPORT)),
    }
}

/// Writes 8 bits per channel: grey, or colours with opacity.
pub(super) fn write(out: impl Write, width: u32, height: u32, transparent: bool, bytes: &[u8]) -> io::Result<()> {
    let mut encoder = Encoder::new(out, width, height);
    encoder.set_color(if transparent { ColorType::Rgba } else { ColorType::Grayscale });
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(bytes)?;
    writer.finish()?;
    Ok(())
}
