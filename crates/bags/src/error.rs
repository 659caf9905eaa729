//! Why a bag is refused.

use std::io;

use thiserror::Error;

/// Why a bag is refused before its first message. Every message is one line: place, cause, what to do.
#[derive(Debug, Error)]
pub enum BagError {
    /// A file cannot be opened or read.
    #[error("{place}: cannot be read: {source}; check the path and the permissions")]
    Unreadable {
        /// The file.
        place: String,
        /// What the system reports.
        source: io::Error,
    },
    /// It is no bag, or of a form that is not read.
    #[error("{place}: {reason}")]
    Form {
        /// The file or folder.
        place: String,
        /// What it is and what to do.
        reason: String,
    },
}
