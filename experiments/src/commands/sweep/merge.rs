//! All shards as one table.

use std::io::{self, Write};

use super::manifest::Manifest;
use super::row::columns;
use super::shard::{self, State};
use crate::failure::Failure;

/// Name of the merged table.
pub const TABLE: &str = "table.csv";

/// What came of a merge.
#[derive(Debug, Default)]
pub struct Merged {
    rows: u64,
    /// Shards that are missing or not whole.
    gaps: Vec<u32>,
}

/// Writes the table of a sweep, sorted by job: since shards are runs of that order, their rows follow each other.
///
/// # Errors
/// An `out` that cannot be written.
pub fn merge(manifest: &Manifest, out: &mut impl Write) -> io::Result<Merged> {
    let mut head = csv::Writer::from_writer(Vec::new());
    head.write_record(columns(&manifest.head.keys, manifest.head.of_movement)).map_err(io::Error::other)?;
    out.write_all(&head.into_inner().map_err(|e| io::Error::other(e.to_string()))?)?;
    let mut merged = Merged::default();
    for number in 0..manifest.head.shards {
        match shard::copy(manifest, number, out)? {
            State::Done { rows } => merged.rows += rows,
            State::Missing | State::Invalid => merged.gaps.push(number),
        }
    }
    Ok(merged)
}

impl Merged {
    /// The number of rows of a whole table.
    ///
    /// # Errors
    /// Shards that are missing or not whole, with their numbers.
    pub fn whole(self, manifest: &Manifest) -> Result<u64, Failure> {
        if self.gaps.is_empty() {
            return Ok(self.rows);
        }
        Err(Failure::BadInput(format!(
            "{}: {} of {} shards are missing, cut short, or of another manifest: {}; run them with `sweep run`",
            manifest.folder.display(),
            self.gaps.len(),
            manifest.head.shards,
            abridged(&shard::ranges(&self.gaps))
        )))
    }
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
