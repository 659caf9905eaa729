//! The commit, for `--version` of what is installed. Builds for development do not ask for it: every commit would build them anew.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let version = env!("CARGO_PKG_VERSION");
    let release = std::env::var("PROFILE").is_ok_and(|profile| profile == "release");
    match git(&["rev-parse", "--short=12", "HEAD"]).filter(|_| release) {
        None => println!("cargo::rustc-env=SIGHTGRID_VERSION={version}"),
        Some(commit) => {
            println!("cargo::rustc-env=SIGHTGRID_VERSION={version} ({commit})");
            // What changes when another commit is checked out, or one is added.
            let log = git(&["rev-parse", "--git-path", "logs/HEAD"]).filter(|log| Path::new(log).exists());
            log.iter().for_each(|log| println!("cargo::rerun-if-changed={log}"));
        }
    }
}

/// What git says, if there is a git and a repository with this package in it.
fn git(words: &[&str]) -> Option<String> {
    let tracked = Command::new("git").args(["ls-files", "--error-unmatch", "build.rs"]).output().ok()?;
    let said = Command::new("git").args(words).output().ok()?;
    let text = String::from_utf8(said.stdout).ok()?.trim().to_owned();
    (tracked.status.success() && said.status.success() && !text.is_empty()).then_some(text)
}
