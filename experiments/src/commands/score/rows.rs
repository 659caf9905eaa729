//! Every metric of every map and region, as rows.

use grid::Raster;
use rayon::prelude::*;
use score::{Interval, Metric, Scorer, Tiles};
use serde_json::json;

use super::candidate::Scorable;
use super::options::Unknown;
use super::regions::Regions;
use super::truth::Truth;
use crate::failure::Failure;
use crate::output::table::{Table, optional};
use crate::worlds::criteria::{Criterion, criterion};

/// A metric of a map over a region.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) map: String,
    pub(super) region: String,
    pub(super) metric: Metric,
}

/// A metric of a map minus that of the first map, over the cells that both are scored on.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Difference {
    pub(super) map: String,
    pub(super) baseline: String,
    pub(super) region: String,
    pub(super) metric: &'static str,
    pub(super) unit: &'static str,
    pub(super) difference: Option<f64>,
    pub(super) interval: Option<Interval>,
    pub(super) tiles: usize,
    pub(super) cells: usize,
}

/// Scores a map over every region.
pub(super) fn scores(
    name: &str,
    map: &Scorable,
    truth: &Truth,
    regions: &Regions,
    unknown: Unknown,
) -> Result<Vec<Row>, Failure> {
    let scorer = Scorer::new(&truth.cells, &regions.surface)?;
    let of_region = |(region, mask): &(String, Raster<bool>)| {
        let scored = scored_cells(mask, &[map], unknown);
        let inside = |cell: &usize| mask[*cell] && truth.cells[*cell].is_some();
        let cells = (0..mask.spec().cells()).filter(inside).count();
        let known = (0..mask.spec().cells()).filter(inside).filter(|cell| map.known[*cell]).count();
        let outside = (0..mask.spec().cells()).filter(inside).filter(|cell| map.outside[*cell]).count();
        let share = |name, part: usize| {
            let value = (cells > 0).then(|| part as f64 / cells as f64);
            Metric { name, value, unit: "1", support: cells }
        };
        let metrics = scorer.scores(&map.occupancy, scored.as_ref().unwrap_or(mask))?.metrics();
        let metrics = metrics.into_iter().chain([share("known", known), share("outside", outside)]);
        let row = |metric| Row { map: name.to_owned(), region: region.clone(), metric };
        Ok(metrics.map(row).collect::<Vec<_>>())
    };
    let rows: Result<Vec<Vec<Row>>, Failure> = regions.masks.par_iter().map(of_region).collect();
    Ok(rows?.concat())
}

/// What a map makes of every region, less what the first map makes of it.
pub(super) fn differences(
    [(name, map), (baseline, first)]: [(&str, &Scorable); 2],
    truth: &Truth,
    regions: &Regions,
    unknown: Unknown,
) -> Result<Vec<Difference>, Failure> {
    let scorer = Scorer::new(&truth.cells, &regions.surface)?;
    let tiles = Tiles::of(truth.cells.spec());
    let of_region = |(region, mask): &(String, Raster<bool>)| {
        let scored = scored_cells(mask, &[map, first], unknown);
        let mask = scored.as_ref().unwrap_or(mask);
        let found = tiles.differences(&scorer, &map.occupancy, &first.occupancy, mask)?;
        let cells = mask.values().iter().zip(truth.cells.values()).filter(|(inside, cell)| **inside && cell.is_some());
        let cells = cells.count();
        let difference = |d: score::TiledDifference| Difference {
            map: name.to_owned(),
            baseline: baseline.to_owned(),
            region: region.clone(),
            metric: d.metric,
            unit: d.unit,
            difference: d.difference,
            interval: d.interval,
            tiles: d.tiles,
            cells,
        };
        Ok(found.into_iter().map(difference).collect::<Vec<_>>())
    };
    let rows: Result<Vec<Vec<Difference>>, Failure> = regions.masks.par_iter().map(of_region).collect();
    Ok(rows?.concat())
}

/// The cells of a region that all of some maps are scored on, where these are not all.
pub(super) fn scored_cells(mask: &Raster<bool>, maps: &[&Scorable], unknown: Unknown) -> Option<Raster<bool>> {
    if unknown != Unknown::Skip {
        return None;
    }
    let inside = |cell: usize| mask[cell] && maps.iter().all(|map| map.known[cell]);
    Some(Raster::new(*mask.spec(), (0..mask.spec().cells()).map(inside).collect()))
}

/// `metrics.csv`.
pub(super) fn table(rows: &[Row]) -> Table {
    Table::of(
        rows,
        &[
            ("map", &|row| json!(row.map)),
            ("region", &|row| json!(row.region)),
            ("metric", &|row| json!(row.metric.name)),
            ("value", &|row| optional(row.metric.value)),
            ("unit", &|row| json!(row.metric.unit)),
            ("support", &|row| json!(row.metric.support)),
        ],
    )
}

/// `differences.csv`.
pub(super) fn differences_table(rows: &[Difference]) -> Table {
    Table::of(
        rows,
        &[
            ("map", &|row| json!(row.map)),
            ("baseline", &|row| json!(row.baseline)),
            ("region", &|row| json!(row.region)),
            ("metric", &|row| json!(row.metric)),
            ("unit", &|row| json!(row.unit)),
            ("difference", &|row| optional(row.difference)),
            ("low", &|row| optional(row.interval.map(|i| i.low))),
            ("high", &|row| optional(row.interval.map(|i| i.high))),
            ("tiles", &|row| json!(row.tiles)),
            ("cells", &|row| json!(row.cells)),
            ("verdict", &|row| json!(row.verdict())),
        ],
    )
}

impl Difference {
    /// What the interval says, as in `compare` but for the signed-rank test: tiles of one world are no worlds.
    pub(super) fn verdict(&self) -> Option<&'static str> {
        let Criterion { judged, .. } = criterion(self.metric)?;
        let (interval, (better, margin)) = self.interval.zip(*judged)?;
        Some(if interval.inside(margin) {
            "equivalent"
        } else if !interval.excludes_zero() {
            "undecided"
        } else if (interval.high < 0.0) == (better == score::Better::Lower) {
            "better"
        } else {
            "worse"
        })
    }
}
