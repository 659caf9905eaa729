//! Values in the place of a file's own.

use std::ops::Range;

use strict::{Value, open};
use toml::de::DeTable;

use super::camera::NOISE;
use crate::SceneError;

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

/// The text of a scene or family file with other values. Its lines stay where they are but for those that a new key is put
/// before, so that what is wrong with a value is still found in its place.
///
/// # Errors
/// A text that is no TOML, as for [`open`].
pub fn with(text: &str, file: &str, overrides: &[Override]) -> Result<String, SceneError> {
    let mut text = if overrides.is_empty() { text } else { text.strip_prefix('\u{feff}').unwrap_or(text) }.to_owned();
    for Override { section, key, value } in overrides {
        let (_, document) = open(&text, file)?;
        let root = document.get_ref();
        let section = if *section == "sensor" && noise_is_in_camera(root) { "camera" } else { *section };
        let (span, new) = change(&text, root, section, key, value);
        text.replace_range(span, &new);
    }
    Ok(text)
}

/// Whether the noise that is called `[sensor]` stands in `[camera]`: where sensors are listed, or the camera's table has some of it.
fn noise_is_in_camera(root: &DeTable) -> bool {
    let camera = root.get("camera").and_then(|camera| camera.get_ref().as_table());
    let has_noise = || camera.is_some_and(|camera| NOISE.iter().any(|key| camera.contains_key(*key)));
    root.get("sensor").map_or_else(has_noise, |sensor| sensor.get_ref().as_array().is_some())
}

/// Which part of the text to replace, and by what.
fn change(text: &str, root: &DeTable, section: &str, key: &str, value: &Given) -> (Range<usize>, String) {
    let nothing = (0..0, String::new());
    let new = match value {
        Given::Number(number) => format!("{number:?}"),
        Given::Both(number) => format!("[{number:?}, {number:?}]"),
        Given::Word(word) => quoted(word),
        Given::Nothing => String::new(),
    };
    let remove = matches!(value, Given::Nothing);
    let table = root.get(section).map(|value| (value, value.get_ref().as_table()));
    match table.map(|(there, table)| (there, table, table.and_then(|table| table.get_key_value(key)))) {
        Some((_, _, Some((name, old)))) if remove => (removed(text, name.span().start, old), String::new()),
        Some((_, _, Some((_, old)))) => (old.span(), new),
        _ if remove => nothing,
        Some((there, Some(table), None)) => added(text, there, table, &format!("{key} = {new}")),
        Some((_, None, None)) => nothing, // no table: refused where it is read
        None => {
            let line = if text.is_empty() || text.ends_with('\n') { "" } else { "\n" };
            (text.len()..text.len(), format!("{line}\n[{section}]\n{key} = {new}\n"))
        }
    }
}

/// A key with its value, and the comma that parts it from the next or the last in a table on one line.
fn removed(text: &str, name: usize, value: &Value) -> Range<usize> {
    let (start, end) = (start_of_entry(text, name), value.span().end);
    let (before, after) = (text[..start].trim_end(), text[end..].trim_start());
    if after.starts_with(',') {
        start..text.len() - after.len() + 1
    } else if before.ends_with(',') {
        before.len() - 1..end
    } else {
        start..end
    }
}

/// Where to put a line or entry into a table, and the text of it.
fn added(text: &str, table: &Value, entries: &DeTable, entry: &str) -> (Range<usize>, String) {
    let last = entries.iter().max_by_key(|(_, value)| value.span().end);
    let Some((name, value)) = last else {
        // An empty table on one line, or a heading alone.
        let span = table.span();
        let inside = text[span.clone()].starts_with('{');
        let at = if inside { span.start + 1 } else { end_of_line(text, span.end) };
        return (at..at, if inside { entry.to_owned() } else { format!("\n{entry}") });
    };
    let (name, at) = (name.span().start, value.span().end);
    let start = start_of_entry(text, name);
    let prefix = text[start..name].trim_start_matches(['"', '\'']);
    if text[table.span()].starts_with('{') && prefix.is_empty() {
        return (at..at, format!(", {entry}"));
    }
    let at = end_of_line(text, at);
    (at..at, format!("\n{prefix}{entry}"))
}

