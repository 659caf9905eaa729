//! All that is wrong with a file, not only the first of it.

use crate::place::Place;
use crate::problem::{Error, Problem};
use crate::table::Table;

/// An error of a reader, or of one that is built on it.
pub trait Finding: From<Error> {
    /// What is wrong with the content of the file, where it is this crate that says so.
    fn problem(&self) -> Option<&Problem>;

    /// Where it is, unless the file cannot be read at all.
    fn place(&self) -> Option<&Place>;
}

impl Finding for Error {
    fn problem(&self) -> Option<&Problem> {
        match self {
            Self::Invalid { problem, .. } => Some(problem),
            Self::Unreadable { .. } => None,
        }
    }

    fn place(&self) -> Option<&Place> {
        match self {
            Self::Invalid { place, .. } => Some(place),
            Self::Unreadable { .. } => None,
        }
    }
}

/// What was found wrong so far, in the order in which a file is read.
///
/// ```
/// use strict::{Error, Findings, Limit, Table, open};
/// const WIDTH: Limit = Limit { min: 0.1, max: 10.0, bound: "a width in m, 0.1 to 10", remedy: "give a width such as 0.9" };
/// let (source, document) = open("width = 90\nheigth = 2\n", "door.toml")?;
/// let door = Table::new(&source, "the door", 0, document.get_ref());
/// let mut found: Findings<Error> = Findings::default();
/// found.only(&door, &["width", "height"]);
/// let size = (found.take(door.number("width", &WIDTH)), found.take(door.number("height", &WIDTH)));
/// let wrong = found.or(Some(size)).expect_err("two mistakes");
/// assert_eq!(wrong.len(), 2, "a height that is misspelt is not missing too");
/// # Ok::<(), strict::Error>(())
/// ```
#[derive(Debug)]
pub struct Findings<E>(Vec<E>);

impl<E> Default for Findings<E> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<E: Finding> Findings<E> {
    /// A value, or nothing where there is none; what is wrong is kept.
    pub fn take<T>(&mut self, result: Result<T, impl Into<E>>) -> Option<T> {
        result.map_err(|error| self.0.push(error.into())).ok()
    }

    /// Keeps every key that nothing reads.
    pub fn only(&mut self, table: &Table, known: &[&str]) {
        self.0.extend(table.unknown(known).map(E::from));
    }

    /// Keeps one more.
    pub fn add(&mut self, error: impl Into<E>) {
        self.0.push(error.into());
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.len()
    }

    /// The value, if nothing is wrong; else all that is, without what follows from something else: a key that is missing because
    /// its name is misspelt.
    ///
    /// # Errors
    /// All that is wrong, in the order in which it was found.
    pub fn or<T>(mut self, value: Option<T>) -> Result<T, Vec<E>> {
        let misspelt: Vec<(String, String)> = self.0.iter().filter_map(misspelt).collect();
        self.0.retain(|error| !missing(error).is_some_and(|key| misspelt.iter().any(|(e, k)| (&**e, &**k) == key)));
        value.filter(|_| self.0.is_empty()).ok_or(self.0)
    }
}

/// The first of what is wrong, of which there is something.
pub fn first<E>(mut errors: Vec<E>) -> E {
    errors.swap_remove(0)
}

/// The table of an unknown key, and the known key that it is nearly called like.
fn misspelt(error: &impl Finding) -> Option<(String, String)> {
    match error.problem()? {
        Problem::UnknownKey { element, hint, .. } => Some((element.clone(), hint.split('`').nth(1)?.to_owned())),
        _ => None,
    }
}

/// The table and the name of a missing key.
fn missing(error: &impl Finding) -> Option<(&str, &str)> {
    match error.problem()? {
        Problem::MissingKey { element, key, .. } => Some((element, key.trim_matches(['[', ']']))),
        _ => None,
    }
}
