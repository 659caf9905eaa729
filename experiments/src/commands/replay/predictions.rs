//! How well maps predict the scans that were kept back.

use mapper::{Belief, Model, Predictive};
use rayon::prelude::*;
use score::{SeriesMean, series_mean};
use sensor::Scan;
use serde_json::json;

use super::mapping::{BATCH, Map, Maps, is_kept_back};
use super::recording::{self, Recording};
use crate::failure::Failure;
use crate::output::table::{Table, optional, rounded};
use crate::worlds::agreement::{Agreement, Spread};

/// The maps' scores.
pub(super) struct Predictions {
    pub(super) rows: Vec<Prediction>,
    /// The row that the others are compared with.
    pub(super) baseline: usize,
    /// Scans kept back.
    pub(super) scans: usize,
    /// Readings of theirs that were predicted.
    pub(super) readings: u64,
    /// Mappers that gave no map, and why.
    pub(super) faults: Vec<(&'static str, String)>,
    /// How far they agree with a map, if there is one that knows anything.
    pub(super) agreement: Option<Judged>,
}

/// How far readings agree with the map of a mapper.
pub(super) struct Judged {
    pub(super) mapper: &'static str,
    pub(super) agreement: Agreement,
}

/// What one scan says of every map.
struct Told {
    /// `-ln P` of its readings under every belief.
    losses: Vec<f64>,
    /// How many were predicted.
    readings: u64,
    /// How far they agree with every map.
    agreements: Vec<Agreement>,
}

/// The score of one map under one belief.
pub(super) struct Prediction {
    pub(super) name: String,
    /// `-ln P(reading | map)`, nats per reading.
    pub(super) loss: SeriesMean,
    /// How much more than that of the baseline.
    pub(super) difference: SeriesMean,
}

impl Predictions {
    /// Predicts every reading of the scans kept back by every map.
    pub(super) fn of(
        recording: &Recording,
        hold_out: u64,
        maps: &Maps,
        setup: &Model,
        spread: Spread,
    ) -> Result<Self, Failure> {
        let beliefs: Vec<(String, Belief)> = maps
            .maps
            .iter()
            .flat_map(|map| {
                let cells = Some((map.mapper.to_owned(), Belief::Cells(&map.occupancy)));
                let chain = map.pairs.as_ref().map(|pairs| (format!("{}-chain", map.mapper), Belief::Chain(pairs)));
                [cells, chain].into_iter().flatten()
            })
            .collect();
        let onset = setup.prior.onset(setup.grid.cell_m);
        let told = |scan: &Scan| {
            let sensor = &**setup.sensors.of(scan);
            let mut predictive = Predictive::new(setup.grid, sensor, onset);
            let (mut sums, mut readings) = (vec![0.0; beliefs.len()], 0);
            for ray in scan.rays() {
                if predictive.take(&ray) {
                    readings += 1;
                    sums.iter_mut().zip(&beliefs).for_each(|(sum, (_, belief))| *sum += predictive.log_loss(*belief));
                }
            }
            let agreement = |map: &Map| Agreement::of(scan, &map.occupancy, &maps.seen, sensor, spread);
            Told { losses: sums, readings, agreements: maps.maps.iter().map(agreement).collect() }
        };
        let mut scans: Vec<Told> = Vec::new();
        let mut batch = Vec::with_capacity(BATCH);
        for (number, scan) in (0..).zip(recording.scans()?) {
            let scan = scan.map_err(recording::refused)?;
            if is_kept_back(number, hold_out) {
                batch.push(scan);
                if batch.len() == BATCH {
                    scans.par_extend(batch.par_drain(..).map(|scan| told(&scan)));
                }
            }
        }
        scans.par_extend(batch.par_drain(..).map(|scan| told(&scan)));
        let baseline = beliefs.iter().position(|(name, _)| name == "visibility").unwrap_or(0);
        let series = |of: &dyn Fn(&[f64]) -> f64| {
            let series: Vec<(f64, u64)> = scans.iter().map(|scan| (of(&scan.losses), scan.readings)).collect();
            series_mean(&series).map_err(|_| {
                let place = recording.place();
                let what = "no reading of the scans kept back lies on the map; keep more back (--hold-out) or use more of the log";
                Failure::BadInput(format!("{place}: {what}"))
            })
        };
        let row = |(k, (name, _)): (usize, &(String, Belief))| {
            let (loss, difference) = (series(&|sums| sums[k])?, series(&|sums| sums[k] - sums[baseline])?);
            Ok(Prediction { name: name.clone(), loss, difference })
        };
        let rows: Vec<Prediction> = beliefs.iter().enumerate().map(row).collect::<Result<_, Failure>>()?;
        let readings = scans.iter().map(|scan| scan.readings).sum();
        let judged = judging(&rows, maps);
        let agreement = judged.map(|map| Judged {
            mapper: maps.maps[map].mapper,
            agreement: scans.iter().map(|scan| scan.agreements[map]).fold(Agreement::default(), Agreement::and),
        });
        Ok(Self { rows, baseline, scans: scans.len(), readings, faults: maps.faults.clone(), agreement })
    }

