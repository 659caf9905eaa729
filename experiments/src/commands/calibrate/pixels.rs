//! Pixels without a reading: how many a camera misses, and at which angle to a surface it sees none any more.
//!
//! A ray that crosses a straight piece of surface (`Surfaces`), which other scans have seen, has a reading with probability
//!
//! ```text
//! P(read | a) = detection_rate Phi((a - grazing) / 1 degree) + 0.001
//! ```
//!
//! where `a` is the angle between ray and surface. The step is blurred by how well a piece's direction is known, and what little is read below it keeps single
//! pixels from deciding. Of a camera without such an angle the step is left out. Both are those of the largest likelihood, with intervals by blocks of
//! neighbouring scans; a log in which no surface is seen at small angles does not bound the angle from below, and the search says so.

use rayon::prelude::*;
use score::Interval;
use sensor::Scan;

use super::noise::Surfaces;
use super::search::{self, Found, Losses, Parameter, Scale};

/// The names, as scene files have them.
const NAMES: [&str; 2] = ["detection_rate", "grazing_deg"];

/// How well the direction of a piece is known, degrees.
const BLUR_DEG: f64 = 1.0;

/// Share of pixels that are read although they should not be.
const STRAY: f64 = 1e-3;

/// Fewer rays on known surfaces than this say nothing.
const FEWEST: usize = 300;

/// Pixels of surfaces farther than this share of the largest range are left out: noise takes some of them beyond.
const WITHIN: f64 = 0.9;

/// A surface that is seen at such an angle is seen by any camera, degrees.
const FRONT_DEG: f64 = 45.0;

/// Angles that are tried before the search.
const STEPS: u32 = 60;

/// Angle between a ray and the surface that it crosses, and whether there is a reading.
type Look = (f64, bool);

/// What scans tell of pixels without a reading: the share that is read, and, of a camera that has one, the least angle. `max_range_m` is the largest range that it
/// reads.
pub(super) fn of(scans: &[Scan], surfaces: &Surfaces, max_range_m: f64, has_angle: bool) -> (Vec<Found>, String) {
    let look = |scan: &Scan| -> Vec<Look> {
        let of = |ray| {
            let (range_m, angle_rad) = surfaces.first_crossed(&ray)?;
            (range_m < WITHIN * max_range_m).then(|| (angle_rad.to_degrees(), ray.reading.is_some()))
        };
        scan.rays().filter_map(of).collect()
    };
    let looks: Vec<Vec<Look>> = scans.par_iter().map(look).collect();
    fitted(&looks, has_angle)
}

fn parameters(has_angle: bool) -> Vec<Parameter> {
    let parameter = |name, unit, range, start, scale| Parameter { name, unit, range, start, scale };
    let rate = parameter(NAMES[0], "1", [0.01, 0.9999], 0.9, Scale::Odds);
    let angle = parameter(NAMES[1], "deg", [1.0, 60.0], 10.0, Scale::Ratio);
    std::iter::once(rate).chain(has_angle.then_some(angle)).collect()
}

fn fitted(looks: &[Vec<Look>], has_angle: bool) -> (Vec<Found>, String) {
    let parameters = parameters(has_angle);
    let rays: usize = looks.iter().map(Vec::len).sum();
    if rays < FEWEST {
        let why = format!(
            "only {rays} rays cross straight surfaces whose place is known, and {FEWEST} are needed to tell how many pixels are missed"
        );
        return (parameters.iter().map(untold).collect(), why);
    }
    let losses = |values: &[f64]| -> Losses {
        let read = |angle_deg: f64| {
            let seen = match values.get(1) {
                Some(grazing_deg) => {
                    0.5 * libm::erfc((grazing_deg - angle_deg) / BLUR_DEG * std::f64::consts::FRAC_1_SQRT_2)
                }
                None => 1.0,
            };
            STRAY + (1.0 - STRAY) * values[0] * seen
        };
        let loss = |(angle_deg, is_read): &Look| {
            let read = read(*angle_deg);
            -libm::log(if *is_read { read } else { 1.0 - read })
        };
        Some(looks.iter().map(|looks| (looks.iter().map(loss).sum(), looks.len() as u64)).collect())
    };
    let parameters = begun(parameters, looks, &losses);
    let Some(fit) = search::fit(&parameters, None, &losses, &|| ()) else {
        return (parameters.iter().map(untold).collect(), "no share of missed pixels could be tried".to_owned());
    };
    let about = format!(
        "{} of {rays} rays that cross straight surfaces, with or without a reading",
        if has_angle {
            "detection_rate and grazing_deg are those"
        } else {
            "detection_rate, texture included, is that"
        }
    );
    (fit.found, about)
}

