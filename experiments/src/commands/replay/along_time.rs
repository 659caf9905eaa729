//! How well maps predict along the time of a log: where one is better than another, and where it is not.

use score::{SeriesMean, series_mean};
use serde_json::json;

use super::predictions::Loss;
use crate::figures::chart::{At, Axis, Chart, Series, sheet};
use crate::figures::style::{self, Style};
use crate::figures::{Drawing, Paper};
use crate::output::table::{Table, rounded};

/// A log is parted into so many blocks at most ...
const BLOCKS: usize = 24;

/// ... of so many scans kept back at least: an interval needs some.
const FEWEST: usize = 6;

/// What the picture shows.
pub(super) const CAPTION: &str = "How well every map predicts readings kept back, along the time of the log, and how much worse than the baseline it does: blocks of scans that follow \
    each other, with 95 % intervals; of recalibrated maps, where there are any.";

/// The loss of one map in one block.
pub(super) struct Along {
    pub(super) mapper: String,
    /// `recalibrated` or `plain`.
    pub(super) score: &'static str,
    /// Number of the block, from 0.
    pub(super) block: usize,
    /// Time of its first and last scan, s since the first of the log.
    pub(super) time_s: [f64; 2],
    pub(super) scans: usize,
    pub(super) readings: u64,
    pub(super) loss: Loss,
}

/// A scan kept back: when, and how many of its readings were predicted.
pub(super) struct Kept {
    pub(super) time_s: f64,
    pub(super) readings: u64,
}

/// The blocks of a map, from its losses and the baseline's (nats per scan); blocks without a reading on the map are left out.
pub(super) fn blocks(mapper: &str, score: &'static str, kept: &[Kept], losses: &[f64], baseline: &[f64]) -> Vec<Along> {
    let count = (kept.len() / FEWEST).clamp(1, BLOCKS);
    let block = |number: usize| {
        let range = number * kept.len() / count..(number + 1) * kept.len() / count;
        let series = |of: &dyn Fn(usize) -> f64| -> Option<SeriesMean> {
            series_mean(&range.clone().map(|k| (of(k), kept[k].readings)).collect::<Vec<_>>()).ok()
        };
        let loss = Loss { mean: series(&|k| losses[k])?, difference: series(&|k| losses[k] - baseline[k])? };
        let scans = &kept[range.clone()];
        Some(Along {
            mapper: mapper.to_owned(),
            score,
            block: number,
            time_s: [scans.first()?.time_s, scans.last()?.time_s],
            scans: scans.len(),
            readings: scans.iter().map(|scan| scan.readings).sum(),
            loss,
        })
    };
    (0..count).filter_map(block).collect()
}

/// As it is written: a row per mapper and block.
pub(super) fn table(along: &[Along], baseline: &str) -> Table {
    Table::of(
        along,
        &[
            ("mapper", &|row| json!(row.mapper)),
            ("baseline", &|_| json!(baseline)),
            ("score", &|row| json!(row.score)),
            ("block", &|row| json!(row.block)),
            ("from_s", &|row| rounded(row.time_s[0])),
            ("to_s", &|row| rounded(row.time_s[1])),
            ("scans", &|row| json!(row.scans)),
            ("readings", &|row| json!(row.readings)),
            ("predictive_log_loss", &|row| rounded(row.loss.mean.mean)),
            ("low", &|row| rounded(row.loss.mean.interval.low)),
            ("high", &|row| rounded(row.loss.mean.interval.high)),
            ("difference", &|row| rounded(row.loss.difference.mean)),
            ("difference_low", &|row| rounded(row.loss.difference.interval.low)),
            ("difference_high", &|row| rounded(row.loss.difference.interval.high)),
        ],
    )
}