/// Where an entry begins whose last key stands at `name`: before the keys of a dotted one.
fn start_of_entry(text: &str, name: usize) -> usize {
    let before = &text[..name];
    let from = before.rfind(['\n', '{', ',']).map_or(0, |at| at + 1);
    from + before[from..].len() - before[from..].trim_start().len()
}

fn end_of_line(text: &str, at: usize) -> usize {
    text[at..].find('\n').map_or(text.len(), |found| at + found)
}

/// A text as TOML has it.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => quoted.extend(['\\', c]),
            c if c.is_control() => quoted += &format!("\\u{:04X}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted + "\""
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
    fn every_form_of_a_table_can_be_changed() {
        let overrides = [
            given("sensor", "persistence", Given::Nothing),
            given("sensor", "copies", Given::Number(0.25)),
            given("sensor", "mismatches", Given::Word("a \"b\" \\ \u{7}")),
        ];
        let forms = [
            "[sensor]\npersistence = 0.9 # why\nsigma = 1\n[z]\n",
            "[sensor]\nsigma = 1\n\"persistence\"=0.9",
            "sensor.persistence = 0.9\nsensor.sigma = 1 # px\n[z]\n",
            "sensor = { persistence = 0.9, sigma = 1 }\nz = {}\n",
            "sensor = {sigma=1,persistence=0.9}\n[z]\n",
            "\u{feff}[sensor] # empty but for\n  persistence = 0.9\n  sigma = 1\n\n[z]",
        ];
        for form in forms {
            let text = with(form, "a.toml", &overrides).expect("TOML");
            let read: toml::Table = text.parse().unwrap_or_else(|error| panic!("{form}\n{text}\n{error}"));
            let sensor = &read["sensor"];
            let keys = ["sigma", "copies", "mismatches"].map(|key| sensor.get(key).is_some());
            assert!(sensor.get("persistence").is_none() && keys == [true; 3], "{text}");
            assert_eq!(sensor["mismatches"].as_str(), Some("a \"b\" \\ \u{7}"), "{text}");
            assert_eq!(read.len(), if form.contains('z') { 2 } else { 1 }, "{text}");
        }
        for empty in ["", "[sensor]", "sensor = {}", "[sensor]\n[z]\n", "z = 1", "sensor = { persistence = 0.9 }"] {
            let text = with(empty, "a.toml", &overrides).expect("TOML");
            let read: toml::Table = text.parse().unwrap_or_else(|error| panic!("{empty}\n{text}\n{error}"));
            assert_eq!(read["sensor"]["copies"].as_float(), Some(0.25), "{text}");
            assert!(read["sensor"].get("persistence").is_none(), "{text}");
        }
        assert_eq!(with("sensor = 7\n", "a.toml", &overrides).expect("TOML"), "sensor = 7\n");
    }

    #[test]
    fn the_noise_of_a_camera_changes_where_it_stands() {
        let overrides = [given("sensor", "correct_match", Given::Number(0.7))];
        for text in ["[camera]\ncorrect_match = 0.9\n", "[[sensor]]\nkind = \"laser\"\n[camera]\ncolumns = 9\n"] {
            let changed = with(text, "a.toml", &overrides).expect("TOML");
            let read: toml::Table = changed.parse().expect("TOML");
            assert_eq!(read["camera"]["correct_match"].as_float(), Some(0.7), "{changed}");
            assert!(read.get("sensor").is_none_or(toml::Value::is_array), "{changed}");
        }
    }

    #[test]
    fn what_is_no_toml_says_where() {
        let error = with("name = ", "a.toml", &[given("sensor", "copies", Given::Number(0.1))]).expect_err("cut");
        assert!(error.to_string().starts_with("a.toml:1:"), "{error}");
    }
}
