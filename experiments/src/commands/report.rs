//! `report DIR`: the page of a folder of results, made anew.
//!
//! Numbers come from the folder. The maps that the page shows on the way are no files, so the command that left the
//! folder simulates the worlds shown again, and must find the numbers that stand in the folder.

use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use crate::failure::Failure;
use crate::output::folder::{self, RECORD};
use crate::output::note;
use crate::page::Folder;

/// Options of `report`.
#[derive(Debug, Args)]
pub struct ReportOptions {
    /// Folder that `room` or `compare` left
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Page to write [default: report.html in the folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Makes the page of a folder anew, from the folder and its record.
pub type Renewal = fn(&Folder, &Value) -> Result<String, Failure>;

/// Makes the page; `pages` are the commands that leave one, by name.
///
/// # Errors
/// A folder that no command of ours left, or whose numbers this program does not find again; I/O.
pub fn run(options: &ReportOptions, pages: &[(&str, Renewal)]) -> Result<(), Failure> {
    let folder = Folder { path: &options.folder };
    let record = folder.record()?;
    let Some(command) = record["command"].as_str() else {
        return Err(folder.refuse(RECORD, "names no command; give a folder that 'room' or 'compare' left"));
    };
    let Some((_, renewed)) = pages.iter().find(|(name, _)| *name == command) else {
        let why = format!("the command {command:?} leaves no page; give a folder of 'room' or 'compare'");
        return Err(folder.refuse(RECORD, &why));
    };
    let html = renewed(&folder, &record)?;
    let out = options.out.clone().unwrap_or_else(|| options.folder.join("report.html"));
    folder::replace(&out, html.as_bytes())?;
    note(out.display());
    Ok(())
}
