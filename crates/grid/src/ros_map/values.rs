//! Values of a map's YAML file, each checked where it is taken.

use std::collections::HashMap;
use std::path::Path;

use strict::{LONGEST_VALUE, Place, excerpt};

use super::error::RosMapError;
use super::yaml::{FORM, Node, Text};

/// The keys of one file; others than those that are asked for are ignored, since programs add their own.
pub(super) struct Values<'a> {
    pub(super) path: &'a Path,
    pub(super) keys: &'a HashMap<String, Node>,
}

/// A list of values.
pub(super) struct List<'a> {
    pub(super) items: Vec<&'a Text>,
    pub(super) at: (usize, usize),
}

impl<'a> Values<'a> {
    /// A place in the file.
    pub(super) fn place(&self, (line, column): (usize, usize)) -> Place {
        Place { file: self.path.display().to_string(), line, column }
    }

    /// A value that need not be there.
    pub(super) fn optional(&self, key: &str) -> Result<Option<&'a Text>, RosMapError> {
        match self.keys.get(key) {
            None | Some(Node::Nothing) => Ok(None),
            Some(node) => self.single(node).map(Some),
        }
    }

    /// A value that must be there.
    pub(super) fn text(&self, key: &'static str, example: &'static str) -> Result<&'a Text, RosMapError> {
        self.optional(key)?.ok_or_else(|| self.missing(key, example))
    }

    /// A list that must be there.
    pub(super) fn list(&self, key: &'static str, example: &'static str) -> Result<List<'a>, RosMapError> {
        match self.keys.get(key) {
            None | Some(Node::Nothing) => Err(self.missing(key, example)),
            Some(Node::List { items, at }) => {
                let items = items.iter().map(|item| self.single(item)).collect::<Result<_, _>>()?;
                Ok(List { items, at: *at })
            }
            Some(other) => Err(self.syntax(other, "a list such as [0.0, 0.0, 0.0] is needed here")),
        }
    }

    /// A number that must be there and lie in a range, and its place; `remedy` depends on what was written.
    pub(super) fn number(
        &self,
        key: &'static str,
        example: &'static str,
        range: [f64; 2],
        remedy: impl Fn(f64) -> String,
    ) -> Result<(f64, Place), RosMapError> {
        let given = self.text(key, example)?;
        Ok((self.within(key, given, range, remedy)?, self.place(given.at)))
    }

    /// A number in a range; `remedy` is told what was written, NaN where it was no number.
    pub(super) fn within(
        &self,
        key: &'static str,
        given: &Text,
        [low, high]: [f64; 2],
        remedy: impl Fn(f64) -> String,
    ) -> Result<f64, RosMapError> {
        let text = given.value.trim();
        let number = number(text).unwrap_or(f64::NAN);
        // A number that is none (NaN) is in no range.
        if (low..=high).contains(&number) {
            return Ok(number);
        }
        let comma = text.replacen(',', ".", 1);
        let remedy = if comma != text && comma.parse::<f64>().is_ok() {
            format!("write a decimal point: {comma}")
        } else {
            remedy(number)
        };
        Err(self.wrong(key, given, &format!("a number from {low} to {high}"), remedy))
    }

    /// 0 or 1, or one of the words that YAML 1.1 has for them, and its place.
    pub(super) fn boolean(
        &self,
        key: &'static str,
        example: &'static str,
        remedy: &'static str,
    ) -> Result<(bool, Place), RosMapError> {
        let given = self.text(key, example)?;
        match given.value.trim().to_ascii_lowercase().as_str() {
            "0" | "false" | "no" | "off" | "n" => Ok((false, self.place(given.at))),
            "1" | "true" | "yes" | "on" | "y" => Ok((true, self.place(given.at))),
            _ => Err(self.wrong(key, given, "0 or 1", remedy.to_owned())),
        }
    }

    pub(super) fn wrong(&self, key: &'static str, given: &Text, bound: &str, remedy: String) -> RosMapError {
        let value = excerpt(given.value.trim(), LONGEST_VALUE);
        let remedy = remedy.into();
        RosMapError::Value { place: self.place(given.at), key, value, bound: bound.into(), remedy }
    }

    fn missing(&self, key: &'static str, example: &'static str) -> RosMapError {
        RosMapError::MissingKey { path: self.path.into(), key, example }
    }

    fn single(&self, node: &'a Node) -> Result<&'a Text, RosMapError> {
        match node {
            Node::Text(text) => Ok(text),
            other => Err(self.syntax(other, "one value is needed here, not a list or table")),
        }
    }

    fn syntax(&self, node: &Node, problem: &str) -> RosMapError {
        RosMapError::Syntax { place: self.place(node.at()), problem: problem.to_owned(), remedy: FORM }
    }
}

/// A number as YAML and its writers have them; `.nan` and `-nan` are numbers that are none.
fn number(text: &str) -> Option<f64> {
    let digits = text.strip_prefix('+').unwrap_or(text);
    let plain = digits.replace('_', "");
    let plain = if digits.starts_with(|c: char| c.is_ascii_digit()) { plain.as_str() } else { digits };
    plain.parse().ok()
}

/// What a writer in single precision meant: 0.05000000074505806 is 0.05.
///
/// A value is taken for such a one if it is a float32 to the bit and stands within float32's rounding of a number with at
/// most six digits.
pub(super) fn without_noise(value: f64) -> f64 {
    let single = value as f32;
    let exact = f64::from(single) - value;
    let short: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    let meant = (short as f32).to_bits() == single.to_bits();
    // Writers with nine or ten digits: 0.0500000007.
    let digits = format!("{value:e}").chars().take_while(|&c| c != 'e').filter(char::is_ascii_digit).count();
    if meant && (exact.abs() <= 0.0 || digits <= 10) { short } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn noise_of_single_precision_is_taken_off() {
        for meant in [0.05, 0.025, 0.1, 0.2, -12.3, -4.05, 0.01, 123.456, 0.0] {
            let noisy = f64::from(meant as f32);
            assert_eq!(without_noise(noisy).to_bits(), f64::to_bits(meant), "{noisy}");
        }
        assert_eq!(without_noise(0.0500000007).to_bits(), 0.05_f64.to_bits());
        for kept in [0.05, 0.0512345678, 4_649_776.22, 500_012.35, 1.0 / 3.0, 0.123456789012] {
            assert_eq!(without_noise(kept).to_bits(), f64::to_bits(kept), "{kept}");
        }
    }

    proptest! {
        #[test]
        fn no_value_moves_by_more_than_single_precision(value in -1e8_f64..1e8) {
            let noisy = f64::from(value as f32);
            prop_assert!((without_noise(noisy) - noisy).abs() <= noisy.abs() * f64::from(f32::EPSILON));
        }
    }
}
