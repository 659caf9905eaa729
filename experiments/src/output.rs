//! What a command takes and leaves behind: options, folders, tables, records.

pub mod args;
pub mod browser;
pub mod digest;
pub mod folder;
pub mod ledger;
pub mod loudness;
pub mod map;
pub mod marks;
pub mod paint;
pub mod publication;
pub mod record;
pub mod recording;
pub mod screen;
pub mod single;
pub mod table;

use std::fmt::Display;
use std::io::Write as _;

use self::loudness::Loudness;

/// Prints what is suspicious to stderr, a line each.
pub fn warn(warnings: &[impl Display]) {
    warnings.iter().for_each(|warning| note(format_args!("warning: {warning}")));
}

/// Prints a line to stderr with `--verbose` alone.
pub fn detail(line: impl Display) {
    if loudness::says(Loudness::Verbose) {
        note(line);
    }
}

/// Prints a line to stderr, in a terminal as several that end between words: nobody may be listening. With `--quiet`, errors and
/// warnings alone are printed.
pub fn note(line: impl Display) {
    let line = line.to_string();
    if loudness::says(Loudness::Usual) || ["error:", "warning:"].iter().any(|head| line.starts_with(head)) {
        tell(&line);
    }
}

/// As [`note`], however little is to be said.
pub fn tell(line: &str) {
    let line = screen::fitted(line, screen::width_of_notes());
    let headed =
        ["error", "warning"].into_iter().find_map(|word| Some((word, line.strip_prefix(word)?.strip_prefix(':')?)));
    let shown = headed.map(|(word, rest)| format!("{}{rest}", paint::heading(word)));
    let _ = writeln!(anstream::stderr(), "{}", shown.unwrap_or(line));
}
