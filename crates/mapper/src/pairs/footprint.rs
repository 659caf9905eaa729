//! The probability that an obstacle stands under a robot's footprint: what a planner asks of a map.
//!
//! A cell is a bad question to a map that knows a wall to within three cells and not which of them: each holds a third, and a threshold
//! finds no wall. That one of them is occupied is nearly sure, and the joint probabilities of neighbours say so.

use grid::{GridSpec, Raster, disc_reach};

use crate::pairs::joint::Joint;
use crate::ray::predictive::Belief;
use crate::ray::recalibration::Recalibration;

/// What the line that is least free is recalibrated by, fitted on 24 tuning worlds, pooled over `visibility` and `visibility-lateral`, with a disc
/// of 0.2 m in cells of 5 cm: lines of a map are taken for emptier than they are nowhere, and for fuller by a factor of four in the odds.
pub const CALIBRATION: Recalibration = Recalibration { shift: -1.53, slope: 0.89 };

/// For every cell, the probability that an obstacle stands in a disc of `radius_m` (m, above 0) about its centre. Cells beyond the border of the
/// map do not count. O(cells × rows of the disc).
///
/// What is not known of a wall is mostly where on a ray it stands, so that its cells exclude each other along a line, and all its cells stand or
/// fall together across. So probabilities are summed along lines and not across: of the rows and the columns of the disc, each a chain of
/// neighbours by their joint probabilities (of [`Belief::Cells`]: independent), the one counts that is least free. [`CALIBRATION`] makes a
/// probability of it. The cells that a disc covers a part of are those of [`grid::clear`].
pub fn occupied(map: Belief, radius_m: f64) -> Raster<f64> {
    least_free(map, radius_m).map(|p| CALIBRATION.of(*p))
}

/// The probability that the line of each disc that is least free is not free.
fn least_free(map: Belief, radius_m: f64) -> Raster<f64> {
    let spec = match map {
        Belief::Cells(marginals) => *marginals.spec(),
        Belief::Chain(pairs) => *pairs.spec(),
    };
    let GridSpec { width, height, .. } = spec;
    let rows = Chains::new(map, [width, height], |at, row| row * width + at);
    let columns = Chains::new(map, [height, width], |at, column| at * width + column);
    let disc = Disc::new(radius_m / spec.cell_m);
    let of = |cell| {
        let (column, row) = (cell % width, cell / width);
        let least = rows.least(&disc, column, row).min(columns.least(&disc, row, column));
        1.0 - libm::exp(least)
    };
    Raster::new(spec, (0..width * height).map(of).collect())
}

/// The cells that a disc about the centre of a cell covers a part of, the same in both directions.
struct Disc {
    /// How far it reaches to both sides, row by row from the middle one up, cells.
    half: Vec<usize>,
}

impl Disc {
    /// `radius` in cells.
    fn new(radius: f64) -> Self {
        Self { half: (0..).map_while(|row| disc_reach(radius, f64::from(row))).collect() }
    }
}

/// Logarithms of the probabilities that cells of lines are free: the lines are rows, or columns.
struct Chains {
    cells: usize,
    lines: usize,
    /// Of every cell, line by line.
    first: Vec<f64>,
    /// Sum over the cells of its line up to it, but for the line's first, of being free given that the one before is.
    next: Vec<f64>,
}

impl Chains {
    /// `lines` of so many `cells`; `cell` gives a cell of the map by its place on the line and the line.
    fn new(map: Belief, [cells, lines]: [usize; 2], cell: impl Fn(usize, usize) -> usize) -> Self {
        let log = |p: f64| libm::log(p.clamp(f64::MIN_POSITIVE, 1.0));
        let (mut first, mut next) = (Vec::with_capacity(cells * lines), Vec::with_capacity(cells * lines));
        for line in 0..lines {
            let mut sum = 0.0;
            for at in 0..cells {
                let here = cell(at, line);
                let before = (at > 0).then(|| cell(at - 1, line));
                let free = |marginals: &Raster<f64>| log(1.0 - marginals[here]);
                let (alone, given) = match (map, before) {
                    (Belief::Cells(marginals), _) => (free(marginals), free(marginals)),
                    (Belief::Chain(pairs), None) => (free(pairs.marginals()), 0.0),
                    (Belief::Chain(pairs), Some(before)) => {
                        let p = pairs.marginals();
                        let both = pairs.both[pairs.spec().edge_between(before, here)];
                        (free(p), log(Joint::new(p[before], p[here], both).ff / (1.0 - p[before])))
                    }
                };
                sum += if at > 0 { given } else { 0.0 };
                first.push(alone);
                next.push(sum);
            }
        }
        Self { cells, lines, first, next }
    }

