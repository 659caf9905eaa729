//! What is wrong, as an exception.

use experiments::failure::Failure;
use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};

/// What a user can correct is a `ValueError`, with the message of the command line.
pub(crate) fn of_failure(failure: Failure) -> PyErr {
    let text = failure.to_string();
    match failure {
        Failure::BadInput(_) | Failure::Claim(_) => PyValueError::new_err(text),
        Failure::Internal(_) => PyRuntimeError::new_err(text),
    }
}

/// A value that makes no sense.
pub(crate) fn bad(text: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(text.to_string())
}

/// A file that the system does not give or take.
pub(crate) fn system(text: impl std::fmt::Display) -> PyErr {
    PyOSError::new_err(text.to_string())
}
