//! Where maps err: error against the range from which a cell was seen best, and against the number of looks at it.

use score::{ErrorBin, LOOK_EDGES, RANGE_EDGES_M, error_profile};
use serde_json::json;

use super::candidate::Scorable;
use super::options::Unknown;
use super::regions::Regions;
use super::rows::{Row, scored_cells};
use super::truth::Truth;
use crate::failure::Failure;
use crate::output::table::{Table, optional, rounded};
use crate::worlds::bins::ends;

/// What errors are set against: name in rows, name with unit in tables, edges of the bins.
pub(super) const COVARIATES: [(&str, &str, &[f64]); 2] =
    [("range", "range_m", &RANGE_EDGES_M), ("looks", "looks", &LOOK_EDGES)];

/// The errors of a map over all that could be seen, in the bins of each of [`COVARIATES`].
pub(super) type Profiles = [Vec<ErrorBin>; 2];

/// The profiles of a map; none without scans, which alone say from where cells were seen.
///
/// # Errors
/// A map that holds something else than probabilities.
pub(super) fn of(
    map: &Scorable,
    truth: &Truth,
    regions: &Regions,
    unknown: Unknown,
) -> Result<Option<Profiles>, Failure> {
    let Some(seen) = &regions.seen else { return Ok(None) };
    let scored = scored_cells(&seen.observable, &[map], unknown);
    let mask = scored.as_ref().unwrap_or(&seen.observable);
    let [range, looks] = [&seen.nearest_m, &seen.looks].map(|known| (known, mask));
    let bins = |(known, mask), edges: &[f64]| error_profile(&map.occupancy, &truth.cells, mask, known, edges);
    let [(_, _, range_edges), (_, _, look_edges)] = COVARIATES;
    Ok(Some([bins(range, range_edges)?.bins, bins(looks, look_edges)?.bins]))
}

/// The profiles as rows: `range 1-1.5` and `looks 4-8` stand for regions, upper ends not included. Empty bins are left out.
pub(super) fn rows(map: &str, profiles: &Profiles) -> Vec<Row> {
    let of_bin = |(name, bin): (&str, &ErrorBin)| {
        let region = format!("{name} {}", ends([bin.from, bin.to]));
        [bin.log_loss, bin.brier].map(|metric| Row { map: map.to_owned(), region: region.clone(), metric })
    };
    let bins = COVARIATES.iter().zip(profiles).flat_map(|((name, ..), bins)| bins.iter().map(move |bin| (*name, bin)));
    bins.filter(|(_, bin)| bin.log_loss.support > 0).flat_map(of_bin).collect()
}

/// `profiles.csv`, as that of `compare`: all bins, of which an open one has no upper edge.
pub(super) fn table<'a>(maps: impl Iterator<Item = (&'a str, &'a Profiles)>) -> Table {
    let mut rows = Vec::new();
    for (map, profiles) in maps {
        for ((_, covariate, _), bins) in COVARIATES.iter().zip(profiles) {
            rows.extend(bins.iter().map(|bin| (map, *covariate, bin)));
        }
    }
    Table::of(
        &rows,
        &[
            ("map", &|row| json!(row.0)),
            ("covariate", &|row| json!(row.1)),
            ("from", &|row| rounded(row.2.from)),
            ("to", &|row| rounded(row.2.to)),
            ("cells", &|row| json!(row.2.log_loss.support)),
            ("log_loss", &|row| optional(row.2.log_loss.value)),
            ("brier", &|row| optional(row.2.brier.value)),
        ],
    )
}
