//! Which mapper is better than the reference, where, by how much and how surely.

use rayon::prelude::*;
use score::{Comparison, Margin, StatisticsError, Verdict, holm_table};

use super::world::{WorldScores, judged_in};
use crate::failure::Failure;
use crate::worlds::criteria::Criterion;

/// A set of worlds that is judged together.
#[derive(Debug, Clone, PartialEq)]
pub struct Scope {
    /// `all`, or the name of a family or a condition.
    pub name: String,
    /// Numbers of its worlds.
    pub worlds: Vec<usize>,
}

/// A mapper against the reference, by one metric in one region.
#[derive(Debug, Clone)]
pub struct Judgement {
    /// Name of the scope.
    pub scope: String,
    /// Name of the region.
    pub region: &'static str,
    /// The metric.
    pub criterion: &'static Criterion,
    /// The mapper compared with the reference.
    pub mapper: String,
    /// Mean of the mapper over the pairs; none without a pair.
    pub mean: Option<f64>,
    /// Mean of the reference over the same pairs.
    pub reference_mean: Option<f64>,
    /// The differences, mapper minus reference; none with fewer than two pairs.
    pub comparison: Option<Comparison>,
    /// p of the signed-rank test, adjusted within scope and region over all mappers and judged metrics.
    pub adjusted_p: Option<f64>,
    /// The verdict on the mapper; none of a metric that does not judge.
    pub verdict: Option<Verdict>,
}

/// The worlds as one scope and, where there are several, those of every family and every condition.
pub fn scopes(worlds: &[WorldScores]) -> Vec<Scope> {
    let mut scopes = vec![Scope { name: "all".to_owned(), worlds: (0..worlds.len()).collect() }];
    for name in [|w: &WorldScores| w.job.world.family.clone(), |w: &WorldScores| w.job.world.condition.clone()] {
        let mut parts: Vec<Scope> = Vec::new();
        for (number, world) in worlds.iter().enumerate() {
            match parts.iter_mut().find(|part| part.name == name(world)) {
                Some(part) => part.worlds.push(number),
                None => parts.push(Scope { name: name(world), worlds: vec![number] }),
            }
        }
        scopes.extend(parts.into_iter().skip_while(|part| part.worlds.len() == worlds.len()));
    }
    scopes
}

