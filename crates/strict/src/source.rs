//! The text of a file, by which offsets become places.

use crate::excerpt::{LONGEST_VALUE, excerpt};
use crate::place::Place;
use crate::problem::{Error, Problem};

/// A file's text and its name.
pub struct Source<'a> {
    file: &'a str,
    text: &'a str,
    /// Offset at which each line begins: a scene of a hundred thousand boxes asks for as many lines.
    lines: Vec<usize>,
}

impl<'a> Source<'a> {
    /// The source of messages about `text`; `file` is what they call it.
    pub fn new(file: &'a str, text: &'a str) -> Self {
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { file, text, lines }
    }

    /// The place of a byte of the text; the end of the text for what lies beyond.
    pub fn place(&self, offset: usize) -> Place {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.lines.partition_point(|&start| start <= offset);
        let column = self.text[self.lines[line - 1]..offset].chars().count() + 1;
        Place { file: self.file.to_owned(), line, column }
    }

    /// A problem with what stands at a byte of the text.
    pub fn error(&self, offset: usize, problem: Problem) -> Error {
        Error::Invalid { place: self.place(offset), problem: Box::new(problem) }
    }

    /// The bytes of the text as they stand there; empty for what lies beyond.
    pub fn verbatim(&self, span: std::ops::Range<usize>) -> &'a str {
        self.text.get(span).unwrap_or_default()
    }

    /// The same on one line, cut where it is long.
    pub fn excerpt(&self, span: std::ops::Range<usize>) -> String {
        let words: Vec<&str> = self.verbatim(span).split_whitespace().collect();
        excerpt(&words.join(" "), LONGEST_VALUE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_place_is_found_again_by_counting(text in "[a-zé\n]{0,40}", at in 0_usize..60) {
            let place = Source::new("f", &text).place(at);
            let mut end = at.min(text.len());
            while !text.is_char_boundary(end) {
                end -= 1;
            }
            let (mut line, mut column) = (1, 1);
            for c in text[..end].chars() {
                (line, column) = if c == '\n' { (line + 1, 1) } else { (line, column + 1) };
            }
            prop_assert_eq!(place, Place { file: "f".to_owned(), line, column });
        }
    }
}
