//! How far a mapper goes of the way from the prior to the best that these readings and this prior allow, `gibbs`.

use score::ratio_of_means;

use super::judgement::Scope;
use super::rows::Efficient;
use super::sheets::{ALL, OBSERVABLE, Width};
use super::world::{WorldScores, judged_in};
use crate::page::{Cell, Sheet};

/// The mapper that stands for no reading at all ...
const NONE: &str = "prior";

/// ... and those for the best that can be had: the first that is among the mappers.
const BEST: [&str; 2] = ["gibbs", "gibbs-unchecked"];

/// A row for every scope and mapper but the two ends, on the worlds in which all three have a map; nothing where one of the ends is not among the mappers.
///
/// Efficiency is `(prior - mapper) / (prior - gibbs)` in log loss over what could be seen: means over worlds before the ratio, see
/// [`ratio_of_means`]. It may leave 0 to 1. None where the prior is no worse than `gibbs`.
pub(super) fn rows(worlds: &[WorldScores], scopes: &[Scope], mappers: &[&str]) -> Vec<Efficient> {
    let place = judged_in(worlds).1.iter().position(|criterion| criterion.metric == "log_loss");
    let best = BEST.into_iter().find(|best| mappers.contains(best));
    let (Some(place), Some(best)) = (place.filter(|_| mappers.contains(&NONE)), best) else { return Vec::new() };
    let row = |scope: &Scope, mapper: &&str| {
        let losses = |world: &usize| {
            let of = |mapper| worlds[*world].value(mapper, OBSERVABLE, place);
            Some([of(mapper)?, of(NONE)?, of(best)?])
        };
        let losses: Vec<[f64; 3]> = scope.worlds.iter().filter_map(losses).collect();
        let mean = |k: usize| losses.iter().map(|loss| loss[k]).sum::<f64>() / losses.len() as f64;
        let pairs: Vec<_> = losses.iter().map(|[own, none, best]| (none - own, none - best)).collect();
        let ratio = ratio_of_means(&pairs);
        let interval = ratio.and_then(|ratio| ratio.interval);
        (!losses.is_empty()).then(|| Efficient {
            scope: scope.name.clone(),
            mapper: (*mapper).to_owned(),
            worlds: losses.len(),
            log_loss: mean(0),
            prior: mean(1),
            gibbs: mean(2),
            efficiency: ratio.map(|ratio| ratio.value),
            low: interval.map(|interval| interval.low),
            high: interval.map(|interval| interval.high),
        })
    };
    let rules = || mappers.iter().filter(|name| ![NONE, best].contains(*name));
    scopes.iter().flat_map(|scope| rules().filter_map(move |mapper| row(scope, mapper))).collect()
}

