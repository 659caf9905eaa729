//! Probabilities of a bin of disparities for the chords of a ray, eight at a time.

use super::Stereo;
use crate::in_lanes;
use crate::lanes::{LANES, Lanes, each};
use crate::normal::{self, LaneTable};

in_lanes! {
    /// [`bin_probability`](crate::InverseModel::bin_probability) of every chord `ranges[k] ..= ranges[k + 1]` and the bin between two
    /// disparities (px), to the bit.
    pub(super) fn fill<'a>(stereo: &'a Stereo, cosine: f64, bin: [f64; 2], ranges: &'a [f64], bins: &'a mut [f64]) {
        fill_eight(stereo, cosine, bin, ranges, bins);
    }
}

#[inline(always)]
fn fill_eight(stereo: &Stereo, cosine: f64, [low, high]: [f64; 2], ranges: &[f64], bins: &mut [f64]) {
    let sigma = stereo.disparity_sigma;
    let (low, high) = (low / sigma, high / sigma);
    let integrals = LaneTable::cumulative_integral();
    // Of the grid line at which a chord ends: its disparity in standard deviations, and the integrals up to the ends of the bin.
    let first = stereo.at_cosine(ranges[0], cosine) / sigma;
    let mut before = [first, normal::cumulative_integral(high - first), normal::cumulative_integral(low - first)];
    for (bins, exits) in bins.chunks_mut(LANES).zip(ranges[1..].chunks(LANES)) {
        let last = exits.len() - 1;
        let exit = each(|l| exits[l.min(last)]);
        let far = at_cosine(stereo, cosine, &exit);
        let far = each(|l| far[l] / sigma);
        let high_far = integrals.at(&each(|l| high - far[l]));
        let low_far = integrals.at(&each(|l| low - far[l]));
        let near = each(|l| if l == 0 { before[0] } else { far[l - 1] });
        let high_near = each(|l| if l == 0 { before[1] } else { high_far[l - 1] });
        let low_near = each(|l| if l == 0 { before[2] } else { low_far[l - 1] });
        before = [far[last], high_far[last], low_far[last]];
        // The mean over the chord's disparities d of Phi(high - d) - Phi(low - d).
        let span = each(|l| near[l] - far[l]);
        let mean = each(|l| ((high_far[l] - high_near[l]) - (low_far[l] - low_near[l])) / span[l]);
        let mean = each(|l| if mean[l] < 0.0 { 0.0 } else { mean[l] });
        let mean = each(|l| if mean[l] > 1.0 { 1.0 } else { mean[l] });
        bins.iter_mut().zip(mean).for_each(|(bin, mean)| *bin = mean);
        let special = each(|l| if span[l] >= 1e-3 && span[l] < f64::INFINITY { 0.0 } else { 1.0 });
        if special[..=last].iter().sum::<f64>() > 0.0 {
            for (l, bin) in bins.iter_mut().enumerate().filter(|(l, _)| special[*l] > 0.0) {
                *bin = special_chord([low, high], near[l], far[l]);
            }
        }
    }
}

/// [`Stereo::at_cosine`] in lanes.
#[inline(always)]
fn at_cosine(stereo: &Stereo, cosine: f64, range: &Lanes<f64>) -> Lanes<f64> {
    let depth = each(|l| range[l] * cosine);
    let disparity = each(|l| stereo.focal_baseline / depth[l]);
    each(|l| if depth[l] > 0.0 { disparity[l] } else { f64::INFINITY })
}

/// A chord that is short, or begins at the sensor.
#[inline(never)]
fn special_chord([low, high]: [f64; 2], near: f64, far: f64) -> f64 {
    if near.is_finite() {
        let middle = 0.5 * (near + far);
        normal::between(low - middle, high - middle)
    } else {
        0.0
    }
}
