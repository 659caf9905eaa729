//! `--mapper` and `--mapper-timeout`.

use std::path::Path;
use std::time::Duration;

use clap::Args;
use serde::Serialize;

use super::program::Program;
use crate::output::args::number;
use crate::output::digest;

/// Longest time for a map where none is given, s.
const TIMEOUT_S: f64 = 600.0;

/// A week, s.
const LONGEST_TIMEOUT_S: f64 = 604_800.0;

/// Programs of one's own as mappers.
#[derive(Debug, Clone, Args)]
pub struct ProgramOptions {
    /// A program of your own as a mapper beside --mappers, such as mine='python3 mine.py' or mine='online: ./mine'; repeatable
    #[arg(id = "mapper", long, value_name = "NAME=COMMAND", value_parser = Program::parse)]
    pub programs: Vec<Program>,
    /// Longest time that such a program may take for a map, s
    #[arg(id = "mapper_timeout", long = "mapper-timeout", value_name = "SECONDS", default_value_t = TIMEOUT_S, allow_negative_numbers = true, value_parser = timeout)]
    pub timeout_s: f64,
}

impl Default for ProgramOptions {
    fn default() -> Self {
        Self { programs: Vec::new(), timeout_s: TIMEOUT_S }
    }
}

/// A program as records hold it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ProgramRecord {
    /// Its name.
    pub name: String,
    /// Its command.
    pub command: String,
    /// Longest time for a map, s.
    pub timeout_s: f64,
}

impl ProgramOptions {
    /// Longest time for a map.
    pub fn timeout(&self) -> Duration {
        Duration::from_secs_f64(self.timeout_s)
    }

    /// Digests of the files that the commands name: by these a program that was changed is told from what it was.
    pub fn files(&self) -> String {
        let words = self.programs.iter().flat_map(|program| &program.words);
        let files = words.map(Path::new).filter(|path| path.is_file());
        let digests = files.filter_map(|path| digest::file(path).ok());
        digests.map(|(bytes, digest)| format!("\n{bytes} {digest}")).collect()
    }

    /// The programs as records hold them.
    pub fn record(&self) -> Vec<ProgramRecord> {
        let record = |program: &Program| ProgramRecord {
            name: program.name.clone(),
            command: program.command.clone(),
            timeout_s: self.timeout_s,
        };
        self.programs.iter().map(record).collect()
    }
}

fn timeout(text: &str) -> Result<f64, String> {
    number(text, "above 0 and at most 604800, a week", |v| v > 0.0 && v <= LONGEST_TIMEOUT_S)
}
