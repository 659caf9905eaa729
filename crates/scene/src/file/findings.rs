//! All that is wrong with a file, not only the first of it.

use strict::Table;

use crate::{Problem, SceneError};

/// What was found wrong so far, in the order in which a file is read.
#[derive(Debug, Default)]
pub(super) struct Findings(Vec<SceneError>);

impl Findings {
    /// A value, or nothing where there is none; what is wrong is kept.
    pub(super) fn take<T>(&mut self, result: Result<T, impl Into<SceneError>>) -> Option<T> {
        result.map_err(|error| self.0.push(error.into())).ok()
    }

    /// Keeps every key that nothing reads.
    pub(super) fn only(&mut self, table: &Table, known: &[&str]) {
        self.0.extend(table.unknown(known).map(SceneError::from));
    }

    /// Keeps one more.
    pub(super) fn add(&mut self, error: impl Into<SceneError>) {
        self.0.push(error.into());
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.0.len()
    }

    /// The value, if nothing is wrong; else all that is, without what follows from something else: a key that is missing because
    /// its name is misspelt.
    pub(super) fn or<T>(mut self, value: Option<T>) -> Result<T, Vec<SceneError>> {
        let misspelt: Vec<(String, String)> = self.0.iter().filter_map(misspelt).collect();
        self.0.retain(|error| !missing(error).is_some_and(|key| misspelt.iter().any(|(e, k)| (&**e, &**k) == key)));
        value.filter(|_| self.0.is_empty()).ok_or(self.0)
    }
}

/// The first of what is wrong.
pub(super) fn first(mut errors: Vec<SceneError>) -> SceneError {
    errors.swap_remove(0)
}

fn problem(error: &SceneError) -> Option<&strict::Problem> {
    match error {
        SceneError::Invalid { problem, .. } => match &**problem {
            Problem::File(problem) => Some(problem),
            _ => None,
        },
        SceneError::Unreadable { .. } => None,
    }
}

/// The table of an unknown key, and the known key that it is nearly called like.
fn misspelt(error: &SceneError) -> Option<(String, String)> {
    match problem(error)? {
        strict::Problem::UnknownKey { element, hint, .. } => {
            Some((element.clone(), hint.split('`').nth(1)?.to_owned()))
        }
        _ => None,
    }
}

/// The table and the name of a missing key.
fn missing(error: &SceneError) -> Option<(&str, &str)> {
    match problem(error)? {
        strict::Problem::MissingKey { element, key, .. } => Some((element, key.trim_matches(['[', ']']))),
        _ => None,
    }
}
