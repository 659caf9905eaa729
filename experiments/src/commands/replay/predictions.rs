//! How well maps predict the scans that were kept back.

use grid::Raster;
use logs::Sensor;
use mapper::{Belief, Model, Predictive, Recalibration};
use score::{SeriesMean, series_mean};
use sensor::Scan;
use serde_json::json;

use super::along_time::{self, Along, Kept};
use super::extent::{Known, Survey};
use super::kept_back;
use super::mapping::{Map, Maps};
use super::recalibrated::{FOLDS, Recalibrated};
use super::recording::Recording;
use crate::failure::Failure;
use crate::output::table::{Table, optional, rounded};
use crate::worlds::agreement::{Agreement, Spread};
use crate::worlds::kernels;
use crate::worlds::suspects::false_density;

/// The maps' scores.
pub(super) struct Predictions {
    pub(super) rows: Vec<Prediction>,
    /// The plain scores of every sensor by itself: a list for each, of every row.
    pub(super) sensors: Vec<Vec<OfSensor>>,
    /// The row that the others are compared with.
    pub(super) baseline: usize,
    /// Scans kept back.
    pub(super) scans: usize,
    /// Readings of theirs that were predicted.
    pub(super) readings: u64,
    /// Mappers that gave no map, and why.
    pub(super) faults: Vec<(&'static str, String)>,
    /// The scores along the time of the log.
    pub(super) along: Vec<Along>,
    /// How far they agree with a map, if there is one that knows anything.
    pub(super) agreement: Option<Judged>,
}

/// How far readings agree with the map of a mapper.
pub(super) struct Judged {
    pub(super) mapper: &'static str,
    pub(super) agreement: Agreement,
}

/// How well a map predicts one sensor.
pub(super) struct OfSensor {
    pub(super) mapper: String,
    /// Its number; the first, of an array of sonars.
    pub(super) sensor: usize,
    /// What it is.
    pub(super) called: &'static str,
    /// Readings that were predicted.
    pub(super) readings: u64,
    /// `-ln P`, nats per reading; none of a sensor none of whose scans was kept back.
    pub(super) loss: Option<SeriesMean>,
    /// How much more that is under an unseen world.
    pub(super) gain: Option<SeriesMean>,
    /// Share of the readings that come from what the map holds, by its own probabilities.
    pub(super) explained: Option<SeriesMean>,
    /// What that share is where sensor, kernel and map are right.
    pub(super) correct: f64,
}

/// A sensor is named where its map explains less than this of the share of readings that it should. Measured: at least 0.93 of sensors that are right, in
/// a simulated office and in two logs of a real laser whose beams were dealt to two sensors; at most 0.6 of those half of whose readings are false.
const LEAST_EXPLAINED: f64 = 0.9;

impl OfSensor {
    /// What to say of a sensor that reads nothing, or of which the map explains too little.
    fn doubt(&self) -> Option<String> {
        let Self { mapper, sensor, called, .. } = self;
        let Some(explained) = self.explained else {
            return Some(format!(
                "sensor {sensor} ({called}) has no reading in the scans kept back: is it blinded, or broken?"
            ));
        };
        (explained.interval.high < LEAST_EXPLAINED * self.correct).then(|| {
            format!(
                "the map of {mapper} explains {:.0} % of the readings of sensor {sensor} ({called}), and {:.0} % should come from what is there: is the \
                 sensor broken, or turned or placed otherwise than the log has it? Map it without",
                100.0 * explained.mean,
                100.0 * self.correct
            )
        })
    }
}

/// What one scan says of every map.
struct Told {
    /// Number of its sensor.
    sensor: usize,
    /// When it was made, s since the first scan of the log.
    time_s: f64,
    /// `-ln P` of its readings under every belief.
    losses: Vec<f64>,
    /// The same under an unseen world, in a log of several sensors.
    unseen: f64,
    /// Under every belief, the sum over its readings of the probability that it comes from what the map holds, in a log of several sensors.
    explained: Vec<f64>,
    /// The same of every map after recalibration, if there is one.
    fair: Vec<f64>,
    /// How many were predicted.
    readings: u64,
    /// How far they agree with every map.
    agreements: Vec<Agreement>,
}

/// The score of one map under one belief.
pub(super) struct Prediction {
    pub(super) name: String,
    /// As the map is.
    pub(super) plain: Loss,
    /// After recalibration; none of a row by the joint probabilities, and where scans are too few to fit one.
    pub(super) fair: Option<Fair>,
}

/// `-ln P(reading | map)`, nats per reading.
pub(super) struct Loss {
    pub(super) mean: SeriesMean,
    /// How much more than that of the baseline.
    pub(super) difference: SeriesMean,
}

/// The score of a map after recalibration.
pub(super) struct Fair {
    pub(super) loss: Loss,
    /// What the map was recalibrated by, for each part of the scans.
    pub(super) by: [Recalibration; FOLDS],
}

/// The columns of the table of scores.
pub(super) const COLUMNS: [&str; 10] = [
    "mapper",
    "readings",
    "predictive_log_loss",
    "low",
    "high",
    "recalibrated_log_loss",
    "recalibrated_low",
    "recalibrated_high",
    "shift",
    "slope",
];

impl Predictions {
    /// Predicts every reading of the scans kept back by every map, of a log with so many scans, every so-many-th of them kept back.
    pub(super) fn of(
        recording: &Recording,
        (hold_out, survey): (u64, &Survey),
        maps: &Maps,
        setup: &Model,
        spread: &(dyn Fn(Sensor) -> Spread + Sync),
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
        let recalibrated = Recalibrated::of(recording, (hold_out, survey.kept), maps, setup)?;
        let several = survey.arrays.len() > 1;
        let unseen_world = Raster::filled(setup.grid, setup.prior.marginal());
        let told = |number: usize, scan: &Scan| {
            let sensor = &**setup.sensors.of(scan);
            let mut predictive = Predictive::new(setup.grid, sensor, onset);
            let after = recalibrated.as_ref().map_or(&[][..], |recalibrated| recalibrated.maps_for(number));
            let (mut losses, mut fair) = (vec![0.0; beliefs.len()], vec![0.0; after.len()]);
            let (mut explained, mut unseen, mut readings) = (vec![0.0; beliefs.len()], 0.0, 0);
            for ray in scan.rays() {
                if predictive.take(&ray) {
                    readings += 1;
                    unseen += if several { predictive.log_loss(Belief::Cells(&unseen_world)) } else { 0.0 };
                    let false_match = ray.reading.map_or(0.0, |reading| false_density(sensor, reading));
                    for (k, (_, belief)) in beliefs.iter().enumerate() {
                        let loss = predictive.log_loss(*belief);
                        losses[k] += loss;
                        explained[k] += (1.0 - false_match * libm::exp(loss)).clamp(0.0, 1.0);
                    }
                    fair.iter_mut().zip(after).for_each(|(sum, map)| *sum += predictive.log_loss(Belief::Cells(map)));
                }
            }
            let spread = spread(survey.kind(scan));
            let agreement = |map: &Map| Agreement::of(scan, &map.occupancy, &maps.seen, sensor, spread);
            Told {
                sensor: scan.sensor,
                time_s: scan.time_s,
                losses,
                unseen,
                explained,
                fair,
                readings,
                agreements: maps.maps.iter().map(agreement).collect(),
            }
        };
        let scans = kept_back::each(recording, hold_out, &told)?;
        let series = |of: &dyn Fn(&Told) -> f64| {
            let series: Vec<(f64, u64)> = scans.iter().map(|scan| (of(scan), scan.readings)).collect();
            series_mean(&series).map_err(|_| {
                let place = recording.place();
                let what = "no reading of the scans kept back lies on the map; keep more back (--hold-out) or use more of the log";
                Failure::BadInput(format!("{place}: {what}"))
            })
        };
        let loss = |of: &dyn Fn(&Told) -> f64, baseline: &dyn Fn(&Told) -> f64| {
            Ok::<_, Failure>(Loss { mean: series(of)?, difference: series(&|scan| of(scan) - baseline(scan))? })
        };
        let baseline = beliefs.iter().position(|(name, _)| name == "visibility").unwrap_or(0);
        let place = |name: &str| maps.maps.iter().position(|map| map.mapper == name);
        let compared = place(&beliefs[baseline].0).unwrap_or(0);
        let row = |(k, (name, _)): (usize, &(String, Belief))| {
            let fair = match recalibrated.as_ref().zip(place(name)) {
                Some((recalibrated, map)) => Some(Fair {
                    loss: loss(&|scan| scan.fair[map], &|scan| scan.fair[compared])?,
                    by: recalibrated.of_map(map),
                }),
                None => None,
            };
            let plain = loss(&|scan| scan.losses[k], &|scan| scan.losses[baseline])?;
            Ok(Prediction { name: name.clone(), plain, fair })
        };
        let rows: Vec<Prediction> = beliefs.iter().enumerate().map(row).collect::<Result<_, Failure>>()?;
        let along = Self::along(&scans, &rows, baseline, compared, &place);
        let readings = scans.iter().map(|scan| scan.readings).sum();
        let of_sensor = |(number, numbers): (&usize, &Vec<usize>), known: &Known, k: usize| {
            let own = || scans.iter().filter(|scan| numbers.contains(&scan.sensor));
            let series = |of: &dyn Fn(&Told) -> f64| {
                series_mean(&own().map(|scan| (of(scan), scan.readings)).collect::<Vec<_>>()).ok()
            };
            OfSensor {
                mapper: beliefs[k].0.clone(),
                sensor: *number,
                called: kernels::called(known.kind),
                readings: own().map(|scan| scan.readings).sum(),
                loss: series(&|scan| scan.losses[k]),
                gain: series(&|scan| scan.unseen - scan.losses[k]),
                explained: series(&|scan| scan.explained[k]),
                correct: known.model.correct_match(),
            }
        };
        let all_rows = |array: (&usize, &Vec<usize>)| {
            let known = survey.sensors.get(array.0)?;
            Some((0..beliefs.len()).map(|k| of_sensor(array, known, k)).collect())
        };
        let sensors = survey.arrays.iter().filter_map(all_rows).collect();
        let judged = judging(&rows, maps);
        let agreement = judged.map(|map| Judged {
            mapper: maps.maps[map].mapper,
            agreement: scans.iter().map(|scan| scan.agreements[map]).fold(Agreement::default(), Agreement::and),
        });
        Ok(Self {
            rows,
            sensors,
            baseline,
            scans: scans.len(),
            readings,
            faults: maps.faults.clone(),
            along,
            agreement,
        })
    }

