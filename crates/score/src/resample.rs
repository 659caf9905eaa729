//! Maps in the cells of the truth: another cell size, another origin, another angle.

use grid::{CellsToCells, Frame, NoMemory, Raster};
use serde::Serialize;

/// Two places closer than this share of a cell are one.
const SAME: f64 = 1e-6;

/// What a cell of the truth takes of several cells of a finer map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Finer {
    /// Their mean: the share of the cell's area that is expected to be occupied.
    #[default]
    Mean,
    /// The greatest: what a planner takes that must hit nothing.
    Greatest,
}

/// How a map was brought into the cells of the truth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Resampling {
    /// The cells are the same.
    CellByCell,
    /// The map's cell in which the centre of the truth's cell lies.
    Nearest,
    /// The map is finer: `points` x `points` points, spread evenly over the cell of the truth, each with the map's cell in which it lies.
    Points {
        /// Points along a side.
        points: usize,
        /// What becomes of their values.
        finer: Finer,
    },
}

/// A map in the cells of the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Resampled {
    /// Share of occupancy from 0 to 1; NaN where the map knows nothing, or does not reach.
    pub occupancy: Raster<f64>,
    /// Cells beyond the border of the map.
    pub outside: Raster<bool>,
    /// How.
    pub how: Resampling,
}

/// A share of occupancy as files hold it.
pub trait Share: Copy {
    /// The share that is meant, from 0 to 1.
    fn meant(self) -> f64;
}

impl Share for f32 {
    fn meant(self) -> f64 {
        meant(self)
    }
}

impl Share for f64 {
    fn meant(self) -> f64 {
        self
    }
}

/// What a point meets.
enum Met {
    Outside,
    Unknown,
    Share(f64),
}

impl Resampling {
    /// How a map in the cells of `map` is brought into those of `truth`.
    ///
    /// A map is finer if more than one of its cells fit beside each other into one of the truth's. A whole number n fits: n points a
    /// side, which is the exact mean where the borders of cells coincide. Else 2 n, n rounded up.
    pub fn of(map: &Frame, truth: &Frame, finer: Finer) -> Self {
        if same(map, truth) {
            return Self::CellByCell;
        }
        let ratio = truth.spec.cell_m / map.spec.cell_m;
        if ratio < 1.0 + SAME {
            return Self::Nearest;
        }
        let whole = (ratio - ratio.round()).abs() < SAME * ratio;
        let points = if whole { ratio.round() } else { 2.0 * ratio.ceil() };
        Self::Points { points: points as usize, finer }
    }

    /// Points along the side of a cell.
    fn side(self) -> usize {
        match self {
            Self::CellByCell | Self::Nearest => 1,
            Self::Points { points, .. } => points,
        }
    }
}

/// Whether two grids have the same cells but for rounding.
fn same(a: &Frame, b: &Frame) -> bool {
    let size = [a.spec.width, a.spec.height] == [b.spec.width, b.spec.height];
    let to = a.cells_to(b);
    let corners = [[0.0, 0.0], [a.spec.width as f64, 0.0], [0.0, a.spec.height as f64]];
    size && corners.into_iter().all(|at| (0..2).all(|k| (to.of(at)[k] - at[k]).abs() < SAME * (1.0 + at[k])))
}

/// Brings a map, whose cells lie in `from`, into the cells of the truth, `onto`. Several values are the mean, or the greatest, of
/// those that are known; a cell is unknown where most of its points are, and outside where most lie beyond the map's border.
/// O(cells of `onto` x points).
///
/// # Errors
/// Memory that the system does not give.
pub fn resample<S: Share>(
    map: &Raster<Option<S>>,
    from: &Frame,
    onto: &Frame,
    finer: Finer,
) -> Result<Resampled, NoMemory> {
    let how = Resampling::of(from, onto, finer);
    let mut occupancy = Raster::try_filled(onto.spec, f64::NAN)?;
    let mut outside = Raster::try_filled(onto.spec, false)?;
    if how == Resampling::CellByCell {
        for (to, from) in occupancy.values_mut().iter_mut().zip(map.values()) {
            *to = from.map_or(f64::NAN, S::meant);
        }
        return Ok(Resampled { occupancy, outside, how });
    }
    let to_map = onto.cells_to(from);
    let side = how.side();
    let offsets: Vec<f64> = (0..side).map(|k| (k as f64 + 0.5) / side as f64).collect();
    for row in 0..onto.spec.height {
        for column in 0..onto.spec.width {
            let cell = onto.spec.index(column, row);
            let met = gathered(map, &to_map, [column as f64, row as f64], &offsets, finer);
            match met {
                Met::Outside => outside[cell] = true,
                Met::Unknown => {}
                Met::Share(share) => occupancy[cell] = share,
            }
        }
    }
    Ok(Resampled { occupancy, outside, how })
}

