//! The text at the beginning of a netpbm image, and where its pixels begin.

use super::pixel::Defect;

/// The bytes of a file, and where the next one stands.
pub(super) struct Text<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    column: usize,
}

impl<'a> Text<'a> {
    /// What follows the two bytes that name the kind.
    pub(super) fn behind_magic(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 2, line: 1, column: 3 }
    }

    /// Line and column of the next byte, each from 1.
    pub(super) fn place(&self) -> (usize, usize) {
        (self.line, self.column)
    }

    /// A number of the header.
    pub(super) fn header(&mut self, what: &str, most: u32) -> Result<u32, Defect> {
        match self.number(most)? {
            Some(number) => Ok(number),
            None => Err(self.wrong(&format!("it ends before {what}"))),
        }
    }

    /// The next whole number; takes the one byte behind it. `None` at the end of the file.
    pub(super) fn number(&mut self, most: u32) -> Result<Option<u32>, Defect> {
        let mut digits = String::new();
        let mut start = self.place();
        while let Some(byte) = self.byte() {
            match byte {
                b'#' if digits.is_empty() => self.skip_line(),
                byte if is_blank(byte) && digits.is_empty() => {}
                byte if is_blank(byte) => break,
                b'0'..=b'9' if digits.len() < 20 => {
                    digits.push(char::from(byte));
                    continue;
                }
                _ if !digits.is_empty() => {
                    return Err(Defect::Damaged(Some(start), format!("{digits}...: must be a whole number")));
                }
                _ => return Err(no_number(start, byte)),
            }
            start = self.place();
        }
        if digits.is_empty() {
            return Ok(None);
        }
        let number = digits.parse().ok().filter(|&n| n <= most);
        number.map(Some).ok_or_else(|| Defect::Damaged(Some(start), format!("{digits}: must be at most {most}")))
    }

    /// The next 0 or 1. `None` at the end of the file.
    pub(super) fn bit(&mut self) -> Result<Option<u16>, Defect> {
        loop {
            let start = self.place();
            match self.byte() {
                None => return Ok(None),
                Some(b'#') => self.skip_line(),
                Some(byte @ (b'0' | b'1')) => return Ok(Some(u16::from(byte - b'0'))),
                Some(byte) if is_blank(byte) => {}
                Some(byte) => return Err(no_number(start, byte)),
            }
        }
    }

    /// The next line, without its end. `None` at the end of the file.
    pub(super) fn line(&mut self) -> Option<String> {
        if self.at >= self.bytes.len() {
            return None;
        }
        let mut line = Vec::new();
        while let Some(byte) = self.byte().filter(|&byte| byte != b'\n') {
            line.push(byte);
        }
        Some(String::from_utf8_lossy(&line).trim().to_owned())
    }

    /// The bytes from the first pixel on, of which `needed` are pixels.
    ///
    /// One blank ends the header. Where the file has bytes to spare, a line end of two bytes counts as one, and blanks and
    /// comments that some programs write behind the header are skipped.
    pub(super) fn pixels(&mut self, needed: usize) -> &'a [u8] {
        let header = &self.bytes[..self.at];
        let mut rest = &self.bytes[self.at..];
        if header.ends_with(b"\r") && rest.starts_with(b"\n") {
            let elsewhere = header.windows(2).any(|pair| pair == b"\r\n");
            if elsewhere || rest.len() > needed {
                rest = &rest[1..];
            }
        }
        while rest.len() > needed {
            let spare = rest.len() - needed;
            let comment = rest.iter().position(|&byte| byte == b'\n' || byte == b'\r');
            let skipped = match (rest[0], comment) {
                (b'#', Some(end)) if end < spare && is_text(&rest[..end]) => end + 1,
                // Blanks at the end of the file are as likely to be the spare ones.
                (byte, _) if is_blank(byte) && !rest[needed..].iter().all(|&byte| is_blank(byte)) => 1,
                _ => break,
            };
            rest = &rest[skipped..];
        }
        self.at = self.bytes.len();
        rest
    }

    /// Bytes that nothing reads: what follows but for blanks.
    pub(super) fn left_over(&self) -> usize {
        let rest = &self.bytes[self.at.min(self.bytes.len())..];
        if rest.iter().all(|&byte| is_blank(byte)) { 0 } else { rest.len() }
    }

    pub(super) fn wrong(&self, problem: &str) -> Defect {
        Defect::Damaged(Some(self.place()), problem.to_owned())
    }

    fn skip_line(&mut self) {
        while self.byte().is_some_and(|byte| byte != b'\n' && byte != b'\r') {}
    }

    fn byte(&mut self) -> Option<u8> {
        let byte = *self.bytes.get(self.at)?;
        self.at += 1;
        (self.line, self.column) = if byte == b'\n' { (self.line + 1, 1) } else { (self.line, self.column + 1) };
        Some(byte)
    }
}

fn no_number(place: (usize, usize), byte: u8) -> Defect {
    Defect::Damaged(Some(place), format!("'{}': must be a whole number", byte.escape_ascii()))
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

/// Whether these bytes could be a comment.
fn is_text(bytes: &[u8]) -> bool {
    std::str::from_utf8(bytes).is_ok_and(|text| !text.chars().any(|c| c.is_control() && c != '\t'))
}
