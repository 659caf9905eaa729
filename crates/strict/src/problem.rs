//! What can be wrong with a file.

use std::io;

use thiserror::Error;

use crate::place::Place;

/// Why a file cannot be used. Every message is one line: place, value, bound, what to do.
#[derive(Debug, Error)]
pub enum Error {
    /// The file cannot be opened or read.
    #[error("{file}: cannot be read: {source}; check the path and the permissions")]
    Unreadable {
        /// The file as the caller named it.
        file: String,
        /// What the system reports.
        source: io::Error,
    },
    /// The file's content is wrong.
    #[error("{place}: {problem}")]
    Invalid {
        /// Where.
        place: Place,
        /// What is wrong.
        problem: Box<Problem>,
    },
}

/// What is wrong with the content of a file. `element` names its part, such as `box 3`.
#[derive(Debug, Error)]
#[allow(missing_docs)] // The messages explain the fields.
pub enum Problem {
    /// Not a text file.
    #[error("{0}; must be a TOML text of at most 16 MiB in UTF-8")]
    NotText(String),
    /// Not TOML.
    #[error("no valid TOML: {0}")]
    Syntax(String),
    /// A file that another command reads.
    #[error("is {what}, not the TOML text that is asked for; {remedy}")]
    Foreign { what: &'static str, remedy: &'static str },
    /// A key that nothing reads.
    #[error("{element}: unknown key `{key}`{hint}; known keys: {known}")]
    UnknownKey { element: String, key: String, hint: String, known: String },
    /// A key that must be there.
    #[error("{element}: `{key}` is missing; add {example}")]
    MissingKey { element: String, key: String, example: String },
    /// A value of the wrong type or outside its range.
    #[error("{element}: {key} = {value}: must be {bound}; {remedy}")]
    Value { element: String, key: String, value: String, bound: String, remedy: String },
}

/// What an error comes from, for exit codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ErrorKind {
    /// A name or a content that the user can correct.
    BadInput,
    /// The system could not read a file that is there.
    Io,
}

impl Error {
    /// What the error comes from.
    pub fn kind(&self) -> ErrorKind {
        match self {
            Self::Unreadable { source, .. } => ErrorKind::of(source),
            Self::Invalid { .. } => ErrorKind::BadInput,
        }
    }
}

impl ErrorKind {
    /// A wrong name is the user's fault, a refusal the system's.
    pub fn of(source: &io::Error) -> Self {
        let named_wrong = [io::ErrorKind::NotFound, io::ErrorKind::IsADirectory, io::ErrorKind::NotADirectory];
        if named_wrong.contains(&source.kind()) { Self::BadInput } else { Self::Io }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_name_is_the_users_a_refusal_the_systems() {
        let error = |kind: io::ErrorKind| Error::Unreadable { file: "s.toml".to_owned(), source: kind.into() };
        assert_eq!(error(io::ErrorKind::NotFound).kind(), ErrorKind::BadInput);
        assert_eq!(error(io::ErrorKind::PermissionDenied).kind(), ErrorKind::Io);
    }
}
