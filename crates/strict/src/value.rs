//! Values of a file.

use toml::de::DeValue;

/// A value with its place in the text.
pub type Value<'a> = toml::Spanned<DeValue<'a>>;

/// A TOML number; `None` for other types and for what no double holds.
pub fn number(value: &Value) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|v| v as f64),
        _ => None,
    }
}
