//! All shards as one table.

use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use super::manifest::Manifest;
use super::row::columns;
use super::shard::{self, State};
use crate::failure::Failure;
use crate::output::folder::Temporary;

/// Name of the merged table.
pub const TABLE: &str = "table.csv";

/// Writes the table of a sweep, sorted by job, whole or not at all: since shards are runs of that order, their rows
/// follow each other.
///
/// # Errors
/// Shards that are missing or not whole, with their numbers; I/O.
pub fn merge(manifest: &Manifest, out: &Path) -> Result<u64, Failure> {
    let mut gaps = Vec::new();
    let mut rows = 0;
    let partial = Temporary::beside(out);
    let write = |gaps: &mut Vec<u32>, rows: &mut u64| -> io::Result<()> {
        let mut file = BufWriter::new(File::create(partial.path())?);
        let mut head = csv::Writer::from_writer(Vec::new());
        head.write_record(columns(&manifest.head.keys)).map_err(io::Error::other)?;
        file.write_all(&head.into_inner().map_err(|e| io::Error::other(e.to_string()))?)?;
        for number in 0..manifest.head.shards {
            match shard::copy(manifest, number, &mut file)? {
                State::Done { rows: more } => *rows += more,
                State::Missing | State::Invalid => gaps.push(number),
            }
        }
        file.flush()?;
        file.get_ref().sync_all()
    };
    write(&mut gaps, &mut rows).map_err(|e| Failure::write(out, &e))?;
    if !gaps.is_empty() {
        return Err(Failure::BadInput(format!(
            "{}: {} of {} shards are missing, cut short, or of another manifest: {}; run them with `sweep run`",
            manifest.folder.display(),
            gaps.len(),
            manifest.head.shards,
            abridged(&shard::ranges(&gaps))
        )));
    }
    partial.publish(out).map_err(|e| Failure::write(out, &e))?;
    Ok(rows)
}

/// A list for a message.
fn abridged(list: &str) -> String {
    const LONGEST: usize = 60;
    if list.len() <= LONGEST {
        return list.to_owned();
    }
    // Between two numbers: half of one is another.
    let end = list[..=LONGEST].rfind(',').unwrap_or(LONGEST);
    format!("{},...", &list[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_abridged_between_its_numbers() {
        assert_eq!(abridged("0-3,7"), "0-3,7");
        let numbers: Vec<u32> = (0..200).map(|k| 100_001 + 3 * k).collect();
        let text = abridged(&shard::ranges(&numbers));
        let said: Vec<&str> = text.strip_suffix(",...").expect("abridged").split(',').collect();
        assert!(said.len() > 5 && text.len() < 70, "{text}");
        for (word, number) in said.iter().zip(&numbers) {
            assert_eq!(*word, number.to_string());
        }
    }
}
