//! What is made of a sweep all of whose shards are done.

use std::path::Path;

use super::manifest::Manifest;
use super::merge::TABLE;
use super::{merge as shards, plots};
use crate::failure::Failure;
use crate::output::note;

/// Merges the shards into a table, and reports the number of its rows.
pub(super) fn merge(manifest: &Manifest, out: &Path) -> Result<(), Failure> {
    let rows = shards::merge(manifest, out)?;
    note(format_args!("{}: {rows} rows", out.display()));
    Ok(())
}

/// Merges a sweep all of whose shards are done, draws the table, and gives the names of the pictures.
pub(super) fn conclude(manifest: &Manifest) -> Result<Vec<String>, Failure> {
    merge(manifest, &manifest.folder.join(TABLE))?;
    let pictures = plots::draw(&manifest.folder)?;
    pictures.iter().for_each(|picture| note(manifest.folder.join(picture).display()));
    Ok(pictures)
}