    /// Of the lines of the disc about a cell, the one that is least free.
    fn least(&self, disc: &Disc, at: usize, line: usize) -> f64 {
        let last = disc.half.len() - 1;
        let lines = line.saturating_sub(last)..=(line + last).min(self.lines - 1);
        let free = |there: usize| {
            let half = disc.half[there.abs_diff(line)];
            let [from, to] =
                [at.saturating_sub(half), (at + half).min(self.cells - 1)].map(|at| there * self.cells + at);
            self.first[from] + self.next[to] - self.next[from]
        };
        lines.map(free).fold(0.0, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::pairs::joint::both_occupied;
    use crate::{PairwiseGrid, Prior};

    fn spec(width: usize, height: usize) -> GridSpec {
        GridSpec { cell_m: 0.1, origin_m: [0.0; 2], width, height }
    }

    /// A map with marginals, and joints by correlations.
    fn pairs() -> impl Strategy<Value = PairwiseGrid> {
        (1usize..6, 1usize..6).prop_flat_map(|(width, height)| {
            let cells = prop::collection::vec(0.001f64..0.999, width * height);
            let ties = prop::collection::vec(-0.9f64..0.95, 2 * width * height);
            (cells, ties).prop_map(move |(cells, ties)| {
                let mut pairs = PairwiseGrid::prior(spec(width, height), &Prior::default());
                pairs.marginal = Raster::new(spec(width, height), cells);
                for cell in 0..width * height {
                    for n in spec(width, height).neighbours(cell) {
                        pairs.both[n.edge] = both_occupied(pairs.marginal[cell], pairs.marginal[n.cell], ties[n.edge]);
                    }
                }
                pairs
            })
        })
    }

    /// The lines of a disc, by the distance of every cell, each from its first cell on.
    fn lines(spec: &GridSpec, middle: usize, radius_m: f64) -> Vec<Vec<usize>> {
        let at = |cell: usize| [cell % spec.width, cell / spec.width];
        let far = |cell: usize| {
            let [x, y] = [0, 1].map(|k| (at(cell)[k].abs_diff(at(middle)[k]) as f64 - 0.5).max(0.0));
            libm::hypot(x, y) * spec.cell_m
        };
        let covered: Vec<usize> = (0..spec.cells()).filter(|cell| far(*cell) < radius_m - 1e-7).collect();
        let on =
            |k: usize, line: usize| covered.iter().copied().filter(|cell| at(*cell)[k] == line).collect::<Vec<_>>();
        let all = (0..spec.height).map(|row| on(1, row)).chain((0..spec.width).map(|column| on(0, column)));
        all.filter(|line| !line.is_empty()).collect()
    }

    /// The probability that all cells of a line are free, over all states of the chain.
    fn free(pairs: &PairwiseGrid, line: &[usize]) -> f64 {
        let states = 0..1u32 << line.len();
        let occupied = |states: u32, k: usize| states >> k & 1 == 1;
        let weight = |states: u32| {
            let p = pairs.marginals()[line[0]];
            let begin = if occupied(states, 0) { p } else { 1.0 - p };
            line.windows(2).enumerate().fold(begin, |weight, (k, pair)| {
                let joint = pairs.joint(pair[0], pair[1]);
                let [given, both] = match (occupied(states, k), occupied(states, k + 1)) {
                    (true, true) => [joint.first(), joint.ee],
                    (true, false) => [joint.first(), joint.ef],
                    (false, true) => [1.0 - joint.first(), joint.fe],
                    (false, false) => [1.0 - joint.first(), joint.ff],
                };
                weight * both / given
            })
        };
        let all: f64 = states.map(weight).sum();
        assert!((all - 1.0).abs() < 1e-9, "a distribution: {all}");
        weight(0)
    }

    proptest! {
        #[test]
        fn it_is_that_of_the_line_that_is_least_free(pairs in pairs(), radius_m in 0.01f64..0.4) {
            let found = least_free(Belief::Chain(&pairs), radius_m);
            let independent = least_free(Belief::Cells(pairs.marginals()), radius_m);
            for cell in 0..pairs.spec().cells() {
                let lines = lines(pairs.spec(), cell, radius_m);
                let least = lines.iter().map(|line| free(&pairs, line)).fold(1.0, f64::min);
                prop_assert!((found[cell] - (1.0 - least)).abs() < 1e-9, "{cell}: {} {least}", found[cell]);
                let product = |line: &Vec<usize>| line.iter().map(|cell| 1.0 - pairs.marginals()[*cell]).product();
                let least = lines.iter().map(product).fold(1.0, f64::min);
                prop_assert!((independent[cell] - (1.0 - least)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_wall_that_may_be_in_any_of_three_cells_is_found() {
        let spec = spec(9, 1);
        let mut pairs = PairwiseGrid::prior(spec, &Prior::default());
        let cells = [1e-6, 1e-6, 1e-6, 0.33, 0.33, 0.33, 1e-6, 1e-6, 1e-6];
        pairs.marginal = Raster::new(spec, cells.to_vec());
        pairs.both.fill(0.0); // they exclude each other
        let found = least_free(Belief::Chain(&pairs), 0.16);
        assert!(found[4] > 0.8 && found[0] < 1e-4, "{found:?}");
        assert!(least_free(Belief::Cells(pairs.marginals()), 0.16)[4] < 0.71);
    }
}
