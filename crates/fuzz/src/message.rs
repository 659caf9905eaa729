//! What every refusal promises.

use std::fmt::Display;

/// Longer messages are not read. Characters.
const LONGEST: usize = 2000;

/// Panics unless the error is one line of bounded length that begins with its place.
pub(crate) fn check(error: &impl Display, place: &str) {
    let message = error.to_string();
    line(&message);
    assert!(message.starts_with(place), "does not begin with {place}: {message}");
}

/// Panics unless the text is one line of bounded length.
pub(crate) fn line(text: &str) {
    assert!(!text.contains(char::is_control), "is not one line of plain text: {text:?}");
    let length = text.chars().count();
    assert!(length <= LONGEST, "has {length} characters: {text}");
}