    /// Every row along the time of the log, recalibrated and as the maps are; `place` is where a map stands among the recalibrated.
    fn along(
        scans: &[Told],
        rows: &[Prediction],
        baseline: usize,
        compared: usize,
        place: &dyn Fn(&str) -> Option<usize>,
    ) -> Vec<Along> {
        let kept: Vec<Kept> = scans.iter().map(|scan| Kept { time_s: scan.time_s, readings: scan.readings }).collect();
        let blocks = |row: &Prediction, score, of: &dyn Fn(&Told) -> f64, than: &dyn Fn(&Told) -> f64| {
            let values = |of: &dyn Fn(&Told) -> f64| scans.iter().map(of).collect::<Vec<_>>();
            along_time::blocks(&row.name, score, &kept, &values(of), &values(than))
        };
        let fair = rows.iter().filter(|row| row.fair.is_some()).filter_map(|row| Some((row, place(&row.name)?)));
        let fair =
            fair.flat_map(|(row, k)| blocks(row, "recalibrated", &|scan| scan.fair[k], &|scan| scan.fair[compared]));
        let plain = rows.iter().enumerate();
        let plain =
            plain.flat_map(|(k, row)| blocks(row, "plain", &|scan| scan.losses[k], &|scan| scan.losses[baseline]));
        fair.chain(plain).collect()
    }

