//! How long a map takes to follow a change.

use grid::Raster;

use crate::error::{probabilities, same_cells};
use crate::threshold::HELD_OCCUPIED;
use crate::{Metric, ScoreError};

/// Looks from farther away, m, do not count: one reading of the paper's camera is 0.5 m long there (one standard deviation), longer than what moves.
pub const NEAR_LOOK_M: f64 = 4.0;

/// Changes are followed for so many looks; one that takes longer counts as that long.
pub const LONGEST_LAG: usize = 10;

/// Looks within which a planner needs a change to be in the map.
pub const QUICK_LOOKS: usize = 3;

/// How many looks a map takes until it holds a cell right whose state has changed.
///
/// A change is found by the first look that finds another state than the look before it. The lag is the number of looks at the cell, that one
/// included, until the map after a look holds it right: p > 0.5 where it is occupied now, p < 0.5 where it is free now. What the map does later does not matter.
///
/// Many changes end before they are followed: the state changes again, or nobody looks any more. Their lag is at least the looks they got, and taking
/// it for that would favour slow maps; leaving them out, too. So the share `S(k)` of changes not followed after k looks is estimated from those that got k looks
/// (the product-limit estimate, Kaplan and Meier 1958: `S(k) = S(k - 1) (1 - followed at k / changes that got k looks)`), and the mean lag is the restricted
/// mean `S(0) + ... + S(9)`: that of the lesser of lag and [`LONGEST_LAG`] looks (Irwin 1949). Beyond the most looks that any change got, the last share holds.
#[derive(Debug, Clone)]
pub struct Lag {
    cells: Raster<Found>,
    /// Changes to free ...
    to_free: Lags,
    /// ... and to occupied.
    to_occupied: Lags,
}

/// How changes of a kind have gone.
#[derive(Debug, Clone, Copy, Default)]
struct Lags {
    /// Number of changes followed at look k + 1.
    followed: [usize; LONGEST_LAG],
    /// Number of changes that ended unfollowed after k + 1 looks.
    ended: [usize; LONGEST_LAG],
}

impl Lags {
    fn and(&self, other: &Self) -> Self {
        let sum = |a: &[usize; LONGEST_LAG], b: &[usize; LONGEST_LAG]| std::array::from_fn(|k| a[k] + b[k]);
        Self { followed: sum(&self.followed, &other.followed), ended: sum(&self.ended, &other.ended) }
    }

    fn open(&self) -> usize {
        self.ended.iter().sum()
    }

    fn changes(&self) -> usize {
        self.followed.iter().sum::<usize>() + self.open()
    }

    /// `S(0)` to `S(10)`: the shares not followed after so many looks.
    fn unfollowed(&self) -> [f64; LONGEST_LAG + 1] {
        let (mut at_risk, mut shares) = (self.changes(), [1.0; LONGEST_LAG + 1]);
        for k in 0..LONGEST_LAG {
            let stay = if at_risk > 0 { (at_risk - self.followed[k]) as f64 / at_risk as f64 } else { 1.0 };
            shares[k + 1] = shares[k] * stay;
            at_risk -= self.followed[k] + self.ended[k];
        }
        shares
    }

    /// The share followed within [`QUICK_LOOKS`].
    fn quick(&self, name: &'static str) -> Metric {
        self.metric(name, "1", 1.0 - self.unfollowed()[QUICK_LOOKS])
    }

    fn metric(&self, name: &'static str, unit: &'static str, value: f64) -> Metric {
        let changes = self.changes();
        Metric { name, value: (changes > 0).then_some(value), unit, support: changes }
    }
}

/// What looks have found of a cell.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    /// The state that the last look found.
    state: Option<bool>,
    /// Looks since the last change, which the map does not hold right yet; 0 where there is none to follow.
    looks: u8,
}

impl Lag {
    /// Before the first scan.
    pub fn new(truth: &Raster<Option<bool>>) -> Self {
        Self { cells: truth.map(|_| Found::default()), to_free: Lags::default(), to_occupied: Lags::default() }
    }

    /// Takes note of the map at the end of a scan; call it once per scan, in order. `truth` is that of the moment, `near` the cells that the scan
    /// has looked at from at most [`NEAR_LOOK_M`] ([`Sightings::seen_within`](crate::Sightings::seen_within)). Allocates nothing.
    ///
    /// # Errors
    /// Rasters of different geometry; a cell that holds no probability. The scan then leaves no trace.
    pub fn observe(
        &mut self,
        truth: &Raster<Option<bool>>,
        near: &Raster<bool>,
        map: &Raster<f64>,
    ) -> Result<(), ScoreError> {
        same_cells("truth of the moment", truth.spec(), self.cells.spec())?;
        same_cells("mask of near looks", near.spec(), self.cells.spec())?;
        same_cells("map", map.spec(), self.cells.spec())?;
        probabilities(map)?;
        for cell in (0..near.spec().cells()).filter(|cell| near[*cell]) {
            if let Some(occupied) = truth[cell] {
                self.look(cell, occupied, map[cell]);
            }
        }
        Ok(())
    }