/// Draws the losses, and the differences from the baseline where there is more than one map.
pub(super) fn draw(along: &[Along], baseline: &str, paper: &Paper) -> Drawing {
    let score = if along.iter().any(|row| row.score == "recalibrated") { "recalibrated" } else { "plain" };
    let rows: Vec<&Along> = along.iter().filter(|row| row.score == score).collect();
    let mut mappers: Vec<&str> = Vec::new();
    for row in &rows {
        if !mappers.contains(&row.mapper.as_str()) {
            mappers.push(&row.mapper);
        }
    }
    let styles = style::of_mappers(&mappers);
    let end_s = rows.iter().map(|row| row.time_s[1]).fold(1.0, f64::max);
    let chart = |title: &str, label: &str, without: Option<&str>, zero: bool, of: fn(&Loss) -> SeriesMean| {
        let shown = || mappers.iter().zip(&styles).filter(|(mapper, _)| without != Some(**mapper));
        let points = |mapper: &str| -> Vec<At> {
            let at = |row: &&Along| {
                let SeriesMean { mean, interval } = of(&row.loss);
                At { x: 0.5 * (row.time_s[0] + row.time_s[1]), y: mean, interval: Some((interval.low, interval.high)) }
            };
            rows.iter().filter(|row| row.mapper == mapper).map(at).collect()
        };
        let mut series: Vec<Series> = shown()
            .map(|(mapper, style)| Series { name: (*mapper).to_owned(), points: points(mapper), style: *style })
            .collect();
        let values = series
            .iter()
            .flat_map(|series| &series.points)
            .flat_map(|at| [at.y, at.interval.map_or(at.y, |i| i.0), at.interval.map_or(at.y, |i| i.1)]);
        let start = if zero { 0.0 } else { f64::INFINITY };
        let (low, high) = values.fold((start, if zero { 0.0 } else { f64::NEG_INFINITY }), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let margin = (0.05 * (high - low)).max(1e-3);
        if zero {
            series.insert(0, Series::new("", Style::guide(), [(0.0, Some(0.0)), (end_s, Some(0.0))]));
        }
        Chart::new(title, Axis::linear("time, s", 0.0..end_s), Axis::linear(label, low - margin..high + margin), series)
    };
    let mut charts = vec![chart("Predictive loss", "nats/reading", None, false, |loss| loss.mean)];
    if mappers.len() > 1 {
        let title = format!("Minus {baseline}");
        charts.push(chart(&title, "nats/reading more", Some(baseline), true, |loss| loss.difference));
    }
    sheet(&charts, 2, (700.0, 560.0), paper)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(count: usize) -> Vec<Kept> {
        (0..count).map(|k| Kept { time_s: k as f64, readings: 1 + (k % 3) as u64 }).collect()
    }

    #[test]
    fn blocks_part_the_scans_and_weigh_them_by_their_readings() {
        for count in [1, 5, 12, 100, 1000] {
            let kept = kept(count);
            let losses: Vec<f64> = kept.iter().map(|scan| scan.time_s * scan.readings as f64).collect();
            let baseline: Vec<f64> = kept.iter().map(|scan| (scan.time_s - 2.0) * scan.readings as f64).collect();
            let blocks = blocks("a", "plain", &kept, &losses, &baseline);
            assert_eq!(blocks.iter().map(|block| block.scans).sum::<usize>(), count);
            assert!(blocks.len() <= BLOCKS && (blocks.len() == 1 || blocks.iter().all(|block| block.scans >= FEWEST)));
            let readings: u64 = blocks.iter().map(|block| block.readings).sum();
            let mean =
                blocks.iter().map(|block| block.loss.mean.mean * block.readings as f64).sum::<f64>() / readings as f64;
            let expected = losses.iter().sum::<f64>() / kept.iter().map(|scan| scan.readings).sum::<u64>() as f64;
            assert!((mean - expected).abs() < 1e-9, "{mean} {expected}");
            for pair in blocks.windows(2) {
                assert!(pair[0].time_s[1] < pair[1].time_s[0]);
            }
            for Along { loss, .. } in &blocks {
                let difference = loss.difference;
                assert!((difference.mean - 2.0).abs() < 1e-9 && (difference.interval.high - 2.0).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn what_predicts_nothing_is_no_block() {
        let mut kept = kept(12);
        kept[..6].iter_mut().for_each(|scan| scan.readings = 0);
        let blocks = blocks("a", "plain", &kept, &[0.0; 12], &[0.0; 12]);
        assert_eq!(blocks.iter().map(|block| block.block).collect::<Vec<_>>(), [1]);
    }
}
