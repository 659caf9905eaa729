//! `report DIR`: the page of a folder of results, made anew.
//!
//! Numbers come from the folder. The maps that a page of worlds shows on the way are no files, so the command that left the
//! folder simulates the worlds shown again, and must find the numbers that stand in the folder.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::Value;

use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::progress::Doing;
use crate::output::args::OpenOption;
use crate::output::folder::{Purpose, Staging, recover};
use crate::output::ledger::{Ledger, RECORD};
use crate::output::note;
use crate::output::single::{self, Existing, Whole};
use crate::page::Folder;

/// Options of `report`.
#[derive(Debug, Args)]
pub struct ReportOptions {
    /// Folder that `room`, `compare` or `score` left
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Page to write [default: report.html in the folder]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the page if it is there already
    #[arg(long, requires = "out")]
    pub force: bool,
    /// Whether the page is shown
    #[command(flatten)]
    pub open: OpenOption,
}

/// Makes the page of a folder anew, from the folder and its record.
pub type Renewal = fn(&Folder, &Value) -> Result<String, Failure>;

/// Makes the page; `pages` are the commands that leave one, by name.
///
/// # Errors
/// A folder that no command of ours left, or whose numbers this program does not find again; I/O.
pub fn run(options: &ReportOptions, pages: &[(&str, Renewal)]) -> Result<(), Failure> {
    interruption::watch();
    let folder = Folder { path: &options.folder };
    if folder.path.is_dir() {
        recover(folder.path)?;
    }
    let record = folder.record()?;
    let Some(command) = record["command"].as_str() else {
        return Err(folder.refuse(RECORD, "names no command; give a folder that 'room', 'compare' or 'score' left"));
    };
    let Some((_, renewed)) = pages.iter().find(|(name, _)| *name == command) else {
        let why = format!("the command {command:?} leaves no page; give a folder of 'room', 'compare' or 'score'");
        return Err(folder.refuse(RECORD, &why));
    };
    if let Ledger::Foreign(why) = Ledger::read(folder.path) {
        return Err(folder.refuse(RECORD, &format!("{why}; run the command again, into another folder")));
    }
    let place = Place::of(options, &record)?;
    let doing = Doing::new("mapping the worlds that the page shows, and drawing it");
    let out = place.write(renewed(&folder, &record)?)?;
    drop(doing);
    note(out.display());
    options.open.show(&out);
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