/// What the points of a cell meet together.
fn gathered<S: Share>(
    map: &Raster<Option<S>>,
    to_map: &CellsToCells,
    corner: [f64; 2],
    offsets: &[f64],
    finer: Finer,
) -> Met {
    let (mut outside, mut known, mut sum, mut greatest) = (0_usize, 0_usize, 0.0, 0.0_f64);
    for v in offsets {
        for u in offsets {
            match met(map, to_map.of([corner[0] + u, corner[1] + v])) {
                Met::Outside => outside += 1,
                Met::Unknown => {}
                Met::Share(share) => {
                    known += 1;
                    sum += share;
                    greatest = greatest.max(share);
                }
            }
        }
    }
    let points = offsets.len() * offsets.len();
    match finer {
        _ if 2 * outside > points => Met::Outside,
        _ if 2 * known < points => Met::Unknown,
        Finer::Mean => Met::Share((sum / known as f64).min(1.0)),
        Finer::Greatest => Met::Share(greatest),
    }
}

/// The cell in which a point lies, a border belonging to the cell above and to the right; within rounding of one, no worse.
fn met<S: Share>(map: &Raster<Option<S>>, [u, v]: [f64; 2]) -> Met {
    let spec = map.spec();
    let (column, row) = ((u + 1e-9).floor(), (v + 1e-9).floor());
    if column < 0.0 || row < 0.0 || column >= spec.width as f64 || row >= spec.height as f64 {
        return Met::Outside;
    }
    map[spec.index(column as usize, row as usize)].map_or(Met::Unknown, |share| Met::Share(share.meant()))
}