    /// As `replay` prints them; where programs gave no map, with a row and the error for each.
    pub(super) fn table(&self) -> Table {
        let scored = self.rows.iter().map(|row| (row.name.as_str(), Some(row), None));
        let failed = self.faults.iter().map(|(mapper, fault)| (*mapper, None, Some(fault)));
        let rows: Vec<(&str, Option<&Prediction>, Option<&String>)> = scored.chain(failed).collect();
        let plain = |row: Option<&Prediction>| row.map(|row| row.plain.mean);
        let fair = |row: Option<&Prediction>| row.and_then(|row| row.fair.as_ref()).map(|fair| fair.loss.mean);
        let by = |row: Option<&Prediction>, of: &dyn Fn(&Recalibration) -> f64| {
            let by = row.and_then(|row| row.fair.as_ref()).map(|fair| fair.by);
            optional(by.map(|by| by.iter().map(of).sum::<f64>() / FOLDS as f64))
        };
        let table = Table::of(
            &rows,
            &[
                ("mapper", &|row| json!(row.0)),
                ("readings", &|row| json!(row.1.map(|_| self.readings))),
                ("predictive_log_loss", &|row| optional(plain(row.1).map(|loss| loss.mean))),
                ("low", &|row| optional(plain(row.1).map(|loss| loss.interval.low))),
                ("high", &|row| optional(plain(row.1).map(|loss| loss.interval.high))),
                ("recalibrated_log_loss", &|row| optional(fair(row.1).map(|loss| loss.mean))),
                ("recalibrated_low", &|row| optional(fair(row.1).map(|loss| loss.interval.low))),
                ("recalibrated_high", &|row| optional(fair(row.1).map(|loss| loss.interval.high))),
                ("shift", &|row| by(row.1, &|by| by.shift)),
                ("slope", &|row| by(row.1, &|by| by.slope)),
            ],
        );
        debug_assert_eq!(table.columns(), COLUMNS);
        if self.faults.is_empty() { table } else { table.and(&rows, &[("error", &|row| json!(row.2))]) }
    }

