//! Netpbm images, in their own depth: PBM, PGM and PPM as text and binary, and PAM.
//!
//! A shade keeps the brightest value of its file: stretched to 8 or 16 bits it would be rounded across the thresholds of a
//! map. No more memory is asked for than the file has bytes, whatever its header claims.

use super::header::Text;
use super::pixel::{Defect, Picture, Pixel, sized};

/// How the pixels of a file are stored.
struct Form {
    width: u32,
    height: u32,
    /// The brightest value.
    white: u32,
    /// Values per pixel: shade, shade and opacity, colours, or colours and opacity.
    channels: usize,
    /// One bit per pixel, 1 for black, rows in whole bytes.
    packed: bool,
    /// 1 is black.
    inverted: bool,
}

/// Reads the file `bytes`, which begins with `P1` to `P7`, and takes `of` of every pixel.
pub(super) fn read<T>(bytes: &[u8], mut of: impl FnMut(Pixel) -> T) -> Result<Picture<T>, Defect> {
    let kind = bytes.get(1).copied().unwrap_or_default();
    let mut text = Text::behind_magic(bytes);
    let form = if kind == b'7' { pam(&mut text)? } else { form(kind, &mut text)? };
    let count = sized(form.width, form.height)?;
    if form.white == 0 {
        return Err(text.wrong("its brightest value is 0: must be from 1 to 65535"));
    }
    let (values, left_over) = match kind {
        b'1' => (bits_of_text(&mut text, count)?, text.left_over()),
        b'2' | b'3' => (numbers_of_text(&mut text, count * form.channels, form.white)?, text.left_over()),
        _ => binary(&mut text, &form),
    };
    let (width, height) = (form.width as usize, form.height as usize);
    let whole = values.len() / form.channels;
    if let Some(at) = values.iter().position(|&v| u32::from(v) > form.white) {
        let (pixel, value) = (at / form.channels, values[at]);
        let problem = format!(
            "pixel {} of row {}, from 0 at the top left, is {value}: must be at most {}, its brightest value",
            pixel % width,
            pixel / width,
            form.white
        );
        return Err(Defect::Damaged(None, problem));
    }
    if whole < count {
        return Err(Defect::Damaged(None, format!("it ends after {whole} of {width} x {height} pixels")));
    }
    let pixels = values.chunks_exact(form.channels).map(|values| of(pixel(values, &form))).collect();
    Ok(Picture { width, height, pixels, left_over })
}

/// The header of all but PAM.
fn form(kind: u8, text: &mut Text) -> Result<Form, Defect> {
    let width = text.header("its width", u32::MAX)?;
    let height = text.header("its height", u32::MAX)?;
    let bits = matches!(kind, b'1' | b'4');
    let white = if bits { 1 } else { text.header("its brightest value", 65535)? };
    let channels = if matches!(kind, b'3' | b'6') { 3 } else { 1 };
    Ok(Form { width, height, white, channels, packed: kind == b'4', inverted: bits })
}

/// The header of a PAM: a key and its value per line, up to `ENDHDR`.
fn pam(text: &mut Text) -> Result<Form, Defect> {
    let (mut width, mut height, mut depth, mut white) = (None, None, None, None);
    loop {
        let place = text.place();
        let Some(line) = text.line() else { return Err(text.wrong("it ends within its header")) };
        let (key, value) = line.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((&line, ""));
        let field = match key {
            "ENDHDR" => break,
            "WIDTH" => &mut width,
            "HEIGHT" => &mut height,
            "DEPTH" => &mut depth,
            "MAXVAL" => &mut white,
            _ => continue, // TUPLTYPE, comments, and what others add
        };
        let number = value.trim().parse::<u32>().ok();
        *field = Some(number.ok_or_else(|| Defect::Damaged(Some(place), format!("{key}: must be a whole number")))?);
    }
    let (Some(width), Some(height), Some(depth), Some(white)) = (width, height, depth, white) else {
        return Err(text.wrong("its header lacks WIDTH, HEIGHT, DEPTH or MAXVAL"));
    };
    if !(1..=4).contains(&depth) || white > 65535 {
        return Err(text.wrong(&format!("DEPTH {depth} and MAXVAL {white}: must be 1 to 4, and at most 65535")));
    }
    Ok(Form { width, height, white, channels: depth as usize, packed: false, inverted: false })
}

/// The values of a binary file, as many as there are, and the bytes that follow them.
fn binary(text: &mut Text, form: &Form) -> (Vec<u16>, usize) {
    let (width, height) = (form.width as usize, form.height as usize);
    if form.packed {
        let per_row = width.div_ceil(8);
        let rest = text.pixels(per_row * height);
        let bit = |row: &[u8], column: usize| u16::from(row[column / 8] >> (7 - column % 8) & 1);
        let rows = rest.chunks_exact(per_row).take(height);
        let values = rows.flat_map(|row| (0..width).map(move |column| bit(row, column))).collect();
        return (values, rest.len().saturating_sub(per_row * height));
    }
    let per_value = if form.white > 255 { 2 } else { 1 };
    let needed = width * height * form.channels * per_value;
    let rest = text.pixels(needed);
    let held = &rest[..rest.len().min(needed)];
    let values = match per_value {
        1 => held.iter().map(|&byte| u16::from(byte)).collect(),
        _ => held.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]])).collect(),
    };
    (values, rest.len() - held.len())
}

fn numbers_of_text(text: &mut Text, count: usize, white: u32) -> Result<Vec<u16>, Defect> {
    let mut values = Vec::new();
    while values.len() < count
        && let Some(value) = text.number(white)?
    {
        values.push(value as u16); // at most 65535
    }
    Ok(values)
}

/// Zeros and ones, with or without blanks between them.
fn bits_of_text(text: &mut Text, count: usize) -> Result<Vec<u16>, Defect> {
    let mut values = Vec::new();
    while values.len() < count
        && let Some(bit) = text.bit()?
    {
        values.push(bit);
    }
    Ok(values)
}

fn pixel(values: &[u16], form: &Form) -> Pixel {
    let white = form.white;
    let opacity =
        |value: u16| ((u64::from(value) * u64::from(Pixel::OPAQUE) + u64::from(white) / 2) / u64::from(white)) as u16;
    let sum = |values: &[u16]| values.iter().map(|&v| u32::from(v)).sum();
    match *values {
        [grey] if form.inverted => Pixel::grey(white - u32::from(grey), white),
        [grey] => Pixel::grey(grey.into(), white),
        [grey, alpha] => Pixel { opacity: opacity(alpha), ..Pixel::grey(grey.into(), white) },
        [.., alpha] if values.len() == 4 => {
            Pixel { brightness: sum(&values[..3]), white: 3 * white, opacity: opacity(alpha) }
        }
        _ => Pixel::grey(sum(values), 3 * white),
    }
}
