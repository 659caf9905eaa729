//! `gate`: the build fails when maps get worse, with a message that names the metric, the place and the difference.
//!
//! A file of gates ([`mod@file`]) states what must hold of which mapper; what it needs is mapped and scored anew from fixed
//! seeds ([`measure`]), and judged by bounds, by another mapper, or by values kept from a time when the maps were
//! good ([`baseline`], [`verdict`]). [`program`] is the whole of it as a program of your own, with your own mappers.

pub mod baseline;
pub mod door;
pub mod file;
mod held;
pub mod measure;
pub mod options;
mod schema;
pub mod source;
pub mod tables;
pub mod update;
pub mod verdict;
pub mod views;

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use clap::Parser as _;
use mapper::catalogue::{Entry, MAPPERS};

pub use self::held::held;
pub use self::options::GateOptions;
pub use self::schema::schema;

use self::file::{Gate, Gates};
use self::measure::Values;
use self::verdict::{Outcome, Verdict};
use crate::exit;
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::output::{note, single};
use crate::programs::{times, watcher};
use crate::worlds::mappers::own as programs;
use crate::worlds::shipped;

/// The command line of a program of your own: gates on your mappers and the built-in ones.
///
/// ```no_run
/// use mapper::catalogue::{Entry, Kind};
///
/// const MINE: Entry = Entry {
///     name: "mine",
///     summary: "nothing is ever seen",
///     source: "here",
///     kind: Kind::Online,
///     build: &|setup| Box::new(mapper::Unseen::new(setup)),
/// };
///
/// fn main() -> std::process::ExitCode {
///     experiments::gate::program(&[MINE])
/// }
/// ```
pub fn program(own: &[Entry]) -> ExitCode {
    watcher::if_asked().unwrap_or_else(|| exit::code(run_with(&GateOptions::parse(), own)))
}

/// Runs the gates on the built-in mappers.
///
/// # Errors
/// As [`run_with`].
pub fn run(options: &GateOptions) -> Result<(), Failure> {
    run_with(options, &[])
}

/// Runs the gates, on mappers of your own too. One that is called like a built-in mapper takes its place: it is
/// then judged by the baselines of the mapper that it is to replace.
///
/// # Errors
/// Bad input and baselines that are missing before any work, I/O, and gates that fail.
pub fn run_with(options: &GateOptions, own: &[Entry]) -> Result<(), Failure> {
    let start = Instant::now();
    interruption::watch();
    strict::bring(shipped::FILES);
    let asked = Asked::new(options, own)?;
    if options.update {
        return update(options, asked);
    }
    let baseline = asked.baseline(options)?;
    let reads = [options.gates.as_path(), &options.baseline()];
    for (path, beginning) in [(&options.junit, views::JUNIT), (&options.summary, views::MARKDOWN)] {
        path.iter().try_for_each(|path| writable(path, beginning, &reads))?;
    }
    let outcomes = asked.judge(options, &baseline)?;
    let heading = heading(&asked.gates, options.stream);
    if let Some(path) = &options.junit {
        write(path, &views::junit(&outcomes, &asked.gates.file)?, Former::Replaced)?;
    }
    if let Some(path) = &options.summary {
        let former = if is_shared(path) { Former::Kept } else { Former::Replaced };
        write(path, views::markdown(&outcomes, &heading).as_bytes(), former)?;
    }
    tables::table(&outcomes).print(options.print.format, || tables::text(&outcomes, &heading))?;
    note(format_args!("{} gates in {:.0} s", outcomes.len(), start.elapsed().as_secs_f64()));
    times::tell();
    match all_pass(&outcomes) {
        Err(failure) if options.report_only => {
            note(format_args!("warning: {failure}; --report-only lets the build go on"));
            Ok(())
        }
        ended => ended,
    }
}

/// The outcome of every gate as values, with nothing printed and no file written: for tests of your own.
///
/// # Errors
/// Bad input, and baselines that are missing. A gate that fails is none.
pub fn judge(options: &GateOptions, own: &[Entry]) -> Result<Vec<Outcome>, Failure> {
    let asked = Asked::new(options, own)?;
    let baseline = asked.baseline(options)?;
    asked.judge(options, &baseline)
}

/// What was asked for.
struct Asked {
    known: Vec<Entry>,
    /// All gates of the file.
    all: Vec<Gate>,
    /// Those to run.
    gates: Gates,
}

impl Asked {
    fn new(options: &GateOptions, own: &[Entry]) -> Result<Self, Failure> {
        let programs = programs(&options.programs)?.into_iter().copied();
        let known = mappers(&own.iter().copied().chain(programs).collect::<Vec<_>>());
        let all = file::load(&options.gates, &known)?;
        let gates = Gates { gates: only(&all, &options.only)?, ..all.clone() };
        Ok(Self { known, all: all.gates, gates })
    }

    /// The baselines, all that are needed.
    fn baseline(&self, options: &GateOptions) -> Result<Values, Failure> {
        let gates = &self.gates.gates;
        let path = options.baseline();
        let baseline = if gates.iter().any(Gate::needs_baseline) { baseline::read(&path)? } else { None };
        baseline::complete(gates, baseline.as_ref(), &path)?;
        Ok(baseline.unwrap_or_default())
    }

