//! `report DIR`: the page of a folder of results, made anew.
//!
//! Numbers come from the folder. The maps that the page shows on the way are no files, so the worlds
//! shown are simulated again, and must give the numbers that stand in the folder.

mod compare;
mod room;
mod source;

use std::io::Write as _;
use std::path::{Path, PathBuf};

use serde_json::Value;

use self::source::Folder;
use crate::cli::ReportOptions;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::output::folder::{Purpose, Staging, recover};
use crate::output::ledger::{Ledger, RECORD};
use crate::output::single::{self, Existing, Whole};

/// Makes the page.
///
/// # Errors
/// A folder that no command of ours left, or whose numbers this program does not find again; I/O.
pub fn run(options: &ReportOptions) -> Result<(), Failure> {
    interruption::watch();
    let folder = Folder { path: &options.folder };
    if folder.path.is_dir() {
        recover(folder.path)?;
    }
    let record = folder.record()?;
    let page: fn(&Folder, &Value) -> Result<String, Failure> = match record["command"].as_str() {
        Some("room") => room::page,
        Some("compare") => compare::page,
        Some(other) => {
            let why = format!("the command {other:?} leaves no page; give a folder of 'room' or 'compare'");
            return Err(folder.refuse(RECORD, &why));
        }
        None => return Err(folder.refuse(RECORD, "names no command; give a folder that 'room' or 'compare' left")),
    };
    if let Ledger::Foreign(why) = Ledger::read(folder.path) {
        return Err(folder.refuse(RECORD, &format!("{why}; run the command again, into another folder")));
    }
    let place = Place::of(options, &record)?;
    let out = place.write(page(&folder, &record)?)?;
    let _ = writeln!(std::io::stderr(), "{}", out.display());
    Ok(())
}

/// Where the page goes.
enum Place<'a> {
    /// Into the folder, whose record then lists it as it is now.
    Folder(Box<Staging>),
    /// Elsewhere.
    File { path: &'a Path, folder: &'a Path, existing: Existing },
}

const PAGE: &str = "report.html";

impl<'a> Place<'a> {
    /// # Errors
    /// A page that somebody else has put there, before any work.
    fn of(options: &'a ReportOptions, record: &Value) -> Result<Self, Failure> {
        if let Some(path) = &options.out {
            let existing = Existing::forced(options.force);
            let place = Self::File { path, folder: &options.folder, existing };
            single::refuse_read(path, &[&options.folder.join(RECORD)])?;
            return Ok(place);
        }
        // The page is the command's whose folder it is; it alone is made anew.
        let command = record["command"].as_str().unwrap_or_default();
        let purpose = Purpose::new(command, &[] as &[&Path], [PAGE]);
        Ok(Self::Folder(Box::new(Staging::amend(&options.folder, &purpose)?)))
    }

    fn write(self, html: String) -> Result<PathBuf, Failure> {
        match self {
            Self::Folder(mut staging) => {
                staging.write(PAGE, |out| out.write_all(html.as_bytes()))?;
                staging.record_again()?;
                let out = staging.folder().join(PAGE);
                staging.publish().map(|()| out)
            }
            Self::File { path, folder, existing } => {
                let read = folder.join(RECORD);
                single::put(&[Whole { path: path.to_owned(), bytes: html.into_bytes() }], &[&read], existing)?;
                Ok(path.to_owned())
            }
        }
    }
}
