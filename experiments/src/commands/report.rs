//! `report DIR`: the page of a folder of results, made anew.
//!
//! Numbers come from the folder. The maps that the page shows on the way are no files, so the worlds
//! shown are simulated again, and must give the numbers that stand in the folder.

mod compare;
mod room;
mod source;

use std::io::Write as _;

use self::source::Folder;
use crate::cli::ReportOptions;
use crate::failure::Failure;
use crate::output::folder::{self, RECORD};

/// Makes the page.
///
/// # Errors
/// A folder that no command of ours left, or whose numbers this program does not find again; I/O.
pub fn run(options: &ReportOptions) -> Result<(), Failure> {
    let folder = Folder { path: &options.folder };
    let record = folder.record()?;
    let html = match record["command"].as_str() {
        Some("room") => room::page(&folder, &record)?,
        Some("compare") => compare::page(&folder, &record)?,
        Some(other) => {
            let why = format!("the command {other:?} leaves no page; give a folder of 'room' or 'compare'");
            return Err(folder.refuse(RECORD, &why));
        }
        None => return Err(folder.refuse(RECORD, "names no command; give a folder that 'room' or 'compare' left")),
    };
    let out = options.out.clone().unwrap_or_else(|| options.folder.join("report.html"));
    folder::replace(&out, html.as_bytes())?;
    let _ = writeln!(std::io::stderr(), "{}", out.display());
    Ok(())
}
