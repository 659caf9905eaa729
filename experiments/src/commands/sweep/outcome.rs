//! What a sweep leaves beside its shards: the table of all of them, pictures of it, and the record.

use std::path::Path;

use serde_json::json;

use super::file::Sweep;
use super::manifest::Manifest;
use super::merge::{self as shards, Merged, TABLE};
use super::options::{MergeOptions, PlotOptions};
use super::plots;
use crate::failure::Failure;
use crate::figures::{Drawing, Paper};
use crate::output::folder::{Purpose, Staging};
use crate::output::note;
use crate::output::record::Record;
use crate::output::single::{self, Existing};

/// What a sweep of these mappers means to do with its folder.
pub(super) fn purpose(mappers: &[String], paper: &Paper) -> Purpose {
    let pictures: Vec<String> =
        mappers.iter().flat_map(|mapper| plots::names(mapper)).chain([plots::name_of_all()]).collect();
    let pictures = paper.files(&pictures.iter().map(String::as_str).collect::<Vec<_>>());
    Purpose::new("sweep", &[] as &[&Path], [TABLE.to_owned()].into_iter().chain(pictures))
}

/// Merges a sweep all of whose shards are done, draws the table, and leaves the record, whose configuration is known
/// where the sweep file is at hand.
pub(super) fn conclude(manifest: &Manifest, sweep: Option<&Sweep>, paper: &Paper) -> Result<(), Failure> {
    let mappers = manifest.mappers()?;
    let mut staging = match sweep {
        Some(_) => Staging::open(&manifest.folder, &purpose(&mappers, paper))?,
        None => Staging::amend(&manifest.folder, &purpose(&mappers, paper))?,
    };
    table(manifest, &mut staging)?;
    let sheets = plots::draw(&staging.written(TABLE), paper)?;
    pictures(&mut staging, &sheets, paper)?;
    record(manifest, sweep, &mut staging)?;
    staging.publish()?;
    sheets.iter().for_each(|(picture, _)| note(manifest.folder.join(picture).display()));
    Ok(())
}

/// `sweep merge`.
pub(super) fn merge(options: &MergeOptions) -> Result<(), Failure> {
    let manifest = Manifest::open(&options.folder)?;
    let usual = options.folder.join(TABLE);
    let out = options.out.as_deref().unwrap_or(&usual);
    let inside = out.file_name() == usual.file_name()
        && out.parent().is_some_and(|parent| crate::output::folder::is_same(parent, &options.folder));
    if inside {
        let mut staging = Staging::amend(&options.folder, &purpose(&[], &Paper::default()))?;
        table(&manifest, &mut staging)?;
        record(&manifest, None, &mut staging)?;
        return staging.publish();
    }
    let mut merged = Merged::default();
    let rows = single::fill(out, Existing::forced(options.force), |file| {
        merged = shards::merge(&manifest, file)?;
        Ok(())
    })
    .and_then(|filled| {
        let rows = merged.whole(&manifest)?;
        filled.publish()?;
        Ok(rows)
    })?;
    note(format_args!("{}: {rows} rows", out.display()));
    Ok(())
}

/// `sweep plot`.
pub(super) fn plot(PlotOptions { folder, paper }: &PlotOptions) -> Result<(), Failure> {
    let manifest = Manifest::open(folder)?;
    let sheets = plots::draw(&folder.join(TABLE), paper)?;
    let mut staging = Staging::amend(folder, &purpose(&manifest.mappers()?, paper))?;
    pictures(&mut staging, &sheets, paper)?;
    record(&manifest, None, &mut staging)?;
    staging.publish()
}

fn table(manifest: &Manifest, staging: &mut Staging) -> Result<(), Failure> {
    let mut merged = Merged::default();
    staging.write(TABLE, |out| -> std::io::Result<()> {
        merged = shards::merge(manifest, out)?;
        Ok(())
    })?;
    let rows = merged.whole(manifest)?;
    note(format_args!("{}: {rows} rows", manifest.folder.join(TABLE).display()));
    Ok(())
}

fn pictures(staging: &mut Staging, sheets: &[(String, Drawing)], paper: &Paper) -> Result<(), Failure> {
    sheets.iter().try_for_each(|(name, drawing)| paper.save(staging, name, drawing).map(drop))
}

/// Leaves `run.json`, with nothing in it that changes from build to build. Without the sweep file the configuration is
/// that of the record before.
fn record(manifest: &Manifest, sweep: Option<&Sweep>, staging: &mut Staging) -> Result<(), Failure> {
    let former = staging.former_record().map(|record| record["configuration"].clone());
    let configuration = match sweep {
        Some(sweep) => serde_json::to_value(sweep).map_err(Failure::internal)?,
        None => former.unwrap_or_default(),
    };
    let parts = json!({ "configuration": configuration, "jobs": manifest.head.jobs });
    staging.record(&Record::new("sweep", parts))
}
