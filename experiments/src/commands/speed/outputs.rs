//! The files that `speed` leaves behind.

use serde_json::json;

use super::growth::{self, Curve};
use super::measure::Speed;
use super::tables::{self, Alone, Conditions};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output::folder::Staging;
use crate::output::record::Record;

/// The files, beside the record.
pub(super) const FILES: [&str; 4] = ["speed.csv", "by-sensor.csv", "growth.csv", "growth.png"];

/// Writes tables, picture and record.
///
/// # Errors
/// A drawing that fails; a file that cannot be written.
pub(super) fn write(
    mut staging: Staging,
    (speeds, alone): (&[Speed], &[Alone]),
    conditions: &Conditions,
    curves: Option<&[Curve]>,
    paper: &Paper,
) -> Result<(), Failure> {
    tables::table(speeds, conditions).save(&mut staging, "speed.csv")?;
    if !alone.is_empty() {
        tables::by_sensor(alone).save(&mut staging, "by-sensor.csv")?;
    }
    if let Some(curves) = curves {
        growth::table(curves).save(&mut staging, "growth.csv")?;
        paper.save(&mut staging, "growth.png", &growth::draw(curves, paper))?;
    }
    let configuration = json!({
        "scans": conditions.source,
        "mappers": speeds.iter().map(|speed| speed.mapper).collect::<Vec<_>>(),
        "repeats": conditions.repeats,
        "world": conditions.world.name(),
        "growth": curves.is_some(),
    });
    let Conditions { grid, processor, .. } = conditions;
    let parts = json!({ "configuration": configuration, "grid": grid, "processor": processor });
    staging.record(&Record::new("speed", parts))?;
    staging.publish()
}
