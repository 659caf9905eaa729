//! All metrics against their definitions, written down a second time, slowly and one at a time.

use grid::{GridSpec, Raster};
use proptest::prelude::*;
use score::{
    ErrorBin, LOOK_EDGES, Metric, Retention, Scorer, Scores, error_profile, log_loss, probability_bins, reliability,
};

/// A random case: truth, surface marks, mask and map over one grid.
#[derive(Debug, Clone)]
struct Case {
    truth: Raster<Option<bool>>,
    surface: Raster<bool>,
    mask: Raster<bool>,
    map: Raster<f64>,
}

/// Probabilities with many ties, with the thresholds themselves and with certainties among them.
fn probability() -> impl Strategy<Value = f64> {
    prop_oneof![
        prop::sample::select(vec![0.0, 0.1, 0.2, 0.3, 0.5, 0.65, 0.8, 0.97, 1.0]),
        (0u32..=40).prop_map(|i| f64::from(i) / 40.0),
        0.0f64..=1.0,
    ]
}

fn case() -> impl Strategy<Value = Case> {
    // The rarer class may be missing altogether.
    (1usize..9, 1usize..9, 0.0f64..=1.0, 0.0f64..=1.0).prop_flat_map(|(width, height, occupied, inside)| {
        let spec = GridSpec { cell_m: 0.05, origin_m: [-1.0, 2.0], width, height };
        let truth = prop::option::weighted(0.9, prop::bool::weighted(occupied));
        let cell = (truth, any::<bool>(), prop::bool::weighted(inside), probability());
        prop::collection::vec(cell, width * height).prop_map(move |cells| Case {
            truth: Raster::new(spec, cells.iter().map(|c| c.0).collect()),
            surface: Raster::new(spec, cells.iter().map(|c| c.1).collect()),
            mask: Raster::new(spec, cells.iter().map(|c| c.2).collect()),
            map: Raster::new(spec, cells.iter().map(|c| c.3).collect()),
        })
    })
}

impl Case {
    fn scores(&self) -> Scores {
        Scorer::new(&self.truth, &self.surface).and_then(|s| s.scores(&self.map, &self.mask)).expect("valid")
    }

    /// (p, occupied, surface) of every scored cell.
    fn cells(&self) -> Vec<(f64, bool, bool)> {
        (0..self.truth.spec().cells())
            .filter(|&i| self.mask[i])
            .filter_map(|i| self.truth[i].map(|occupied| (self.map[i], occupied, self.surface[i])))
            .collect()
    }

    /// The same cells in the opposite order.
    fn turned(&self) -> Self {
        fn turn<T: Clone>(raster: &Raster<T>) -> Raster<T> {
            Raster::new(*raster.spec(), raster.values().iter().rev().cloned().collect())
        }
        Self { truth: turn(&self.truth), surface: turn(&self.surface), mask: turn(&self.mask), map: turn(&self.map) }
    }
}

type Cell = (f64, bool, bool);

/// A value, where there is one, and its support.
type Supported = (Option<f64>, usize);

/// Mean of `f` over the cells that `of` picks, and how many those are.
fn mean(cells: &[Cell], of: impl Fn(&Cell) -> bool, f: impl Fn(&Cell) -> f64) -> Supported {
    let picked: Vec<f64> = cells.iter().filter(|c| of(c)).map(f).collect();
    ((!picked.is_empty()).then(|| picked.iter().sum::<f64>() / picked.len() as f64), picked.len())
}

fn share(cells: &[Cell], of: impl Fn(&Cell) -> bool, that: impl Fn(&Cell) -> bool) -> Supported {
    mean(cells, of, |c| if that(c) { 1.0 } else { 0.0 })
}

/// Area is share times size: a way round to the same number.
fn area(cells: &[Cell], of: impl Fn(&Cell) -> bool, that: impl Fn(&Cell) -> bool) -> Supported {
    let (share, support) = share(cells, of, that);
    (share.map(|s| s * support as f64 * 0.05 * 0.05), support)
}

fn auc(cells: &[Cell]) -> Supported {
    let (mut sum, mut pairs) = (0.0, 0usize);
    for a in cells.iter().filter(|c| c.1) {
        for b in cells.iter().filter(|c| !c.1) {
            pairs += 1;
            sum += match a.0.partial_cmp(&b.0).expect("probabilities") {
                std::cmp::Ordering::Greater => 1.0,
                std::cmp::Ordering::Equal => 0.5,
                std::cmp::Ordering::Less => 0.0,
            };
        }
    }
    ((pairs > 0).then(|| sum / pairs as f64), cells.len())
}

fn calibration_error(cells: &[Cell]) -> Supported {
    let same = |a: &Cell, b: &Cell| a.0.total_cmp(&b.0).is_eq();
    let mut expected: Vec<(f64, f64)> =
        cells.iter().map(|c| (c.0, share(cells, |d| same(c, d), |d| d.1).0.expect("itself"))).collect();
    expected.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = cells.len();
    let sum: f64 = (0..15)
        .map(|bin| &expected[bin * n / 15..(bin + 1) * n / 15])
        .map(|bin| bin.iter().map(|c| c.0 - c.1).sum::<f64>().abs())
        .sum();
    ((n > 0).then(|| sum / n as f64), n)
}

