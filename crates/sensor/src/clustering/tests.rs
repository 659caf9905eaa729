use rand_chacha::{ChaCha8Rng, rand_core::SeedableRng as _};

use super::*;
use crate::Stereo;

const COLUMNS: usize = 500;

fn clustered(clustering: Clustering, disparity_sigma: f64) -> Matcher {
    let stereo = Stereo { disparity_sigma, ..Stereo::default() };
    Matcher { stereo, mismatches: Mismatches::Clustered(clustering), ..Matcher::default() }
}

/// Rows of surfaces 3 to 12 columns wide as a robot sees furniture: true disparities (px) in `range`, the
/// next surface at least `step` px away.
fn rows(count: u64, range: [f64; 2], step: f64) -> Vec<Vec<f64>> {
    let row = |seed| {
        let mut rng = ChaCha8Rng::seed_from_u64(1000 + seed);
        let mut row = Vec::new();
        let mut last = f64::NEG_INFINITY;
        while row.len() < COLUMNS {
            let px = range[0] + (range[1] - range[0]) * rng.random::<f64>();
            if (px - last).abs() >= step {
                last = px;
                row.extend(vec![px; rng.random_range(3..=12)]);
            }
        }
        row.truncate(COLUMNS);
        row
    };
    (0..count).map(row).collect()
}

/// The scan of a row of true disparities (px).
fn scan(matcher: &Matcher, row: &[f64], seed: u64) -> Vec<Option<f64>> {
    let surfaces: Vec<_> = row.iter().map(|px| Some(Surface { range_m: 15.0 / px, texture: 1.0 })).collect();
    matcher.scan(&vec![0.0; row.len()], &surfaces, |column| {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        rng.set_word_pos(64 * column as u128);
        rng
    })
}

/// A share that was counted, and of how many.
#[derive(Default, Clone, Copy)]
struct Share {
    yes: f64,
    of: f64,
}

impl Share {
    fn count(&mut self, yes: bool) {
        self.yes += f64::from(u8::from(yes));
        self.of += 1.0;
    }

    fn value(self) -> f64 {
        self.yes / self.of
    }

    /// Fails outside four binomial standard deviations, widened where draws depend on each other.
    fn is(self, expected: f64, widened: f64, what: &str) {
        let bound = 4.0 * widened * (expected * (1.0 - expected) / self.of).sqrt();
        let found = self.value();
        assert!((found - expected).abs() < bound, "{what}: {found}, expected {expected} +- {bound} of {}", self.of);
    }
}

/// With almost no noise and surfaces far apart in disparity every reading tells what it is.
#[test]
fn the_statistics_are_those_asked_for() {
    for (clustering, correct_match) in [
        (Clustering::default(), 0.8),
        (Clustering { persistence: 0.7, copies: 0.4, near_misses: 0.4, copy_reach: 3 }, 0.6),
        (Clustering { persistence: 0.2, copies: 0.0, near_misses: 1.0, copy_reach: 7 }, 0.8),
    ] {
        let mut matcher = clustered(clustering, 1e-3);
        matcher.stereo.correct_match = correct_match;
        let [mut detected, mut failed, mut after_failed, mut after_correct, mut copies, mut near] =
            [Share::default(); 6];
        for (seed, row) in rows(400, [6.0, 54.0], 6.0).iter().enumerate() {
            let mut before: Option<bool> = None;
            for (column, reading) in scan(&matcher, row, seed as u64).into_iter().enumerate() {
                detected.count(reading.is_some());
                let Some(reading) = reading else { continue };
                let error = (reading - row[column]).abs();
                let fails = error > 0.01;
                failed.count(fails);
                match before.replace(fails) {
                    Some(true) => after_failed.count(fails),
                    Some(false) => after_correct.count(fails),
                    None => {}
                }
                let in_reach = |away: i64| {
                    let at = usize::try_from(column as i64 + away).ok()?;
                    row.get(at).filter(|px| (*px - row[column]).abs() > 1.0)
                };
                let reach = i64::from(clustering.copy_reach);
                if fails && (-reach..=reach).any(|away| in_reach(away).is_some()) {
                    copies.count((-reach..=reach).filter_map(in_reach).any(|px| (px - reading).abs() < 0.01));
                    near.count((1.0..=3.0).contains(&error));
                }
            }
        }
        let rate = 1.0 - correct_match;
        let from_correct = rate * (1.0 - clustering.persistence) / correct_match;
        let memory = clustering.persistence - from_correct;
        detected.is(0.6, 1.0, "detected");
        failed.is(rate, ((1.0 + memory) / (1.0 - memory)).sqrt(), "mismatches");
        after_failed.is(clustering.persistence, 1.0, "mismatches after a mismatch");
        after_correct.is(from_correct, 1.0, "mismatches after a correct match");
        if clustering.copies > 0.0 {
            copies.is(clustering.copies, 1.0, "copies");
            // Of the uniform rest, 4 px of the 60 look like near misses.
            let rest = 1.0 - clustering.copies - clustering.near_misses;
            near.is(clustering.near_misses + rest * 4.0 / 60.0, 1.0, "near misses");
        } else {
            assert!((near.value() - 1.0).abs() < 1e-12 && copies.yes == 0.0, "{} {}", near.value(), copies.yes);
        }
    }
}

