//! Marks behind numbers of tables for reading.

/// The best of its column, and all that read the same.
pub const BEST: char = '*';

/// Worse than the best of its column by no more than the largest difference that does not matter.
pub const EVEN: char = '=';

/// Whether a word is a number with a mark behind it.
pub fn is_marked(word: &str, mark: char) -> bool {
    word.strip_suffix(mark).is_some_and(|number| value(number).is_some())
}

/// The number that a cell shows: with a sign, commas between thousands, or `M` for millions.
pub fn value(cell: &str) -> Option<f64> {
    let (digits, scale) = cell.strip_suffix('M').map_or((cell, 1.0), |millions| (millions, 1e6));
    let begins = digits.trim_start_matches(['+', '-']).starts_with(|c: char| c.is_ascii_digit());
    digits.replace(',', "").parse::<f64>().ok().filter(|_| begins).map(|number| number * scale)
}
