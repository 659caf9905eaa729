//! The prior of a known world: occupied share, correlation and mean obstacle length.

use grid::Raster;

use crate::belief::prior::{CorrelationLaw, Prior};

/// The fit uses lags as long as their correlation is at least this: beyond, it is mostly sampling error.
const LEAST_FITTED: f64 = 0.3;

/// Occupied share, correlation and obstacle lengths along the rows and columns of a known map.
///
/// Along a line, occupancy is taken for a two-state Markov process: runs of occupied length are exponential with
/// mean `L`, and cells a distance `d` apart have correlation `c(d) = exp(-d / ((1 - p) L))`, where `p` is the occupied
/// share. Rows and columns are counted alike; cells that are not known are in no pair, and a run ends at them
/// without being over.
///
/// What is estimated is the raster's own statistics. Where a cell counts as occupied if its centre is, they are the
/// world's, unless walls lie along the cells: a wall is then in a whole row of centres or in none. Finer cells, and
/// [`correlation`] at a longer lag, average over that. Where a partly covered cell counts as occupied, obstacles are
/// about one cell longer and gaps one cell shorter than in the world, so that share and lengths come out too large, the
/// more the coarser the cells.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Side of a cell, m.
    pub cell_m: f64,
    /// Known cells.
    pub known: usize,
    /// Occupied share of the known cells, 0 to 1; none where nothing is known.
    pub occupancy: Option<f64>,
    /// Correlation of cells at every lag, from one cell up, as far as [`length_fit_m`](Self::length_fit_m)
    /// needs it; empty where cells are all occupied or all free.
    pub lags: Vec<Lag>,
    /// Mean length of an occupied run, m: cells in runs over ends of runs, each pair of neighbours counted from both
    /// sides. Runs that the map's border or an unknown cell cuts off count with the part that is known and the ends that
    /// were seen, which is the maximum of the likelihood for geometric runs. In cells sampled from the
    /// Markov process it is `L` and about half a cell.
    pub mean_run_m: Option<f64>,
    /// Mean length of the runs of which both ends are seen, m: what one would measure with a ruler. Too small, since long runs
    /// are cut off more often.
    pub mean_complete_run_m: Option<f64>,
}

/// Correlation of cells some way apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// Distance, m.
    pub distance_m: f64,
    /// Correlation coefficient, -1 to 1.
    pub correlation: f64,
}

impl Estimate {
    /// Counts along the rows and columns of a map; `None` is a cell that is not known. O(cells x lags).
    pub fn of(map: &Raster<Option<bool>>) -> Self {
        let cell_m = map.spec().cell_m;
        let known = map.values().iter().flatten().count();
        let occupied = map.values().iter().filter(|cell| **cell == Some(true)).count();
        let mut lags: Vec<Lag> = Vec::new();
        let longest = map.spec().width.max(map.spec().height);
        for lag in 1..longest {
            let Some(correlation) = correlation(map, lag) else { break };
            lags.push(Lag { distance_m: lag as f64 * cell_m, correlation });
            if correlation < LEAST_FITTED {
                break;
            }
        }
        let neighbours = Pairs::count(map, 1);
        let ends = neighbours.first + neighbours.second - 2.0 * neighbours.both;
        let in_runs = neighbours.first + neighbours.second;
        let complete = complete_runs(map);
        Self {
            cell_m,
            known,
            occupancy: ratio(occupied as f64, known as f64),
            lags,
            mean_run_m: ratio(in_runs * cell_m, ends),
            mean_complete_run_m: ratio(complete.iter().sum::<usize>() as f64 * cell_m, complete.len() as f64),
        }
    }

    /// Correlation of neighbouring cells.
    pub fn correlation(&self) -> Option<f64> {
        self.lags.first().map(|lag| lag.correlation)
    }

    /// Mean obstacle length `L` (m) by the correlation of neighbouring cells.
    pub fn length_m(&self) -> Option<f64> {
        length_m(self.occupancy?, self.lags.first()?)
    }

    /// Mean obstacle length `L` (m) by the law's line `ln c(d) = -d / ((1 - p) L)` through all lags whose
    /// correlation is at least 0.3, with weights `c²`, since the error of `ln c` goes as `1 / c`.
    pub fn length_fit_m(&self) -> Option<f64> {
        let fitted = self.lags.iter().filter(|lag| lag.correlation >= LEAST_FITTED);
        let (mut xx, mut xy) = (0.0, 0.0);
        for Lag { distance_m, correlation } in fitted {
            let weight = correlation * correlation;
            xx += weight * distance_m * distance_m;
            xy -= weight * distance_m * libm::log(*correlation);
        }
        ratio(xx, xy * (1.0 - self.occupancy?))
    }

    /// The prior of the map's own cells: occupied share, and the correlation of neighbours carried to 5 cm by the law. None
    /// where the cells are all alike or neighbours are not positively correlated.
    pub fn prior(&self) -> Option<Prior> {
        let between = self.correlation().filter(|c| *c > 0.0)?;
        let correlation = libm::pow(between, Prior::REFERENCE_M / self.cell_m);
        Some(Prior { occupancy: self.occupancy?, correlation, correlation_law: CorrelationLaw::Scaled })
    }
}

/// Correlation coefficient of cells `lag` cells apart along rows and columns; none where one of two such cells is
/// always the same, or there are none.
pub fn correlation(map: &Raster<Option<bool>>, lag: usize) -> Option<f64> {
    Pairs::count(map, lag).correlation()
}