/// Every metric, in the order of the README.
fn definitions(cells: &[Cell]) -> Vec<(&'static str, &'static str, Supported)> {
    let every = |_: &Cell| true;
    let free = |c: &Cell| !c.1;
    let right = |c: &Cell| (if c.1 { c.0 } else { 1.0 - c.0 }).clamp(1e-4, 1.0 - 1e-4);
    let truth = |c: &Cell| if c.1 { 1.0 } else { 0.0 };
    vec![
        ("log_loss", "nats/cell", mean(cells, every, |c| -right(c).ln())),
        ("brier", "1", mean(cells, every, |c| (c.0 - truth(c)).powi(2))),
        ("ece", "1", calibration_error(cells)),
        ("auc", "1", auc(cells)),
        ("iou", "1", share(cells, |c| c.0 > 0.5 || c.1, |c| c.0 > 0.5 && c.1)),
        ("decided", "1", share(cells, every, |c| !(0.2..=0.8).contains(&c.0))),
        ("free_agreement", "1", share(cells, |c| c.0 < 0.2, free)),
        ("occupied_agreement", "1", share(cells, |c| c.0 > 0.8, |c| c.1)),
        ("phantom_area", "m²", area(cells, free, |c| c.0 > 0.5)),
        ("missed_area", "m²", area(cells, |c| c.1 && c.2, |c| c.0 < 0.2)),
        ("free_known", "1", share(cells, free, |c| c.0 < 0.2)),
        ("free_lost", "1", share(cells, free, |c| c.0 > 0.5)),
        ("recall_50", "1", share(cells, |c| c.1 && c.2, |c| c.0 > 0.5)),
        ("recall_65", "1", share(cells, |c| c.1 && c.2, |c| c.0 > 0.65)),
    ]
}

fn agree(found: Option<f64>, expected: Option<f64>) -> bool {
    match (found, expected) {
        (Some(found), Some(expected)) => (found - expected).abs() < 1e-12 * expected.abs().max(1.0),
        (found, expected) => found.is_none() && expected.is_none(),
    }
}