/// The same counts as were made on real pairs: wrong is more than 1 px off, whatever the reason.
#[test]
fn the_defaults_look_like_real_stereo() {
    for sigma in [0.2, 0.5] {
        let matcher = clustered(Clustering::default(), sigma);
        let [mut wrong, mut after_wrong, mut copies, mut near] = [Share::default(); 4];
        for (seed, row) in rows(200, [2.5, 30.0], 1.5).iter().enumerate() {
            let mut before = false;
            for (column, reading) in scan(&matcher, row, seed as u64).into_iter().enumerate() {
                let Some(reading) = reading else { continue };
                let error = (reading - row[column]).abs();
                wrong.count(error > 1.0);
                if before {
                    after_wrong.count(error > 1.0);
                }
                before = error > 1.0;
                if error > 1.0 {
                    let around = column.saturating_sub(7)..(column + 8).min(COLUMNS);
                    copies.count(around.into_iter().any(|at| (row[at] - reading).abs() <= 1.0));
                    near.count(error <= 3.0);
                }
            }
        }
        let shares = [wrong, after_wrong, copies, near].map(Share::value);
        let measured = [(0.09, 0.30), (0.67, 0.90), (0.61, 0.94), (0.12, 0.40)];
        for (share, (low, high)) in shares.into_iter().zip(measured) {
            assert!((low..=high).contains(&share), "sigma {sigma}: {shares:?} against {measured:?}");
        }
    }
}

#[test]
fn where_no_other_surface_is_near_there_is_nothing_to_copy() {
    let clustering = Clustering { copies: 0.8, near_misses: 0.1, ..Clustering::default() };
    let matcher = clustered(clustering, 1e-3);
    let mut near = Share::default();
    for seed in 0..100 {
        for reading in scan(&matcher, &[20.0; COLUMNS], seed).into_iter().flatten() {
            let error = (reading - 20.0).abs();
            if error > 0.01 {
                near.count((1.0..=3.0).contains(&error));
            }
        }
    }
    near.is(0.5 + 0.5 * 4.0 / 60.0, 1.0, "half and half");
}

