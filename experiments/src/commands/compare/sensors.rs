//! What a second sensor is worth: every mapper by suite of sensors, and each suite against the better one of its sensors alone.

use score::{Better, Comparison, Summary};
use serde_json::json;

use super::judgement::Scope;
use super::plan::{Plan, REFERENCE};
use super::rows::{Rows, Sensed};
use super::sheets::ALL;
use super::world::{WorldScores, judged_in};
use crate::failure::Failure;
use crate::output::table::{Table, optional};
use crate::page::{Cell, Sheet, Tone};
use crate::worlds::condition::SUITES;
use crate::worlds::criteria::{Criterion, criterion};
use crate::worlds::sensed::{GLASS, IN_REACH, LEGS, REGIONS};

/// The metrics of the table.
const BY: [&str; 4] = ["log_loss", "brier", "recall_50", "free_known"];

/// The scopes: all worlds and every family, with the numbers of the worlds of each suite in the order of [`SUITES`], world by world the same.
fn scopes(plan: &Plan, worlds: &[WorldScores]) -> Vec<(String, Vec<Scope>)> {
    let families = plan.families.iter().map(|family| Some(family.name.as_str()));
    let of = |family: Option<&str>| {
        let is_of = |world: &WorldScores, suite: &str| {
            world.job.world.condition == suite && family.is_none_or(|family| world.job.world.family == family)
        };
        let scope = |suite: &str| Scope {
            name: suite.to_owned(),
            worlds: (0..worlds.len()).filter(|number| is_of(&worlds[*number], suite)).collect(),
        };
        (family.unwrap_or(ALL).to_owned(), SUITES.iter().map(|suite| scope(suite.name)).collect())
    };
    let of_families = if plan.families.len() > 1 { families.map(of).collect() } else { Vec::new() };
    [of(None)].into_iter().chain(of_families).collect()
}

/// A row for every scope, region, metric, mapper and suite; nothing of a comparison of other worlds.
///
/// # Errors
/// Values that are no numbers.
pub(super) fn rows(plan: &Plan, worlds: &[WorldScores]) -> Result<Vec<Sensed>, Failure> {
    let mut rows = Vec::new();
    if !plan.has_suites() {
        return Ok(rows);
    }
    let criteria = judged_in(worlds).1;
    let chosen: Vec<(usize, &Criterion)> =
        criteria.into_iter().enumerate().filter(|(_, criterion)| BY.contains(&criterion.metric)).collect();
    for (scope, suites) in scopes(plan, worlds) {
        for region in REGIONS {
            for &(number, criterion) in &chosen {
                for mapper in plan.names() {
                    let values = |suite: &Scope| -> Vec<Option<f64>> {
                        suite.worlds.iter().map(|world| worlds[*world].value(mapper, region, number)).collect()
                    };
                    let of_suites: Vec<Vec<Option<f64>>> = suites.iter().map(values).collect();
                    for row in of_mapper(&of_suites, criterion)? {
                        rows.push(Sensed {
                            scope: scope.clone(),
                            region: region.to_owned(),
                            metric: criterion.metric.to_owned(),
                            mapper: mapper.to_owned(),
                            ..row
                        });
                    }
                }
            }
        }
    }
    Ok(rows)
}

