//! Pages shown in the browser.

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use super::note;

/// What shows files, by system.
const PROGRAM: &str = if cfg!(windows) {
    "cmd"
} else if cfg!(target_os = "macos") {
    "open"
} else {
    "xdg-open"
};

/// Shows a page in the browser. Where that cannot be, a note says where the page is: the run has done its work.
pub fn show(page: &Path) {
    if let Err(why) = started(PROGRAM, page) {
        note(format_args!("note: --open: {PROGRAM}: {why}; open {} in a browser", page.display()));
    }
}

/// So long a program may say that it cannot: one that goes on may be the browser itself.
const PATIENCE: Duration = Duration::from_secs(2);

/// Starts what shows the page, and waits for it no longer than it takes to fail.
fn started(program: &str, page: &Path) -> Result<(), String> {
    let page = page.canonicalize().map_err(|error| error.to_string())?;
    let shown = Command::new(program)
        .args(arguments(&page))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let mut shown = shown.map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => "there is no such program".to_owned(),
        _ => error.to_string(),
    })?;
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        match shown.try_wait().map_err(|error| error.to_string())? {
            Some(status) if status.success() => return Ok(()),
            Some(status) => return Err(format!("found nothing that shows a page ({status})")),
            None => std::thread::sleep(Duration::from_millis(20)),
        }
    }
    Ok(())
}

/// On Windows `start` is a word of the shell, whose first quoted argument is a title.
fn arguments(page: &Path) -> Vec<OsString> {
    let before: &[&str] = if cfg!(windows) { &["/C", "start", ""] } else { &[] };
    before.iter().map(OsString::from).chain([page.as_os_str().to_owned()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_is_not_there_is_said_and_so_is_a_page() {
        let page = tempfile::NamedTempFile::new().expect("a file");
        assert_eq!(started("no-such-program-anywhere", page.path()), Err("there is no such program".to_owned()));
        assert!(started("true", Path::new("no/such/page.html")).is_err());
        if cfg!(unix) {
            assert_eq!(started("true", page.path()), Ok(()));
            let why = started("false", page.path()).expect_err("it fails");
            assert!(why.starts_with("found nothing that shows a page"), "{why}");
        }
    }
}
