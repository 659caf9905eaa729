//! Results of a shard: rows, and a last line that says that they are whole and whose they are.
//!
//! A result is written under another name, synced and renamed, so that it is there whole or not at all. Whoever runs a
//! shard, however often and wherever at the same time, writes the same bytes: the last one to rename changes nothing.

use std::fs::{self, File};
use std::io::{self, BufRead as _, BufReader, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::manifest::Manifest;
use crate::failure::Failure;
use crate::output::digest::{Running, hex, sha256};
use crate::output::{publication, single};

/// The last line, after `# `.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Trailer {
    manifest: String,
    shard: u32,
    jobs: u64,
    rows: u64,
    sha256: String,
}

/// What there is of a shard.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Whole.
    Done {
        /// Number of rows.
        rows: u64,
    },
    /// Nothing.
    Missing,
    /// A file that is cut short, changed, or of another manifest.
    Invalid,
}

/// The file of a shard's result.
pub fn path(folder: &Path, shard: u32) -> PathBuf {
    folder.join("shards").join(format!("{shard:06}.csv"))
}

/// Writes the result of a shard; `rows` are lines of CSV.
///
/// # Errors
/// Whatever the system reports, a full disk for example; nothing is left then.
pub fn write(manifest: &Manifest, shard: u32, rows: &[u8]) -> Result<(), Failure> {
    let target = path(&manifest.folder, shard);
    let trailer = Trailer {
        manifest: manifest.digest.clone(),
        shard,
        jobs: manifest.jobs_of(shard),
        rows: rows.iter().filter(|byte| **byte == b'\n').count() as u64,
        sha256: hex(&sha256(rows)),
    };
    let trailer = serde_json::to_string(&trailer).map_err(Failure::internal)?;
    let folder = target.parent().map_or(Ok(()), fs::create_dir_all);
    let written = folder.and_then(|()| {
        single::whole(&target, |out| {
            out.write_all(rows)?;
            writeln!(out, "# {trailer}")
        })
    });
    written.map_err(|e| Failure::write(&target, &e))
}

/// Copies the rows of a shard to `out` and says what the file is. Where it is not whole, what was copied is worth nothing.
///
/// # Errors
/// An `out` that cannot be written.
pub fn copy(manifest: &Manifest, shard: u32, out: &mut impl Write) -> io::Result<State> {
    let Ok(file) = File::open(path(&manifest.folder, shard)) else { return Ok(State::Missing) };
    let mut reader = BufReader::new(file);
    let (mut digest, mut rows) = (Running::default(), 0);
    let mut line = Vec::new();
    loop {
        line.clear();
        match reader.read_until(b'\n', &mut line) {
            Err(_) | Ok(0) => return Ok(State::Invalid), // without a last line
            Ok(_) => {}
        }
        if let Some(text) = line.strip_prefix(b"# ") {
            let trailer: Option<Trailer> = serde_json::from_slice(text).ok();
            let expected = Trailer {
                manifest: manifest.digest.clone(),
                shard,
                jobs: manifest.jobs_of(shard),
                rows,
                sha256: digest.hex(),
            };
            let last = reader.read_until(b'\n', &mut Vec::new()).is_ok_and(|read| read == 0);
            let whole = last && line.ends_with(b"\n") && trailer == Some(expected);
            return Ok(if whole { State::Done { rows } } else { State::Invalid });
        }
        digest.add(&line);
        rows += 1;
        out.write_all(&line)?;
    }
}

/// What there is of a shard.
pub fn state(manifest: &Manifest, shard: u32) -> State {
    copy(manifest, shard, &mut io::sink()).unwrap_or(State::Invalid)
}

/// The shards that are not done, in order.
pub fn missing(manifest: &Manifest) -> Vec<u32> {
    let done = |shard: &u32| matches!(state(manifest, *shard), State::Done { .. });
    (0..manifest.head.shards).filter(|shard| !done(shard)).collect()
}

/// Numbers in rising order as Slurm writes them: `0-3,7`.
pub fn ranges(numbers: &[u32]) -> String {
    let mut text = Vec::new();
    for run in numbers.chunk_by(|a, b| a + 1 == *b) {
        text.push(match run {
            [one] => one.to_string(),
            [first, .., last] => format!("{first}-{last}"),
            [] => continue,
        });
    }
    text.join(",")
}

/// A try that failed.
#[derive(Debug, Serialize)]
struct Try<'a> {
    shard: u32,
    cause: &'a str,
    build: &'a str,
}

/// Folder of the tries that failed.
pub fn failures(folder: &Path) -> PathBuf {
    folder.join("failures")
}

