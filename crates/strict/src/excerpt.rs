//! What messages quote of a file.

/// So many characters of a value or name stand in a message.
pub const LONGEST_VALUE: usize = 60;

/// So many characters of what a parser reports, which can quote the file.
pub const LONGEST_REPORT: usize = 200;

/// The text on one line, with what cannot be printed escaped, and cut behind `longest` characters.
pub fn excerpt(text: &str, longest: usize) -> String {
    let mut line = String::new();
    for c in text.chars().take(longest) {
        if c.is_control() { line.extend(c.escape_default()) } else { line.push(c) }
    }
    if text.chars().nth(longest).is_some() { line + "..." } else { line }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_of_bounded_length() {
        assert_eq!(excerpt("a\nb\0\u{85}é", 9), "a\\nb\\u{0}\\u{85}é");
        assert_eq!((excerpt("été", 3), excerpt("étés", 3)), ("été".to_owned(), "été...".to_owned()));
    }
}
