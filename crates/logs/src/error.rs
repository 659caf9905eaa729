//! Why a log is refused.

use std::io;

use thiserror::Error;

use crate::bag::Contents;
use crate::report::Unit;

/// Why a log or a trajectory is refused. Every message is one line: place, value, bound, what to do.
#[derive(Debug, Error)]
pub enum LogError {
    /// The file cannot be opened.
    #[error("{place}: cannot be opened: {source}; check the path and the permissions")]
    Unreadable {
        /// The file.
        place: String,
        /// What the system reports.
        source: io::Error,
    },
    /// It is no bag that can be read.
    #[error(transparent)]
    Bag(bags::BagError),
    /// A bag does not hold what was asked for, or what is needed.
    #[error("{place}: {reason}")]
    Unusable {
        /// The bag.
        place: String,
        /// What is missing, what there is, and what to do.
        reason: String,
    },
    /// A bag holds more than one thing that could be meant.
    #[error("{place}: {reason}")]
    Undecided {
        /// The bag.
        place: String,
        /// Between what there is a choice.
        reason: String,
        /// All that it holds.
        contents: Box<Contents>,
    },
    /// It is a folder.
    #[error("{place}: is a folder; give one log")]
    Folder {
        /// The path.
        place: String,
    },
    /// It is no file, and a log is read more than once.
    #[error("{place}: is a pipe or a device, and a log is read more than once; save it to a file and give that")]
    Pipe {
        /// The path.
        place: String,
    },
    /// It is another kind of file.
    #[error("{place}: is {what}, not a log or a trajectory; {remedy}")]
    Foreign {
        /// The file.
        place: String,
        /// What it is.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// Reading came to an end before the log did: a disk's error, or compressed data that are cut or damaged.
    #[error(
        "{place}: cannot be read beyond line {line}: {source}; what stands before was read, get a whole copy of the file"
    )]
    Interrupted {
        /// The file.
        place: String,
        /// The last line that was read; 0 where none was.
        line: u64,
        /// What the system or the decoder reports.
        source: io::Error,
    },
    /// The rows of a table cannot be put together to scans.
    #[error("{place}:{line}: {reason}")]
    Table {
        /// The file.
        place: String,
        /// Line, from 1.
        line: u64,
        /// What is wrong and what to do.
        reason: String,
    },
    /// A trajectory has another clock than the log.
    #[error(
        "{place}: none of its {scans} scans lies in the time of the trajectory: the log goes from {:.3} to {:.3} s, the trajectory from \
         {:.3} to {:.3} s; it has another clock: add {:.3} s to its times if both begin together",
        log_s[0],
        log_s[1],
        trajectory_s[0],
        trajectory_s[1],
        log_s[0] - trajectory_s[0]
    )]
    Clocks {
        /// The log.
        place: String,
        /// Number of its scans.
        scans: u64,
        /// First and last time of the log, s.
        log_s: [f64; 2],
        /// First and last time of the trajectory, s.
        trajectory_s: [f64; 2],
    },
    /// The first line of a table does not name its columns as it must.
    #[error("{place}:{line}: {reason}")]
    Head {
        /// The file.
        place: String,
        /// Line, from 1.
        line: u64,
        /// What is wrong and what to do.
        reason: String,
    },
    /// Nothing in the file is a scan.
    #[error("{place}: no scan in {lines} {unit}s{reason}")]
    NoScan {
        /// The file.
        place: String,
        /// Number of lines or messages.
        lines: u64,
        /// What was counted.
        unit: Unit,
        /// The first problem, or what was skipped and what to do.
        reason: String,
    },
    /// Too many lines are damaged.
    #[error(
        "{place}{}{line}: {reason}; {damaged} of {lines} {unit}s are damaged, which is more than {} %; repair the log, or allow more",
        if *unit == Unit::Line { ":" } else { ", message " },
        share * 100.0
    )]
    Damaged {
        /// The file.
        place: String,
        /// The first damaged line, or message of a bag.
        line: u64,
        /// What was counted.
        unit: Unit,
        /// What is wrong with it.
        reason: String,
        /// Number of damaged lines or messages.
        damaged: u64,
        /// Number of all lines that are not blank, or of all messages.
        lines: u64,
        /// The share that is allowed, 0 to 1.
        share: f64,
    },
    /// An option has a value that makes no sense.
    #[error("option {name}: {value}: must be {bound}")]
    Option {
        /// The option.
        name: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        bound: &'static str,
    },
    /// A trajectory is not as it must be.
    #[error("{place}:{line}: {reason}")]
    Trajectory {
        /// The file.
        place: String,
        /// Line, from 1.
        line: u64,
        /// What is wrong and what to do.
        reason: String,
    },
    /// A trajectory was given for a table that has no times.
    #[error(
        "{place}: has no column time_s, so that a trajectory cannot give its poses; add the column, or leave the trajectory out"
    )]
    Untimed {
        /// The table.
        place: String,
    },
}