    fn judge(&self, options: &GateOptions, baseline: &Values) -> Result<Vec<Outcome>, Failure> {
        let measured = measure::measure(&self.gates, &self.known, options.stream, options.threads())?;
        verdict::judge(&self.gates.gates, &measured, baseline)
    }
}

/// Takes what is measured now as the baseline.
fn update(options: &GateOptions, asked: Asked) -> Result<(), Failure> {
    let Asked { known, all, mut gates } = asked;
    gates.gates.retain(Gate::needs_baseline);
    if gates.gates.is_empty() {
        let message = format!("{}: none of the gates asked for has a baseline; leave out --update", gates.file);
        return Err(Failure::BadInput(message));
    }
    let path = &options.baseline();
    let old = match baseline::read(path) {
        Ok(old) => old.unwrap_or_default(),
        // Nothing is to be kept of it.
        Err(Failure::BadInput(what)) if options.only.is_empty() && path.is_file() => {
            note(format_args!("warning: {what}"));
            Values::new()
        }
        Err(failure) => return Err(failure),
    };
    let measured = measure::measure(&gates, &known, 0, options.threads())?;
    let new = update::merged(&all, &old, verdict::baselines(&gates.gates, &measured)?);
    baseline::write(path, &new)?;
    let table = update::table(&gates.gates, &old, &new);
    table.print(options.print.format, || update::text(&gates.gates, &old, &new))?;
    let gone = old.keys().filter(|key| !new.contains_key(key)).count();
    note(format_args!("{}: {} values, {gone} gone; commit it and say why", path.display(), new.len()));
    Ok(())
}

/// The built-in mappers and your own, which come first and take the place of those of their name.
pub fn mappers(own: &[Entry]) -> Vec<Entry> {
    let replaced = |entry: &&Entry| own.iter().any(|mine| mine.name == entry.name);
    own.iter().chain(MAPPERS.iter().filter(|entry| !replaced(entry))).copied().collect()
}

/// The gates of the given names in the order of the file, all where none is given.
fn only(gates: &Gates, names: &[String]) -> Result<Vec<Gate>, Failure> {
    if let Some(name) = names.iter().find(|name| gates.gates.iter().all(|gate| gate.name != **name)) {
        let all: Vec<&str> = gates.gates.iter().map(|gate| gate.name.as_str()).collect();
        let message = format!("--only: {} has no gate {name:?}; all are: {}", gates.file, all.join(", "));
        return Err(Failure::BadInput(message));
    }
    let asked = |gate: &&Gate| names.is_empty() || names.contains(&gate.name);
    Ok(gates.gates.iter().filter(asked).cloned().collect())
}

/// One line on what was done.
fn heading(gates: &Gates, stream: u32) -> String {
    let (count, worlds) = (gates.gates.len(), measure::plan(&gates.gates).len());
    let other = if stream == 0 { String::new() } else { format!(", other readings ({stream})") };
    format!("{}: {count} gates on {worlds} worlds{other}", gates.file)
}

/// Whether every gate passes.
fn all_pass(outcomes: &[Outcome]) -> Result<(), Failure> {
    let failing: Vec<&str> =
        outcomes.iter().filter(|o| o.verdict != Verdict::Pass).map(|o| o.gate.name.as_str()).collect();
    match failing.len() {
        0 => Ok(()),
        n => Err(Failure::Claim(format!("{n} of {} gates fail: {}", outcomes.len(), failing.join(", ")))),
    }
}

/// Other commands of the same step of a workflow write there too, and what they have written is kept.
fn is_shared(path: &Path) -> bool {
    std::env::var_os("GITHUB_STEP_SUMMARY").is_some_and(|shared| Path::new(&shared) == path)
}

/// Proves before any work that a file can be written, and leaves what is in it: nothing, or what an earlier run wrote,
/// which begins in its own way.
fn writable(path: &Path, beginning: &str, reads: &[&Path]) -> Result<(), Failure> {
    single::refuse_read(path, reads)?;
    if path.is_file() && !is_shared(path) {
        let mut start = vec![0; beginning.len()];
        let mut file = File::open(path).map_err(|error| Failure::write(path, &error))?;
        let read = file.read(&mut start).map_err(|error| Failure::write(path, &error))?;
        if read > 0 && start != beginning.as_bytes() {
            return Err(Failure::BadInput(format!(
                "{}: was not written by `gate`, and would be replaced; choose another file, or move it away",
                path.display()
            )));
        }
    }
    OpenOptions::new().create(true).append(true).open(path).map(drop).map_err(|error| {
        Failure::BadInput(format!("{}: cannot be written: {error}; choose another file", path.display()))
    })
}

/// What becomes of the content that a file has.
#[derive(Clone, Copy, PartialEq)]
enum Former {
    Kept,
    Replaced,
}

fn write(path: &Path, bytes: &[u8], former: Former) -> Result<(), Failure> {
    let append = former == Former::Kept;
    let opened = OpenOptions::new().create(true).write(true).append(append).truncate(!append).open(path);
    opened.and_then(|mut file| file.write_all(bytes)).map_err(|error| Failure::write(path, &error))
}
