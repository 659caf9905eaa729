//! `--mapper` and `--mapper-timeout`.

use std::path::Path;
use std::time::Duration;

use clap::Args;
use mapper::catalogue::Entry;
use serde::{Deserialize, Serialize};

use super::program::Program;
use crate::failure::Failure;
use crate::output::args::number;
use crate::output::digest;

/// Longest time for a map where none is given, s.
pub(crate) const TIMEOUT_S: f64 = 600.0;

/// A week, s.
const LONGEST_TIMEOUT_S: f64 = 604_800.0;

/// Programs of one's own as mappers.
#[derive(Debug, Clone, Args)]
pub struct ProgramOptions {
    /// A program of your own as a mapper beside --mappers, such as mine='python3 mine.py' or mine='online: ./mine'; repeatable
    #[arg(id = "mapper", long, help_heading = "Mappers of your own", value_name = "NAME=COMMAND", value_parser = Program::parse)]
    pub programs: Vec<Program>,
    /// Longest time that such a program may take for a map, s
    #[arg(id = "mapper_timeout", long = "mapper-timeout", help_heading = "Mappers of your own", value_name = "SECONDS", default_value_t = TIMEOUT_S, allow_negative_numbers = true, value_parser = timeout)]
    pub timeout_s: f64,
}

impl Default for ProgramOptions {
    fn default() -> Self {
        Self { programs: Vec::new(), timeout_s: TIMEOUT_S }
    }
}

/// A program as records hold it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProgramRecord {
    /// Its name.
    pub name: String,
    /// Its command.
    pub command: String,
    /// Longest time for a map, s.
    pub timeout_s: f64,
    /// The files that its command names: by these a program that was changed is told from what it was.
    pub files: Vec<FileRecord>,
}

/// A file that a command names.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileRecord {
    /// Its name in the command.
    pub name: String,
    /// SHA-256 of its content, in hexadecimal.
    pub sha256: String,
}

impl FileRecord {
    /// The file of this name, if there is one.
    fn of(name: &str) -> Option<Self> {
        let path = Path::new(name);
        let (_, sha256) = path.is_file().then(|| digest::file(path).ok())??;
        Some(Self { name: name.to_owned(), sha256 })
    }
}

impl ProgramRecord {
    /// The mapper that the program is.
    ///
    /// # Errors
    /// A record that was made by hand and names no program.
    pub fn entry(&self) -> Result<&'static Entry, Failure> {
        let refuse = |why: String| Failure::BadInput(format!("the program {:?} {why}", self.name));
        let program = Program::parse(&format!("{}={}", self.name, self.command)).map_err(refuse)?;
        let timeout = timeout(&self.timeout_s.to_string()).map_err(refuse)?;
        Ok(program.entry(Duration::from_secs_f64(timeout)))
    }
}

impl ProgramOptions {
    /// Longest time for a map.
    pub fn timeout(&self) -> Duration {
        Duration::from_secs_f64(self.timeout_s)
    }

    /// The options that a record was made from; nothing is started by that.
    ///
    /// # Errors
    /// A record that was made by hand and names no program.
    pub fn recorded(records: &[ProgramRecord]) -> Result<Self, Failure> {
        let refuse =
            |record: &ProgramRecord, why: String| Failure::BadInput(format!("the program {:?} {why}", record.name));
        let parse = |record: &ProgramRecord| {
            Program::parse(&format!("{}={}", record.name, record.command)).map_err(|why| refuse(record, why))
        };
        let programs = records.iter().map(parse).collect::<Result<_, _>>()?;
        let Some(first) = records.first() else { return Ok(Self::default()) };
        let timeout_s = timeout(&first.timeout_s.to_string()).map_err(|why| refuse(first, why))?;
        Ok(Self { programs, timeout_s })
    }

    /// The programs as records hold them.
    pub fn record(&self) -> Vec<ProgramRecord> {
        let record = |program: &Program| ProgramRecord {
            name: program.name.clone(),
            command: program.command.clone(),
            timeout_s: self.timeout_s,
            files: program.words.iter().filter_map(|word| FileRecord::of(word)).collect(),
        };
        self.programs.iter().map(record).collect()
    }
}

fn timeout(text: &str) -> Result<f64, String> {
    number(text, "above 0 and at most 604800, a week", |v| v > 0.0 && v <= LONGEST_TIMEOUT_S)
}
