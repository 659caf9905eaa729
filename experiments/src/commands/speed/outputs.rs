//! The files that `speed` leaves behind.

use std::io::{self, Write as _};

use serde_json::json;

use super::growth::{self, Curve};
use super::measure::Speed;
use super::tables::{self, Conditions};
use crate::failure::Failure;
use crate::output::folder::Staging;
use crate::output::record::versions;

/// The files, beside the record.
pub(super) const FILES: [&str; 3] = ["speed.csv", "growth.csv", "growth.png"];

/// Writes tables, picture and record.
///
/// # Errors
/// A drawing that fails; a file that cannot be written.
pub(super) fn write(
    mut staging: Staging,
    speeds: &[Speed],
    conditions: &Conditions,
    curves: Option<&[Curve]>,
) -> Result<(), Failure> {
    let table = tables::table(speeds, conditions);
    staging.write("speed.csv", |out| table.write_csv(out).map_err(io::Error::other))?;
    if let Some(curves) = curves {
        let table = growth::table(curves);
        staging.write("growth.csv", |out| table.write_csv(out).map_err(io::Error::other))?;
        let picture = growth::draw(curves)?;
        staging.write("growth.png", |out| out.write_all(&picture))?;
    }
    let record = json!({
        "schema_version": 1,
        "command": "speed",
        "configuration": {
            "scans": conditions.source,
            "mappers": speeds.iter().map(|speed| speed.mapper).collect::<Vec<_>>(),
            "repeats": conditions.repeats,
            "growth": curves.is_some(),
        },
        "grid": conditions.grid,
        "processor": conditions.processor,
        "versions": versions(),
    });
    staging.record(&record)?;
    staging.publish()
}
