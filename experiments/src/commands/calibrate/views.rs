//! Over what distance and angle views share their errors: how often a false reading comes again from nearly the same pose.
//!
//! A reading is *astray* where it differs by more than 8 sigma from every straight piece of surface that its ray crosses. Of two scans of one
//! sensor, at poses apart by `d` (m) and `a` (degrees), the second has by the same beam a reading like it, up to its noise, with probability
//!
//! ```text
//! c(d, a) = other + (same - other) exp(-(d / D)^2 / 2 - (a / A)^2 / 2)
//! ```
//!
//! (`mapper::Repeats` takes views for the same where the exponential is above one half). What stands in front of a wall and is no straight piece is astray from every
//! view, and changes slowly: `other` holds it, and chance. `D` and `A` are those of the largest likelihood; intervals are by blocks of neighbouring scans. They
//! can be told where a robot has stood, or crept, and has moved on: from a log without such places the search says that it cannot.

use mapper::Repeats;
use rayon::prelude::*;
use score::Interval;
use sensor::Scan;

use super::noise::Surfaces;
use super::search::{self, Found, Losses, Parameter, Scale};

/// Scans that follow each other, of which pairs are made ...
pub(super) const RUN: usize = 20;

/// ... and so many such runs, spread evenly over the log.
pub(super) const RUNS: usize = 60;

/// Readings of one beam are alike up to so many sigma: four, of the difference of two.
const LIKE: f64 = 5.7;

/// Fewer readings astray in pairs of scans than this say nothing.
const FEWEST: u64 = 200;

/// The names, as the options have them.
const NAMES: [&str; 2] = ["repeat_distance", "repeat_angle"];

/// Two scans: how far their poses are apart, the readings astray in the first to which the second has one, and those that come again.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Pair {
    apart_m: f64,
    turned_deg: f64,
    astray: u64,
    again: u64,
}

/// What runs of scans say of the views, with what is to be known of it.
pub(super) fn of(runs: &[Vec<Scan>], surfaces: &Surfaces, sigma: f64) -> (Vec<Found>, String) {
    let series: Vec<Vec<Pair>> = runs.par_iter().flat_map_iter(|run| pairs(run, surfaces, sigma)).collect();
    fitted(&series)
}

/// The pairs of every scan of a run with those after it.
fn pairs(run: &[Scan], surfaces: &Surfaces, sigma: f64) -> Vec<Vec<Pair>> {
    let astray = |scan: &Scan| -> Vec<usize> {
        let rays = scan.rays().enumerate().filter(|(_, ray)| surfaces.is_astray(ray) == Some(true));
        rays.map(|(beam, _)| beam).collect()
    };
    let of = |(number, first): (usize, &Scan)| {
        let astray = astray(first);
        let like = |second: &Scan| {
            let both = |beam: &usize| Some((first.readings[*beam]?, second.readings[*beam]?));
            let both: Vec<(f64, f64)> = astray.iter().filter_map(both).collect();
            let apart = |(a, b): &(f64, f64)| (surfaces.value(*a) - surfaces.value(*b)).abs();
            let again = both.iter().filter(|both| apart(both) <= LIKE * sigma).count();
            let turned_rad = libm::remainder(second.pose.theta_rad - first.pose.theta_rad, std::f64::consts::TAU);
            Pair {
                apart_m: libm::hypot(second.pose.x_m - first.pose.x_m, second.pose.y_m - first.pose.y_m),
                turned_deg: turned_rad.abs().to_degrees(),
                astray: both.len() as u64,
                again: again as u64,
            }
        };
        let later = run[number + 1..].iter();
        let later = later.filter(|second| second.sensor == first.sensor && second.bearings_rad == first.bearings_rad);
        later.map(like).filter(|pair| pair.astray > 0).collect()
    };
    run.iter().enumerate().map(of).collect()
}

/// `same`, `other`, `D` and `A`.
fn parameters() -> [Parameter; 4] {
    let Repeats { distance_m, angle_rad, .. } = Repeats::CHOSEN;
    let parameter = |name, unit, range, start, scale| Parameter { name, unit, range, start, scale };
    [
        parameter("same", "1", [0.01, 0.999], 0.7, Scale::Odds),
        parameter("other", "1", [0.001, 0.99], 0.1, Scale::Odds),
        parameter(NAMES[0], "m", [0.001, 1.0], distance_m, Scale::Ratio),
        parameter(NAMES[1], "deg", [0.02, 45.0], angle_rad.to_degrees(), Scale::Ratio),
    ]
}

