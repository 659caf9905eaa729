//! The tables of a comparison, as files hold them.

use score::{Comparison, LOOK_EDGES, PROBABILITY_EDGES, ProbabilityBin, RANGE_EDGES_M, Summary};
use serde_json::json;

use super::judgement::{Judgement, Scope};
use super::repeats::Repeated;
use super::rows::{Efficient, Rested};
use super::world::{ErrorSum, MapScores, WorldScores, judged_in};
use crate::output::table::{Table, optional, rounded};
use crate::worlds::criteria::Criterion;
use crate::worlds::site::WorldId;

/// Every metric of a mapper in every world and region: a row each, a column per metric.
pub fn scores(worlds: &[WorldScores], mapper: &str) -> Table {
    let mut rows = Vec::new();
    for WorldScores { job, maps, .. } in worlds {
        let own = maps.iter().filter(|map| map.mapper == mapper);
        let regions = own.flat_map(|map| map.regions.iter().map(move |scores| (map, scores)));
        rows.extend(regions.map(|(map, scores)| (&job.world, &map.mapper, scores, &map.fault)));
    }
    let table = Table::of(
        &rows,
        &[
            ("condition", &|row| json!(row.0.condition)),
            ("family", &|row| json!(row.0.family)),
            ("seed", &|row| json!(row.0.seed)),
            ("mapper", &|row| json!(row.1)),
            ("region", &|row| json!(row.2.region)),
            ("cells", &|row| json!(row.2.cells)),
        ],
    );
    let metrics: Vec<&str> = judged_in(worlds).1.iter().map(|criterion| criterion.metric).collect();
    let table = table.with(&rows, &metrics, |row, number| optional(row.2.values.get(number).copied().flatten()));
    match rows.iter().any(|row| row.3.is_some()) {
        true => table.and(&rows, &[("error", &|row| json!(row.3))]),
        false => table,
    }
}

/// A mean over the worlds of a scope.
struct Spread<'a> {
    scope: &'a str,
    region: &'static str,
    mapper: &'a str,
    criterion: &'static Criterion,
    summary: Option<Summary>,
}

/// Mean and spread over the worlds of every scope.
pub fn summary(worlds: &[WorldScores], scopes: &[Scope], mappers: &[&str]) -> Table {
    let mut rows = Vec::new();
    let (regions, criteria) = judged_in(worlds);
    for (scope, region) in scopes.iter().flat_map(|scope| regions.iter().map(move |region| (scope, *region))) {
        for mapper in mappers {
            let criteria = criteria.iter().enumerate().filter(|(_, criterion)| criterion.is_of(region));
            rows.extend(criteria.map(|(number, criterion)| {
                let summary = over_worlds(worlds, scope, mapper, region, number);
                Spread { scope: &scope.name, region, mapper, criterion, summary }
            }));
        }
    }
    Table::of(
        &rows,
        &[
            ("scope", &|row| json!(row.scope)),
            ("region", &|row| json!(row.region)),
            ("mapper", &|row| json!(row.mapper)),
            ("metric", &|row| json!(row.criterion.metric)),
            ("unit", &|row| json!(row.criterion.unit)),
            ("worlds", &|row| json!(row.summary.map_or(0, |s| s.count))),
            ("mean", &|row| optional(row.summary.map(|s| s.mean))),
            ("standard_deviation", &|row| optional(row.summary.and_then(|s| s.standard_deviation))),
        ],
    )
}

/// The spread of a metric, by its place among those of [`judged_in`], over those worlds of a scope in which it has a value.
pub fn over_worlds(
    worlds: &[WorldScores],
    scope: &Scope,
    mapper: &str,
    region: &str,
    criterion: usize,
) -> Option<Summary> {
    let values = scope.worlds.iter().filter_map(|&world| worlds[world].value(mapper, region, criterion));
    Summary::of(&values.collect::<Vec<_>>())
}