/// Leaves a note of a try that failed, as far as the system lets it.
pub fn note_failure(manifest: &Manifest, shard: u32, cause: &str) {
    let note = Try { shard, cause, build: &manifest.head.build };
    let path = failures(&manifest.folder).join(format!("{shard:06}-{}.json", publication::unique()));
    let _ = fs::create_dir_all(failures(&manifest.folder));
    let _ = fs::write(path, serde_json::to_vec(&note).unwrap_or_default());
}

/// Removes what processes of this machine left behind that were killed while they wrote.
pub fn remove_leftovers(folder: &Path) {
    let entries = [folder, &folder.join("shards")].map(|folder| fs::read_dir(folder).into_iter().flatten().flatten());
    for entry in entries.into_iter().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let parts: Vec<&str> = name.rsplit('.').collect(); // number, process, host, ...
        let Some([_, process, host]) = parts.first_chunk() else { continue };
        let own = publication::unique();
        let here = own.split('.').next() == Some(*host);
        let ended = process.parse::<u32>().is_ok() && !Path::new("/proc").join(process).exists();
        if name.starts_with('.') && here && ended && Path::new("/proc/self").exists() {
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_as_slurm_writes_them() {
        assert_eq!(ranges(&[]), "");
        assert_eq!(ranges(&[3]), "3");
        assert_eq!(ranges(&[0, 1, 2, 3, 7, 9, 10]), "0-3,7,9-10");
    }

    /// A manifest of three jobs in one shard, which no test runs.
    fn planned(folder: &Path, first_seed: u64) -> Manifest {
        use super::super::{file, manifest};
        let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
        let text = format!(
            "scene = {:?}\nmappers = [\"prior\"]\nseeds = {{ first = {first_seed}, count = 3 }}",
            scene.display().to_string()
        );
        let sweep = file::parse(&text, "s.toml").expect("valid");
        manifest::plan(&sweep, folder, Some(1), manifest::Replace::Always).expect("planned")
    }

    #[test]
    fn a_result_counts_only_as_it_was_written() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let manifest = planned(folder.path(), 1);
        assert_eq!(state(&manifest, 0), State::Missing);
        let rows = b"0a,room,1,0.5\n0b,room,2,\n0c,room,3,0.25\n";
        write(&manifest, 0, rows).expect("written");
        assert_eq!(state(&manifest, 0), State::Done { rows: 3 });
        let mut copied = Vec::new();
        copy(&manifest, 0, &mut copied).expect("copied");
        assert_eq!(copied, rows);

        let file = path(folder.path(), 0);
        let good = fs::read(&file).expect("there");
        for length in 0..good.len() {
            fs::write(&file, &good[..length]).expect("writable");
            assert_eq!(state(&manifest, 0), State::Invalid, "the first {length} bytes");
        }
        for at in 0..good.len() {
            let mut bytes = good.clone();
            bytes[at] ^= 1;
            fs::write(&file, &bytes).expect("writable");
            assert_eq!(state(&manifest, 0), State::Invalid, "byte {at} flipped");
        }
        for more in [&b"\n"[..], b"x", b"0d,room,4,\n"] {
            fs::write(&file, [&good, more].concat()).expect("writable");
            assert_eq!(state(&manifest, 0), State::Invalid, "{more:?} behind it");
        }
        fs::write(&file, &good).expect("writable");
        assert_eq!(state(&manifest, 0), State::Done { rows: 3 });
        assert_eq!(state(&planned(folder.path(), 2), 0), State::Invalid, "of another manifest");
    }

    #[test]
    fn what_a_dead_process_left_goes_and_what_others_may_still_write_stays() {
        let folder = tempfile::tempdir().expect("temporary folder");
        fs::create_dir(folder.path().join("shards")).expect("writable");
        let own = publication::unique();
        let (host, process) = (own.split('.').next().unwrap_or_default(), std::process::id());
        // Process numbers end far below this.
        let dead = format!(".000001.csv.{host}.4294967295.00");
        let stay = [
            format!(".000001.csv.{host}.{process}.00"),
            format!(".000001.csv.{host}x.4294967295.00"),
            format!("000001.csv.{host}.4294967295.00"),
        ];
        let at = |name: &String| folder.path().join("shards").join(name);
        for name in stay.iter().chain([&dead]) {
            fs::write(at(name), "half").expect("writable");
        }
        remove_leftovers(folder.path());
        assert!(stay.iter().all(|name| at(name).exists()));
        assert_eq!(at(&dead).exists(), !Path::new("/proc/self").exists());
    }
}
