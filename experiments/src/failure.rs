//! Why a command did not succeed, and its exit code.

use std::any::Any;
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::{fmt, io};

use thiserror::Error;

use crate::interruption;

/// Why a command did not succeed.
#[derive(Debug, Error)]
pub enum Failure {
    /// Exit code 1: the system, or a defect of ours.
    #[error("{0}")]
    Internal(String),
    /// Exit code 2: something the user can correct.
    #[error("{0}")]
    BadInput(String),
    /// Exit code 3: everything ran, and a claim does not hold.
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

    /// Prints the message to stderr and gives the exit code.
    pub fn report(&self) -> ExitCode {
        if let Some(code) = interruption::exit_code() {
            return ExitCode::from(code);
        }
        // Nobody may be listening any more.
        let _ = writeln!(io::stderr(), "error: {self}");
        ExitCode::from(match self {
            Self::Internal(_) => 1,
            Self::BadInput(_) => 2,
            Self::Claim(_) => 3,
        })
    }
}

/// Prints what is suspicious to stderr, a line each.
pub fn warn(warnings: &[impl fmt::Display]) {
    for warning in warnings {
        // Nobody may be listening any more.
        let _ = writeln!(io::stderr(), "warning: {warning}");
    }
}

/// Prints a line to stderr, where stdout holds something else.
pub fn note(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// What a panic said, if it said anything.
pub fn panic_text(panic: &(dyn Any + Send)) -> Option<&str> {
    panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied())
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