/// Where the search begins: the share that is read of surfaces seen from in front, the angle that is then the likeliest, and the share
/// that is read beyond that. From elsewhere a walk parameter by parameter can miss a step as sharp as this.
fn begun(mut parameters: Vec<Parameter>, looks: &[Vec<Look>], losses: &dyn Fn(&[f64]) -> Losses) -> Vec<Parameter> {
    let Parameter { range: [least, most], start, .. } = parameters[0];
    let share_from = |from_deg: f64| {
        let beyond = || looks.iter().flatten().filter(|(angle_deg, _)| *angle_deg >= from_deg);
        let (read, all) = (beyond().filter(|(_, is_read)| *is_read).count(), beyond().count());
        (all > 0).then(|| (read as f64 / all as f64).clamp(least, most))
    };
    let mut from_deg = 0.0;
    if let Some(angle) = parameters.get_mut(1) {
        let share = share_from(FRONT_DEG).unwrap_or(start);
        let [low, high] = angle.range;
        let tried = (0..=STEPS).map(|k| low * libm::pow(high / low, f64::from(k) / f64::from(STEPS)));
        let loss = |angle_deg: &f64| {
            let all = losses(&[share, *angle_deg]);
            all.map_or(f64::INFINITY, |all| all.iter().map(|(sum, _)| sum).sum::<f64>())
        };
        angle.start = tried.min_by(|a, b| loss(a).total_cmp(&loss(b))).unwrap_or(angle.start);
        from_deg = angle.start + 3.0 * BLUR_DEG;
    }
    if let Some(share) = share_from(from_deg) {
        parameters[0].start = share;
    }
    parameters
}

/// What a scene takes where nothing is told.
fn untold(parameter: &Parameter) -> Found {
    Found {
        parameter: parameter.clone(),
        value: parameter.start,
        interval: Interval { low: parameter.range[0], high: parameter.range[1] },
        unidentified: Some("too few rays cross known surfaces"),
        profile: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

    /// Looks at angles from so many degrees to 90, of which a share is read from an angle on.
    fn drawn(scans: usize, least_deg: f64, rate: f64, grazing_deg: f64) -> Vec<Vec<Look>> {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let mut uniform = || f64::from(rng.next_u32()) / 4_294_967_296.0;
        let mut look = || {
            let angle_deg = least_deg + (90.0 - least_deg) * uniform();
            (angle_deg, angle_deg >= grazing_deg && uniform() < rate)
        };
        (0..scans).map(|_| (0..60).map(|_| look()).collect()).collect()
    }

    #[test]
    fn share_and_angle_come_back_from_looks_that_were_drawn_by_them() {
        let found = fitted(&drawn(100, 0.0, 0.85, 14.0), true).0;
        for (found, (truth, within)) in found.iter().zip([(0.85, 0.02), (14.0, 0.7)]) {
            assert!(found.unidentified.is_none() && (found.value - truth).abs() < within, "{found:?}");
        }
        let found = fitted(&drawn(100, 0.0, 0.6, 0.0), false).0;
        assert!(
            found.len() == 1 && (found[0].value - 0.6).abs() < 0.02 && found[0].unidentified.is_none(),
            "{found:?}"
        );
    }

    #[test]
    fn what_was_not_looked_at_is_not_told() {
        // No surface is seen at less than 40 degrees.
        let found = fitted(&drawn(100, 40.0, 0.85, 14.0), true).0;
        assert!(found[0].unidentified.is_none() && found[1].unidentified.is_some(), "{found:?}");
        let (found, why) = fitted(&drawn(4, 0.0, 0.85, 14.0), true);
        assert!(found.iter().all(|found| found.unidentified.is_some()) && why.contains("240 rays"), "{why}");
    }
}