/// The value, for metrics that are defined whatever the case.
fn value(metric: Metric) -> f64 {
    metric.value.expect("defined")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_metric_equals_its_definition(case in case()) {
        let found = case.scores().metrics();
        let expected = definitions(&case.cells());
        prop_assert_eq!(found.len(), expected.len());
        for (metric, (name, unit, (value, support))) in found.iter().zip(expected) {
            prop_assert_eq!((metric.name, metric.unit, metric.support), (name, unit, support));
            prop_assert!(agree(metric.value, value), "{:?} is not {:?}", metric, value);
        }
    }

    #[test]
    fn shares_stay_within_zero_and_one(case in case()) {
        for metric in case.scores().metrics().iter().filter(|m| m.unit == "1") {
            prop_assert!(metric.value.is_none_or(|v| (0.0..=1.0).contains(&v)), "{:?}", metric);
        }
    }

    #[test]
    fn log_loss_alone_is_the_same(case in case()) {
        prop_assert_eq!(log_loss(&case.map, &case.truth, &case.mask), Ok(case.scores().log_loss));
    }

    /// A bin is nothing but a smaller mask.
    #[test]
    fn every_bin_of_a_profile_scores_like_its_own_mask(case in case(), seed in any::<u32>()) {
        // From -1, which is in no bin, over 0 and small numbers with edges among them to infinity.
        let value = |cell: u32| match seed.wrapping_add(cell.wrapping_mul(2_654_435_761)) >> 27 {
            31 => f64::INFINITY,
            odd if odd % 2 == 1 => f64::from(odd) - 2.0,
            even => f64::from(even / 2),
        };
        let covariate = Raster::new(*case.map.spec(), (0..).map(value).take(case.map.spec().cells()).collect());
        let profile = error_profile(&case.map, &case.truth, &case.mask, &covariate, &LOOK_EDGES).expect("valid");
        prop_assert_eq!(profile.bins.len(), LOOK_EDGES.len() - 1);
        let mut binned = 0;
        for (k, ErrorBin { from, to, log_loss, brier }) in profile.bins.into_iter().enumerate() {
            prop_assert_eq!([from, to].map(f64::to_bits), [LOOK_EDGES[k], LOOK_EDGES[k + 1]].map(f64::to_bits));
            let mut part = case.clone();
            (0..case.map.spec().cells()).for_each(|c| part.mask[c] &= from <= covariate[c] && covariate[c] < to);
            let scores = part.scores();
            prop_assert_eq!((log_loss, brier), (scores.log_loss, scores.brier));
            binned += brier.support;
        }
        prop_assert_eq!(binned + profile.outside, case.cells().len());
    }

    #[test]
    fn the_calibration_error_is_the_diagrams(case in case()) {
        let bins = reliability(&case.map, &case.truth, &case.mask).expect("valid");
        let n: usize = bins.iter().map(|b| b.count).sum();
        prop_assert_eq!(n, case.cells().len());
        let sum: f64 = bins.iter().map(|b| b.count as f64 * (b.mean_probability - b.observed_share).abs()).sum();
        prop_assert!(agree(case.scores().ece.value, (n > 0).then(|| sum / n as f64)));
        let rising = bins.windows(2).all(|b| b[0].mean_probability <= b[1].mean_probability + 1e-12);
        prop_assert!(rising, "{:?}", bins);
    }

    #[test]
    fn cells_that_are_not_scored_do_not_matter(case in case(), other in prop::collection::vec(probability(), 64)) {
        let mut changed = case.clone();
        for (cell, other) in (0..changed.map.spec().cells()).zip(other) {
            if !case.mask[cell] || case.truth[cell].is_none() {
                changed.map[cell] = other;
                changed.surface[cell] = !changed.surface[cell];
            }
            if case.truth[cell].is_none() {
                changed.mask[cell] = !changed.mask[cell];
            }
        }
        prop_assert_eq!(case.scores(), changed.scores());
    }

    #[test]
    fn the_order_of_the_cells_does_not_matter(case in case()) {
        let (one, other) = (case.scores(), case.turned().scores());
        // What is counted or ranked is the same to the last bit; sums of reals may round differently.
        let exact = |s: &Scores| s.metrics()[2..].to_vec();
        prop_assert_eq!(exact(&one), exact(&other));
        prop_assert!(agree(one.log_loss.value, other.log_loss.value) && agree(one.brier.value, other.brier.value));
    }

    #[test]
    fn areas_add_up_over_a_split_of_the_region(case in case()) {
        let mut parts = [case.clone(), case.clone()];
        for cell in 0..case.mask.spec().cells() {
            parts[cell % 2].mask[cell] = false;
        }
        let [even, odd] = parts.map(|part| part.scores());
        let whole = case.scores();
        for pick in [|s: &Scores| s.phantom_area, |s: &Scores| s.missed_area] {
            let [whole, even, odd] = [pick(&whole), pick(&even), pick(&odd)];
            prop_assert_eq!(even.support + odd.support, whole.support);
            let sum = even.value.unwrap_or(0.0) + odd.value.unwrap_or(0.0);
            prop_assert!((sum - whole.value.unwrap_or(0.0)).abs() < 1e-12);
        }
    }

    #[test]
    fn a_map_nearer_to_the_truth_scores_no_worse(case in case(), step in 0.0f64..=1.0) {
        prop_assume!(!case.cells().is_empty());
        let mut nearer = case.clone();
        for cell in 0..nearer.map.spec().cells() {
            if let Some(occupied) = case.truth[cell] {
                let goal = if occupied { 1.0 } else { 0.0 };
                nearer.map[cell] = (case.map[cell] + step * (goal - case.map[cell])).clamp(0.0, 1.0);
            }
        }
        let (before, after) = (case.scores(), nearer.scores());
        prop_assert!(value(after.log_loss) <= value(before.log_loss) + 1e-12);
        prop_assert!(value(after.brier) <= value(before.brier) + 1e-12);
        for pick in [|s: &Scores| s.phantom_area, |s: &Scores| s.missed_area, |s: &Scores| s.free_lost] {
            prop_assert!(pick(&after).value <= pick(&before).value);
        }
        prop_assert!(after.iou.value.is_none_or(|v| v >= before.iou.value.unwrap_or(0.0)));
        prop_assert!(after.auc.value >= before.auc.value);
    }

    #[test]
    fn anything_but_a_probability_is_refused_where_it_is(case in case(), at in any::<prop::sample::Index>(), bad in prop_oneof![
        Just(f64::NAN), Just(f64::INFINITY), Just(f64::NEG_INFINITY), 1.000_000_001f64..1e9, -1e9f64..-1e-9,
    ]) {
        let mut case = case;
        let cell = at.index(case.map.spec().cells());
        case.map[cell] = bad;
        let (column, row) = case.map.spec().column_row(cell);
        let place = format!("{bad} in cell {cell} (column {column}, row {row})");
        let refused = [
            Scorer::new(&case.truth, &case.surface).and_then(|s| s.scores(&case.map, &case.mask)).map(|_| ()),
            log_loss(&case.map, &case.truth, &case.mask).map(|_| ()),
            reliability(&case.map, &case.truth, &case.mask).map(|_| ()),
            probability_bins(&case.map, &case.truth, &case.mask).map(|_| ()),
            error_profile(&case.map, &case.truth, &case.mask, &case.map.map(|_| 0.0), &LOOK_EDGES).map(|_| ()),
            Retention::new(&case.truth).observe(&case.mask, &case.map),
        ];
        for refused in refused {
            let message = refused.expect_err("refused").to_string();
            prop_assert!(message.contains(&place), "{}", message);
        }
    }
}
