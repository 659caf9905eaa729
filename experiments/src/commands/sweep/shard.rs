//! Results of a shard: its rows, sealed with the manifest that they are of.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::manifest::Manifest;
use crate::failure::Failure;
use crate::jobs::seal;
use crate::output::publication;

pub use crate::jobs::seal::State;

/// Names a shard in its seal.
#[derive(Debug, Serialize)]
struct Shard<'a> {
    manifest: &'a str,
    shard: u32,
    jobs: u64,
}

impl<'a> Shard<'a> {
    fn of(manifest: &'a Manifest, shard: u32) -> Self {
        Self { manifest: &manifest.digest, shard, jobs: manifest.jobs_of(shard) }
    }
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
    seal::write(&path(&manifest.folder, shard), &Shard::of(manifest, shard), rows)
}

/// Copies the rows of a shard to `out` and gives the state of the file. What was copied of a file that is not whole is worth nothing.
///
/// # Errors
/// An `out` that cannot be written.
pub fn copy(manifest: &Manifest, shard: u32, out: &mut impl Write) -> io::Result<State> {
    seal::copy(&path(&manifest.folder, shard), &Shard::of(manifest, shard), out)
}

/// What there is of a shard.
pub fn state(manifest: &Manifest, shard: u32) -> State {
    copy(manifest, shard, &mut io::sink()).unwrap_or(State::Invalid)
}

/// Whether a shard is done.
pub fn is_done(manifest: &Manifest, number: u32) -> bool {
    matches!(state(manifest, number), State::Done { .. })
}

/// The shards that are not done, in order.
pub fn missing(manifest: &Manifest) -> Vec<u32> {
    (0..manifest.head.shards).filter(|number| !is_done(manifest, *number)).collect()
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
    fn a_result_counts_only_for_its_manifest() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let manifest = planned(folder.path(), 1);
        assert_eq!(state(&manifest, 0), State::Missing);
        let rows = b"0a,room,1,0.5\n0b,room,2,\n0c,room,3,0.25\n";
        write(&manifest, 0, rows).expect("written");
        assert_eq!(state(&manifest, 0), State::Done { rows: 3 });
        let mut copied = Vec::new();
        copy(&manifest, 0, &mut copied).expect("copied");
        assert_eq!(copied, rows);

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
