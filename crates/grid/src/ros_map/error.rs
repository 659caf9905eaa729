//! What can be wrong with a map's files.

use std::io;
use std::path::{Path, PathBuf};

use strict::{Place, excerpt};
use thiserror::Error;

/// Why a map cannot be read. Every message is one line: place, value, bound, what to do.
#[derive(Debug, Error)]
pub enum RosMapError {
    /// A file cannot be opened or read.
    #[error("{}: cannot be read: {source}; check the path and the permissions", shown(path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system reports.
        source: io::Error,
    },
    /// The description is no text, or far too long.
    #[error("{}: is not a map description: {problem}; give the YAML file, not the image", shown(path))]
    NotADescription {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: String,
    },
    /// The description is not YAML, or a value has the wrong form.
    #[error("{place}: {problem}; {remedy}")]
    Syntax {
        /// Where.
        place: Place,
        /// What the parser reports.
        problem: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A key is not there.
    #[error("{}: the key `{key}` is missing; add {example}", shown(path))]
    MissingKey {
        /// The description.
        path: PathBuf,
        /// The key.
        key: &'static str,
        /// A line to add.
        example: &'static str,
    },
    /// A value is out of its range.
    #[error("{place}: {key} = {value}: must be {bound}; {remedy}")]
    Value {
        /// Where.
        place: Place,
        /// The key.
        key: &'static str,
        /// The value, as it stands in the file.
        value: String,
        /// What it must be.
        bound: Box<str>,
        /// What to do.
        remedy: Box<str>,
    },
    /// The image is neither where the description says nor beside it.
    #[error("{place}: image = {value}: no such file, tried {}; {remedy}", listed(tried))]
    NoImage {
        /// Where it is named.
        place: Place,
        /// The name in the description.
        value: String,
        /// Where it was looked for.
        tried: Vec<PathBuf>,
        /// What to do.
        remedy: &'static str,
    },
    /// The image is damaged or of a kind that is not read.
    #[error(
        "{}{}: cannot be read as a PGM or PNG image: {problem}; save the map again or convert it to one of the two",
        shown(path),
        within(at)
    )]
    DamagedImage {
        /// The image.
        path: PathBuf,
        /// Line and column, each from 1, in the text of a netpbm image.
        at: Option<(usize, usize)>,
        /// What the decoder reports.
        problem: String,
    },
    /// The image has no pixels, or too many.
    #[error(
        "{}: {width} x {height} pixels: must be at least 1 and at most {limit} in all; save the map again, cropped or with larger pixels",
        shown(path)
    )]
    ImageSize {
        /// The image.
        path: PathBuf,
        /// Pixels along x.
        width: u32,
        /// Pixels along y.
        height: u32,
        /// The largest number of pixels.
        limit: u64,
    },
}

impl RosMapError {
    /// Whether the system, not the content of the files, is at fault.
    pub fn is_io(&self) -> bool {
        matches!(self, Self::Unreadable { .. })
    }
}

fn within(at: &Option<(usize, usize)>) -> String {
    at.map(|(line, column)| format!(":{line}:{column}")).unwrap_or_default()
}

fn listed(paths: &[PathBuf]) -> String {
    paths.iter().map(|path| shown(path)).collect::<Vec<_>>().join(" and ")
}

/// A path on one line: the name of an image is what the file says.
fn shown(path: &Path) -> String {
    excerpt(&path.display().to_string(), usize::MAX)
}
