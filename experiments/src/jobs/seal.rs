//! Results of jobs on the disk, which count only where they are whole and of the job asked for: lines, and a last line
//! that names the job, their number and their digest.
//!
//! A result is written under another name, synced and renamed, so that it is there whole or not at all. Whoever does a
//! job, however often and wherever at the same time, writes the same bytes: the last one to rename changes nothing.

use std::fs::{self, File};
use std::io::{self, BufRead as _, BufReader, Write};
use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use crate::failure::Failure;
use crate::output::digest::{Running, hex, sha256};
use crate::output::single;

/// The last line, after `# `. A job is named by values that differ from those of every other job.
#[derive(Debug, Serialize)]
struct Seal<'a, J> {
    #[serde(flatten)]
    job: &'a J,
    rows: u64,
    sha256: String,
}

/// What there is of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Whole.
    Done {
        /// Number of lines.
        rows: u64,
    },
    /// Nothing.
    Missing,
    /// A file that is cut short, changed, or of another job.
    Invalid,
}

fn seal(job: &impl Serialize, rows: u64, sha256: String) -> Result<String, Failure> {
    serde_json::to_string(&Seal { job, rows, sha256 }).map(|text| format!("# {text}\n")).map_err(Failure::internal)
}

/// Writes the result of a job: lines that each end with a line feed and none of which begins with `# `. Folders are
/// made if need be.
///
/// # Errors
/// Whatever the system reports, a full disk for example; nothing is left then.
pub fn write(path: &Path, job: &impl Serialize, lines: &[u8]) -> Result<(), Failure> {
    let rows = lines.iter().filter(|byte| **byte == b'\n').count() as u64;
    let last = seal(job, rows, hex(&sha256(lines)))?;
    let folder = path.parent().map_or(Ok(()), fs::create_dir_all);
    let written = folder.and_then(|()| {
        single::whole(path, |out| {
            out.write_all(lines)?;
            out.write_all(last.as_bytes())
        })
    });
    written.map_err(|e| Failure::write(path, &e))
}

/// Copies the lines of a result to `out` and gives the state of the file. What was copied of a file that is not whole is worth nothing.
///
/// # Errors
/// An `out` that cannot be written.
pub fn copy(path: &Path, job: &impl Serialize, out: &mut impl Write) -> io::Result<State> {
    let Ok(file) = File::open(path) else { return Ok(State::Missing) };
    let mut reader = BufReader::new(file);
    let (mut digest, mut rows) = (Running::default(), 0);
    let mut line = Vec::new();
    loop {
        line.clear();
        match reader.read_until(b'\n', &mut line) {
            Err(_) | Ok(0) => return Ok(State::Invalid), // without a last line
            Ok(_) => {}
        }
        if line.starts_with(b"# ") {
            let expected = seal(job, rows, digest.hex()).map_err(io::Error::other)?;
            let last = reader.read_until(b'\n', &mut Vec::new()).is_ok_and(|read| read == 0);
            return Ok(if last && line == expected.as_bytes() { State::Done { rows } } else { State::Invalid });
        }
        digest.add(&line);
        rows += 1;
        out.write_all(&line)?;
    }
}

/// Whether a file is a result as it was written, of whatever job.
pub fn is_whole(path: &Path) -> bool {
    let Ok(bytes) = fs::read(path) else { return false };
    let Some(body) = bytes.strip_suffix(b"\n") else { return false };
    let at = body.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let (lines, last) = bytes.split_at(at);
    let trailer: Option<Value> = last.strip_prefix(b"# ").and_then(|text| serde_json::from_slice(text).ok());
    trailer.is_some_and(|trailer| trailer["sha256"] == hex(&sha256(lines)))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn a_result_counts_only_as_it_was_written_and_for_its_job() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("results").join("0.csv");
        let (job, other) = (json!({"manifest": "m", "shard": 0}), json!({"manifest": "n", "shard": 0}));
        let state = |job| copy(&file, job, &mut io::sink()).expect("a sink");
        assert_eq!(state(&job), State::Missing);
        let rows = b"0a,room,1,0.5\n0b,room,2,\n0c,room,3,0.25\n";
        write(&file, &job, rows).expect("written");
        let mut copied = Vec::new();
        assert_eq!(copy(&file, &job, &mut copied).expect("copied"), State::Done { rows: 3 });
        assert_eq!(copied, rows);

        let good = fs::read(&file).expect("there");
        for length in 0..good.len() {
            fs::write(&file, &good[..length]).expect("writable");
            assert_eq!(state(&job), State::Invalid, "the first {length} bytes");
        }
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 1;
            fs::write(&file, &bytes).expect("writable");
            assert_eq!(state(&job), State::Invalid, "byte {at} flipped");
        }
        for more in [&b"\n"[..], b"x", b"0d,room,4,\n"] {
            fs::write(&file, [&good, more].concat()).expect("writable");
            assert_eq!(state(&job), State::Invalid, "{more:?} behind it");
        }
        fs::write(&file, &good).expect("writable");
        assert_eq!(state(&job), State::Done { rows: 3 });
        assert_eq!(state(&other), State::Invalid, "of another job");
        assert!(is_whole(&file), "of whatever job");
        fs::write(&file, &good[..good.len() - 1]).expect("writable");
        assert!(!is_whole(&file));
    }

    #[test]
    fn a_result_that_cannot_be_written_is_an_error_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("0.csv");
        fs::create_dir(&file).expect("writable");
        let message = write(&file, &json!({}), b"1\n").expect_err("in the way").to_string();
        assert!(message.contains("cannot be written"), "{message}");
        assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 1);
    }
}
