//! What a program did wrong.

use std::io;

use grid::GridSpec;
use grid::npy::NpyError;
use thiserror::Error;

/// Why a program has given no map. Every message is one line: what, value, bound, what to do.
#[derive(Debug, Error)]
pub(super) enum Fault {
    /// It cannot be started.
    #[error("{program} cannot be started: {source}; check its path and permissions")]
    Start {
        /// The first word of the command.
        program: String,
        /// What the system reports.
        source: io::Error,
    },
    /// It took too long.
    #[error("no {what} within {seconds} s; the process was killed; make it faster, or raise --mapper-timeout")]
    TimeOut {
        /// What was waited for.
        what: &'static str,
        /// The longest time, s.
        seconds: f64,
    },
    /// It ended with another exit code than 0.
    #[error("exit code {0}: must be 0")]
    Exit(i32),
    /// A signal ended it.
    #[error("killed by signal {0}")]
    Signal(i32),
    /// It ended well, and there is no map.
    #[error("{file} was not written; write it into the folder that is the last argument")]
    NoFile {
        /// Name of the file.
        file: &'static str,
    },
    /// There is something else in the place of the map.
    #[error("{file} is no regular file; write the map itself there")]
    NoRegularFile {
        /// Name of the file.
        file: &'static str,
    },
    /// The map is larger than it can be.
    #[error("{file} holds {bytes} bytes: must be at most {most} for {} x {} cells; write float32 or float64", grid.height, grid.width)]
    TooLarge {
        /// Name of the file.
        file: &'static str,
        /// Its size.
        bytes: u64,
        /// The largest that can be a map of the grid.
        most: u64,
        /// The grid.
        grid: GridSpec,
    },
    /// The map has other rows or columns than the grid.
    #[error("the map is {found_height} x {found_width}: must be {} x {}, height x width as in the grid that was given", grid.height, grid.width)]
    Shape {
        /// Its rows.
        found_height: u64,
        /// Its columns.
        found_width: u64,
        /// The grid.
        grid: GridSpec,
    },
    /// The map cannot be read.
    #[error("{0}")]
    Array(#[from] NpyError),
    /// A value of a map that came over standard output.
    #[error("value [{row}, {column}] = {value}: must be from 0 to 1, or NaN")]
    Value {
        /// Row of the cell, 0 the lowest.
        row: usize,
        /// Column of the cell.
        column: usize,
        /// The value.
        value: f64,
    },
    /// The folder has grown too large.
    #[error("its folder holds {bytes} bytes more than it was given: must be at most {most}; write the map alone")]
    Disk {
        /// What it wrote.
        bytes: u64,
        /// The most that it may write.
        most: u64,
    },
    /// A line that announces no map.
    #[error("the line before a map is {line:?}: {problem}")]
    Header {
        /// The line, or its beginning.
        line: String,
        /// What is wrong with it.
        problem: String,
    },
    /// Standard output ended in the middle of an answer, or before it.
    #[error("standard output ended before a whole map was there")]
    Closed,
    /// Standard input was closed, so that no scan can be given.
    #[error("standard input was closed; read it up to its end")]
    Deaf,
    /// A map that nobody asked for.
    #[error("a map that was not asked for; answer lines of type \"map\" alone, each once")]
    Unasked,
    /// The system does not let us exchange files.
    #[error("{what}: {source}")]
    Exchange {
        /// What was to be done.
        what: String,
        /// What the system reports.
        source: io::Error,
    },
    /// Everything is being stopped.
    #[error("interrupted")]
    Interrupted,
}
