//! Where a map is wrong: its error against something known about each cell, such as range.

use grid::Raster;
use serde::Serialize;

use crate::error::same_cells;
use crate::judged::judged;
use crate::log_loss::LogLoss;
use crate::{Metric, ScoreError};

/// Edges, m, for the range from which a cell was seen best
/// ([`Sightings::nearest_m`](crate::Sightings::nearest_m)): narrow where stereo is sharp, wider as its
/// error grows with the square of the range. Cells that were never seen, at infinity, are outside.
pub const RANGE_EDGES_M: [f64; 11] = [0.0, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0, 8.0, f64::INFINITY];

/// Edges for the number of looks at a cell ([`Sightings::looks`](crate::Sightings::looks)): none, one,
/// two or three, then doubling, as independent evidence would halve the variance.
pub const LOOK_EDGES: [f64; 12] = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, f64::INFINITY];

/// The error of a map over the bins of a covariate.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ErrorProfile {
    /// All bins, in order, empty ones too.
    pub bins: Vec<ErrorBin>,
    /// Number of judged cells that lie in no bin.
    pub outside: usize,
}

/// The error over the cells whose covariate is at least `from` and below `to`. Metrics of bins of
/// several maps are pooled by their support.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorBin {
    /// Lower edge, in the unit of the covariate; included.
    pub from: f64,
    /// Upper edge; excluded.
    pub to: f64,
    /// Log loss, nats per cell; see [`log_loss`](crate::log_loss).
    pub log_loss: Metric,
    /// Brier score.
    pub brier: Metric,
}

/// Splits the error of a map over the known cells of `mask` by `covariate`: bin k holds the cells
/// with `edges[k] <= covariate < edges[k + 1]`. The last edge may be infinite; the bin then holds
/// everything finite from the edge before it on, and cells at infinity are outside.
///
/// # Errors
/// Rasters of different geometry; a cell that holds no probability; a judged cell whose covariate is
/// NaN; fewer than two edges, or edges that do not rise.
pub fn error_profile(
    map: &Raster<f64>,
    truth: &Raster<Option<bool>>,
    mask: &Raster<bool>,
    covariate: &Raster<f64>,
    edges: &[f64],
) -> Result<ErrorProfile, ScoreError> {
    same_cells("covariate", covariate.spec(), truth.spec())?;
    if edges.len() < 2 || edges.iter().any(|edge| edge.is_nan()) || edges.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err(ScoreError::Edges { edges: edges.to_vec() });
    }
    let mut sums = vec![Sums::default(); edges.len() - 1];
    let mut outside = 0;
    for j in judged(map, truth, mask)? {
        let value = covariate[j.cell];
        if value.is_nan() {
            let (column, row) = covariate.spec().column_row(j.cell);
            return Err(ScoreError::Covariate { cell: j.cell, column, row });
        }
        let bin = edges.partition_point(|&edge| edge <= value).checked_sub(1);
        match bin.and_then(|bin| sums.get_mut(bin)) {
            Some(sums) => sums.add(j.p, j.occupied),
            None => outside += 1,
        }
    }
    let bins = edges.windows(2).zip(&sums).map(|(edge, sums)| sums.bin(edge[0], edge[1])).collect();
    Ok(ErrorProfile { bins, outside })
}

/// What a bin has gathered.
#[derive(Clone, Default)]
struct Sums {
    log_loss: LogLoss,
    squared_error: f64,
    cells: usize,
}

impl Sums {
    fn add(&mut self, p: f64, occupied: bool) {
        let error = p - f64::from(u8::from(occupied));
        self.log_loss.add(p, occupied);
        self.squared_error += error * error;
        self.cells += 1;
    }

    fn bin(&self, from: f64, to: f64) -> ErrorBin {
        let brier = Metric::mean("brier", "1", self.squared_error, self.cells);
        ErrorBin { from, to, log_loss: self.log_loss.metric(), brier }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::drawn;

    fn profile(world: &[&str], map: &[f64], covariate: &[f64], edges: &[f64]) -> Result<ErrorProfile, ScoreError> {
        let truth = drawn(world);
        let raster = |values: &[f64]| Raster::new(*truth.spec(), values.to_vec());
        error_profile(&raster(map), &truth, &truth.map(|_| true), &raster(covariate), edges)
    }

    #[test]
    fn by_hand() {
        let map = [0.5, 0.2, 0.25, 0.9, 0.1];
        let found = profile(&["..##?"], &map, &[0.0, 0.9, 1.0, 7.0, f64::NAN], &[0.0, 1.0, 3.0, 5.0, f64::INFINITY]);
        let found = found.expect("the cell that is not known needs no covariate");
        let bins: Vec<_> = found.bins.iter().map(|b| (b.from, b.to, b.log_loss.support, b.brier.support)).collect();
        assert_eq!(bins, [(0.0, 1.0, 2, 2), (1.0, 3.0, 1, 1), (3.0, 5.0, 0, 0), (5.0, f64::INFINITY, 1, 1)]);
        assert_eq!(found.outside, 0);
        let expected = [Some((2.0f64.ln() + 1.25f64.ln()) / 2.0), Some(4.0f64.ln()), None, Some(-(0.9f64.ln()))];
        for (bin, expected) in found.bins.iter().zip(expected) {
            assert_eq!(bin.log_loss.value.is_some(), expected.is_some());
            assert!(bin.log_loss.value.zip(expected).is_none_or(|(v, e)| (v - e).abs() < 1e-14), "{bin:?}");
        }
        let brier: Vec<_> = found.bins.iter().filter_map(|b| b.brier.value).collect();
        assert!(brier.iter().zip([(0.25 + 0.04) / 2.0, 0.5625, 0.01]).all(|(v, e)| (v - e).abs() < 1e-15), "{brier:?}");
    }

    #[test]
    fn what_is_in_no_bin_is_counted() {
        let found = profile(&["....."], &[0.1; 5], &[-1.0, 0.0, 1.0, 2.0, f64::INFINITY], &[0.0, 1.0, 2.0]);
        let found = found.expect("valid");
        assert_eq!(found.bins.iter().map(|b| b.brier.support).collect::<Vec<_>>(), [1, 1]);
        assert_eq!(found.outside, 3);
        let found = profile(&[".."], &[0.1; 2], &[9e99, f64::INFINITY], &RANGE_EDGES_M).expect("valid");
        assert_eq!((found.bins[9].brier.support, found.outside), (1, 1), "never seen is outside");
    }

    #[test]
    fn what_makes_no_bins_is_refused() {
        for edges in [&[][..], &[1.0], &[1.0, 1.0], &[2.0, 1.0], &[0.0, f64::NAN], &[f64::NAN, 1.0]] {
            let message = profile(&["."], &[0.1], &[0.0], edges).expect_err("refused").to_string();
            assert!(message.starts_with(&format!("bin edges {edges:?} do not rise")), "{message}");
        }
        let message = profile(&["..", ".."], &[0.1; 4], &[0.0, 0.0, 0.0, f64::NAN], &[0.0, 1.0]).expect_err("refused");
        assert!(message.to_string().contains("in cell 3 (column 1, row 1)"), "{message}");
        let truth = drawn(&[".."]);
        let narrow = Raster::filled(*drawn(&["."]).spec(), 0.0);
        let other = error_profile(&truth.map(|_| 0.1), &truth, &truth.map(|_| true), &narrow, &[0.0, 1.0]);
        assert!(matches!(other, Err(ScoreError::Geometry { what: "covariate", .. })), "{other:?}");
    }
}
