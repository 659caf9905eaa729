//! Where in a file something stands.

use std::fmt;

use crate::excerpt::excerpt;

/// A place in a text file; printed as `FILE:LINE:COLUMN`, on one line whatever the file's name is.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// The file as the caller named it.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Character within the line, from 1.
    pub column: usize,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", excerpt(&self.file, usize::MAX), self.line, self.column)
    }
}
