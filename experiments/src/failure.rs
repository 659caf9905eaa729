//! Why a command did not succeed.

use std::any::Any;
use std::path::Path;
use std::{fmt, io};

use thiserror::Error;

/// Why a command did not succeed.
#[derive(Debug, Error)]
pub enum Failure {
    /// The system, or a defect of ours.
    #[error("{0}")]
    Internal(String),
    /// Something the user can correct.
    #[error("{0}")]
    BadInput(String),
    /// Everything ran, and a claim does not hold.
    #[error("{0}")]
    Claim(String),
}

impl Failure {
    /// A file or folder that the system would not write.
    pub fn write(path: &Path, source: &io::Error) -> Self {
        Self::Internal(format!("{}: cannot be written: {source}", path.display()))
    }

    /// Anything that has gone wrong inside.
    pub fn internal(source: impl fmt::Display) -> Self {
        Self::Internal(source.to_string())
    }
}

/// What a panic said, if it said anything.
pub fn panic_text(panic: &(dyn Any + Send)) -> Option<&str> {
    panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied())
}

impl Failure {
    /// One failure of several: a line each, in the order of the file.
    pub fn of_all(mut errors: Vec<scene::SceneError>) -> Self {
        errors.sort_by_key(|error| error.place().map(|place| (place.line, place.column)));
        let all: Vec<Self> = errors.into_iter().map(Self::from).collect();
        let lines = all.iter().map(ToString::to_string).collect::<Vec<_>>().join("\nerror: ");
        match all.iter().any(|failure| matches!(failure, Self::Internal(_))) {
            true => Self::Internal(lines),
            false => Self::BadInput(lines),
        }
    }
}

impl From<Vec<scene::SceneError>> for Failure {
    fn from(errors: Vec<scene::SceneError>) -> Self {
        Self::of_all(errors)
    }
}

impl From<Vec<strict::Error>> for Failure {
    fn from(errors: Vec<strict::Error>) -> Self {
        Self::of_all(errors.into_iter().map(scene::SceneError::from).collect())
    }
}

impl From<strict::Error> for Failure {
    fn from(error: strict::Error) -> Self {
        scene::SceneError::from(error).into()
    }
}

impl From<scene::SceneError> for Failure {
    fn from(error: scene::SceneError) -> Self {
        match error.kind() {
            scene::ErrorKind::BadInput => Self::BadInput(error.to_string()),
            scene::ErrorKind::Io => Self::Internal(error.to_string()),
        }
    }
}

impl From<score::ScoreError> for Failure {
    fn from(error: score::ScoreError) -> Self {
        Self::internal(error)
    }
}