/// The suites of one mapper by one metric: `values` are of every suite, world by world the same.
fn of_mapper(values: &[Vec<Option<f64>>], criterion: &Criterion) -> Result<Vec<Sensed>, Failure> {
    let Some((better, margin)) = criterion.judged else { return Ok(Vec::new()) };
    let summary = |suite: usize| Summary::of(&values[suite].iter().flatten().copied().collect::<Vec<_>>());
    let mean = |suite: usize| summary(suite).map(|summary| summary.mean);
    let mut rows = Vec::new();
    for (number, suite) in SUITES.iter().enumerate() {
        let carried = suite.suite.unwrap_or_default();
        // Those of its sensors, alone, the better one first.
        let mut alone: Vec<(f64, usize)> = SUITES
            .iter()
            .enumerate()
            .filter(|(_, one)| one.suite.is_some_and(|one| one.len() == 1 && carried.contains(&one[0])))
            .filter_map(|(one, _)| Some((mean(one)?, one)))
            .collect();
        alone.sort_by(|a, b| if better == Better::Lower { a.0.total_cmp(&b.0) } else { b.0.total_cmp(&a.0) });
        let best = alone.first().filter(|_| carried.len() > 1).map(|(_, one)| *one);
        let comparison = match best {
            Some(best) if pairs(&values[number], &values[best]) > 1 => {
                Some(Comparison::of_defined(&values[number], &values[best]).map_err(Failure::internal)?)
            }
            _ => None,
        };
        let interval = comparison.as_ref().map(|comparison| comparison.interval);
        rows.push(Sensed {
            suite: suite.name.to_owned(),
            worlds: summary(number).map_or(0, |summary| summary.count),
            mean: mean(number),
            better_alone: best.map(|best| SUITES[best].name.to_owned()),
            difference: comparison.as_ref().map(|comparison| comparison.mean_difference),
            low: interval.map(|interval| interval.low),
            high: interval.map(|interval| interval.high),
            margin: best.map(|_| margin),
            not_worse: interval.map(|interval| match better {
                Better::Lower => interval.high < margin,
                Better::Higher => interval.low > -margin,
            }),
            ..Sensed::default()
        });
    }
    Ok(rows)
}

fn pairs(ours: &[Option<f64>], theirs: &[Option<f64>]) -> usize {
    ours.iter().zip(theirs).filter(|(a, b)| a.is_some() && b.is_some()).count()
}

/// `sensors.csv`.
pub(super) fn table(rows: &[Sensed]) -> Table {
    Table::of(
        rows,
        &[
            ("scope", &|row| json!(row.scope)),
            ("region", &|row| json!(row.region)),
            ("metric", &|row| json!(row.metric)),
            ("mapper", &|row| json!(row.mapper)),
            ("suite", &|row| json!(row.suite)),
            ("worlds", &|row| json!(row.worlds)),
            ("mean", &|row| optional(row.mean)),
            ("better_alone", &|row| json!(row.better_alone)),
            ("difference", &|row| optional(row.difference)),
            ("low", &|row| optional(row.low)),
            ("high", &|row| optional(row.high)),
            ("margin", &|row| optional(row.margin)),
            ("not_worse", &|row| json!(row.not_worse)),
        ],
    )
}

/// The tables for reading: means of every mapper by suite, and the reference against the better one alone, family by family. None of other worlds.
pub(super) fn sheets(plan: &Plan, rows: &Rows) -> Vec<Sheet> {
    if !plan.has_suites() {
        return Vec::new();
    }
    let means = [(IN_REACH, "log_loss"), (IN_REACH, "recall_50"), (GLASS, "recall_50"), (LEGS, "recall_50")];
    let means = means.map(|(region, metric)| means_by_suite(plan, rows, region, metric));
    let against = ["log_loss", "recall_50"].map(|metric| against_the_better(plan, rows, metric));
    means.into_iter().chain(against).collect()
}

/// What a region of suites is, in words.
pub(super) fn region_in_words(region: &str) -> Option<&'static str> {
    match region {
        IN_REACH => Some("all that any of the three sensors could see"),
        GLASS => Some("panes of glass"),
        LEGS => Some("thin legs"),
        _ => None,
    }
}

fn find<'a>(rows: &'a Rows, key: [&str; 5]) -> Option<&'a Sensed> {
    let is = |row: &&Sensed| [&row.scope, &row.region, &row.metric, &row.mapper, &row.suite].map(String::as_str) == key;
    rows.sensors.iter().find(is)
}

fn means_by_suite(plan: &Plan, rows: &Rows, region: &str, metric: &str) -> Sheet {
    let (title, decimals) = criterion(metric).map_or(("", 3), |criterion| (criterion.title, criterion.decimals));
    let cell = |mapper: &str, suite: &str| {
        let mean = find(rows, [ALL, region, metric, mapper, suite]).and_then(|row| row.mean);
        Cell::from(mean.map_or_else(|| "-".to_owned(), |mean| format!("{mean:.decimals$}")))
    };
    let row = |mapper: &'static str| {
        [Cell::from(mapper)].into_iter().chain(SUITES.iter().map(|suite| cell(mapper, suite.name))).collect()
    };
    Sheet {
        caption: format!("{title} by sensors, {}", region_in_words(region).unwrap_or(region)),
        note: String::new(),
        heads: ["mapper"].into_iter().chain(SUITES.iter().map(|suite| suite.name)).map(str::to_owned).collect(),
        rows: plan.names().into_iter().map(row).collect(),
    }
}