/// Neither the sides nor the sizes of near misses are skewed, nor the readings that are uniform over the search range:
/// on one flat surface every mismatch is one or the other.
#[test]
fn near_misses_and_the_uniform_rest_are_spread_evenly() {
    let errors = |near_misses: f64| {
        let matcher = clustered(Clustering { copies: 0.0, near_misses, ..Clustering::default() }, 1e-3);
        let readings: Vec<f64> =
            (0..200).flat_map(|seed| scan(&matcher, &[20.0; COLUMNS], seed)).flatten().map(|px| px - 20.0).collect();
        readings.into_iter().filter(|error| error.abs() > 0.01)
    };
    let (mut above, mut large) = (Share::default(), [Share::default(); 3]);
    for error in errors(1.0) {
        above.count(error > 0.0);
        large.iter_mut().zip([1.5, 2.0, 2.5]).for_each(|(share, edge)| share.count(error.abs() > edge));
    }
    above.is(0.5, 1.0, "to the side of the larger disparity");
    large
        .into_iter()
        .zip([0.75, 0.5, 0.25])
        .for_each(|(share, expected)| share.is(expected, 1.0, "size of near misses"));
    let mut upper = [Share::default(); 3];
    for error in errors(0.0) {
        upper.iter_mut().zip([15.0, 30.0, 45.0]).for_each(|(share, edge)| share.count(20.0 + error > edge));
    }
    upper.into_iter().zip([0.75, 0.5, 0.25]).for_each(|(share, expected)| share.is(expected, 1.0, "uniform"));
}

#[test]
fn the_nearest_other_surface_is_copied_and_the_foreground_of_two_as_near() {
    let clustering = Clustering { copy_reach: 3, ..Clustering::default() };
    let px = [5.0, 10.0, 10.5, 10.0, 20.0, 5.0].map(Some);
    let copied = |column: usize| clustering.neighbour(&px, column, px[column].unwrap_or_default());
    assert_eq!(copied(1), Some(5.0), "the nearest");
    assert_eq!(copied(2), Some(20.0), "5 and 20 px are two columns away");
    assert_eq!(copied(5), Some(20.0));
    assert_eq!(clustering.neighbour(&[Some(1.0), None, None, None, Some(9.0)], 0, 1.0), None, "out of reach");
    assert_eq!(clustering.neighbour(&[Some(1.0), Some(f64::INFINITY)], 0, 1.0), None, "touching the lens");
}

#[test]
fn mismatches_stay_within_the_search_range() {
    let all_fail = Matcher { stereo: Stereo { correct_match: 0.0, ..Stereo::default() }, ..Matcher::default() };
    let clustering = Clustering { persistence: 1.0, copies: 0.3, near_misses: 0.7, copy_reach: 7 };
    let matcher = Matcher { mismatches: Mismatches::Clustered(clustering), detection_rate: 1.0, ..all_fail };
    let row: Vec<f64> = (0..COLUMNS).map(|k| if k % 10 < 5 { 0.5 } else { 59.5 }).collect();
    let readings = scan(&matcher, &row, 5);
    assert_eq!(readings.iter().flatten().count(), COLUMNS, "every edge is read");
    assert!(readings.iter().flatten().all(|px| (0.0..=60.0).contains(px)));
}

#[test]
fn the_least_persistence_leaves_no_two_correct_matches_in_a_row() {
    for correct_match in [0.0, 0.1, 0.3, 0.5, 0.9, 1.0] {
        let persistence = Clustering::least_persistence(correct_match);
        let clustering = Clustering { persistence, ..Clustering::default() };
        let rate = 1.0 - correct_match;
        let [after_failed, after_correct] = [true, false].map(|before| clustering.failing(correct_match, Some(before)));
        if correct_match > 0.0 {
            assert!((rate * after_failed + correct_match * after_correct - rate).abs() < 1e-12, "{correct_match}");
        }
        assert!(correct_match >= 0.5 || after_correct > 1.0 - 1e-12);
    }
}

#[test]
fn written_and_read_only_where_it_is_not_the_papers() {
    let json = serde_json::to_string(&Matcher::default()).expect("JSON");
    assert!(!json.contains("mismatches"), "{json}");
    assert_eq!(serde_json::from_str::<Matcher>(&json).expect("read"), Matcher::default());
    let matcher = clustered(Clustering::default(), 0.5);
    let json = serde_json::to_string(&matcher).expect("JSON");
    assert!(json.contains(r#""mismatches":{"clustered":{"persistence":0.85,"#), "{json}");
    assert_eq!(serde_json::from_str::<Matcher>(&json).expect("read"), matcher);
}