/// As it is shown: all worlds with the interval, and every part; none where there is nothing to show.
pub(super) fn sheet(rows: &[Efficient], parts: &[&str], width: Width) -> Option<Sheet> {
    // What a terminal has room for.
    let parts = if parts.len() == 1 || width == Width::Terminal && parts.len() > 4 { &[] } else { parts };
    let of = |scope: &str, mapper: &str| rows.iter().find(|row| row.scope == scope && row.mapper == mapper);
    let value = |row: Option<&Efficient>| {
        row.and_then(|row| row.efficiency).map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"))
    };
    let with_interval = |row: &Efficient| match (row.low, row.high) {
        (Some(low), Some(high)) => format!("{} [{low:.2}, {high:.2}]", value(Some(row))),
        _ => value(Some(row)),
    };
    let line = |row: &Efficient| {
        let all = [Cell::from(row.mapper.as_str()), row.worlds.to_string().into(), with_interval(row).into()];
        let part = |part: &&str| match (of(part, &row.mapper), width) {
            (Some(row), Width::Page) => Cell::from(with_interval(row)),
            (row, _) => value(row).into(),
        };
        all.into_iter().chain(parts.iter().map(part)).collect()
    };
    let heads = ["mapper", "worlds", "all, 95 % interval"].into_iter().chain(parts.iter().copied());
    (!rows.is_empty()).then(|| Sheet {
        caption: "Efficiency by log loss: (prior - mapper) / (prior - gibbs)".to_owned(),
        note: match width {
            Width::Terminal => String::new(),
            Width::Page => "0 is the prior, 1 the posterior over whole maps, on the worlds in which gibbs has a map; means over worlds before the ratio, \
                            intervals by a bootstrap of worlds"
                .to_owned(),
        },
        heads: heads.map(str::to_owned).collect(),
        rows: rows.iter().filter(|row| row.scope == ALL).map(line).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::compare::judgement::scopes;
    use crate::commands::compare::world::{MapScores, RegionScores, WorldJob};
    use crate::worlds::criteria::CRITERIA;
    use crate::worlds::site::WorldId;

    const MAPPERS: [&str; 3] = ["visibility", "prior", "gibbs"];

    /// Worlds of two families in turn with the log loss given for each of the three.
    fn worlds(losses: &[[Option<f64>; 3]]) -> Vec<WorldScores> {
        let map = |(mapper, loss): (&str, &Option<f64>)| MapScores {
            mapper: mapper.to_owned(),
            regions: vec![RegionScores {
                region: OBSERVABLE.to_owned(),
                cells: 1,
                values: vec![*loss; CRITERIA.len()],
            }],
            reliability: Vec::new(),
            range: Vec::new(),
            looks: Vec::new(),
            mixing: None,
            fault: None,
        };
        let world = |(k, losses): (usize, &[Option<f64>; 3])| {
            let family = ["f", "g"][k % 2].to_owned();
            let world = WorldId { family, condition: "as-believed".to_owned(), cell_um: None, seed: k as u64 };
            let maps = MAPPERS.into_iter().zip(losses).map(map).collect();
            WorldScores { job: WorldJob { world, batch: true }, maps, at_rest: Vec::new() }
        };
        losses.iter().enumerate().map(world).collect()
    }

    #[test]
    fn it_is_the_share_of_the_way_where_gibbs_has_a_map() {
        let worlds = worlds(&[
            [Some(0.15), Some(0.2), Some(0.1)],
            [Some(0.2), Some(0.3), Some(0.1)],
            [Some(9.0), Some(0.2), None],
            [Some(0.05), Some(0.3), Some(0.1)],
        ]);
        let found = rows(&worlds, &scopes(&worlds), &MAPPERS);
        let all: Vec<_> = found.iter().map(|row| (row.scope.as_str(), row.worlds)).collect();
        assert_eq!(all, [("all", 3), ("f", 1), ("g", 2)]);
        let values: Vec<f64> = found.iter().map(|row| row.efficiency.expect("gibbs is better")).collect();
        for (value, expected) in values.iter().zip([0.4 / 0.5, 0.5, 0.35 / 0.4]) {
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
        assert!(found[0].low.zip(found[0].high).is_some_and(|(low, high)| low < 0.8 && 0.8 < high && high > 1.0));
        assert_eq!((found[1].low, found[1].high), (None, None), "one world");
        let sheet = sheet(&found, &["f", "g"], Width::Terminal).expect("something");
        let shown: Vec<&str> = sheet.rows[0].iter().map(|cell| cell.text.as_str()).collect();
        assert_eq!((shown[0], shown[1], shown[3], shown[4]), ("visibility", "3", "0.50", "0.88"));
        assert!(shown[2].starts_with("0.80 ["), "{shown:?}");
    }

    #[test]
    fn without_both_ends_there_is_none() {
        let worlds = worlds(&[[Some(0.15), Some(0.2), Some(0.1)]; 3]);
        for ends in [&["visibility", "prior"][..], &["visibility", "gibbs"][..]] {
            assert_eq!(rows(&worlds, &scopes(&worlds), ends), []);
        }
        assert!(sheet(&[], &["f"], Width::Page).is_none());
    }
}
