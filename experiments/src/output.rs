//! What a command takes and leaves behind: options, folders, tables, records.

pub mod args;
pub mod digest;
pub mod folder;
pub mod ledger;
pub mod map;
pub mod publication;
pub mod record;
pub mod single;
pub mod table;

use std::fmt::Display;
use std::io::Write as _;

/// Prints what is suspicious to stderr, a line each.
pub fn warn(warnings: &[impl Display]) {
    warnings.iter().for_each(|warning| note(format_args!("warning: {warning}")));
}

/// Prints a line to stderr: nobody may be listening.
pub fn note(line: impl Display) {
    let _ = writeln!(std::io::stderr(), "{line}");
}
