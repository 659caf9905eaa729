//! TOML tables read strictly: every value is checked where it is taken, and every refusal knows its line and column.

use grid::excerpt::{LONGEST_VALUE, excerpt};
use toml::de::{DeTable, DeValue};

use crate::{Place, Problem, SceneError};

/// Coordinates and lengths stay below this, m: doubles then resolve a tenth of a nanometre.
pub(super) const METRES: f64 = 1e6;

/// Longest name of a file, with its folders, in characters.
const LONGEST_FILE: usize = 255;

/// No name that is known is as long: the time and the memory that likeness takes grow with the length, in characters.
const LONGEST_LIKE: usize = 64;

/// A range that a number must lie in.
pub struct Limit {
    /// Least value.
    pub min: f64,
    /// Greatest value.
    pub max: f64,
    /// What the value must be, with its unit and range.
    pub bound: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

impl Limit {
    /// Whether a value lies in the range; what is no number does not.
    pub fn allows(&self, value: f64) -> bool {
        self.min <= value && value <= self.max
    }
}

/// A file's text, to turn offsets into places.
pub struct Source<'a> {
    file: &'a str,
    text: &'a str,
    /// Offset at which each line begins: a scene of a hundred thousand boxes asks for as many lines.
    lines: Vec<usize>,
}

impl<'a> Source<'a> {
    pub(super) fn new(file: &'a str, text: &'a str) -> Self {
        let lines = std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect();
        Self { file, text, lines }
    }

    pub(super) fn place(&self, offset: usize) -> Place {
        let mut offset = offset.min(self.text.len());
        while !self.text.is_char_boundary(offset) {
            offset -= 1;
        }
        let line = self.lines.partition_point(|&start| start <= offset);
        let column = self.text[self.lines[line - 1]..offset].chars().count() + 1;
        Place { file: self.file.to_owned(), line, column }
    }

    pub(super) fn error(&self, offset: usize, problem: Problem) -> SceneError {
        SceneError::Invalid { place: self.place(offset), problem: Box::new(problem) }
    }

    /// The text of a value on one line, cut where it is long.
    fn excerpt(&self, span: std::ops::Range<usize>) -> String {
        let words: Vec<&str> = self.text.get(span).unwrap_or_default().split_whitespace().collect();
        excerpt(&words.join(" "), LONGEST_VALUE)
    }
}

