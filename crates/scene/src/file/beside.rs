//! Names of files beside a scene file.

use strict::{Error, Table, Value};

/// Longest name of a file, with its folders, in characters: messages repeat it.
const LONGEST: usize = 255;

/// The name under the key `file`, which must be `bound`.
pub(super) fn name<'a>(table: &Table, value: &'a Value<'a>, bound: &str) -> Result<&'a str, Error> {
    let fit = |s: &&str| !s.is_empty() && s.chars().count() <= LONGEST && !s.chars().any(char::is_control);
    let name = value.get_ref().as_str().filter(fit);
    name.ok_or_else(|| table.refuse("file", value, bound, "it is relative to the scene file"))
}
