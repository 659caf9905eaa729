//! The rules of axe-core, which judge whether a page can be used by everybody. They are no part of this repository: npm
//! fetches them when the test runs.

use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// The package. Pinned, so that a change of its rules is a change here.
const PACKAGE: &str = "axe-core@4.14.1";

/// The source of axe-core: the file that `AXE_CORE` names, else as npm gives it, kept for the next run. Without either, none;
/// a line then says that the test is left out.
pub(crate) fn source() -> Option<String> {
    if let Some(path) = std::env::var_os("AXE_CORE") {
        return Some(fs::read_to_string(&path).unwrap_or_else(|error| panic!("AXE_CORE={}: {error}", path.display())));
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(PACKAGE);
    let file = folder.join("package/axe.min.js");
    if !file.is_file() && fetch(&folder).is_none() {
        let line = format!(
            "axe-core is not to be had (npm pack {PACKAGE}): the page is not tested with it; set AXE_CORE to its axe.min.js"
        );
        // Past the test runner, which keeps what a test prints to itself.
        let _ = writeln!(std::io::stderr(), "{line}");
        return None;
    }
    fs::read_to_string(file).ok()
}

/// Fetches and unpacks the package.
fn fetch(folder: &Path) -> Option<()> {
    fs::create_dir_all(folder).ok()?;
    let succeeds = |program: &str, arguments: &[&str]| {
        let mut command = Command::new(program);
        let run = command.args(arguments).current_dir(folder).stdout(Stdio::null()).stderr(Stdio::null()).status();
        run.is_ok_and(|status| status.success()).then_some(())
    };
    succeeds("npm", &["pack", "--silent", PACKAGE])?;
    let archive =
        fs::read_dir(folder).ok()?.flatten().find(|entry| entry.path().extension().is_some_and(|e| e == "tgz"))?;
    succeeds("tar", &["xzf", &archive.file_name().to_string_lossy()])
}