/// Judges every mapper but the reference in every scope and region by every metric.
///
/// # Errors
/// Values that are no numbers.
pub fn judge(
    worlds: &[WorldScores],
    scopes: &[Scope],
    mappers: &[&str],
    reference: &str,
) -> Result<Vec<Judgement>, Failure> {
    let rivals: Vec<&str> = mappers.iter().copied().filter(|name| *name != reference).collect();
    let (regions, criteria) = judged_in(worlds);
    let tables: Vec<(&Scope, &'static str)> =
        scopes.iter().flat_map(|scope| regions.iter().map(move |region| (scope, *region))).collect();
    let judged: Result<Vec<_>, StatisticsError> = tables
        .par_iter()
        .map(|(scope, region)| table(worlds, (scope, region), &criteria, &rivals, reference))
        .collect();
    Ok(judged.map_err(Failure::internal)?.into_iter().flatten().collect())
}

/// One table: a row per rival, a column per metric; one family of tests.
fn table(
    worlds: &[WorldScores],
    (scope, region): (&Scope, &'static str),
    criteria: &[&'static Criterion],
    rivals: &[&str],
    reference: &str,
) -> Result<Vec<Judgement>, StatisticsError> {
    let values = |mapper: &str, number: usize| -> Vec<Option<f64>> {
        scope.worlds.iter().map(|&world| worlds[world].value(mapper, region, number)).collect()
    };
    let mut rows = Vec::new();
    for rival in rivals {
        for (number, &criterion) in criteria.iter().enumerate().filter(|(_, criterion)| criterion.is_of(region)) {
            let (theirs, ours) = (values(rival, number), values(reference, number));
            let pairs: Vec<(f64, f64)> = theirs.iter().zip(&ours).filter_map(|(t, o)| Some(((*t)?, (*o)?))).collect();
            let mean = |of: fn(&(f64, f64)) -> f64| {
                (!pairs.is_empty()).then(|| pairs.iter().map(of).sum::<f64>() / pairs.len() as f64)
            };
            let comparison = if pairs.len() < 2 { None } else { Some(Comparison::of_defined(&theirs, &ours)?) };
            rows.push(Judgement {
                scope: scope.name.clone(),
                region,
                criterion,
                mapper: (*rival).to_owned(),
                mean: mean(|pair| pair.0),
                reference_mean: mean(|pair| pair.1),
                comparison,
                adjusted_p: None,
                verdict: None,
            });
        }
    }
    let p =
        |row: &Judgement| row.comparison.as_ref().filter(|_| row.criterion.judged.is_some()).map(|c| c.signed_rank.p);
    let metrics = criteria.iter().filter(|criterion| criterion.is_of(region)).count();
    let adjusted = holm_table(&rows.chunks(metrics).map(|row| row.iter().map(p).collect()).collect::<Vec<_>>())?;
    for (row, adjusted) in rows.iter_mut().zip(adjusted.into_iter().flatten()) {
        row.adjusted_p = adjusted;
        row.verdict = match (row.criterion.judged, &row.comparison, adjusted) {
            (Some((better, margin)), Some(comparison), Some(p)) => {
                Some(comparison.verdict(better, Some(Margin::new(margin)?), p))
            }
            (Some(_), ..) => Some(Verdict::Undecided),
            (None, ..) => None,
        };
    }
    Ok(rows)
}

/// The judgement of a mapper by a metric in a scope and region.
pub fn find<'a>(
    judgements: &'a [Judgement],
    scope: &str,
    region: &str,
    mapper: &str,
    metric: &str,
) -> Option<&'a Judgement> {
    judgements
        .iter()
        .find(|j| j.scope == scope && j.region == region && j.mapper == mapper && j.criterion.metric == metric)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::compare::world::{MapScores, RegionScores, WorldJob};
    use crate::worlds::criteria::CRITERIA;
    use crate::worlds::site::WorldId;
    use score::Region;

    /// Worlds in which every metric of every region is the value given for each mapper.
    fn worlds(values: &[[Option<f64>; 2]]) -> Vec<WorldScores> {
        let map = |mapper: &str, value: Option<f64>| MapScores {
            mapper: mapper.to_owned(),
            regions: Region::ALL
                .iter()
                .map(|r| RegionScores { region: r.name().to_owned(), cells: 1, values: vec![value; CRITERIA.len()] })
                .collect(),
            reliability: Vec::new(),
            range: Vec::new(),
            looks: Vec::new(),
            mixing: None,
            fault: None,
        };
        let world = |(k, [ours, theirs]): (usize, &[Option<f64>; 2])| {
            let family = ["f", "g"][k % 2].to_owned();
            let world = WorldId { family, condition: "as-believed".to_owned(), cell_um: None, seed: k as u64 };
            let job = WorldJob { world, batch: true };
            WorldScores { job, maps: vec![map("visibility", *ours), map("rival", *theirs)], at_rest: Vec::new() }
        };
        values.iter().enumerate().map(world).collect()
    }

    fn judged(values: &[[Option<f64>; 2]]) -> Vec<Judgement> {
        let worlds = worlds(values);
        judge(&worlds, &scopes(&worlds), &["visibility", "rival"], "visibility").expect("numbers")
    }

    #[test]
    fn scopes_are_all_worlds_and_their_parts() {
        let worlds = worlds(&[[None; 2]; 5]);
        let found: Vec<_> = scopes(&worlds).into_iter().map(|s| (s.name, s.worlds)).collect();
        let expected = [("all", vec![0, 1, 2, 3, 4]), ("f", vec![0, 2, 4]), ("g", vec![1, 3])];
        assert_eq!(found, expected.map(|(name, worlds)| (name.to_owned(), worlds)), "the only condition is no part");
    }

    #[test]
    fn a_rival_with_more_loss_is_worse_and_one_with_more_retention_better() {
        let values: Vec<_> =
            (0..30).map(|k| [Some(0.1 + 0.001 * f64::from(k)), Some(0.2 + 0.002 * f64::from(k))]).collect();
        let judged = judged(&values);
        let verdict = |metric| find(&judged, "all", "observable", "rival", metric).and_then(|j| j.verdict);
        assert_eq!(verdict("log_loss"), Some(Verdict::Worse));
        assert_eq!(verdict("retention"), Some(Verdict::Better));
        assert_eq!(verdict("decided"), None, "a metric that does not judge");
        let loss = find(&judged, "all", "observable", "rival", "log_loss").expect("there");
        let comparison = loss.comparison.as_ref().expect("thirty pairs");
        assert!((comparison.mean_difference - (0.1 + 0.0145)).abs() < 1e-12);
        assert!(find(&judged, "all", "observable", "rival", "reached").is_none(), "drives are of the whole world");
        let of_drives = find(&judged, "all", "all", "rival", "reached").and_then(|j| j.adjusted_p).expect("adjusted");
        assert!((of_drives / comparison.signed_rank.p - 18.0).abs() < 1e-9, "{of_drives}");
        assert!((loss.mean.expect("a mean") - loss.reference_mean.expect("a mean") - 0.1145).abs() < 1e-12);
        // Fourteen tests of equal p in the table: each is multiplied by fourteen.
        let adjusted = loss.adjusted_p.expect("adjusted");
        assert!((adjusted / comparison.signed_rank.p - 14.0).abs() < 1e-9, "{adjusted}");
    }

    #[test]
    fn what_has_no_pairs_has_no_numbers() {
        let judged = judged(&[[Some(0.1), None], [None, Some(0.2)], [Some(0.1), Some(0.3)]]);
        let loss = find(&judged, "all", "all", "rival", "log_loss").expect("there");
        assert_eq!((loss.mean, loss.reference_mean), (Some(0.3), Some(0.1)), "one pair has means");
        assert!(loss.comparison.is_none() && loss.adjusted_p.is_none());
        assert_eq!(loss.verdict, Some(Verdict::Undecided));
        let half = find(&judged, "g", "all", "rival", "log_loss").expect("there");
        assert_eq!((half.mean, half.verdict), (None, Some(Verdict::Undecided)));
    }
}
