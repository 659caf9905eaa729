//! Tables read strictly: every value is checked where it is taken, and every refusal has its line and column.

use toml::de::{DeTable, DeValue};

use crate::excerpt::{LONGEST_VALUE, excerpt};
use crate::likeness::{hint, nearest};
use crate::limit::Limit;
use crate::place::Place;
use crate::problem::{Error, Problem};
use crate::source::Source;
use crate::value::{Value, number};

/// One table of the file.
pub struct Table<'a> {
    source: &'a Source<'a>,
    element: String,
    offset: usize,
    entries: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    /// A table of the file; `element` is what messages call it.
    pub fn new(source: &'a Source<'a>, element: &str, offset: usize, entries: &'a DeTable<'a>) -> Self {
        Self { source, element: element.to_owned(), offset, entries }
    }

    /// The file that the table stands in.
    pub fn source(&self) -> &'a Source<'a> {
        self.source
    }

    /// What messages call the table.
    pub fn element(&self) -> String {
        self.element.clone()
    }

    /// Refuses keys that nothing reads.
    ///
    /// # Errors
    /// The first such key, with those known and the nearest.
    pub fn only(&self, known: &[&str]) -> Result<(), Error> {
        self.unknown(known).next().map_or(Ok(()), Err)
    }

    /// Every key that nothing reads, with those known and the nearest.
    pub fn unknown<'s>(&'s self, known: &'s [&str]) -> impl Iterator<Item = Error> + 's {
        let unknown = self.entries.iter().filter(|(key, _)| !known.contains(&key.get_ref().as_ref()));
        unknown.map(|(key, _)| {
            let problem = Problem::UnknownKey {
                element: self.element(),
                key: excerpt(key.get_ref(), LONGEST_VALUE),
                hint: hint(key.get_ref(), known),
                known: known.join(", "),
            };
            self.source.error(key.span().start, problem)
        })
    }

    /// Every key with the byte at which it begins, in the order of the file.
    pub fn keys(&self) -> impl Iterator<Item = (&'a str, usize)> {
        self.entries.iter().map(|(key, _)| (key.get_ref().as_ref(), key.span().start))
    }

    /// Every key with the text of its value.
    pub fn verbatim(&self) -> Vec<(String, String)> {
        let text = |value: &Value| self.source.verbatim(value.span()).to_owned();
        self.entries.iter().map(|(key, value)| (key.get_ref().to_string(), text(value))).collect()
    }

    /// The value of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<&'a Value<'a>> {
        self.entries.get(key)
    }

    /// Where the table begins.
    pub fn place(&self) -> Place {
        self.source.place(self.offset)
    }

    /// Where a key's value stands, or the table where there is none.
    pub fn place_of(&self, key: &str) -> Place {
        self.source.place(self.get(key).map_or(self.offset, |value| value.span().start))
    }

    /// A key that must be there and is not.
    pub fn missing(&self, key: &str, example: &str) -> Error {
        let problem = Problem::MissingKey { element: self.element(), key: key.to_owned(), example: example.to_owned() };
        self.source.error(self.offset, problem)
    }

    /// A refusal of a key's value, or of one part of it.
    pub fn refuse(&self, key: &str, value: &Value, bound: &str, remedy: &str) -> Error {
        let problem = Problem::Value {
            element: self.element(),
            key: key.to_owned(),
            value: self.source.excerpt(value.span()),
            bound: bound.to_owned(),
            remedy: remedy.to_owned(),
        };
        self.source.error(value.span().start, problem)
    }

    /// A sub-table such as `[camera]`.
    ///
    /// # Errors
    /// Something else under this key.
    pub fn section(&self, key: &str) -> Result<Option<Self>, Error> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let element = format!("[{key}]");
        match value.get_ref() {
            DeValue::Table(entries) => Ok(Some(Table::new(self.source, &element, value.span().start, entries))),
            _ => Err(self.refuse(key, value, "a table", &format!("write {element} and its keys below"))),
        }
    }

    /// The tables of an array such as `[[box]]`, numbered from 1.
    ///
    /// # Errors
    /// Something else under this key.
    pub fn list(&self, key: &str) -> Result<Vec<Self>, Error> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        let refused = |value| self.refuse(key, value, "a list of tables", &format!("write [[{key}]] above each"));
        let DeValue::Array(items) = value.get_ref() else { return Err(refused(value)) };
        let numbered = items.iter().enumerate().map(|(k, item)| match item.get_ref() {
            DeValue::Table(entries) => {
                Ok(Table::new(self.source, &format!("{key} {}", k + 1), item.span().start, entries))
            }
            _ => Err(refused(item)),
        });
        numbered.collect()
    }

    /// A number within its limit, if the key is there.
    ///
    /// # Errors
    /// Another type, or a value outside the limit.
    pub fn optional_number(&self, key: &str, limit: &Limit) -> Result<Option<f64>, Error> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let number = number(value).filter(|&v| limit.allows(v));
        number.map(Some).ok_or_else(|| self.refuse(key, value, limit.bound, limit.remedy))
    }

    /// A number within its limit.
    ///
    /// # Errors
    /// No such key; another type, or a value outside the limit.
    pub fn number(&self, key: &str, limit: &Limit) -> Result<f64, Error> {
        let missing = || self.missing(key, &format!("`{key} = ...`, {}", limit.bound));
        self.optional_number(key, limit)?.ok_or_else(missing)
    }

    /// A whole number within its limit, if the key is there.
    ///
    /// # Errors
    /// Another type, a fraction, or a value outside the limit.
    pub fn optional_whole(&self, key: &str, limit: &Limit) -> Result<Option<u64>, Error> {
        match (self.optional_number(key, limit)?, self.get(key)) {
            (Some(number), Some(value)) if number.fract() > 0.0 => {
                Err(self.refuse(key, value, limit.bound, limit.remedy))
            }
            (number, _) => Ok(number.map(|number| number as u64)),
        }
    }

    /// The one of the known words that a key's value, or one part of it, is.
    ///
    /// # Errors
    /// Anything else, with those known and the nearest.
    pub fn word<'k>(&self, key: &str, value: &Value, known: &[&'k str]) -> Result<&'k str, Error> {
        let text = value.get_ref().as_str().unwrap_or_default();
        known.iter().copied().find(|word| *word == text).ok_or_else(|| {
            let bound = format!("one of {}", known.join(", "));
            self.refuse(key, value, &bound, &format!("the nearest is \"{}\"", nearest(text, known.iter().copied())))
        })
    }

    /// Two numbers in a list, no more and no less, each within the limit.
    ///
    /// # Errors
    /// Anything else.
    pub fn pair(&self, key: &str, value: &Value, limit: &Limit) -> Result<[f64; 2], Error> {
        let numbers = value.get_ref().as_array().filter(|items| items.len() == 2);
        let pair = numbers.and_then(|items| Some([number(&items[0])?, number(&items[1])?]));
        let allowed = pair.filter(|pair| pair.iter().all(|&v| limit.allows(v)));
        allowed.ok_or_else(|| self.refuse(key, value, limit.bound, limit.remedy))
    }

    /// Two numbers in a list, each within the limit.
    ///
    /// # Errors
    /// No such key; anything else.
    pub fn required_pair(&self, key: &str, limit: &Limit) -> Result<[f64; 2], Error> {
        let missing = || self.missing(key, &format!("`{key} = [..., ...]`, {}", limit.bound));
        self.pair(key, self.get(key).ok_or_else(missing)?, limit)
    }

    /// Free text of one line, if the key is there.
    ///
    /// # Errors
    /// Another type, more than 200 characters, or control characters.
    pub fn text(&self, key: &str) -> Result<Option<String>, Error> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let line = value.get_ref().as_str().filter(|s| s.chars().count() <= 200 && !s.chars().any(char::is_control));
        let refused = || self.refuse(key, value, "one line of text, at most 200 characters", "write it in quotes");
        line.map(|s| Some(s.to_owned())).ok_or_else(refused)
    }

    /// True or false; false if not given.
    ///
    /// # Errors
    /// Anything else.
    pub fn flag(&self, key: &str) -> Result<bool, Error> {
        let Some(value) = self.get(key) else { return Ok(false) };
        let refused = || self.refuse(key, value, "true or false", "write it without quotes, or leave it out for false");
        value.get_ref().as_bool().ok_or_else(refused)
    }

    /// A name that can be part of a file name.
    ///
    /// # Errors
    /// No such key; anything else than 1 to 32 letters, digits, `-` or `_`.
    pub fn name(&self, key: &str) -> Result<String, Error> {
        let Some(value) = self.get(key) else { return Err(self.missing(key, &format!("`{key} = \"...\"`"))) };
        let fit = |s: &&str| {
            let plain = s.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
            plain && !s.is_empty() && s.len() <= 32
        };
        let refused =
            || self.refuse(key, value, "a name of 1 to 32 letters, digits, - or _", "it becomes part of file names");
        value.get_ref().as_str().filter(fit).map(str::to_owned).ok_or_else(refused)
    }

    /// A list of names, each with its own place; `what` they are, such as `waypoint names`, stands in messages.
    ///
    /// # Errors
    /// No such key; anything but a list of texts.
    pub fn strings(&self, key: &str, what: &str, example: &str) -> Result<Vec<(&'a str, &'a Value<'a>)>, Error> {
        let Some(value) = self.get(key) else { return Err(self.missing(key, &format!("`{key} = {example}`"))) };
        let remedy = format!("write it like {example}");
        let DeValue::Array(items) = value.get_ref() else {
            return Err(self.refuse(key, value, &format!("a list of {what}"), &remedy));
        };
        let names = items.iter().map(|item| {
            let refused = || self.refuse(key, item, &format!("a list of {what}, each in quotes"), &remedy);
            item.get_ref().as_str().map(|s| (s, item)).ok_or_else(refused)
        });
        names.collect()
    }
}
