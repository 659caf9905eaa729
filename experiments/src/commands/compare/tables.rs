//! The tables of a comparison, as files hold them.

use score::{LOOK_EDGES, PROBABILITY_EDGES, ProbabilityBin, RANGE_EDGES_M, Summary};
use serde_json::{Value, json};

use super::judgement::{Judgement, Scope};
use super::repeats::Repeated;
use super::world::{ErrorSum, MapScores, WorldScores};
use crate::output::table::{Table, optional, rounded};
use crate::worlds::criteria::CRITERIA;

/// Every metric of every world, mapper and region: a row each, a column per metric.
pub fn scores(worlds: &[WorldScores]) -> Table {
    let metrics = CRITERIA.iter().map(|criterion| criterion.metric);
    let columns: Vec<&str> =
        ["condition", "family", "seed", "mapper", "region", "cells"].into_iter().chain(metrics).collect();
    let mut table = Table::new(&columns);
    for WorldScores { job, maps } in worlds {
        for map in maps {
            for scores in &map.regions {
                let mut row = vec![
                    json!(job.world.condition),
                    json!(job.world.family),
                    json!(job.world.seed),
                    json!(map.mapper),
                    json!(scores.region),
                    json!(scores.cells),
                ];
                row.extend(scores.values.iter().map(|value| optional(*value)));
                table.push(row);
            }
        }
    }
    table
}

/// Mean and spread over the worlds of every scope.
pub fn summary(worlds: &[WorldScores], scopes: &[Scope], mappers: &[&str]) -> Table {
    let columns = ["scope", "region", "mapper", "metric", "unit", "worlds", "mean", "standard_deviation"];
    let mut table = Table::new(&columns);
    for scope in scopes {
        for region in score::Region::ALL {
            for mapper in mappers {
                for (number, criterion) in CRITERIA.iter().enumerate() {
                    let spread = over_worlds(worlds, scope, mapper, region.name(), number);
                    table.push(vec![
                        json!(scope.name),
                        json!(region.name()),
                        json!(mapper),
                        json!(criterion.metric),
                        json!(criterion.unit),
                        json!(spread.map_or(0, |s| s.count)),
                        optional(spread.map(|s| s.mean)),
                        optional(spread.and_then(|s| s.standard_deviation)),
                    ]);
                }
            }
        }
    }
    table
}

/// The spread of a metric, by its place among [`CRITERIA`], over those worlds of a scope in which it has a value.
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
    let mut table = Table::new(&[
        "scope",
        "region",
        "metric",
        "unit",
        "mapper",
        "reference",
        "pairs",
        "dropped",
        "mean",
        "reference_mean",
        "difference",
        "low",
        "high",
        "p",
        "p_holm",
        "rank_biserial",
        "cohen_dz",
        "margin",
        "verdict",
    ]);
    for j in judgements {
        let of = |value: fn(&score::Comparison) -> Option<f64>| optional(j.comparison.as_ref().and_then(value));
        let count =
            |value: fn(&score::Comparison) -> usize| j.comparison.as_ref().map_or(Value::Null, |c| json!(value(c)));
        table.push(vec![
            json!(j.scope),
            json!(j.region),
            json!(j.criterion.metric),
            json!(j.criterion.unit),
            json!(j.mapper),
            json!(reference),
            count(|c| c.pairs),
            count(|c| c.dropped),
            optional(j.mean),
            optional(j.reference_mean),
            of(|c| Some(c.mean_difference)),
            of(|c| Some(c.interval.low)),
            of(|c| Some(c.interval.high)),
            of(|c| Some(c.signed_rank.p)),
            optional(j.adjusted_p),
            of(|c| c.rank_biserial),
            of(|c| c.cohen_dz),
            optional(j.criterion.judged.map(|(_, margin)| margin)),
            j.verdict.map_or(Value::Null, |verdict| json!(verdict.word())),
        ]);
    }
    table
}

/// Reliability diagrams over all worlds of a scope, in the observable region.
pub fn reliability(worlds: &[WorldScores], scopes: &[Scope], mappers: &[&str]) -> Table {
    let columns = ["scope", "mapper", "from", "to", "cells", "mean_probability", "observed_share"];
    let mut table = Table::new(&columns);
    for scope in scopes {
        for mapper in mappers {
            for (edges, bin) in PROBABILITY_EDGES.windows(2).zip(pooled_reliability(worlds, scope, mapper)) {
                table.push(vec![
                    json!(scope.name),
                    json!(mapper),
                    rounded(edges[0]),
                    rounded(edges[1]),
                    json!(bin.cells),
                    optional(bin.mean_probability()),
                    optional(bin.observed_share()),
                ]);
            }
        }
    }
    table
}

/// Error against the range from which a cell was seen best, and against the number of looks at it, over
/// all worlds of a scope, in the observable region. The last bin is open: its upper edge is empty.
pub fn profiles(worlds: &[WorldScores], scopes: &[Scope], mappers: &[&str]) -> Table {
    let columns = ["scope", "mapper", "covariate", "from", "to", "cells", "log_loss", "brier"];
    let mut table = Table::new(&columns);
    for scope in scopes {
        for mapper in mappers {
            for (name, edges, of) in COVARIATES {
                for (edge, bin) in edges.windows(2).zip(pooled_errors(worlds, scope, mapper, of)) {
                    table.push(vec![
                        json!(scope.name),
                        json!(mapper),
                        json!(name),
                        rounded(edge[0]),
                        rounded(edge[1]),
                        json!(bin.cells),
                        optional(bin.mean_log_loss()),
                        optional((bin.cells > 0).then(|| bin.squared_error / bin.cells as f64)),
                    ]);
                }
            }
        }
    }
    table
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

fn maps<'a>(worlds: &'a [WorldScores], scope: &'a Scope, mapper: &'a str) -> impl Iterator<Item = &'a MapScores> {
    scope.worlds.iter().filter_map(move |&world| worlds[world].maps.iter().find(|map| map.mapper == mapper))
}

/// The same scan, again and again.
pub fn repeats(repeated: &[Repeated]) -> Table {
    let columns =
        ["family", "seed", "scan", "mapper", "repeats", "log_loss", "free_known", "phantom_area", "missed_area"];
    let mut table = Table::new(&columns);
    for r in repeated {
        let mut row = vec![json!(r.family), json!(r.seed), json!(r.scan), json!(r.mapper), json!(r.repeats)];
        row.extend([r.log_loss, r.free_known, r.phantom_area, r.missed_area].map(optional));
        table.push(row);
    }
    table
}