fn against_the_better(plan: &Plan, rows: &Rows, metric: &str) -> Sheet {
    let (title, decimals) = criterion(metric).map_or(("", 3), |criterion| (criterion.title, criterion.decimals));
    let several = || SUITES.iter().filter(|suite| suite.suite.is_some_and(|suite| suite.len() > 1));
    let cell = |scope: &str, suite: &str| match find(rows, [scope, IN_REACH, metric, REFERENCE, suite]) {
        Some(Sensed { difference: Some(difference), low: Some(low), high: Some(high), not_worse, .. }) => {
            let text = format!("{difference:+.decimals$} [{low:+.decimals$}, {high:+.decimals$}]");
            Cell::toned(text, if *not_worse == Some(true) { Tone::Even } else { Tone::Bad })
        }
        _ => "-".into(),
    };
    let row =
        |scope: &str| [Cell::from(scope)].into_iter().chain(several().map(|suite| cell(scope, suite.name))).collect();
    let families = plan.families.iter().map(|family| family.name.as_str()).filter(|_| plan.families.len() > 1);
    let margin = criterion(metric).and_then(|c| c.judged).map_or(0.0, |(_, margin)| margin);
    Sheet {
        caption: format!("{title} of {REFERENCE}: several sensors minus the better one of them alone; margin {margin}"),
        note: String::new(),
        heads: ["family"].into_iter().chain(several().map(|suite| suite.name)).map(str::to_owned).collect(),
        rows: [ALL].into_iter().chain(families).map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The better one alone is that with the better mean, and what counts is the interval's end on the bad side.
    #[test]
    fn several_are_held_against_the_better_one_alone() {
        let loss = criterion("log_loss").expect("listed");
        let around = |mean: f64| (0..12).map(|k| Some(mean + 0.0001 * f64::from(k % 3))).collect::<Vec<_>>();
        let means = [0.10, 0.06, 0.30, 0.0605, 0.09, 0.08, 0.05];
        let rows = of_mapper(&means.map(around), loss).expect("numbers");
        let row = |suite: &str| rows.iter().find(|row| row.suite == suite).expect("a row");
        assert_eq!((row("camera").better_alone.as_deref(), row("camera").not_worse), (None, None));
        let expected = [
            ("camera-laser", "laser", 0.0005, true),
            ("camera-sonar", "camera", -0.01, true),
            ("laser-sonar", "laser", 0.02, false),
            ("all-three", "laser", -0.01, true),
        ];
        for (suite, better, difference, not_worse) in expected {
            let row = row(suite);
            assert_eq!((row.better_alone.as_deref(), row.not_worse), (Some(better), Some(not_worse)), "{suite}");
            assert!((row.difference.expect("pairs") - difference).abs() < 1e-12, "{suite}");
        }
        // A share is better when it is greater.
        let recall = criterion("recall_50").expect("listed");
        let rows = of_mapper(&[0.5, 0.8, 0.9, 0.7, 0.85, 0.95, 0.9].map(around), recall).expect("numbers");
        let verdicts: Vec<_> = rows[3..].iter().map(|row| (row.better_alone.as_deref(), row.not_worse)).collect();
        let [laser, sonar] = ["laser", "sonar"].map(Some);
        assert_eq!(verdicts, [(laser, Some(false)), (sonar, Some(false)), (sonar, Some(true)), (sonar, Some(true))]);
    }

    /// A single world has no interval, and a suite without a value no comparison.
    #[test]
    fn too_few_pairs_have_no_verdict() {
        let loss = criterion("log_loss").expect("listed");
        let one: Vec<Vec<Option<f64>>> = vec![vec![Some(0.1)]; 7];
        let rows = of_mapper(&one, loss).expect("numbers");
        assert!(rows.iter().all(|row| row.not_worse.is_none() && row.mean.is_some() && row.worlds == 1));
        let none: Vec<Vec<Option<f64>>> = vec![vec![None, None]; 7];
        assert!(
            of_mapper(&none, loss).expect("numbers").iter().all(|row| row.mean.is_none() && row.difference.is_none())
        );
    }
}
