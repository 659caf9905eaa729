//! A process that outlives this one by a moment, so that programs do not: what nobody can clean up after who is killed by
//! signal 9, it does.
//!
//! It is this executable once more, with [`WORD`] as its argument. It is told over its standard input what is to be cleaned up,
//! and does it when that ends, as it does when this process ends, however it ends. It has a process group of its own, so that
//! what is sent to ours does not reach it.

use std::fs;
use std::io::{self, BufRead, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use super::{adopted, orphans};

/// The argument that makes this executable a watcher.
const WORD: &str = "--watch-programs";

/// Whether this executable hands [`WORD`] to [`if_asked`]: one that does not would do something else with it.
static ABLE: AtomicBool = AtomicBool::new(false);

static WATCHER: Mutex<State> = Mutex::new(State::Before);

enum State {
    Before,
    Running(Child),
    /// There is none: it cannot be started, or somebody has killed it.
    Without,
}

/// What is to be cleaned up.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Charge {
    /// Its name, and the mark of the processes.
    mark: String,
    /// The process that leads the group of the program, as long as it is not reaped.
    pid: Option<u32>,
    /// A folder that goes.
    folder: Option<PathBuf>,
    /// Nothing is left to be cleaned up.
    over: bool,
}

/// Something that is cleaned up after this process, as long as the value lives.
#[derive(Debug)]
pub(super) struct Watched(String);

impl Watched {
    /// What a program of this mark will start.
    pub(super) fn program(mark: &str) -> Self {
        tell(&Charge { mark: mark.to_owned(), ..Charge::default() });
        Self(mark.to_owned())
    }

    /// A folder that a program of this mark works in.
    pub(super) fn folder(mark: &str, folder: &Path) -> Self {
        tell(&Charge { mark: mark.to_owned(), folder: Some(folder.to_owned()), ..Charge::default() });
        Self(mark.to_owned())
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        tell(&Charge { mark: std::mem::take(&mut self.0), over: true, ..Charge::default() });
    }
}

/// Says which process leads the group of a program; none before it is reaped, since its number then may become another's.
pub(super) fn leader(mark: &str, pid: Option<u32>) {
    tell(&Charge { mark: mark.to_owned(), pid, ..Charge::default() });
}

/// To be asked first by every `main` of ours: the exit code if this process is a watcher, which has then done its work.
pub(crate) fn if_asked() -> Option<ExitCode> {
    if std::env::args_os().nth(1).is_some_and(|word| word == WORD) {
        watch(io::stdin().lock());
        return Some(ExitCode::SUCCESS);
    }
    ABLE.store(true, Ordering::SeqCst);
    None
}

/// Takes charges until there are no more, and cleans up after those that are not over.
fn watch(input: impl BufRead) {
    let mut charges: Vec<Charge> = Vec::new();
    // A line that is cut was not yet acted upon either.
    let told = input.lines().map_while(Result::ok).filter_map(|line| serde_json::from_str::<Charge>(&line).ok());
    for charge in told {
        charges.retain(|other| other.mark != charge.mark);
        if !charge.over {
            charges.push(charge);
        }
    }
    for Charge { pid, mark, folder, .. } in charges {
        if let Some(pid) = pid {
            orphans::kill_group(pid);
        }
        orphans::kill(&mark);
        if let Some(folder) = folder {
            let _ = fs::remove_dir_all(folder);
        }
    }
}

/// Tells the watcher, which is started if there was none yet.
fn tell(charge: &Charge) {
    let mut watcher = WATCHER.lock().unwrap_or_else(PoisonError::into_inner);
    if matches!(*watcher, State::Before) && ABLE.load(Ordering::SeqCst) {
        adopted::begin();
        *watcher = start().map_or(State::Without, State::Running);
    }
    let State::Running(child) = &mut *watcher else { return };
    let told = child.stdin.as_mut().is_some_and(|stdin| {
        let line = serde_json::to_string(charge).map_err(io::Error::other);
        line.and_then(|line| stdin.write_all(format!("{line}\n").as_bytes())).is_ok()
    });
    if !told {
        let _ = child.try_wait(); // reaps it
        *watcher = State::Without;
    }
}

#[cfg(unix)]
fn start() -> io::Result<Child> {
    use std::os::unix::process::CommandExt as _;
    // On Linux also of an executable that was replaced since, and by another name than ours, for those who kill by name.
    let own = if cfg!(target_os = "linux") { PathBuf::from("/proc/self/exe") } else { std::env::current_exe()? };
    let mut command = Command::new(own);
    command.args([WORD, &std::process::id().to_string()]).current_dir("/").process_group(0);
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::null());
    adopted::spawn(&mut command)
}

/// Programs as mappers need a Unix system.
#[cfg(not(unix))]
fn start() -> io::Result<Child> {
    Err(io::Error::from(io::ErrorKind::Unsupported))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    use std::os::unix::process::CommandExt as _;
    use std::os::unix::process::ExitStatusExt as _;

    #[test]
    fn what_is_not_over_is_cleaned_up() {
        let temporary = tempfile::tempdir().expect("temporary folder");
        let [left, over] = ["left", "over"].map(|name| temporary.path().join(name));
        fs::create_dir(&left).and_then(|()| fs::create_dir(&over)).expect("made");
        let sleeper = || Command::new("sleep").arg("1000").process_group(0).spawn().expect("sleep");
        let (mut killed, mut spared) = (sleeper(), sleeper());
        let charge = |mark: &str| Charge { mark: mark.to_owned(), ..Charge::default() };
        let lines = [
            Charge { folder: Some(left.clone()), ..charge("a") },
            Charge { folder: Some(over.clone()), ..charge("b") },
            charge("c"),
            Charge { pid: Some(killed.id()), ..charge("c") },
            Charge { pid: Some(spared.id()), ..charge("d") },
            Charge { over: true, ..charge("b") },
            charge("d"),
        ];
        let text: String = lines.iter().map(|line| serde_json::to_string(line).expect("JSON") + "\n").collect();
        watch((text + "{\"mark\":\"d\",\"pid\":").as_bytes());
        assert_eq!(killed.wait().expect("a child").signal(), Some(9));
        assert!(spared.try_wait().expect("a child").is_none(), "reaped programs have no number any more");
        spared.kill().and_then(|()| spared.wait()).expect("a child");
        assert!(!left.exists() && over.exists());
    }
}
