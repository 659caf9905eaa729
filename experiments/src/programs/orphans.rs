//! Processes that a program has left behind, also those that went out of its process group.

/// Name of the environment variable by which what a program starts is known.
pub(super) const MARK: &str = "SIGHTGRID_PROGRAM";

/// Kills all processes of the group that a process leads which is not reaped.
#[cfg(unix)]
pub(super) fn kill_group(leader: u32) {
    if let Some(leader) = i32::try_from(leader).ok().and_then(rustix::process::Pid::from_raw) {
        let _ = rustix::process::kill_process_group(leader, rustix::process::Signal::KILL);
    }
}

/// Without process groups no program is started.
#[cfg(not(unix))]
pub(super) fn kill_group(_leader: u32) {}

/// Kills every process whose environment holds the mark, again and again until there is none.
#[cfg(target_os = "linux")]
pub(super) fn kill(mark: &str) {
    /// A process that forks as fast as it is killed is met again and again.
    const ROUNDS: usize = 50;
    let line = format!("{MARK}={mark}").into_bytes();
    for _ in 0..ROUNDS {
        let marked = marked(&line);
        if marked.is_empty() {
            return;
        }
        for pid in marked {
            let _ = rustix::process::kill_process(pid, rustix::process::Signal::KILL);
        }
    }
}

/// Other systems do not show the environment of a process; its process group is killed there too.
#[cfg(not(target_os = "linux"))]
pub(super) fn kill(_mark: &str) {}

#[cfg(target_os = "linux")]
fn marked(line: &[u8]) -> Vec<rustix::process::Pid> {
    let own = std::process::id();
    let number = |entry: std::fs::DirEntry| entry.file_name().to_str()?.parse::<u32>().ok();
    let all = std::fs::read_dir("/proc").into_iter().flatten().flatten().filter_map(number).filter(|pid| *pid != own);
    let is_marked = |pid: &u32| {
        let environment = std::fs::read(format!("/proc/{pid}/environ")).unwrap_or_default();
        environment.split(|byte| *byte == 0).any(|variable| variable == line)
    };
    let pid = |pid: u32| rustix::process::Pid::from_raw(i32::try_from(pid).ok()?);
    all.filter(is_marked).filter_map(pid).collect()
}
