//! The fields of a line, and what is wrong with them.

use std::str;

/// Fields of a line, read one by one.
pub(crate) struct Fields<'a> {
    fields: Vec<&'a [u8]>,
    next: usize,
}

impl<'a> Fields<'a> {
    /// Fields that blanks separate.
    pub(crate) fn by_blanks(line: &'a [u8]) -> Self {
        Self { fields: line.split(u8::is_ascii_whitespace).filter(|field| !field.is_empty()).collect(), next: 0 }
    }

    /// Fields that have not been read yet.
    pub(crate) fn left(&self) -> usize {
        self.fields.len() - self.next
    }

    /// The next field as it stands.
    pub(crate) fn raw(&mut self, name: &str) -> Result<&'a [u8], String> {
        let field = self.fields.get(self.next).copied().ok_or_else(|| format!("{name} is missing: the line is cut"))?;
        self.next += 1;
        Ok(field)
    }

    /// The next field as it stands, to be read again.
    pub(crate) fn peek(&self) -> Option<&'a [u8]> {
        self.fields.get(self.next).copied()
    }

    /// Passes over so many fields.
    pub(crate) fn skip(&mut self, count: usize) {
        self.next = self.fields.len().min(self.next + count);
    }

    /// The next field as a number, NaN and infinities included.
    pub(crate) fn any_number(&mut self, name: &str) -> Result<f64, String> {
        let field = self.raw(name)?;
        number(field).ok_or_else(|| format!("field {}, {name}: {} is no number", self.next, quoted(field)))
    }

    /// The next field as a number of a magnitude up to `most`.
    pub(crate) fn number(&mut self, name: &str, most: f64) -> Result<f64, String> {
        let value = self.any_number(name)?;
        if value.abs() <= most {
            return Ok(value);
        }
        let field = quoted(self.fields[self.next - 1]);
        Err(format!("field {}, {name}: {field} must be a number from {:e} to {most:e}", self.next, -most))
    }

    /// The next field as a count of fields to come; the line must be long enough to hold them.
    pub(crate) fn count(&mut self, name: &str) -> Result<usize, String> {
        let field = self.raw(name)?;
        let count = str::from_utf8(field).ok().and_then(|text| text.parse::<u64>().ok());
        let count =
            count.ok_or_else(|| format!("field {}, {name}: {} is no whole number", self.next, quoted(field)))?;
        match usize::try_from(count).ok().filter(|count| *count <= self.left()) {
            Some(count) => Ok(count),
            None => Err(format!("field {}, {name}: {count} of them, but {} fields follow", self.next, self.left())),
        }
    }
}

/// Text as a number, NaN and infinities included.
pub(crate) fn number(field: &[u8]) -> Option<f64> {
    str::from_utf8(field).ok()?.parse().ok()
}

/// A field for a message: in quotes, escaped, of bounded length.
pub(crate) fn quoted(field: &[u8]) -> String {
    const LONGEST: usize = 40;
    let text = String::from_utf8_lossy(&field[..field.len().min(4 * LONGEST)]);
    let short: String = text.chars().take(LONGEST).collect();
    let rest = if short.len() < text.len() || field.len() > 4 * LONGEST { "..." } else { "" };
    format!("{:?}", short + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_read_in_turn_and_messages_name_them() {
        let mut fields = Fields::by_blanks(b" X  2 1.5\t-inf nan 1e9 \xff ");
        assert_eq!(fields.raw("name"), Ok(&b"X"[..]));
        assert_eq!(fields.count("number of ranges"), Ok(2));
        assert_eq!(fields.any_number("range"), Ok(1.5));
        assert_eq!(fields.any_number("range"), Ok(f64::NEG_INFINITY));
        assert_eq!(fields.number("x", 1e8), Err("field 5, x: \"nan\" must be a number from -1e8 to 1e8".to_owned()));
        assert_eq!(fields.number("y", 1e8), Err("field 6, y: \"1e9\" must be a number from -1e8 to 1e8".to_owned()));
        assert_eq!(fields.any_number("theta"), Err("field 7, theta: \"\u{fffd}\" is no number".to_owned()));
        assert_eq!(fields.any_number("time"), Err("time is missing: the line is cut".to_owned()));
    }

    #[test]
    fn a_count_is_no_larger_than_the_line() {
        for (line, expected) in [
            ("4000000000 1 2", "field 1, n: 4000000000 of them, but 2 fields follow"),
            ("99999999999999999999999 1", "field 1, n: \"99999999999999999999999\" is no whole number"),
            ("-1 1", "field 1, n: \"-1\" is no whole number"),
            ("1.5 1", "field 1, n: \"1.5\" is no whole number"),
        ] {
            assert_eq!(Fields::by_blanks(line.as_bytes()).count("n"), Err(expected.to_owned()));
        }
    }

    #[test]
    fn a_long_field_is_quoted_in_part() {
        assert_eq!(quoted(&[b'a'; 1000]), format!("\"{}...\"", "a".repeat(40)));
        assert_eq!(quoted(b"a\nb"), "\"a\\nb\"");
    }
}