    /// A look at a cell, which holds p after it.
    fn look(&mut self, cell: usize, occupied: bool, p: f64) {
        let Found { state, looks } = self.cells[cell];
        let changed = state.is_some_and(|state| state != occupied);
        if changed && looks > 0 {
            self.lags(!occupied).ended[usize::from(looks) - 1] += 1;
        }
        let looks = if changed { 1 } else { looks + u8::from(looks > 0) };
        let right = if occupied { p > HELD_OCCUPIED } else { p < HELD_OCCUPIED };
        let last = usize::from(looks) == LONGEST_LAG;
        if looks > 0 && right {
            self.lags(occupied).followed[usize::from(looks) - 1] += 1;
        } else if last {
            self.lags(occupied).ended[LONGEST_LAG - 1] += 1;
        }
        self.cells[cell] = Found { state: Some(occupied), looks: if right || last { 0 } else { looks } };
    }

    fn lags(&mut self, occupied: bool) -> &mut Lags {
        if occupied { &mut self.to_occupied } else { &mut self.to_free }
    }

    /// `lag_looks`, the restricted mean lag in looks; `lag_open`, the share of changes that were not followed in the looks they got, ten at most; `followed_3`,
    /// the share followed within [`QUICK_LOOKS`], by the same estimate; and `cleared_3`, the same of changes to free. Support of each: those changes that were found so far.
    pub fn metrics(&self) -> [Metric; 4] {
        let mut so_far = self.clone();
        for found in self.cells.values().iter().filter(|found| found.looks > 0) {
            so_far.lags(found.state == Some(true)).ended[usize::from(found.looks) - 1] += 1;
        }
        let all = so_far.to_free.and(&so_far.to_occupied);
        [
            all.metric("lag_looks", "looks", all.unfollowed()[..LONGEST_LAG].iter().sum()),
            Metric::share("lag_open", all.open(), all.changes()),
            all.quick("followed_3"),
            so_far.to_free.quick("cleared_3"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::drawn;
    use proptest::prelude::*;

    /// A look at a cell, or none: state, and what the map says after the scan.
    type Scan = (Option<bool>, f64);

    fn after(histories: &[Vec<Scan>]) -> [Metric; 4] {
        let unknown = drawn(&[&"?".repeat(histories.len())]);
        let mut lag = Lag::new(&unknown);
        for scan in 0..histories[0].len() {
            let of = |h: &Vec<Scan>| h[scan];
            let state = Raster::new(*unknown.spec(), histories.iter().map(|h| of(h).0.or(Some(true))).collect());
            let near = Raster::new(*unknown.spec(), histories.iter().map(|h| of(h).0.is_some()).collect());
            let map = Raster::new(*unknown.spec(), histories.iter().map(|h| of(h).1).collect());
            lag.observe(&state, &near, &map).expect("valid");
        }
        lag.metrics()
    }

    const FREE: Option<bool> = Some(false);
    const TAKEN: Option<bool> = Some(true);

    #[test]
    fn histories_of_one_cell() {
        let cases: [(&[Scan], Option<f64>, usize, &str); 8] = [
            (&[(FREE, 0.1), (FREE, 0.1)], None, 0, "no change, nothing to follow"),
            (&[(FREE, 0.9), (TAKEN, 0.9)], Some(1.0), 1, "right after the look that finds it"),
            (&[(FREE, 0.1), (TAKEN, 0.3), (TAKEN, 0.6)], Some(2.0), 1, "one more look"),
            (&[(FREE, 0.1), (TAKEN, 0.3), (None, 0.9), (None, 0.1), (TAKEN, 0.6)], Some(2.0), 1, "only looks count"),
            (
                &[(TAKEN, 0.9), (FREE, 0.5), (FREE, 0.4), (FREE, 0.9)],
                Some(2.0),
                1,
                "0.5 is no side; later does not matter",
            ),
            (&[(FREE, 0.1), (None, 0.1), (FREE, 0.1)], None, 0, "what no look finds is no change"),
            (&[(FREE, 0.1), (TAKEN, 0.1)], Some(10.0), 1, "never followed"),
            (
                &[(FREE, 0.1), (TAKEN, 0.1), (FREE, 0.1)],
                Some(5.5),
                2,
                "of two at the first look one, and then none is left",
            ),
        ];
        for (history, mean, changes, why) in cases {
            let [lag, ..] = after(&[history.to_vec()]);
            assert_eq!((lag.name, lag.unit, lag.support), ("lag_looks", "looks", changes), "{why}");
            assert!(
                lag.value.zip(mean).map_or(lag.value.is_none() && mean.is_none(), |(a, b)| (a - b).abs() < 1e-12),
                "{why}: {lag:?}"
            );
        }
    }

    #[test]
    fn a_change_that_ends_early_is_neither_a_quick_one_nor_left_out() {
        // One change is followed at its second look, one ends unfollowed after its first.
        let quick = vec![(FREE, 0.1), (TAKEN, 0.1), (TAKEN, 0.9)];
        let short = vec![(FREE, 0.1), (TAKEN, 0.1), (None, 0.1)];
        let [lag, open, within, cleared] = after(&[quick, short]);
        assert_eq!((lag.value, open.value, within.value), (Some(2.0), Some(0.5), Some(1.0)));
        assert_eq!((lag.support, open.name, within.name), (2, "lag_open", "followed_3"));
        assert_eq!((cleared.value, cleared.support, cleared.name), (None, 0, "cleared_3"), "nothing became free");
    }

    #[test]
    fn a_change_is_followed_for_ten_looks() {
        let follow = |looks: usize| {
            let mut history = vec![(FREE, 0.1)];
            history.extend(vec![(TAKEN, 0.1); looks - 1]);
            history.extend(vec![(TAKEN, 0.9); 3]);
            after(&[history]).map(|metric| metric.value)
        };
        assert_eq!(follow(10), [Some(10.0), Some(0.0), Some(0.0), None]);
        assert_eq!(follow(11), [Some(10.0), Some(1.0), Some(0.0), None]);
        assert_eq!(follow(300), [Some(10.0), Some(1.0), Some(0.0), None]);
        assert_eq!((follow(3)[2], follow(4)[2]), (Some(1.0), Some(0.0)));
    }

    #[test]
    fn a_refused_scan_leaves_no_trace() {
        let truth = drawn(&["."]);
        let (seen, other) = (truth.map(|_| true), drawn(&[".."]));
        let mut lag = Lag::new(&truth);
        lag.observe(&truth, &seen, &truth.map(|_| 0.1)).expect("valid");
        let taken = truth.map(|_| Some(true));
        assert!(lag.observe(&taken, &seen, &truth.map(|_| f64::NAN)).is_err());
        assert!(lag.observe(&other, &seen, &truth.map(|_| 0.9)).is_err());
        assert!(lag.observe(&taken, &other.map(|_| true), &truth.map(|_| 0.9)).is_err());
        assert!(lag.observe(&taken, &seen, &other.map(|_| 0.9)).is_err());
        assert!(lag.metrics().iter().all(|metric| metric.value.is_none() && metric.support == 0));
    }

    /// The looks that every change got, whether the map followed it at the last of them, and whether it was to occupied, read from the whole history of a cell.
    fn changes(history: &[Scan]) -> Vec<(usize, bool, bool)> {
        let looks: Vec<(bool, f64)> = history.iter().filter_map(|scan| Some((scan.0?, scan.1))).collect();
        let starts = (1..looks.len()).filter(|&k| looks[k].0 != looks[k - 1].0);
        let change = |start: usize| {
            let state = looks[start].0;
            let run = looks[start..].iter().take_while(|look| look.0 == state).take(10);
            let run: Vec<f64> = run.map(|look| look.1).collect();
            let right = run.iter().position(|&p| if state { p > 0.5 } else { p < 0.5 });
            right.map_or((run.len(), false, state), |k| (k + 1, true, state))
        };
        starts.map(change).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn equals_the_definition_read_from_whole_histories(
            histories in (1usize..40, 0.0f64..1.0, 0.0f64..0.3).prop_flat_map(|(scans, right, looked)| {
                let scan = (prop::option::weighted(0.7 + looked, prop::bool::weighted(0.3)), prop::bool::weighted(right), 0.0f64..0.5);
                let scan = scan.prop_map(|(state, right, p)| (state, if right == (state == Some(true)) { 1.0 - p } else { p }));
                prop::collection::vec(prop::collection::vec(scan, scans), 1..12)
            }),
        ) {
            let all: Vec<_> = histories.iter().flat_map(|h| changes(h)).collect();
            let to_free: Vec<_> = all.iter().copied().filter(|change| !change.2).collect();
            let share = |of: &[(usize, bool, bool)], k: usize| (1..=k).map(|j| {
                let got = of.iter().filter(|change| change.0 >= j).count();
                let followed = of.iter().filter(|change| change.0 == j && change.1).count();
                if got > 0 { 1.0 - followed as f64 / got as f64 } else { 1.0 }
            }).product::<f64>();
            let open = all.iter().filter(|change| !change.1).count();
            let mean = (0..10).map(|k| share(&all, k)).sum();
            let expected = [
                (mean, all.len()),
                (open as f64 / all.len() as f64, all.len()),
                (1.0 - share(&all, 3), all.len()),
                (1.0 - share(&to_free, 3), to_free.len()),
            ];
            for (metric, (expected, support)) in after(&histories).iter().zip(expected) {
                prop_assert_eq!((metric.value.is_some(), metric.support), (support > 0, support));
                prop_assert!(metric.value.is_none_or(|v| (v - expected).abs() < 1e-12), "{:?} is not {}", metric, expected);
            }
        }
    }
}
