//! A process that ends when we say so, with all that it has started.

use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use std::{io, thread};

use super::fault::Fault;
use super::kept::Drain;
use super::watcher::{self, Watched};
use super::{adopted, orphans, unique};
use crate::jobs::interruption::{self, CleanUp};

/// How often [`Process::wait`] looks at what a process does meanwhile.
const LOOK: Duration = Duration::from_millis(100);

/// How long the outputs of a process that has ended are waited for.
const DRAINED: Duration = Duration::from_secs(2);

/// What there is of the process, for us and for an interruption.
enum Group {
    Before,
    Running(Child),
    Over(Option<ExitStatus>),
}

/// A running program in a process group of its own. Dropped, it is killed with all that it has started.
pub(super) struct Process {
    group: Arc<Mutex<Group>>,
    /// Told when the program has ended; it is not reaped before [`end`](Self::end), so that its number stays its own.
    ended: Receiver<()>,
    mark: String,
    _watched: Watched,
    stderr: Drain,
    /// Standard output, of a program that is not talked to.
    stdout: Option<Drain>,
    _clean_up: CleanUp,
}

/// The pipes to a program that is talked to.
pub(super) struct Pipes {
    pub(super) stdin: ChildStdin,
    pub(super) stdout: ChildStdout,
}

impl Process {
    /// Starts a program with a folder as its last argument, and nothing on standard input.
    pub(super) fn start(words: &[String], folder: &Path) -> Result<Self, Fault> {
        let mut command = command(words);
        command.arg(folder).stdin(Stdio::null());
        let (mut process, _, stdout) = Self::spawn(command, &words[0])?;
        let drain = stdout.map(Drain::of).transpose().map_err(|source| cannot_start(&words[0], source))?;
        process.stdout = drain;
        Ok(process)
    }

    /// Starts a program to talk to.
    pub(super) fn talk(words: &[String]) -> Result<(Self, Pipes), Fault> {
        let mut command = command(words);
        command.stdin(Stdio::piped());
        match Self::spawn(command, &words[0])? {
            (process, Some(stdin), Some(stdout)) => Ok((process, Pipes { stdin, stdout })),
            _ => Err(Fault::Closed),
        }
    }

    fn spawn(mut command: Command, name: &str) -> Result<(Self, Option<ChildStdin>, Option<ChildStdout>), Fault> {
        let mark = unique();
        command.env(orphans::MARK, &mark);
        let charge = Watched::program(&mark);
        let group = Arc::new(Mutex::new(Group::Before));
        let (place, marked) = (Arc::clone(&group), mark.clone());
        let clean_up = interruption::clean_up(move || {
            end(&place, &marked);
            orphans::kill(&marked);
            adopted::kill();
        });
        let mut locked = lock(&group);
        if matches!(*locked, Group::Over(_)) {
            return Err(Fault::Interrupted);
        }
        let mut child = system::isolate(&mut command)
            .and_then(|()| adopted::spawn(&mut command))
            .map_err(|source| cannot_start(name, source))?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let pid = child.id();
        watcher::leader(&mark, Some(pid));
        *locked = Group::Running(child);
        drop(locked);
        let (tell, ended) = channel();
        let watched = thread::Builder::new().name("wait".to_owned()).spawn(move || {
            system::wait_for_end(pid);
            let _ = tell.send(());
        });
        let drain = pipes.2.map(Drain::of).unwrap_or_else(|| Drain::of(io::empty()));
        match (watched, drain) {
            (Ok(_), Ok(stderr)) => {
                let process = Self { group, ended, mark, _watched: charge, stderr, stdout: None, _clean_up: clean_up };
                Ok((process, pipes.0, pipes.1))
            }
            (Err(source), _) | (_, Err(source)) => {
                end(&group, &mark);
                orphans::kill(&mark);
                adopted::kill();
                Err(cannot_start(name, source))
            }
        }
    }

