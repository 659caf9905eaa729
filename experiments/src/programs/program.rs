//! A program as a mapper: its name, its command, and how it takes scans.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use mapper::Model;
use mapper::catalogue::{Build, Entry, Kind, MAPPERS};

use super::batch::Batch;
use super::online::Online;

/// What a command begins with that takes scans one by one.
const ONLINE: &str = "online:";

/// Characters of a name, which becomes a part of names of files.
const LONGEST_NAME: usize = 60;

/// A program as a mapper.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    /// Its name in tables and files.
    pub name: String,
    /// Its command as it was given.
    pub command: String,
    /// The words of the command, at least one.
    pub words: Vec<String>,
    /// How it takes scans.
    pub mode: Mode,
}

/// How a program takes scans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mode {
    /// All of them at once, in files.
    Batch,
    /// One by one, on standard input.
    Online,
}

impl Program {
    /// Reads `NAME=COMMAND ARG..` or `NAME=online: COMMAND ARG..`. The command is split as a shell splits it, and no shell is
    /// started: nothing is expanded.
    ///
    /// # Errors
    /// A text that is something else, in words for the command line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let Some((name, command)) = text.split_once('=') else {
            return Err("must be NAME='COMMAND ARG..', such as mine='python3 mine.py'".to_owned());
        };
        let name = checked(name.trim())?;
        let (mode, bare) = match command.trim_start().strip_prefix(ONLINE) {
            Some(rest) => (Mode::Online, rest),
            None => (Mode::Batch, command),
        };
        let words = shlex::split(bare)
            .ok_or("a quote in its command is not closed, or a backslash ends it; close the quote")?;
        if words.first().is_none_or(String::is_empty) {
            return Err("names no command; write NAME='COMMAND ARG..', such as mine='python3 mine.py'".to_owned());
        }
        Ok(Self { name: name.to_owned(), command: command.trim().to_owned(), words, mode })
    }

    /// The mapper that the program is, for as long as this process lives; the same one for the same program.
    pub fn entry(&self, timeout: Duration) -> &'static Entry {
        static ENTRIES: Mutex<Vec<(&Program, Duration, &Entry)>> = Mutex::new(Vec::new());
        let mut entries = ENTRIES.lock().unwrap_or_else(PoisonError::into_inner);
        let known = entries.iter().find(|(program, longest, _)| *program == self && *longest == timeout);
        if let Some((_, _, entry)) = known {
            return entry;
        }
        let program: &'static Self = Box::leak(Box::new(self.clone()));
        let build: Box<Build> = match self.mode {
            Mode::Batch => {
                Box::new(move |model: &Model| Box::new(Batch::new(&program.name, &program.words, timeout, model)))
            }
            Mode::Online => {
                Box::new(move |model: &Model| Box::new(Online::new(&program.name, &program.words, timeout, model)))
            }
        };
        let entry: &'static Entry = Box::leak(Box::new(Entry {
            name: &program.name,
            summary: "a program of your own",
            source: &program.command,
            kind: match self.mode {
                Mode::Batch => Kind::Batch,
                Mode::Online => Kind::Online,
            },
            build: Box::leak(build),
        }));
        entries.push((program, timeout, entry));
        entry
    }
}

/// A name that can stand in tables, in lists with commas and in names of files.
fn checked(name: &str) -> Result<&str, String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let begins_well = name.starts_with(|c: char| c.is_ascii_alphanumeric());
    if !begins_well || !name.chars().all(plain) || name.len() > LONGEST_NAME {
        return Err(format!(
            "has the name {:?}: must be letters, digits, - and _, at most {LONGEST_NAME}, the first a letter or a digit",
            strict::excerpt(name, strict::LONGEST_VALUE)
        ));
    }
    if MAPPERS.iter().any(|entry| entry.name == name) {
        return Err(format!("has the name of the built-in mapper {name}; choose another"));
    }
    Ok(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    use proptest::prelude::*;

    #[test]
    fn words_are_those_of_a_shell() {
        let program = Program::parse(r#" mine = python3 "my mapper.py" --cell='0.1 m' a\ b "#).expect("valid");
        assert_eq!(program.name, "mine");
        assert_eq!(program.words, ["python3", "my mapper.py", "--cell=0.1 m", "a b"]);
        assert_eq!(program.mode, Mode::Batch);
        let online = Program::parse("m=online: ./mine --seed=$HOME").expect("valid");
        assert_eq!(
            (online.mode, online.words.as_slice()),
            (Mode::Online, ["./mine".to_owned(), "--seed=$HOME".to_owned()].as_slice())
        );
    }

    #[test]
    fn what_is_no_program_is_refused_in_a_line() {
        let long = format!("{}=x", "n".repeat(61));
        let cases = [
            ("mine", "NAME='COMMAND ARG..'"),
            ("mine=python3 'a", "not closed"),
            ("mine=python3 \\", "backslash"),
            ("mine=", "names no command"),
            ("mine= online: ", "names no command"),
            ("mine=''", "names no command"),
            ("=x", "has the name \"\""),
            ("../mine=x", "must be letters"),
            ("a,b=x", "must be letters"),
            ("-a=x", "must be letters"),
            ("prior=x", "built-in mapper prior"),
            (&long, "at most 60"),
        ];
        for (text, part) in cases {
            let message = Program::parse(text).expect_err(text);
            assert!(message.contains(part) && !message.contains('\n'), "{text}: {message}");
        }
    }

    proptest! {
        #[test]
        fn words_that_were_quoted_come_back(words in prop::collection::vec("[^\0]{1,8}", 1..5)) {
            let quoted = shlex::try_join(words.iter().map(String::as_str)).expect("no NUL");
            let program = Program::parse(&format!("mine={quoted}"));
            // A first word that says online is that.
            prop_assume!(!quoted.trim_start().starts_with(ONLINE));
            prop_assert_eq!(program.map(|p| p.words), Ok(words));
        }
    }
}