    /// As `replay` prints them; where programs gave no map, with a row and the error for each.
    pub(super) fn table(&self) -> Table {
        let scored = self.rows.iter().map(|row| (row.name.as_str(), Some(row.loss), None));
        let failed = self.faults.iter().map(|(mapper, fault)| (*mapper, None, Some(fault)));
        let rows: Vec<(&str, Option<SeriesMean>, Option<&String>)> = scored.chain(failed).collect();
        let table = Table::of(
            &rows,
            &[
                ("mapper", &|row| json!(row.0)),
                ("readings", &|row| json!(row.1.map(|_| self.readings))),
                ("predictive_log_loss", &|row| optional(row.1.map(|loss| loss.mean))),
                ("low", &|row| optional(row.1.map(|loss| loss.interval.low))),
                ("high", &|row| optional(row.1.map(|loss| loss.interval.high))),
            ],
        );
        if self.faults.is_empty() { table } else { table.and(&rows, &[("error", &|row| json!(row.2))]) }
    }

    /// Every row's difference from the baseline.
    pub(super) fn differences(&self) -> Table {
        Table::of(
            &self.others().collect::<Vec<_>>(),
            &[
                ("mapper", &|row| json!(row.name)),
                ("baseline", &|_| json!(self.rows[self.baseline].name)),
                ("difference", &|row| rounded(row.difference.mean)),
                ("low", &|row| rounded(row.difference.interval.low)),
                ("high", &|row| rounded(row.difference.interval.high)),
                ("verdict", &|row| json!(row.verdict())),
            ],
        )
    }

    /// All rows but the baseline.
    pub(super) fn others(&self) -> impl Iterator<Item = &Prediction> {
        self.rows.iter().enumerate().filter(|(k, _)| *k != self.baseline).map(|(_, row)| row)
    }
}

/// The map that readings are held against: that of `visibility`, else the one that predicts best; none that knows nothing.
fn judging(rows: &[Prediction], maps: &Maps) -> Option<usize> {
    let loss = |map: &Map| rows.iter().find(|row| row.name == map.mapper).map_or(f64::INFINITY, |row| row.loss.mean);
    let rank = |map: &Map| if map.mapper == "visibility" { f64::NEG_INFINITY } else { loss(map) };
    let known = (0..maps.maps.len()).filter(|map| maps.maps[*map].mapper != "prior");
    known.min_by(|a, b| rank(&maps.maps[*a]).total_cmp(&rank(&maps.maps[*b])))
}

impl Prediction {
    /// Whether it predicts better or worse than the baseline.
    pub(super) fn verdict(&self) -> &'static str {
        match self.difference.interval {
            interval if !interval.excludes_zero() => "undecided",
            interval if interval.low > 0.0 => "worse",
            _ => "better",
        }
    }
}