/// Every judgement: mapper minus reference.
pub fn differences(judgements: &[Judgement], reference: &str) -> Table {
    let of = |j: &Judgement, value: fn(&Comparison) -> Option<f64>| optional(j.comparison.as_ref().and_then(value));
    let count = |j: &Judgement, value: fn(&Comparison) -> usize| json!(j.comparison.as_ref().map(value));
    Table::of(
        judgements,
        &[
            ("scope", &|j| json!(j.scope)),
            ("region", &|j| json!(j.region)),
            ("metric", &|j| json!(j.criterion.metric)),
            ("unit", &|j| json!(j.criterion.unit)),
            ("mapper", &|j| json!(j.mapper)),
            ("reference", &|_| json!(reference)),
            ("pairs", &|j| count(j, |c| c.pairs)),
            ("dropped", &|j| count(j, |c| c.dropped)),
            ("mean", &|j| optional(j.mean)),
            ("reference_mean", &|j| optional(j.reference_mean)),
            ("difference", &|j| of(j, |c| Some(c.mean_difference))),
            ("low", &|j| of(j, |c| Some(c.interval.low))),
            ("high", &|j| of(j, |c| Some(c.interval.high))),
            ("p", &|j| of(j, |c| Some(c.signed_rank.p))),
            ("p_holm", &|j| optional(j.adjusted_p)),
            ("rank_biserial", &|j| of(j, |c| c.rank_biserial)),
            ("cohen_dz", &|j| of(j, |c| c.cohen_dz)),
            ("margin", &|j| optional(j.criterion.judged.map(|(_, margin)| margin))),
            ("verdict", &|j| json!(j.verdict.map(|verdict| verdict.word()))),
        ],
    )
}

/// Reliability diagrams over all worlds of a scope, in the observable region.
pub fn reliability(worlds: &[WorldScores], scopes: &[Scope], mappers: &[&str]) -> Table {
    let mut rows = Vec::new();
    for (scope, mapper) in scopes.iter().flat_map(|scope| mappers.iter().map(move |mapper| (scope, mapper))) {
        let bins = PROBABILITY_EDGES.windows(2).zip(pooled_reliability(worlds, scope, mapper));
        rows.extend(bins.map(|(edges, bin)| (scope, mapper, edges, bin)));
    }
    Table::of(
        &rows,
        &[
            ("scope", &|row| json!(row.0.name)),
            ("mapper", &|row| json!(row.1)),
            ("from", &|row| rounded(row.2[0])),
            ("to", &|row| rounded(row.2[1])),
            ("cells", &|row| json!(row.3.cells)),
            ("mean_probability", &|row| optional(row.3.mean_probability())),
            ("observed_share", &|row| optional(row.3.observed_share())),
        ],
    )
}

/// Error against the range from which a cell was seen best, and against the number of looks at it, over
/// all worlds of a scope, in the observable region. The last bin is open: its upper edge is empty.
pub fn profiles(worlds: &[WorldScores], scopes: &[Scope], mappers: &[&str]) -> Table {
    let mut rows = Vec::new();
    for (scope, mapper) in scopes.iter().flat_map(|scope| mappers.iter().map(move |mapper| (scope, mapper))) {
        for (name, edges, of) in COVARIATES {
            let bins = edges.windows(2).zip(pooled_errors(worlds, scope, mapper, of));
            rows.extend(bins.map(|(edges, bin)| ((scope, mapper, name), edges, bin)));
        }
    }
    Table::of(
        &rows,
        &[
            ("scope", &|row| json!(row.0.0.name)),
            ("mapper", &|row| json!(row.0.1)),
            ("covariate", &|row| json!(row.0.2)),
            ("from", &|row| rounded(row.1[0])),
            ("to", &|row| rounded(row.1[1])),
            ("cells", &|row| json!(row.2.cells)),
            ("log_loss", &|row| optional(row.2.mean_log_loss())),
            ("brier", &|row| optional((row.2.cells > 0).then(|| row.2.squared_error / row.2.cells as f64))),
        ],
    )
}

/// Which bins of a map's scores.
pub type Profile = fn(&MapScores) -> &[ErrorSum];

/// Name with unit, edges and bins of what error is set against.
pub const COVARIATES: [(&str, &[f64], Profile); 2] =
    [("range_m", &RANGE_EDGES_M, |map| &map.range), ("looks", &LOOK_EDGES, |map| &map.looks)];

/// The reliability bins of a mapper over the worlds of a scope.
pub fn pooled_reliability(worlds: &[WorldScores], scope: &Scope, mapper: &str) -> Vec<ProbabilityBin> {
    let mut pooled = vec![ProbabilityBin::default(); PROBABILITY_EDGES.len() - 1];
    for map in maps(worlds, scope, mapper) {
        pooled.iter_mut().zip(&map.reliability).for_each(|(bin, other)| bin.merge(other));
    }
    pooled
}