    /// Waits until the program ends by itself, which must be well, and ends what it has left behind. `look` is asked now and then
    /// whether to go on.
    pub(super) fn wait(
        &self,
        what: &'static str,
        longest: Duration,
        mut look: impl FnMut() -> Result<(), Fault>,
    ) -> Result<(), Fault> {
        let begin = Instant::now();
        loop {
            let left = longest.saturating_sub(begin.elapsed());
            match self.ended.recv_timeout(left.min(LOOK)) {
                Err(RecvTimeoutError::Timeout) if left.is_zero() => {
                    return Err(Fault::TimeOut { what, seconds: longest.as_secs_f64() });
                }
                Err(RecvTimeoutError::Timeout) => look()?,
                Ok(()) | Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        self.end().map_or(Err(Fault::Interrupted), verdict)
    }

    /// Ends the program and all that it has started, if it has not ended; gives how the program ended.
    pub(super) fn end(&self) -> Option<ExitStatus> {
        let status = end(&self.group, &self.mark);
        orphans::kill(&self.mark);
        adopted::kill();
        for drain in [Some(&self.stderr), self.stdout.as_ref()].into_iter().flatten() {
            drain.finish(DRAINED);
        }
        status
    }

    /// What the program has written to standard error so far.
    pub(super) fn stderr(&self) -> String {
        self.stderr.text()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if end(&self.group, &self.mark).is_some() {
            orphans::kill(&self.mark);
            adopted::kill();
        }
    }
}

fn command(words: &[String]) -> Command {
    let mut command = Command::new(&words[0]);
    command.args(&words[1..]).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn cannot_start(program: &str, source: io::Error) -> Fault {
    Fault::Start { program: program.to_owned(), source }
}

fn lock(group: &Mutex<Group>) -> MutexGuard<'_, Group> {
    group.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Kills the group as long as its leader is not reaped, and reaps it.
fn end(group: &Mutex<Group>, mark: &str) -> Option<ExitStatus> {
    let mut locked = lock(group);
    if let Group::Running(child) = &mut *locked {
        orphans::kill_group(child.id());
        watcher::leader(mark, None);
        let status = child.wait().ok();
        adopted::reaped(child.id());
        *locked = Group::Over(status);
    }
    match &*locked {
        Group::Over(status) => *status,
        _ => {
            *locked = Group::Over(None);
            None
        }
    }
}

#[cfg(unix)]
fn verdict(status: ExitStatus) -> Result<(), Fault> {
    use std::os::unix::process::ExitStatusExt as _;
    match (status.code(), status.signal()) {
        (Some(0), _) => Ok(()),
        (Some(code), _) => Err(Fault::Exit(code)),
        (None, signal) => Err(Fault::Signal(signal.unwrap_or(0))),
    }
}

#[cfg(not(unix))]
fn verdict(status: ExitStatus) -> Result<(), Fault> {
    if status.success() { Ok(()) } else { Err(Fault::Exit(status.code().unwrap_or(1))) }
}

/// Process groups.
#[cfg(unix)]
mod system {
    use std::io;
    use std::os::unix::process::CommandExt as _;
    use std::process::Command;

    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};

    /// Gives the program a process group of its own.
    pub(super) fn isolate(command: &mut Command) -> io::Result<()> {
        command.process_group(0);
        Ok(())
    }

    /// Returns when the process has ended, and does not reap it.
    pub(super) fn wait_for_end(number: u32) {
        let Some(pid) = i32::try_from(number).ok().and_then(Pid::from_raw) else { return };
        let wait = || waitid(WaitId::Pid(pid), WaitIdOptions::EXITED | WaitIdOptions::NOWAIT);
        while wait().is_err_and(|error| error == rustix::io::Errno::INTR) {}
    }
}

/// Without process groups what a program starts could not be ended with it: none is started.
#[cfg(not(unix))]
mod system {
    use std::io;
    use std::process::Command;

    pub(super) fn isolate(_command: &mut Command) -> io::Result<()> {
        Err(io::Error::new(io::ErrorKind::Unsupported, "programs as mappers need a Unix system"))
    }

    pub(super) fn wait_for_end(_number: u32) {}
}