/// The share that a file in single precision means: 0.8 is not 0.800000011920929, which lies above a threshold of 0.8. Six decimals
/// are meant where single precision has nothing nearer.
pub fn meant(share: f32) -> f64 {
    let exact = f64::from(share);
    let six = (exact * 1e6).round() / 1e6;
    if (six as f32).to_bits() == share.to_bits() { six } else { exact }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grid::GridSpec;
    use proptest::prelude::*;

    fn spec(cell_m: f64, origin_m: [f64; 2], width: usize, height: usize) -> GridSpec {
        GridSpec { cell_m, origin_m, width, height }
    }

    /// A row of a map as text, from its lowest row up: digits are tenths, `?` unknown, `x` outside.
    fn shown(resampled: &Resampled) -> Vec<String> {
        let cell = |cell: usize| match (resampled.outside[cell], resampled.occupancy[cell]) {
            (true, _) => "x".to_owned(),
            (_, p) if p.is_nan() => "?".to_owned(),
            (_, p) => format!("{:.0}", 100.0 * p),
        };
        let spec = resampled.occupancy.spec();
        (0..spec.height)
            .map(|row| (0..spec.width).map(|column| cell(spec.index(column, row))).collect::<Vec<_>>().join(" "))
            .collect()
    }

    #[test]
    fn what_a_file_in_single_precision_means() {
        for p in [0.8, 0.2, 0.1, 0.123456, 0.0, 1.0, 1e-6] {
            assert_eq!(meant(p as f32).to_bits(), f64::to_bits(p), "{p}");
        }
        for kept in [1e-9_f32, 0.333_333_34, 0.123_456_7] {
            assert_eq!(meant(kept).to_bits(), f64::from(kept).to_bits(), "{kept}");
        }
    }

    #[test]
    fn the_same_cells_are_taken_cell_by_cell() {
        let frame = Frame::straight(spec(0.05, [1.0, 2.0], 2, 2));
        let map = Raster::new(frame.spec, vec![Some(0.1), None, Some(1.0), Some(0.8)]);
        let close = Frame::straight(spec(0.05, [1.0 + 1e-9, 2.0], 2, 2));
        let resampled = resample(&map, &frame, &close, Finer::Mean).expect("memory");
        assert_eq!(resampled.how, Resampling::CellByCell);
        assert_eq!(shown(&resampled), ["10 ?", "100 80"]);
    }

    #[test]
    fn a_finer_map_gives_the_mean_of_what_it_knows_or_the_greatest() {
        let fine = Frame::straight(spec(0.5, [0.0; 2], 4, 2));
        let map = Raster::new(fine.spec, vec![Some(0.0), Some(1.0), None, None, Some(0.5), Some(0.5), None, Some(0.3)]);
        let coarse = Frame::straight(spec(1.0, [0.0; 2], 3, 1));
        let of = |finer| shown(&resample(&map, &fine, &coarse, finer).expect("memory"));
        assert_eq!(of(Finer::Mean), ["50 ? x"]);
        assert_eq!(of(Finer::Greatest), ["100 ? x"]);
    }

    #[test]
    fn a_coarser_map_gives_the_cell_about_the_centre_and_nothing_beyond_its_border() {
        let coarse = Frame::straight(spec(1.0, [1.0, 0.0], 2, 1));
        let map = Raster::new(coarse.spec, vec![Some(0.2), Some(0.9)]);
        let fine = Frame::straight(spec(0.5, [0.5, 0.0], 6, 1));
        let resampled = resample(&map, &coarse, &fine, Finer::Mean).expect("memory");
        assert_eq!((resampled.how, shown(&resampled)), (Resampling::Nearest, vec!["x 20 20 90 90 x".to_owned()]));
    }

    #[test]
    fn a_map_on_its_side() {
        let turned = Frame { spec: spec(1.0, [2.0, 0.0], 3, 2), yaw_rad: std::f64::consts::FRAC_PI_2 };
        let map = Raster::new(turned.spec, [1, 2, 3, 4, 5, 6].map(|p| Some(p as f32 / 10.0)).to_vec());
        let straight = Frame::straight(spec(1.0, [0.0; 2], 2, 3));
        let resampled = resample(&map, &turned, &straight, Finer::Mean).expect("memory");
        assert_eq!(shown(&resampled), ["40 10", "50 20", "60 30"]);
    }

    #[test]
    fn double_precision_is_taken_as_it_is() {
        let frame = Frame::straight(spec(0.5, [0.0; 2], 2, 1));
        let shares = [0.1 + 0.2, 1e-12];
        let map = Raster::new(frame.spec, shares.map(Some).to_vec());
        let found = resample(&map, &frame, &frame, Finer::Mean).expect("memory").occupancy;
        assert_eq!(found.values().iter().map(|p| p.to_bits()).collect::<Vec<_>>(), shares.map(f64::to_bits));
    }

    proptest! {
        #[test]
        fn a_constant_map_stays_constant(
            share in 0.0_f32..=1.0, cell in 0.01_f64..0.3, yaw in -3.0_f64..3.0, shift in [-0.5_f64..0.5, -0.5..0.5],
            greatest in any::<bool>(),
        ) {
            let side = (6.0 / cell) as usize;
            let middle = Frame::straight(spec(0.1, [-0.5; 2], 10, 10));
            let map = Frame { spec: spec(cell, [0.0; 2], side, side), yaw_rad: 0.0 };
            let map = map.moved([0.0; 2], [-3.0 + shift[0], -3.0 + shift[1]], 0.0).moved([0.0; 2], [0.0; 2], yaw);
            let finer = if greatest { Finer::Greatest } else { Finer::Mean };
            let resampled = resample(&Raster::filled(map.spec, Some(share)), &map, &middle, finer).expect("memory");
            prop_assert!(resampled.occupancy.values().iter().all(|p| (p - f64::from(share)).abs() < 1e-6));
        }

        #[test]
        fn a_whole_number_of_cells_gives_the_plain_mean(
            shares in prop::collection::vec(0.0_f32..=1.0, 36 * 36), factor in prop::sample::select(vec![2_usize, 3, 4, 6]),
        ) {
            let fine = Frame::straight(spec(0.1, [3.0, -2.0], 36, 36));
            let coarse = Frame::straight(spec(0.1 * factor as f64, [3.0, -2.0], 36 / factor, 36 / factor));
            let map = Raster::new(fine.spec, shares.iter().copied().map(Some).collect());
            let resampled = resample(&map, &fine, &coarse, Finer::Mean).expect("memory");
            for cell in 0..coarse.spec.cells() {
                let (column, row) = coarse.spec.column_row(cell);
                let block = (0..factor * factor).map(|k| (column * factor + k % factor, row * factor + k / factor));
                let mean = block.map(|(x, y)| f64::from(shares[y * 36 + x])).sum::<f64>() / (factor * factor) as f64;
                prop_assert!((resampled.occupancy[cell] - mean).abs() < 1e-7);
            }
        }
    }
}