/// The lengths of the largest likelihood of what comes again in each scan's pairs.
fn fitted(series: &[Vec<Pair>]) -> (Vec<Found>, String) {
    let readings: u64 = series.iter().flatten().map(|pair| pair.astray).sum();
    let losses = |values: &[f64]| -> Losses {
        let [same, other, distance_m, angle_deg] = [values[0], values[1], values[2], values[3]];
        if other >= same {
            return None; // lengths of what does not decay
        }
        let loss = |pair: &Pair| {
            let square = |x: f64| x * x;
            let shared = libm::exp(-0.5 * (square(pair.apart_m / distance_m) + square(pair.turned_deg / angle_deg)));
            let again = other + (same - other) * shared;
            -(pair.again as f64 * libm::log(again) + (pair.astray - pair.again) as f64 * libm::log(1.0 - again))
        };
        let of = |pairs: &Vec<Pair>| (pairs.iter().map(loss).sum(), pairs.iter().map(|pair| pair.astray).sum());
        Some(series.iter().map(of).collect())
    };
    let parameters = parameters();
    let fit = (readings >= FEWEST).then(|| search::fit(&parameters, None, &losses, &|| {})).flatten();
    let Some(fit) = fit else {
        let why = format!(
            "the lengths of views are not told by {readings} readings astray, in pairs of scans: {FEWEST} are needed"
        );
        return (parameters[2..].iter().map(untold).collect(), why);
    };
    let [same, other] = [fit.found[0].value, fit.found[1].value];
    let about = format!(
        "of {readings} readings astray, in pairs of scans, {:.0} % come again from the same view and {:.0} % from others: repeat_distance and repeat_angle are \
         the lengths between (visibility-dynamic takes them)",
        100.0 * same,
        100.0 * other
    );
    (fit.found.into_iter().skip(2).collect(), about)
}

/// What the mapper takes where nothing is told.
fn untold(parameter: &Parameter) -> Found {
    Found {
        parameter: parameter.clone(),
        value: parameter.start,
        interval: Interval { low: parameter.range[0], high: parameter.range[1] },
        unidentified: Some("too few readings lie astray"),
        profile: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

    use super::*;

    /// Pairs of scans at poses up to so far apart, of which as many come again as lengths of 5 cm and 2 degrees say.
    fn drawn(most_m: f64, most_deg: f64) -> Vec<Vec<Pair>> {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut uniform = || f64::from(rng.next_u32()) / 4_294_967_296.0;
        let mut pair = || {
            let [apart_m, turned_deg] = [most_m * uniform() * uniform(), most_deg * uniform() * uniform()];
            let shared = libm::exp(-0.5 * ((apart_m / 0.05).powi(2) + (turned_deg / 2.0).powi(2)));
            let again = (0..10).filter(|_| uniform() < 0.1 + 0.7 * shared).count() as u64;
            Pair { apart_m, turned_deg, astray: 10, again }
        };
        (0..400).map(|_| (0..8).map(|_| pair()).collect()).collect()
    }

    fn lengths(series: &[Vec<Pair>]) -> [Found; 2] {
        fitted(series).0.try_into().expect("two")
    }

    #[test]
    fn lengths_come_back_from_pairs_that_were_drawn_by_them() {
        for (found, truth) in lengths(&drawn(0.3, 12.0)).iter().zip([0.05, 2.0]) {
            assert!(found.unidentified.is_none(), "{found:?}");
            assert!((found.value / truth - 1.0).abs() < 0.1, "{found:?}");
            assert!(found.interval.low < truth && truth < found.interval.high, "{found:?}");
        }
    }

    #[test]
    fn what_a_log_cannot_tell_is_said() {
        // A robot that never stays: all pairs are far apart.
        let mut far = drawn(0.3, 12.0);
        far.iter_mut().flatten().for_each(|pair| (pair.apart_m, pair.again) = (pair.apart_m + 0.6, 1));
        // One that never moves.
        let near = drawn(0.0, 0.0);
        // One without false readings.
        let none = vec![Vec::new(); 50];
        for series in [far, near, none] {
            for found in lengths(&series) {
                assert!(found.unidentified.is_some(), "{found:?}");
            }
        }
        // Straight ahead only: the angle moves nothing.
        let [distance, angle] = lengths(&drawn(0.3, 0.0));
        assert!(distance.unidentified.is_none() && angle.unidentified.is_some(), "{distance:?} {angle:?}");
    }
}
