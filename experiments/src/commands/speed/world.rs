//! What a mapper knows of the world before the scans that are timed.

use clap::ValueEnum;
use mapper::catalogue::{Entry, Kind};

use crate::failure::Failure;

/// What a mapper knows of the world before the scans that are timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Known {
    /// nothing before the first scan, as a robot that drives into it
    #[default]
    Mixed,
    /// what all scans, mapped twice before the clock starts, have told
    Settled,
    /// nothing before any scan: each is mapped alone
    Unknown,
}

impl Known {
    /// The name of it, as it is given.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mixed => "mixed",
            Self::Settled => "settled",
            Self::Unknown => "unknown",
        }
    }

    /// Refuses mappers that cannot be timed in such a world.
    ///
    /// # Errors
    /// One that solves for all scans at once, or works in another process.
    pub fn check(self, entries: &[&'static Entry], programs: &[String]) -> Result<(), Failure> {
        let (name, what) = match entries.iter().find(|entry| entry.kind == Kind::Batch) {
            _ if self == Self::Mixed => return Ok(()),
            Some(entry) if !programs.iter().any(|program| program == entry.name) => {
                (entry.name.to_owned(), "solves for all scans at once; leave it out of --mappers")
            }
            _ => match programs.first() {
                Some(name) => (name.clone(), "works in a process of its own; leave out --mapper"),
                None => return Ok(()),
            },
        };
        Err(Failure::BadInput(format!("--world {}: '{name}' {what}, or time it with --world mixed", self.name())))
    }
}
