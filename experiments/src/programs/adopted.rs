//! Processes that nobody is the parent of any more, and that no mark tells: they have left their group and cleared their
//! environment.
//!
//! On Linux a process may ask to be given what its descendants leave behind, as a *subreaper* (prctl(2),
//! `PR_SET_CHILD_SUBREAPER`). A child of ours that we have not started is then one that a program has left.

use std::io;
use std::process::{Child, Command};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::orphans;

/// Children that are no program's leavings: those that we have started, and those that were there before; none as long as
/// nothing is given to us.
static OWN: Mutex<Option<Vec<u32>>> = Mutex::new(None);

/// Asks for what descendants leave behind. Only for a process that is all ours: a host might have children of its own.
pub(super) fn begin() {
    let mut own = own();
    if own.is_none() && system::begin() {
        *own = Some(system::children());
    }
}

/// Starts a child, so that it is not taken for a program's leavings.
pub(super) fn spawn(command: &mut Command) -> io::Result<Child> {
    // Held from before the child is there until it is known.
    let mut own = own();
    let child = command.spawn()?;
    if let Some(own) = &mut *own {
        own.push(child.id());
    }
    Ok(child)
}

/// Forgets a child that is reaped.
pub(super) fn reaped(pid: u32) {
    if let Some(own) = &mut *own() {
        own.retain(|other| *other != pid);
    }
}

/// Kills and reaps what was left behind, but for what the mark of another program tells, which may still run.
pub(super) fn kill() {
    /// What a killed process leaves behind is met in the next round.
    const ROUNDS: usize = 50;
    let own = own();
    let Some(own) = &*own else { return };
    for _ in 0..ROUNDS {
        let left = system::children().into_iter().filter(|pid| !own.contains(pid));
        if left.filter(|pid| system::kill(*pid, orphans::MARK)).count() == 0 {
            return;
        }
    }
}

fn own() -> MutexGuard<'static, Option<Vec<u32>>> {
    OWN.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(target_os = "linux")]
mod system {
    use std::fs;

    use rustix::process::{Pid, Signal, WaitOptions, getpid, kill_process, set_child_subreaper, waitpid};

    pub(super) fn begin() -> bool {
        set_child_subreaper(Some(getpid())).is_ok()
    }

    /// The children of this process.
    pub(super) fn children() -> Vec<u32> {
        let entries = fs::read_dir("/proc").into_iter().flatten().flatten();
        let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok());
        pids.filter(|pid| parent(*pid) == Some(std::process::id())).collect()
    }

    /// The parent of a process: the second field behind its name, which is in parentheses and may hold any.
    fn parent(pid: u32) -> Option<u32> {
        let stat = fs::read(format!("/proc/{pid}/stat")).ok()?;
        let behind = stat.iter().rposition(|byte| *byte == b')')? + 1;
        std::str::from_utf8(&stat[behind..]).ok()?.split_whitespace().nth(1)?.parse().ok()
    }

    /// Kills and reaps a child, unless its environment has the variable `mark`; says whether it did.
    pub(super) fn kill(pid: u32, mark: &str) -> bool {
        let environment = fs::read(format!("/proc/{pid}/environ")).unwrap_or_default();
        let marked =
            |variable: &[u8]| variable.strip_prefix(mark.as_bytes()).is_some_and(|rest| rest.starts_with(b"="));
        if environment.split(|byte| *byte == 0).any(marked) {
            return false;
        }
        let Some(pid) = i32::try_from(pid).ok().and_then(Pid::from_raw) else { return false };
        let _ = kill_process(pid, Signal::KILL);
        let _ = waitpid(Some(pid), WaitOptions::NOHANG);
        true
    }
}

/// Other systems leave orphans to their first process.
#[cfg(not(target_os = "linux"))]
mod system {
    pub(super) fn begin() -> bool {
        false
    }

    pub(super) fn children() -> Vec<u32> {
        Vec::new()
    }

    pub(super) fn kill(_pid: u32, _mark: &str) -> bool {
        false
    }
}