/// A value with its place in the text.
pub type Value<'a> = toml::Spanned<DeValue<'a>>;

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

    pub(super) fn source(&self) -> &'a Source<'a> {
        self.source
    }

    pub(super) fn element(&self) -> String {
        self.element.clone()
    }

    pub(super) fn line(&self) -> usize {
        self.source.place(self.offset).line
    }

    /// Refuses keys that nothing reads.
    ///
    /// # Errors
    /// The first such key, with those known and the nearest.
    pub fn only(&self, known: &[&str]) -> Result<(), SceneError> {
        let unknown = self.entries.iter().find(|(key, _)| !known.contains(&key.get_ref().as_ref()));
        let Some((key, _)) = unknown else { return Ok(()) };
        let problem = Problem::UnknownKey {
            element: self.element(),
            key: excerpt(key.get_ref(), LONGEST_VALUE),
            hint: hint(key.get_ref(), known),
            known: known.join(", "),
        };
        Err(self.source.error(key.span().start, problem))
    }

    pub(super) fn keys(&self) -> impl Iterator<Item = (&'a str, usize)> {
        self.entries.iter().map(|(key, _)| (key.get_ref().as_ref(), key.span().start))
    }

    /// Every key with the text of its value.
    pub(super) fn verbatim(&self) -> Vec<(String, String)> {
        let text = |value: &Value| self.source.text.get(value.span()).unwrap_or_default().to_owned();
        self.entries.iter().map(|(key, value)| (key.get_ref().to_string(), text(value))).collect()
    }

    /// The value of a key, if it is there.
    pub fn get(&self, key: &str) -> Option<&'a Value<'a>> {
        self.entries.get(key)
    }

    /// Where a key's value stands, or the table where there is none.
    pub(super) fn offset_of(&self, key: &str) -> usize {
        self.get(key).map_or(self.offset, |value| value.span().start)
    }

    /// A problem with the table as a whole.
    pub(super) fn error(&self, problem: Problem) -> SceneError {
        self.source.error(self.offset, problem)
    }

    /// A key that must be there and is not.
    pub fn missing(&self, key: &str, example: &str) -> SceneError {
        self.error(Problem::MissingKey { element: self.element(), key: key.to_owned(), example: example.to_owned() })
    }

    /// A refusal of a key's value, or of one part of it.
    pub fn refuse(&self, key: &str, value: &Value, bound: &str, remedy: &str) -> SceneError {
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
    pub fn section(&self, key: &str) -> Result<Option<Self>, SceneError> {
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
    pub fn list(&self, key: &str) -> Result<Vec<Self>, SceneError> {
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
    pub fn optional_number(&self, key: &str, limit: &Limit) -> Result<Option<f64>, SceneError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let number = number(value).filter(|&v| limit.allows(v));
        number.map(Some).ok_or_else(|| self.refuse(key, value, limit.bound, limit.remedy))
    }

    /// A number within its limit.
    ///
    /// # Errors
    /// No such key; another type, or a value outside the limit.
    pub fn number(&self, key: &str, limit: &Limit) -> Result<f64, SceneError> {
        let missing = || self.missing(key, &format!("`{key} = ...`, {}", limit.bound));
        self.optional_number(key, limit)?.ok_or_else(missing)
    }

    /// A whole number within its limit, if the key is there.
    ///
    /// # Errors
    /// Another type, a fraction, or a value outside the limit.
    pub fn optional_whole(&self, key: &str, limit: &Limit) -> Result<Option<u64>, SceneError> {
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
    pub fn word<'k>(&self, key: &str, value: &Value, known: &[&'k str]) -> Result<&'k str, SceneError> {
        let text = value.get_ref().as_str().unwrap_or_default();
        known.iter().copied().find(|word| *word == text).ok_or_else(|| {
            let bound = format!("one of {}", known.join(", "));
            self.refuse(key, value, &bound, &format!("the nearest is \"{}\"", nearest(text, known.iter().copied())))
        })
    }

    /// Two numbers in a list, no more and no less.
    pub(super) fn pair(&self, key: &str, value: &Value, limit: &Limit) -> Result<[f64; 2], SceneError> {
        let numbers = value.get_ref().as_array().filter(|items| items.len() == 2);
        let pair = numbers.and_then(|items| Some([number(&items[0])?, number(&items[1])?]));
        let allowed = pair.filter(|pair| pair.iter().all(|&v| limit.allows(v)));
        allowed.ok_or_else(|| self.refuse(key, value, limit.bound, limit.remedy))
    }

    pub(super) fn required_pair(&self, key: &str, limit: &Limit) -> Result<[f64; 2], SceneError> {
        let missing = || self.missing(key, &format!("`{key} = [..., ...]`, {}", limit.bound));
        self.pair(key, self.get(key).ok_or_else(missing)?, limit)
    }

    pub(super) fn point(&self, key: &str) -> Result<[f64; 2], SceneError> {
        self.required_pair(key, &POINT)
    }

    /// Refuses a rectangle whose `max` does not exceed its `min`, at the key of `max`.
    pub(super) fn ordered(&self, key: &str, [min, max]: [[f64; 2]; 2]) -> Result<(), SceneError> {
        const SMALLEST_M: f64 = 1e-6;
        if (0..2).all(|k| max[k] - min[k] >= SMALLEST_M) {
            return Ok(());
        }
        let value = self.get(key).ok_or_else(|| self.missing(key, "the upper-right corner"))?;
        let bound = format!("to the right of and above min = [{}, {}]", min[0], min[1]);
        Err(self.refuse(key, value, &bound, "min is the lower-left, max the upper-right corner, in m"))
    }

    /// Free text of one line.
    pub(super) fn text(&self, key: &str) -> Result<Option<String>, SceneError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let line = value.get_ref().as_str().filter(|s| s.chars().count() <= 200 && !s.chars().any(char::is_control));
        let refused = || self.refuse(key, value, "one line of text, at most 200 characters", "write it in quotes");
        line.map(|s| Some(s.to_owned())).ok_or_else(refused)
    }

    /// True or false; false if not given.
    pub(super) fn flag(&self, key: &str) -> Result<bool, SceneError> {
        let Some(value) = self.get(key) else { return Ok(false) };
        let refused = || self.refuse(key, value, "true or false", "write it without quotes, or leave it out for false");
        value.get_ref().as_bool().ok_or_else(refused)
    }

    /// A name that can be part of a file name.
    ///
    /// # Errors
    /// No such key; anything else than 1 to 32 letters, digits, `-` or `_`.
    pub fn name(&self, key: &str) -> Result<String, SceneError> {
        let Some(value) = self.get(key) else { return Err(self.missing(key, &format!("`{key} = \"...\"`"))) };
        let fit = |s: &&str| {
            let plain = s.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
            plain && !s.is_empty() && s.len() <= 32
        };
        let refused =
            || self.refuse(key, value, "a name of 1 to 32 letters, digits, - or _", "it becomes part of file names");
        value.get_ref().as_str().filter(fit).map(str::to_owned).ok_or_else(refused)
    }

    /// The name of a file, which messages repeat.
    pub(super) fn file(&self, value: &'a Value<'a>, bound: &str) -> Result<&'a str, SceneError> {
        let fit = |s: &&str| !s.is_empty() && s.chars().count() <= LONGEST_FILE && !s.chars().any(char::is_control);
        let name = value.get_ref().as_str().filter(fit);
        name.ok_or_else(|| self.refuse("file", value, bound, "it is relative to the scene file"))
    }

    /// A list of names, each with its own place.
    pub(super) fn strings(&self, key: &str, example: &str) -> Result<Vec<(&'a str, &'a Value<'a>)>, SceneError> {
        let Some(value) = self.get(key) else { return Err(self.missing(key, &format!("`{key} = {example}`"))) };
        let remedy = format!("write it like {example}");
        let refused = |value, bound| self.refuse(key, value, bound, &remedy);
        let DeValue::Array(items) = value.get_ref() else { return Err(refused(value, "a list of waypoint names")) };
        let names = items.iter().map(|item| {
            let name = item.get_ref().as_str();
            name.map(|s| (s, item)).ok_or_else(|| refused(item, "a list of waypoint names, each in quotes"))
        });
        names.collect()
    }
}

