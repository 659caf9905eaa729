//! Ctrl-C and requests to end.

use std::io::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::output::folder;

/// Exit code after Ctrl-C.
const ENDED: u8 = 130;

/// Exit code where the same command, run again, goes on from what is kept.
const RUN_AGAIN: u8 = 75;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Says what is kept, if anything, for those commands that keep something.
type Kept = Box<dyn Fn() -> Option<String> + Send>;

static KEPT: Mutex<Option<Kept>> = Mutex::new(None);

/// On Ctrl-C, removes what is in the making and ends the program.
pub fn watch() {
    // A second handler in one process is refused; the first does the same.
    let _ = ctrlc::set_handler(|| {
        INTERRUPTED.store(true, Ordering::SeqCst);
        folder::abandon_all();
        let kept = kept();
        if let Some(kept) = &kept {
            let _ = writeln!(std::io::stderr(), "\ninterrupted: {kept}");
        }
        std::process::exit(i32::from(code(kept.is_some())));
    });
}

/// From now on an interruption loses nothing that is finished: `kept` says what is there, if anything, and how to
/// go on.
pub fn keeps(kept: impl Fn() -> Option<String> + Send + 'static) {
    if let Ok(mut place) = KEPT.lock() {
        *place = Some(Box::new(kept));
    }
}

/// The exit code if Ctrl-C was pressed: files then vanish under the hands of whoever still writes them.
pub fn exit_code() -> Option<u8> {
    INTERRUPTED.load(Ordering::SeqCst).then(|| code(kept().is_some()))
}

fn kept() -> Option<String> {
    KEPT.lock().ok().as_deref().and_then(Option::as_ref).and_then(|kept| kept())
}

fn code(kept: bool) -> u8 {
    if kept { RUN_AGAIN } else { ENDED }
}