/// The error bins of a mapper over the worlds of a scope.
pub fn pooled_errors(worlds: &[WorldScores], scope: &Scope, mapper: &str, of: Profile) -> Vec<ErrorSum> {
    let mut pooled: Vec<ErrorSum> = Vec::new();
    for map in maps(worlds, scope, mapper) {
        pooled.resize(of(map).len(), ErrorSum::default());
        pooled.iter_mut().zip(of(map)).for_each(|(bin, other)| bin.merge(other));
    }
    pooled
}

/// The scores of a mapper in the worlds of a scope.
pub fn maps<'a>(worlds: &'a [WorldScores], scope: &'a Scope, mapper: &'a str) -> impl Iterator<Item = &'a MapScores> {
    scope.worlds.iter().filter_map(move |&world| worlds[world].maps.iter().find(|map| map.mapper == mapper))
}

/// Static accuracy beside the same worlds at rest.
pub fn at_rest(rows: &[Rested]) -> Table {
    Table::of(
        rows,
        &[
            ("mapper", &|r| json!(r.mapper)),
            ("worlds", &|r| json!(r.worlds)),
            ("static_accuracy", &|r| rounded(r.static_accuracy)),
            ("at_rest", &|r| rounded(r.at_rest)),
            ("points_less", &|r| rounded(r.points_less)),
            ("low", &|r| optional(r.low)),
            ("high", &|r| optional(r.high)),
        ],
    )
}

/// How well the draws of mappers that sample agree, world by world; a mapper without a map says why in the table of its scores.
pub fn mixing(worlds: &[WorldScores]) -> Table {
    let of_world = |world: &'_ WorldScores| {
        let WorldId { condition, family, seed, .. } = world.job.world.clone();
        let sampled = world.maps.iter().filter_map(|map| Some((map.mapper.clone(), map.mixing?)));
        sampled
            .map(move |(mapper, mixing)| (condition.clone(), family.clone(), seed, mapper, mixing))
            .collect::<Vec<_>>()
    };
    let rows: Vec<_> = worlds.iter().flat_map(of_world).collect();
    Table::of(
        &rows,
        &[
            ("condition", &|row| json!(row.0)),
            ("family", &|row| json!(row.1)),
            ("seed", &|row| json!(row.2)),
            ("mapper", &|row| json!(row.3)),
            ("chains", &|row| json!(row.4.chains)),
            ("sweeps", &|row| json!(row.4.sweeps)),
            ("r_hat_log_posterior", &|row| optional(Some(row.4.log_posterior).filter(|r_hat| r_hat.is_finite()))),
            ("cells", &|row| json!(row.4.cells)),
            ("share_below_1_05", &|row| rounded(row.4.share)),
            ("effective_log_posterior", &|row| rounded(row.4.effective_log_posterior)),
            ("effective_median", &|row| rounded(row.4.effective)),
            ("agree", &|row| json!(row.4.is_enough())),
        ],
    )
}

/// How far every mapper goes of the way from the prior to `gibbs`.
pub fn efficiency(rows: &[Efficient]) -> Table {
    Table::of(
        rows,
        &[
            ("scope", &|r| json!(r.scope)),
            ("mapper", &|r| json!(r.mapper)),
            ("worlds", &|r| json!(r.worlds)),
            ("log_loss", &|r| rounded(r.log_loss)),
            ("prior", &|r| rounded(r.prior)),
            ("gibbs", &|r| rounded(r.gibbs)),
            ("efficiency", &|r| optional(r.efficiency)),
            ("low", &|r| optional(r.low)),
            ("high", &|r| optional(r.high)),
        ],
    )
}

/// The same scan, again and again.
pub fn repeats(repeated: &[Repeated]) -> Table {
    Table::of(
        repeated,
        &[
            ("family", &|r| json!(r.family)),
            ("seed", &|r| json!(r.seed)),
            ("scan", &|r| json!(r.scan)),
            ("readings", &|r| json!(r.readings.name())),
            ("mapper", &|r| json!(r.mapper)),
            ("repeats", &|r| json!(r.repeats)),
            ("log_loss", &|r| optional(r.log_loss)),
            ("free_known", &|r| optional(r.free_known)),
            ("phantom_area", &|r| optional(r.phantom_area)),
            ("missed_area", &|r| optional(r.missed_area)),
            ("retention", &|r| optional(r.retention)),
        ],
    )
}
