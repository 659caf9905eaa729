//! JSON schemas (draft 7) of the TOML files that people write: for editors, which then complete keys and mark mistakes.
//!
//! A schema says what keys there are, of what type and within which bounds. That a waypoint is declared or that the robot
//! fits through a door no schema says; `check` does.

mod family;
mod moving;
mod scene;
mod sensors;

use serde_json::{Map, Value, json};
use strict::Limit;

pub use family::family;
pub use scene::scene;

/// Where the meaning of the keywords is defined.
const DRAFT: &str = "http://json-schema.org/draft-07/schema#";

/// A file: what it is, the keys of its top and those that must be there.
pub(crate) fn file(title: &str, keys: &[(&str, Value)], required: &[&str]) -> Value {
    let mut schema = table(title, keys, required);
    schema["$schema"] = json!(DRAFT);
    schema
}

/// A table of these keys and no others.
pub(crate) fn table(about: &str, keys: &[(&str, Value)], required: &[&str]) -> Value {
    let properties: Map<String, Value> = keys.iter().map(|(key, value)| ((*key).to_owned(), value.clone())).collect();
    let mut schema =
        json!({ "description": about, "type": "object", "additionalProperties": false, "properties": properties });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema
}

/// A list of such items, at least so many.
pub(crate) fn list(about: &str, items: Value, least: u64) -> Value {
    json!({ "description": about, "type": "array", "items": items, "minItems": least })
}

/// A number within a limit.
pub(crate) fn number(about: &str, limit: &Limit) -> Value {
    let Limit { min, max, .. } = limit;
    json!({ "description": format!("{about}: {}", limit.bound), "type": "number", "minimum": min, "maximum": max })
}

/// A whole number within a limit.
pub(crate) fn whole(about: &str, limit: &Limit) -> Value {
    let mut schema = number(about, limit);
    schema["multipleOf"] = json!(1);
    schema
}

/// A number from `min` to `max`.
pub(crate) fn between(about: &str, min: f64, max: f64) -> Value {
    json!({ "description": about, "type": "number", "minimum": min, "maximum": max })
}

/// Two numbers, each within `min` and `max`.
pub(crate) fn pair(about: &str, min: f64, max: f64) -> Value {
    let number = json!({ "type": "number", "minimum": min, "maximum": max });
    json!({ "description": about, "type": "array", "items": number, "minItems": 2, "maxItems": 2 })
}

/// One of some words.
pub(crate) fn word<'a>(about: &str, words: impl IntoIterator<Item = &'a str>) -> Value {
    json!({ "description": about, "enum": words.into_iter().collect::<Vec<_>>() })
}

/// A text that is not empty.
pub(crate) fn text(about: &str) -> Value {
    json!({ "description": about, "type": "string", "minLength": 1 })
}

/// True or false.
pub(crate) fn flag(about: &str) -> Value {
    json!({ "description": about, "type": "boolean" })
}

/// A name that becomes part of file names, of at most so many characters.
pub(crate) fn name(about: &str, most: u64) -> Value {
    json!({ "description": about, "type": "string", "pattern": "^[A-Za-z0-9_-]+$", "maxLength": most })
}

/// One line about something.
fn line(about: &str) -> Value {
    json!({ "description": about, "type": "string", "maxLength": 200 })
}