pub(super) const POINT: Limit = Limit {
    min: -METRES,
    max: METRES,
    bound: "a point [x, y] in m, two numbers of at most 1000000 in size",
    remedy: "write it like [1.0, 2.5]",
};

/// A TOML number; `None` for other types and for what no double holds.
pub fn number(value: &Value) -> Option<f64> {
    match value.get_ref() {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) => i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|v| v as f64),
        _ => None,
    }
}

/// The known name that is most like what was written; nothing if none is known.
pub fn nearest<'k>(name: &str, known: impl IntoIterator<Item = &'k str>) -> &'k str {
    let name: String = name.chars().take(LONGEST_LIKE).collect();
    let likeness = |known: &str| strsim::normalized_damerau_levenshtein(known, &name);
    known.into_iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).unwrap_or_default()
}

/// ` (did you mean ...?)` where a known name is near.
pub(super) fn hint(name: &str, known: &[&str]) -> String {
    let letters = name.chars().take(LONGEST_LIKE + 1).count();
    if letters > LONGEST_LIKE {
        return String::new();
    }
    let away = |candidate: &str| strsim::damerau_levenshtein(&name.to_lowercase(), &candidate.to_lowercase());
    // A third of the letters may be wrong; of one or two letters, none or one.
    let most = (1 + letters / 3).min(letters.saturating_sub(1));
    let nearest = known.iter().filter(|_| letters > 0).min_by_key(|c| away(c)).filter(|c| away(c) <= most);
    nearest.map(|c| format!(" (did you mean `{c}`?)")).unwrap_or_default()
}
