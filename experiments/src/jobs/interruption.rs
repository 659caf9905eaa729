//! Ctrl-C and requests to end.

use std::io::Write as _;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Exit code after Ctrl-C.
const ENDED: u8 = 130;

/// Exit code where the same command, run again, goes on from what is kept.
const RUN_AGAIN: u8 = 75;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Says what is kept, if anything, for those commands that keep something.
type Kept = Box<dyn Fn() -> Option<String> + Send>;

static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

/// What is done when the program is interrupted, by the number of its [`CleanUp`].
type Work = Box<dyn FnMut() + Send>;

static CLEAN_UPS: Mutex<Vec<(u64, Work)>> = Mutex::new(Vec::new());

/// Held while files are put in place: an interruption waits for it.
static WHOLE: Mutex<()> = Mutex::new(());

/// Work that is done if the program is interrupted while this value lives.
#[derive(Debug)]
pub struct CleanUp(u64);

/// Registers work that is done if the program is interrupted while the value returned lives.
pub fn clean_up(work: impl FnMut() + Send + 'static) -> CleanUp {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let number = NEXT.fetch_add(1, Ordering::SeqCst);
    locked(&CLEAN_UPS).push((number, Box::new(work)));
    CleanUp(number)
}

impl Drop for CleanUp {
    fn drop(&mut self) {
        locked(&CLEAN_UPS).retain(|(number, _)| *number != self.0);
    }
}

/// As long as the value returned lives, an interruption waits: for work that takes milliseconds.
pub fn not_now() -> MutexGuard<'static, ()> {
    locked(&WHOLE)
}

/// On Ctrl-C and on requests to end, cleans up and ends the program. Signals that the program was started to ignore, as
/// `nohup` and shells do with what runs in the background, stay ignored.
#[cfg(unix)]
pub fn watch() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
    use std::sync::Once;
    static WATCHED: Once = Once::new();
    WATCHED.call_once(|| {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let ignored = ignored(&status);
        let heeded = [SIGINT, SIGTERM, SIGHUP].into_iter().filter(|signal| ignored >> (signal - 1) & 1 == 0);
        let Ok(mut signals) = signal_hook::iterator::Signals::new(heeded) else { return };
        std::thread::spawn(move || {
            if signals.forever().next().is_some() {
                end();
            }
        });
    });
}

/// Other systems end the program at once; what it leaves goes with its next run.
#[cfg(not(unix))]
pub fn watch() {}

/// The signals that a process ignores, as bits from signal 1 on, from the text of `/proc/PID/status`.
#[cfg(unix)]
fn ignored(status: &str) -> u64 {
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}

#[cfg(unix)]
fn end() {
    let _whole = not_now();
    INTERRUPTED.store(true, Ordering::SeqCst);
    // Held to the end: from now on nobody begins what would have to be cleaned up.
    let mut clean_ups = locked(&CLEAN_UPS);
    clean_ups.iter_mut().for_each(|(_, work)| work());
    // Once more, for files that were registered a moment ago and are made only now.
    std::thread::sleep(std::time::Duration::from_millis(30));
    clean_ups.iter_mut().for_each(|(_, work)| work());
    let kept = kept();
    if let Some(kept) = &kept {
        let _ = writeln!(std::io::stderr(), "\ninterrupted: {kept}");
    }
    std::process::exit(i32::from(code(kept.is_some())));
}

/// From now on an interruption loses nothing that is finished: `kept` says what is there, if anything, and how to
/// go on.
pub fn keeps(kept: impl Fn() -> Option<String> + Send + 'static) {
    *locked(&KEPT) = Some(Box::new(kept));
}

/// The exit code if Ctrl-C was pressed: files then vanish under the hands of whoever still writes them.
pub fn exit_code() -> Option<u8> {
    INTERRUPTED.load(Ordering::SeqCst).then(|| code(kept().is_some()))
}

fn kept() -> Option<String> {
    locked(&KEPT).as_ref().and_then(|kept| kept())
}

fn code(kept: bool) -> u8 {
    if kept { RUN_AGAIN } else { ENDED }
}

/// What a thread that panicked held is whole: only lists are kept here.
fn locked<T>(place: &Mutex<T>) -> MutexGuard<'_, T> {
    place.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn the_mask_of_ignored_signals_is_read_from_the_status() {
        let status = "Name:\tcat\nSigBlk:\t0000000000000007\nSigIgn:\t0000000000000003\nSigCgt:\t0\n";
        assert_eq!(ignored(status), 0b11, "SIGHUP and SIGINT");
        assert_eq!(ignored(""), 0);
    }
}