    /// The scores of every sensor, row by row of the table of scores.
    pub(super) fn sensors_by_mapper(&self) -> impl Iterator<Item = &OfSensor> {
        (0..self.rows.len()).flat_map(|k| self.sensors.iter().map(move |rows| &rows[k]))
    }

    /// Sensors of which the map that others are held against explains too little, and those that gave no reading at all, a line for each.
    pub(super) fn doubtful(&self) -> Vec<String> {
        if self.sensors.len() < 2 {
            return Vec::new();
        }
        let judged = self.agreement.as_ref().map_or(self.rows[self.baseline].name.as_str(), |judged| judged.mapper);
        let of = |rows: &Vec<OfSensor>| rows.iter().find(|row| row.mapper == judged).and_then(OfSensor::doubt);
        self.sensors.iter().filter_map(of).collect()
    }

    /// The same as a table.
    pub(super) fn by_sensor(&self) -> Table {
        Table::of(
            &self.sensors_by_mapper().collect::<Vec<_>>(),
            &[
                ("mapper", &|row| json!(row.mapper)),
                ("sensor", &|row| json!(row.sensor)),
                ("kind", &|row| json!(row.called)),
                ("readings", &|row| json!(row.readings)),
                ("predictive_log_loss", &|row| optional(row.loss.map(|loss| loss.mean))),
                ("low", &|row| optional(row.loss.map(|loss| loss.interval.low))),
                ("high", &|row| optional(row.loss.map(|loss| loss.interval.high))),
                ("gain_over_unseen", &|row| optional(row.gain.map(|gain| gain.mean))),
                ("gain_low", &|row| optional(row.gain.map(|gain| gain.interval.low))),
                ("gain_high", &|row| optional(row.gain.map(|gain| gain.interval.high))),
                ("explained", &|row| optional(row.explained.map(|explained| explained.mean))),
                ("explained_low", &|row| optional(row.explained.map(|explained| explained.interval.low))),
                ("explained_high", &|row| optional(row.explained.map(|explained| explained.interval.high))),
                ("correct_match", &|row| rounded(row.correct)),
            ],
        )
    }

    /// Every row's difference from the baseline, recalibrated and as the maps are.
    pub(super) fn differences(&self) -> Table {
        let fair = self.others().filter_map(|row| Some((row, "recalibrated", &row.fair.as_ref()?.loss)));
        let plain = self.others().map(|row| (row, "plain", &row.plain));
        Table::of(
            &fair.chain(plain).collect::<Vec<_>>(),
            &[
                ("mapper", &|row| json!(row.0.name)),
                ("baseline", &|_| json!(self.rows[self.baseline].name)),
                ("score", &|row| json!(row.1)),
                ("difference", &|row| rounded(row.2.difference.mean)),
                ("low", &|row| rounded(row.2.difference.interval.low)),
                ("high", &|row| rounded(row.2.difference.interval.high)),
                ("verdict", &|row| json!(row.2.verdict())),
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
    let loss =
        |map: &Map| rows.iter().find(|row| row.name == map.mapper).map_or(f64::INFINITY, |row| row.plain.mean.mean);
    let rank = |map: &Map| if map.mapper == "visibility" { f64::NEG_INFINITY } else { loss(map) };
    let known = (0..maps.maps.len()).filter(|map| maps.maps[*map].mapper != "prior");
    known.min_by(|a, b| rank(&maps.maps[*a]).total_cmp(&rank(&maps.maps[*b])))
}

impl Loss {
    /// Whether it predicts better or worse than the baseline.
    pub(super) fn verdict(&self) -> &'static str {
        match self.difference.interval {
            interval if !interval.excludes_zero() => "undecided",
            interval if interval.low > 0.0 => "worse",
            _ => "better",
        }
    }
}
