//! Grey netpbm images (PGM), text or binary, in their own depth.
//!
//! The decoder of crate `image` stretches every depth to 8 or 16 bits and rounds, which moves shades across the
//! thresholds of a map; here a shade keeps the brightest value of its file. No more memory is asked for than the
//! file has pixels, whatever its header says.

use std::io::{self, BufRead, Bytes};

use super::picture::{MAX_PIXELS, Picture, Pixel};

/// What is wrong with the image.
#[derive(Debug)]
pub(super) enum Defect {
    /// The system.
    Io(io::Error),
    /// The content, with line and column where the file is text.
    Damaged(Option<(u64, u64)>, String),
    /// No pixels, or too many.
    Size(u32, u32),
}

/// Reads what follows the first two bytes, `P2` or `P5`, and takes `of` of every pixel.
pub(super) fn read<T>(binary: bool, input: impl BufRead, of: impl Fn(Pixel) -> T) -> Result<Picture<T>, Defect> {
    let mut text = Text { bytes: input.bytes(), line: 1, column: 3 };
    let width = text.header("its width", u32::MAX)?;
    let height = text.header("its height", u32::MAX)?;
    let white = text.header("its brightest value", 65535)?;
    let count = u64::from(width) * u64::from(height);
    if !(1..=MAX_PIXELS).contains(&count) {
        return Err(Defect::Size(width, height));
    }
    if white == 0 {
        return Err(text.wrong("its brightest value is 0: must be from 1 to 65535"));
    }
    let mut pixels = Vec::new();
    let mut row = Vec::new();
    for _ in 0..height {
        row.clear();
        if binary {
            text.row(width, white, &mut row)?
        } else {
            text.row_of_text(width, white, &mut row)?
        }
        if let Some(column) = row.iter().position(|&v| u32::from(v) > white) {
            let (below, value) = (pixels.len() / width as usize, row[column]);
            let problem = format!(
                "pixel {column} of row {below}, from 0 at the top left, is {value}: must be at most {white}, its brightest value"
            );
            return Err(Defect::Damaged(None, problem));
        }
        pixels.extend(row.iter().map(|&v| of(Pixel { brightness: v.into(), white, opacity: Pixel::OPAQUE })));
        if (row.len() as u64) < u64::from(width) {
            let problem = format!("it ends after {} of {width} x {height} pixels", pixels.len());
            return Err(Defect::Damaged(None, problem));
        }
    }
    Ok(Picture { width: width as usize, height: height as usize, pixels })
}

/// The bytes of the file, and where the next one stands.
struct Text<R> {
    bytes: Bytes<R>,
    line: u64,
    column: u64,
}

impl<R: BufRead> Text<R> {
    /// A number of the header.
    fn header(&mut self, what: &str, most: u32) -> Result<u32, Defect> {
        match self.number(most)? {
            Some(number) => Ok(number),
            None => Err(self.wrong(&format!("it ends before {what}"))),
        }
    }

    fn row_of_text(&mut self, width: u32, white: u32, row: &mut Vec<u16>) -> Result<(), Defect> {
        for _ in 0..width {
            let Some(value) = self.number(white)? else { break };
            row.push(value as u16); // at most 65535
        }
        Ok(())
    }

    /// One byte per pixel, or two with the higher one first.
    fn row(&mut self, width: u32, white: u32, row: &mut Vec<u16>) -> Result<(), Defect> {
        for _ in 0..width {
            let Some(first) = self.raw()? else { break };
            let value = match (white > 255).then(|| self.raw()).transpose()? {
                None => u16::from(first),
                Some(Some(second)) => u16::from_be_bytes([first, second]),
                Some(None) => break,
            };
            row.push(value);
        }
        Ok(())
    }

    /// The next whole number; takes the one byte behind it. `None` at the end of the file.
    fn number(&mut self, most: u32) -> Result<Option<u32>, Defect> {
        let mut digits = String::new();
        let mut start = (self.line, self.column);
        while let Some(byte) = self.byte()? {
            match byte {
                b'#' if digits.is_empty() => self.skip_line()?,
                b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c if digits.is_empty() => {}
                b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c => break,
                b'0'..=b'9' if digits.len() < 20 => {
                    digits.push(char::from(byte));
                    continue;
                }
                _ if !digits.is_empty() => {
                    return Err(Defect::Damaged(Some(start), format!("{digits}...: must be a whole number")));
                }
                _ => {
                    let problem = format!("'{}': must be a whole number", byte.escape_ascii());
                    return Err(Defect::Damaged(Some(start), problem));
                }
            }
            start = (self.line, self.column);
        }
        if digits.is_empty() {
            return Ok(None);
        }
        let number = digits.parse().ok().filter(|&n| n <= most);
        number.map(Some).ok_or_else(|| Defect::Damaged(Some(start), format!("{digits}: must be at most {most}")))
    }

    fn skip_line(&mut self) -> Result<(), Defect> {
        while let Some(byte) = self.byte()? {
            if byte == b'\n' || byte == b'\r' {
                break;
            }
        }
        Ok(())
    }

    fn byte(&mut self) -> Result<Option<u8>, Defect> {
        let byte = self.raw()?;
        match byte {
            Some(b'\n') => (self.line, self.column) = (self.line + 1, 1),
            Some(_) => self.column += 1,
            None => {}
        }
        Ok(byte)
    }

    fn raw(&mut self) -> Result<Option<u8>, Defect> {
        self.bytes.next().transpose().map_err(Defect::Io)
    }

    fn wrong(&self, problem: &str) -> Defect {
        Defect::Damaged(Some((self.line, self.column)), problem.to_owned())
    }
}