/// Correlation of cells `distance_m` (m) apart where a share `occupancy` is occupied by obstacles of mean
/// length `length_m` (m): `exp(-d / ((1 - p) L))`.
pub fn law(occupancy: f64, length_m: f64, distance_m: f64) -> f64 {
    libm::exp(-distance_m / ((1.0 - occupancy) * length_m))
}

/// The law solved for the mean length of obstacles, m; none for a correlation that is not within 0 and 1.
pub fn length_m(occupancy: f64, lag: &Lag) -> Option<f64> {
    let c = Some(lag.correlation).filter(|c| *c > 0.0)?;
    ratio(lag.distance_m, -(1.0 - occupancy) * libm::log(c))
}

fn ratio(part: f64, whole: f64) -> Option<f64> {
    Some(part / whole).filter(|ratio| ratio.is_finite() && whole > 0.0)
}

/// Counts of pairs of known cells a lag apart.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Pairs {
    pairs: f64,
    first: f64,
    second: f64,
    both: f64,
}

impl Pairs {
    fn count(map: &Raster<Option<bool>>, lag: usize) -> Self {
        let (width, height) = (map.spec().width, map.spec().height);
        let cells = map.values();
        let [mut pairs, mut first, mut second, mut both] = [0usize; 4];
        let mut count = |one: &[Option<bool>], other: &[Option<bool>]| {
            for (one, other) in one.iter().zip(other) {
                let (Some(one), Some(other)) = (*one, *other) else { continue };
                pairs += 1;
                first += usize::from(one);
                second += usize::from(other);
                both += usize::from(one && other);
            }
        };
        for row in cells.chunks_exact(width.max(1)).filter(|row| row.len() > lag) {
            count(row, &row[lag..]);
        }
        if lag < height {
            count(cells, &cells[lag * width..]);
        }
        Self { pairs: pairs as f64, first: first as f64, second: second as f64, both: both as f64 }
    }

    /// The correlation coefficient; none where one of the two is always the same.
    fn correlation(&self) -> Option<f64> {
        let [first, second, both] = [self.first, self.second, self.both].map(|count| count / self.pairs);
        let variance = first * (1.0 - first) * second * (1.0 - second);
        (variance > 0.0).then(|| (both - first * second) / libm::sqrt(variance))
    }
}

/// Lengths, in cells, of the occupied runs along rows and columns that lie between two free cells.
fn complete_runs(map: &Raster<Option<bool>>) -> Vec<usize> {
    let (width, height) = (map.spec().width, map.spec().height);
    let rows = (0..height).map(|row| (row * width, 1, width));
    let columns = (0..width).map(|column| (column, width, height));
    let mut runs = Vec::new();
    for (start, step, length) in rows.chain(columns) {
        // Cells since the last free one, if only occupied cells follow it.
        let mut run = None;
        for k in 0..length {
            run = match (map[start + k * step], run) {
                (Some(true), run) => run.map(|cells| cells + 1),
                (Some(false), run) => {
                    runs.extend(run.filter(|cells| *cells > 0));
                    Some(0)
                }
                (None, _) => None,
            };
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;

    fn map(width: usize, cells: &str) -> Raster<Option<bool>> {
        let cell = |c| match c {
            '#' => Some(true),
            '.' => Some(false),
            _ => None,
        };
        let values: Vec<_> = cells.chars().map(cell).collect();
        let height = values.len() / width;
        Raster::new(GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height }, values)
    }

    #[test]
    fn counted_by_hand() {
        // Pairs: .. .# ## #. .# #. and none with the unknown cell; the last run has one end.
        let found = Estimate::of(&map(9, "..##.#.?#"));
        assert_eq!((found.known, found.occupancy), (8, Some(0.5)));
        // Of 6 pairs the first is occupied in 3, the second in 3, both in 1.
        let correlation = (1.0 / 6.0 - 0.25) / 0.25;
        assert!((found.correlation().expect("both states") - correlation).abs() < 1e-15);
        assert!((found.mean_complete_run_m.expect("two runs") - 0.05 * 1.5).abs() < 1e-15);
        // Six cells in pairs, four ends.
        assert!((found.mean_run_m.expect("ends") - 0.05 * 6.0 / 4.0).abs() < 1e-15);
        assert_eq!((found.length_m(), found.prior()), (None, None), "the neighbours are against each other");
    }

    #[test]
    fn rows_and_columns_count_alike() {
        let upright = Estimate::of(&map(4, "....##..##..?..."));
        let transposed = Estimate::of(&map(4, ".##?.##........."));
        assert_eq!(upright.correlation().map(f64::to_bits), transposed.correlation().map(f64::to_bits));
        assert_eq!(upright.mean_complete_run_m, transposed.mean_complete_run_m);
    }

    #[test]
    fn a_map_of_one_kind_says_nothing_of_the_other() {
        for (cells, occupancy) in [("......", Some(0.0)), ("######", Some(1.0)), ("??????", None)] {
            let found = Estimate::of(&map(3, cells));
            assert_eq!((found.occupancy, found.correlation(), found.length_fit_m()), (occupancy, None, None));
            assert_eq!((found.mean_complete_run_m, found.prior()), (None, None));
        }
        assert_eq!(Estimate::of(&map(3, "######")).mean_run_m, None, "no run ever ends");
    }

    #[test]
    fn the_law_and_its_solution_are_inverse() {
        let c = law(0.1, 0.402, 0.05);
        assert!((c - 0.871).abs() < 5e-4);
        let length = length_m(0.1, &Lag { distance_m: 0.05, correlation: c }).expect("positive");
        assert!((length - 0.402).abs() < 1e-12);
    }
}
