//! What a folder's record proves: which files an earlier run of the same command wrote.
//!
//! A file is proved by its name, its size and its SHA-256, which stand under `files` in `run.json`; the record
//! itself by `record_sha256`, the digest of everything else in it. Whatever is not proved belongs to somebody else.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::digest;

/// Name of the record of a run; it is put in place last.
pub const RECORD: &str = "run.json";

/// Key of the record's digest of itself.
const SEAL: &str = "record_sha256";

/// A file as a run left it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileEntry {
    /// Plain name of the file in the folder.
    pub name: String,
    /// Its size.
    pub bytes: u64,
    /// Its SHA-256, in hexadecimal.
    pub sha256: String,
}

impl FileEntry {
    /// The entry of a file that is there.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn of(path: &Path, name: &str) -> io::Result<Self> {
        let (bytes, sha256) = digest::file(path)?;
        Ok(Self { name: name.to_owned(), bytes, sha256 })
    }

    /// Whether the file at `path` is the one of this entry: a plain file of this size and digest.
    pub fn is_at(&self, path: &Path) -> bool {
        let plain = fs::symlink_metadata(path).is_ok_and(|found| found.is_file() && found.len() == self.bytes);
        plain && digest::file(path).is_ok_and(|(_, sha256)| sha256 == self.sha256)
    }
}

/// What a folder's record says, as far as it can be relied on.
#[derive(Debug, Clone)]
pub enum Ledger {
    /// There is no record.
    Nothing,
    /// A record of ours, whole.
    Ours(Box<Sealed>),
    /// Something else has the record's name, or somebody has changed it.
    Foreign(String),
}

/// A record of ours.
#[derive(Debug, Clone)]
pub struct Sealed {
    /// The command that left it.
    pub command: String,
    /// The files that it wrote, itself not among them.
    pub files: Vec<FileEntry>,
    /// All of it.
    pub value: Value,
    /// ... as it was written.
    pub text: String,
    /// The record as a file.
    pub entry: FileEntry,
}

impl Ledger {
    /// Reads the record of a folder.
    pub fn read(folder: &Path) -> Self {
        let path = folder.join(RECORD);
        match fs::symlink_metadata(&path) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Self::Nothing,
            Ok(found) if found.is_file() => {}
            _ => return Self::Foreign("is no plain file".to_owned()),
        }
        match fs::read(&path) {
            Ok(bytes) => sealed(&bytes).map_or_else(Self::Foreign, |record| Self::Ours(Box::new(record))),
            Err(error) => Self::Foreign(format!("cannot be read: {error}")),
        }
    }
}

/// The record in some bytes, or why they are none.
fn sealed(bytes: &[u8]) -> Result<Sealed, String> {
    let wrong = "is not a record of this program";
    let text = std::str::from_utf8(bytes).map_err(|_| wrong.to_owned())?;
    let value: Value = serde_json::from_str(text).map_err(|_| wrong.to_owned())?;
    let command = value["command"].as_str().ok_or("is not a record of this program: it names no command")?.to_owned();
    let files: Vec<FileEntry> = serde_json::from_value(value["files"].clone())
        .map_err(|_| "lists no files with size and digest, as records of this program do".to_owned())?;
    if files.iter().any(|file| !is_plain(&file.name) || file.name == RECORD) {
        return Err("lists files that are not in this folder".to_owned());
    }
    if value[SEAL].as_str() != Some(&seal(&value)) {
        return Err("was changed after the run that wrote it".to_owned());
    }
    let entry =
        FileEntry { name: RECORD.to_owned(), bytes: bytes.len() as u64, sha256: digest::hex(&digest::sha256(bytes)) };
    Ok(Sealed { command, files, value, text: text.to_owned(), entry })
}

/// Whether a name leads to a file of the folder itself that is not hidden.
pub fn is_plain(name: &str) -> bool {
    !name.is_empty() && !name.contains(['/', '\\', '\0']) && !name.starts_with('.')
}

/// The digest of a record without its seal.
fn seal(record: &Value) -> String {
    let mut record = record.clone();
    if let Some(object) = record.as_object_mut() {
        object.remove(SEAL);
    }
    digest::hex(&digest::sha256(record.to_string().as_bytes()))
}

