//! Values in the place of a file's own.

use toml_edit::{Array, DocumentMut, Item, Table};

use crate::SceneError;
use strict::open;

/// A value to take the place of what a scene or family file says under `[section]`, `key`.
#[derive(Debug, Clone, PartialEq)]
pub struct Override<'a> {
    /// Such as `sensor`.
    pub section: &'a str,
    /// Such as `correct_match`.
    pub key: &'a str,
    /// What it is to be.
    pub value: Given<'a>,
}

/// A value of an [`Override`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Given<'a> {
    /// A number.
    Number(f64),
    /// A number, as both ends of a range such as `width = [6.0, 6.0]`.
    Both(f64),
    /// A word.
    Word(&'a str),
    /// Nothing: the key is taken out.
    Nothing,
}

/// The text of a scene or family file with other values. Its lines stay where they are, so that what is wrong
/// with a value is still found in its place.
///
/// # Errors
/// A text that is no TOML, as for [`open`].
pub fn with(text: &str, file: &str, overrides: &[Override]) -> Result<String, SceneError> {
    if overrides.is_empty() {
        return Ok(text.to_owned());
    }
    open(text, file)?; // says where it is no TOML
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Ok(mut document) = text.parse::<DocumentMut>() else { return Ok(text.to_owned()) };
    for Override { section, key, value } in overrides {
        let section = document.entry(section).or_insert(Item::Table(Table::new()));
        let Some(table) = section.as_table_like_mut() else { continue };
        match value {
            Given::Number(number) => put(table, key, (*number).into()),
            Given::Both(number) => put(table, key, Array::from_iter([*number; 2]).into()),
            Given::Word(word) => put(table, key, (*word).into()),
            Given::Nothing => drop(table.remove(key)),
        }
    }
    Ok(document.to_string())
}

fn put(table: &mut dyn toml_edit::TableLike, key: &str, value: toml_edit::Value) {
    match table.get_mut(key) {
        Some(place) => *place = Item::Value(value),
        None => drop(table.insert(key, Item::Value(value))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = \"a\" # first\n\n[sensor]\ncorrect_match = 0.8 # of ten\nmismatches = \"clustered\"\npersistence = 0.9\n\n[generate]\nwidth = [6.0, 8.0]\n";

    fn given<'a>(section: &'a str, key: &'a str, value: Given<'a>) -> Override<'a> {
        Override { section, key, value }
    }

    #[test]
    fn values_change_and_nothing_else() {
        let overrides = [
            given("sensor", "correct_match", Given::Number(0.1 + 0.2)),
            given("sensor", "mismatches", Given::Word("independent")),
            given("sensor", "persistence", Given::Nothing),
            given("generate", "width", Given::Both(7.0)),
            given("camera", "columns", Given::Number(70.0)),
        ];
        let text = with(TEXT, "a.toml", &overrides).expect("TOML");
        let read: toml::Table = text.parse().expect("TOML");
        assert_eq!(read["sensor"]["correct_match"].as_float(), Some(0.1 + 0.2), "to the last bit");
        assert_eq!(read["sensor"]["mismatches"].as_str(), Some("independent"));
        assert!(read["sensor"].get("persistence").is_none());
        assert_eq!(read["generate"]["width"].as_array().map(Vec::len), Some(2));
        assert_eq!(read["camera"]["columns"].as_float(), Some(70.0));
        assert!(text.starts_with("name = \"a\" # first\n\n[sensor]\n"), "{text}");
        assert_eq!(with(TEXT, "a.toml", &[]).expect("TOML"), TEXT);
    }

    #[test]
    fn what_is_no_toml_says_where() {
        let error = with("name = ", "a.toml", &[given("sensor", "copies", Given::Number(0.1))]).expect_err("cut");
        assert!(error.to_string().starts_with("a.toml:1:"), "{error}");
    }
}
