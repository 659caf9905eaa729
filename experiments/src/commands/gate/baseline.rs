//! The baselines: the values that maps had when they were last looked at and found good.

use std::fs;
use std::io::{self, Read as _, Write as _};
use std::path::Path;

use serde_json::json;

use super::file::Gate;
use super::measure::{ValueKey, Values};
use crate::failure::Failure;
use crate::output::single;
use crate::output::table::{Table, optional};
use crate::worlds::condition::condition;
use crate::worlds::site::{MICROMETRES, WorldId};

const COLUMNS: [&str; 8] = ["mapper", "metric", "region", "family", "condition", "grid", "seed", "value"];

/// Most that is read of a file: half a million values.
const MOST_BYTES: u64 = 64 << 20;

/// Reads the baselines; none if there is no such file.
///
/// # Errors
/// A file that cannot be read, and the first line of it that is no baseline.
pub fn read(path: &Path) -> Result<Option<Values>, Failure> {
    let place = path.display();
    let unreadable = |error: io::Error| Failure::Internal(format!("{place}: cannot be read: {error}"));
    let no_baseline = || Err(Failure::BadInput(format!("{place}: is no file of baselines; give one with --baseline")));
    // A pipe would be waited for.
    if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
        return no_baseline();
    }
    let mut file = match strict::opened(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        opened => opened.map_err(unreadable)?,
    };
    if file.length().map_err(unreadable)? > MOST_BYTES {
        return no_baseline();
    }
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(unreadable)?;
    let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(bytes.as_slice());
    let mut values = Values::new();
    let refuse = |line: u64, what: &str| {
        let remedy = "restore the file, or make it anew with `gate --update`";
        Failure::BadInput(format!("{place}:{line}: {what}; {remedy}"))
    };
    for (number, record) in reader.records().enumerate() {
        let record = record.map_err(|error| {
            let line = error.position().map_or(number as u64 + 1, csv::Position::line);
            refuse(line, "no line of UTF-8 text")
        })?;
        let line = record.position().map_or(number as u64 + 1, csv::Position::line);
        if number == 0 {
            if record.iter().ne(COLUMNS) {
                return Err(refuse(line, &format!("must be {}", COLUMNS.join(","))));
            }
            continue;
        }
        let (key, value) = row(&record)
            .ok_or_else(|| refuse(line, &format!("must be one value for each of {}", COLUMNS.join(","))))?;
        if values.insert(key, value).is_some() {
            return Err(refuse(line, "is there twice"));
        }
    }
    Ok(Some(values))
}

fn row(record: &csv::StringRecord) -> Option<(ValueKey, Option<f64>)> {
    let fields: [&str; 8] = record.iter().collect::<Vec<_>>().try_into().ok()?;
    let [mapper, metric, region, family, named, grid, seed, value] = fields;
    let condition = condition(named)?.name.to_owned();
    let cell_um = match grid {
        "" => None,
        text => {
            let cell_m: f64 = text.parse().ok().filter(|cell_m| (0.001..=1000.0).contains(cell_m))?;
            Some((cell_m * MICROMETRES).round() as u32)
        }
    };
    let value = match value {
        "" => None,
        text => Some(text.parse().ok().filter(|value: &f64| value.is_finite())?),
    };
    let world = WorldId { family: family.to_owned(), condition, cell_um, seed: seed.parse().ok()? };
    let [mapper, metric, region] = [mapper, metric, region].map(str::to_owned);
    Some((ValueKey { mapper, metric, region, world }, value))
}

/// The file's text: sorted, a row per value.
///
/// # Errors
/// None but a defect.
pub fn text(values: &Values) -> Result<Vec<u8>, Failure> {
    let rows: Vec<(&ValueKey, &Option<f64>)> = values.iter().collect();
    let table = Table::of(
        &rows,
        &[
            ("mapper", &|(key, _)| json!(key.mapper)),
            ("metric", &|(key, _)| json!(key.metric)),
            ("region", &|(key, _)| json!(key.region)),
            ("family", &|(key, _)| json!(key.world.family)),
            ("condition", &|(key, _)| json!(key.world.condition)),
            ("grid", &|(key, _)| optional(key.world.cell_m())),
            ("seed", &|(key, _)| json!(key.world.seed)),
            ("value", &|(_, value)| optional(**value)),
        ],
    );
    debug_assert_eq!(table.columns(), COLUMNS, "what is written can be read");
    table.csv()
}

/// Writes the baselines whole or not at all.
///
/// # Errors
/// Whatever the system reports; the former file is then as it was.
pub fn write(path: &Path, values: &Values) -> Result<(), Failure> {
    let bytes = text(values)?;
    single::whole(path, |out| out.write_all(&bytes)).map_err(|error| Failure::write(path, &error))
}

/// Whether every gate has all its baselines.
///
/// # Errors
/// The first that is missing, and how many are.
pub fn complete(gates: &[Gate], baseline: Option<&Values>, path: &Path) -> Result<(), Failure> {
    let place = path.display();
    for gate in gates.iter().filter(|gate| gate.needs_baseline()) {
        let name = &gate.name;
        let Some(baseline) = baseline else {
            let message =
                format!("{place}: is not there, and gate {name} needs it; make it with `gate --update`, and commit it");
            return Err(Failure::BadInput(message));
        };
        let missing: Vec<ValueKey> = gate.keys(&gate.mapper).filter(|key| !baseline.contains_key(key)).collect();
        if let Some(first) = missing.first() {
            return Err(Failure::BadInput(format!(
                "{place}: gate {name}: no row of {} {} {} on {}, {} of {} are missing; add them with `gate --update --only {name}`, \
                 and commit the file",
                first.mapper,
                first.metric,
                first.region,
                first.world,
                missing.len(),
                gate.worlds.len(),
            )));
        }
    }
    Ok(())
}