/// A record with its files and its seal.
#[derive(Serialize)]
struct Whole<'a, R: Serialize> {
    #[serde(flatten)]
    record: &'a R,
    files: &'a [FileEntry],
    #[serde(skip_serializing_if = "Option::is_none")]
    record_sha256: Option<String>,
}

/// The text of a record with other files than before, and everything else in it as it was, to the letter.
///
/// # Errors
/// A record that is no JSON.
pub fn again(former: &str, files: &[FileEntry]) -> serde_json::Result<String> {
    // Files and seal come last.
    let head = former.rfind(FILES_FROM).map_or(former, |at| &former[..at]);
    let bare: Value = serde_json::from_str(&format!("{}\n}}", head.trim_end().trim_end_matches(',')))?;
    let sorted = text(&bare, files)?;
    let tail = sorted.rfind(FILES_FROM).map_or("", |at| &sorted[at..]);
    Ok(format!("{head}{tail}"))
}

/// Where the files begin in the text of a record.
const FILES_FROM: &str = "\n  \"files\": [";

/// The text of a record of `files`; `record` must be an object that names its `command` and holds no `files`.
///
/// # Errors
/// A record that is no JSON.
pub fn text(record: &impl Serialize, files: &[FileEntry]) -> serde_json::Result<String> {
    let mut whole = Whole { record, files, record_sha256: None };
    // As it will be read, so that nothing hangs on how a number was written.
    let read: Value = serde_json::from_str(&serde_json::to_string(&whole)?)?;
    whole.record_sha256 = Some(seal(&read));
    Ok(serde_json::to_string_pretty(&whole)? + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn entry(name: &str) -> FileEntry {
        FileEntry { name: name.to_owned(), bytes: 3, sha256: digest::hex(&digest::sha256(b"abc")) }
    }

    #[test]
    fn a_record_proves_itself_and_any_change_to_it_shows() {
        let files = [entry("a.csv"), entry("b.png")];
        let record = json!({"schema_version": 1, "command": "room", "x": 0.1, "y": 1e300, "z": [1.0, -0.0]});
        let text = text(&record, &files).expect("JSON");
        let sealed = sealed(text.as_bytes()).expect("ours");
        assert_eq!((sealed.command.as_str(), &sealed.files[..]), ("room", &files[..]));
        assert_eq!(again(&text, &files).expect("JSON"), text);
        let more = again(&text, &[entry("c.csv")]).expect("JSON");
        assert_eq!(super::sealed(more.as_bytes()).expect("ours").files, [entry("c.csv")]);
        for (was, is) in [("0.1", "0.2"), ("a.csv", "c.csv"), ("\"room\"", "\"ray\""), ("\"bytes\": 3", "\"bytes\": 4")]
        {
            let changed = text.replacen(was, is, 1);
            assert_ne!(changed, text);
            assert!(super::sealed(changed.as_bytes()).is_err(), "{was} -> {is}");
        }
    }

    #[test]
    fn records_of_another_form_are_foreign() {
        for other in [
            "",
            "[]",
            "7",
            "{}",
            r#"{"command":"room"}"#,
            r#"{"command":"room","files":["run.log"]}"#,
            r#"{"command":"room","files":[{"name":"../x","bytes":3,"sha256":""}]}"#,
            r#"{"command":"room","files":[]}"#,
        ] {
            assert!(sealed(other.as_bytes()).is_err(), "{other}");
        }
        let outside = text(&json!({"command": "room"}), &[entry("../up")]).expect("JSON");
        assert!(sealed(outside.as_bytes()).is_err(), "sealed, but it reaches out of the folder");
    }

    #[test]
    fn an_entry_knows_its_file_by_content() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let path = folder.path().join("a");
        fs::write(&path, "abc").expect("writable");
        let entry = FileEntry::of(&path, "a").expect("there");
        assert_eq!(entry, super::tests::entry("a"));
        assert!(entry.is_at(&path));
        fs::write(&path, "abd").expect("writable");
        assert!(!entry.is_at(&path));
        assert!(!entry.is_at(folder.path()));
    }
}
