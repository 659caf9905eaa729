//! Mismatches as real stereo makes them: in runs along the image, and of neighbouring surfaces.
//!
//! Measured on real pairs (the edge pixels of three scenes, seven matchers; wrong is more than
//! 1 px off): after a wrong pixel the next is wrong with probability 0.67 to 0.90, against 0.09 to
//! 0.30 in general; after a left-right check 61 to 94 % of the wrong disparities lie within 1 px of
//! the true disparity of a surface within 7 columns; 12 to 40 % are 1 to 3 px off, where a uniform
//! distribution over 60 px puts 7 %. The defaults lie inside these ranges.

use rand::{Rng, RngExt as _};
use serde::{Deserialize, Serialize};

use crate::matcher::Draws;
use crate::{Matcher, Surface};

/// How mismatches are distributed over the image.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Mismatches {
    /// The paper's: every column for itself, uniform over the search range (Section 3.1).
    #[default]
    Independent,
    /// In runs, and of neighbouring surfaces.
    Clustered(Clustering),
}

/// Statistics of clustered mismatches. Their share of all matches stays `1 - P(T)`.
///
/// Whether a match fails is a two-state Markov chain over the columns in which an edge is detected,
/// from right to left, that starts in its stationary state. What a failed match reads is a copy, a near
/// miss or uniform over the search range, drawn for every column:
///
/// - A *copy* reads the true disparity of another surface, with the noise of a correct match. That
///   is the nearest column, within `copy_reach`, whose true disparity differs by more than
///   [`APART_PX`](Self::APART_PX); of two as near, the one with the larger disparity, since
///   correlation windows favour the foreground. Where no other surface is in reach, there is nothing
///   to copy: the column reads a near miss or uniformly, in the proportion of their shares.
/// - A *near miss* is 1 to 3 px off ([`NEAR_MISS_PX`](Self::NEAR_MISS_PX)), uniformly, to either side; on
///   the other side where it would leave the search range.
/// - What would still leave the search range is uniform over it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Clustering {
    /// Probability, 0 to 1, that a match fails if that of the detected column before it failed.
    /// At least [`least_persistence`](Self::least_persistence). Default 0.85; measured 0.67 to 0.90.
    pub persistence: f64,
    /// Share of the mismatches that copy a neighbouring surface, 0 to 1. Default 0.75; measured
    /// 0.61 to 0.94, those included that land there by chance.
    pub copies: f64,
    /// Share of the mismatches that miss by 1 to 3 px, 0 to 1 and at most `1 - copies`. Default 0.12;
    /// measured 0.12 to 0.40, copies of a surface as near and the outliers of correct matches included.
    pub near_misses: f64,
    /// How many columns away a surface is copied from. Default 7, as measured.
    pub copy_reach: u32,
}

impl Default for Clustering {
    fn default() -> Self {
        Self { persistence: 0.85, copies: 0.75, near_misses: 0.12, copy_reach: 7 }
    }
}

impl Mismatches {
    /// Whether they are the paper's.
    pub fn are_independent(&self) -> bool {
        *self == Self::Independent
    }
}

impl Clustering {
    /// Disparities that differ by more than this, px, are of different surfaces: what the
    /// measurements call wrong.
    pub const APART_PX: f64 = 1.0;

    /// Least and largest error of a near miss, px.
    pub const NEAR_MISS_PX: [f64; 2] = [1.0, 3.0];

    /// The least persistence at which a share of `correct_match` correct matches is possible at all:
    /// were the runs of a majority of mismatches shorter, no correct match would be left between.
    pub fn least_persistence(correct_match: f64) -> f64 {
        if correct_match < 0.5 { 1.0 - correct_match / (1.0 - correct_match) } else { 0.0 }
    }

    /// Probability that a match fails, given whether that of the detected column before it did; of
    /// the first one, where there is none before. Keeps the share of mismatches at `1 - P(T)`.
    fn failing(&self, correct_match: f64, before: Option<bool>) -> f64 {
        match before {
            None => 1.0 - correct_match,
            Some(true) => self.persistence,
            Some(false) => ((1.0 - correct_match) * (1.0 - self.persistence) / correct_match).min(1.0),
        }
    }

    /// The readings of one scan; as [`Matcher::scan`] does.
    pub(crate) fn scan<R: Rng>(
        &self,
        matcher: &Matcher,
        bearings_rad: &[f64],
        surfaces: &[Option<Surface>],
        mut draws: impl FnMut(usize) -> Draws<R>,
    ) -> Vec<Option<f64>> {
        let true_px = |(surface, &bearing): (&Option<Surface>, &f64)| {
            surface.map(|s| matcher.stereo.disparity(s.range_m, bearing))
        };
        let true_px: Vec<Option<f64>> = surfaces.iter().zip(bearings_rad).map(true_px).collect();
        let mut before = None;
        let mut readings = vec![None; surfaces.len()];
        for (column, reading) in readings.iter_mut().enumerate() {
            let (Some(surface), Some(own_px)) = (surfaces[column], true_px[column]) else { continue };
            let draws = &mut draws(column);
            if draws.image.random::<f64>() >= matcher.detection_rate * surface.texture {
                continue;
            }
            let fails = draws.image.random::<f64>() < self.failing(matcher.stereo.correct_match, before);
            before = Some(fails);
            *reading = if fails {
                let copied_px = self.neighbour(&true_px, column, own_px);
                matcher.reading(self.mismatch(matcher, own_px, copied_px, draws))
            } else {
                matcher.reading(noisy(matcher, own_px, draws))
            };
        }
        readings
    }

    /// True disparity (px) of the other surface that a mismatch at `column` copies, if one is in reach.
    fn neighbour(&self, true_px: &[Option<f64>], column: usize, own_px: f64) -> Option<f64> {
        let other = |at: Option<usize>| {
            let px = *true_px.get(at?)?;
            px.filter(|px| px.is_finite() && (px - own_px).abs() > Self::APART_PX)
        };
        let nearest =
            (1..=self.copy_reach as usize).map(|away| [column.checked_sub(away), Some(column + away)].map(other));
        nearest.flat_map(|sides| sides.into_iter().flatten().max_by(f64::total_cmp)).next()
    }

    /// The disparity (px) of a failed match, within the search range.
    fn mismatch<R: Rng>(&self, matcher: &Matcher, own_px: f64, copied_px: Option<f64>, draws: &mut Draws<R>) -> f64 {
        let max_px = matcher.stereo.max_disparity;
        let uniform_px = max_px * draws.image.random::<f64>();
        // Without a surface to copy, the other kinds share what is left of the draw.
        let copies = if copied_px.is_some() { self.copies } else { 0.0 };
        let kind = draws.image.random::<f64>() * (1.0 - self.copies + copies);
        let within = |px: &f64| (0.0..=max_px).contains(px);
        let read_px = match copied_px {
            Some(px) if kind < copies => Some(noisy(matcher, px, draws)).filter(within),
            _ if kind < copies + self.near_misses => {
                let [least, most] = Self::NEAR_MISS_PX;
                let size_px = least + (most - least) * draws.image.random::<f64>();
                let by_px = if draws.image.random::<bool>() { size_px } else { -size_px };
                [own_px + by_px, own_px - by_px].into_iter().find(within)
            }
            _ => None,
        };
        read_px.unwrap_or(uniform_px)
    }
}

/// What a correct match of a surface with the given disparity (px) measures, px.
fn noisy<R: Rng>(matcher: &Matcher, px: f64, draws: &mut Draws<R>) -> f64 {
    px + matcher.stereo.disparity_sigma * draws.normal()
}

#[cfg(test)]
mod tests;
