//! Folders of rosbag2: which files they have, and in which order.

use std::path::{Path, PathBuf};

use granit_parser::{Event, Parser};

use crate::error::BagError;

/// The description of a folder.
const DESCRIPTION: &str = "metadata.yaml";

/// The longest description that is read, bytes.
const MOST_DESCRIPTION: u64 = 1 << 24;

/// Whether a folder is a bag.
pub(crate) fn is_bag(folder: &Path) -> bool {
    folder.join(DESCRIPTION).is_file() || !listed(folder).is_empty()
}

/// The files of a folder: those that its description names, which are there; else all that are bags, by their numbers.
///
/// # Errors
/// No file of a bag in it, or a file of the description that is not there: then messages would be missing.
pub(crate) fn files(folder: &Path) -> Result<Vec<PathBuf>, BagError> {
    let form = |reason: String| BagError::Form { place: folder.display().to_string(), reason };
    let path = folder.join(DESCRIPTION);
    let there = listed(folder);
    if !path.is_file() {
        return if there.is_empty() {
            Err(form("no file of it is a bag (.mcap, .db3); give the folder that a recorder wrote".to_owned()))
        } else {
            Ok(there)
        };
    }
    let text =
        description(&path).map_err(|source| BagError::Unreadable { place: path.display().to_string(), source })?;
    let named: Vec<PathBuf> = named(&text).iter().map(|name| beside(folder, name)).collect();
    match named.iter().find(|file| !file.is_file()) {
        // A recorder that was stopped hard has not come to name its files.
        _ if named.is_empty() && !there.is_empty() => Ok(there),
        _ if named.is_empty() => Err(form(format!("{DESCRIPTION} names no file, and no file of it is a bag"))),
        None => Ok(named),
        Some(_) if named.len() == 1 && there.len() == 1 => Ok(there), // renamed
        Some(missing) => Err(form(format!(
            "{DESCRIPTION} names {}, which is not there; get a whole copy, or give the files that are there one by one",
            missing.file_name().unwrap_or_default().display()
        ))),
    }
}

fn description(path: &Path) -> std::io::Result<String> {
    use std::io::Read;
    let mut bytes = Vec::new();
    std::fs::File::open(path)?.take(MOST_DESCRIPTION).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A file of the folder: old recorders name it with the folder before it.
fn beside(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    if path.is_file() { path } else { folder.join(Path::new(name).file_name().unwrap_or_default()) }
}

/// What the list `relative_file_paths` has; nothing where the description cannot be read.
fn named(description: &str) -> Vec<String> {
    let mut names = Vec::new();
    let mut state = State::Before;
    for event in Parser::new_from_str(description).map_while(Result::ok) {
        let (event, _) = event;
        state = match (state, event) {
            (State::Before, Event::Scalar(key, ..)) if key == "relative_file_paths" => State::Key,
            (State::Key, Event::SequenceStart(..)) => State::List,
            (State::Key, _) => State::Before,
            (State::List, Event::Scalar(name, ..)) => {
                names.push(name.to_string());
                State::List
            }
            (State::List, _) => break,
            (state, _) => state,
        };
    }
    names
}

/// How far the description was read.
#[derive(Clone, Copy)]
enum State {
    Before,
    Key,
    List,
}

/// Files whose names are those of bags, in the order of the numbers in their names.
fn listed(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> =
        entries.map(|entry| entry.path()).filter(|path| path.is_file() && is_named(path)).collect();
    files.sort_by_cached_key(|path| (number(path), path.clone()));
    files
}

fn is_named(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
    let name = name.strip_suffix(".zstd").or(name.strip_suffix(".zst")).unwrap_or(&name);
    [".mcap", ".db3"].iter().any(|end| name.ends_with(end))
}

/// The number behind the last underscore of a name.
fn number(path: &Path) -> Option<u64> {
    let name = path.file_name()?.to_str()?;
    name.split('.').next()?.rsplit_once('_')?.1.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_description_names_its_files_in_order() {
        let text = "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n    - run_0.db3\n    - run_1.db3\n  files:\n    - path: x\n";
        assert_eq!(named(text), ["run_0.db3", "run_1.db3"]);
        assert!(named("rosbag2_bagfile_information: {version: 5}").is_empty());
        assert!(named("relative_file_paths: [").is_empty() && named("\t- : :").is_empty());
    }

    #[test]
    fn files_are_in_the_order_of_their_numbers() {
        let folder = tempfile::tempdir().expect("a folder");
        for name in ["run_10.mcap", "run_9.mcap", "notes.txt", "run_0.mcap.zstd"] {
            std::fs::write(folder.path().join(name), "").expect("writable");
        }
        let found = files(folder.path()).expect("files");
        let names: Vec<_> = found.iter().map(|path| path.file_name().expect("a name").to_string_lossy()).collect();
        assert_eq!(names, ["run_0.mcap.zstd", "run_9.mcap", "run_10.mcap"]);
        std::fs::write(folder.path().join(DESCRIPTION), "a:\n  relative_file_paths: [run_9.mcap, run_11.mcap]\n")
            .expect("writable");
        let message = files(folder.path()).expect_err("one is missing").to_string();
        assert!(message.contains("run_11.mcap, which is not there"), "{message}");
    }
}
