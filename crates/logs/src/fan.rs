//! Where the beams of a scanner go: what options, a log's parameters and the number of beams tell of it.

use std::f64::consts::{PI, TAU};

/// Directions of the beams of a scan: `first_rad + k step_rad`, rad to the laser's axis, counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fan {
    /// Bearing of the first beam, rad.
    pub first_rad: f64,
    /// From one beam to the next, rad; negative where beams go from left to right.
    pub step_rad: f64,
}

/// Where a fan comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FanSource {
    /// The options.
    Options,
    /// The log: the message itself, or `PARAM` lines.
    Log,
    /// The number of beams, which usual scanners have.
    UsualNumber,
    /// The number of beams, which no usual scanner has: spread over half a turn.
    Number,
}

/// What is known of a fan. What is given beats a guess; the rest follows: a fan is centred on the laser's axis, and one of a
/// full turn has as many steps as beams where their number is even, else one less.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FanOptions {
    /// Field of view, rad, up to 2 pi.
    pub fov_rad: Option<f64>,
    /// Bearing of the first beam, rad.
    pub first_rad: Option<f64>,
    /// From one beam to the next, rad; negative where beams go from left to right.
    pub step_rad: Option<f64>,
}

/// What rounding does to angles, rad.
const ROUNDING_RAD: f64 = 2e-3;

impl FanOptions {
    /// Refuses angles that make no sense; gives the bound.
    pub(crate) fn check(&self) -> Result<(), &'static str> {
        let within = |value: Option<f64>| value.is_none_or(|value| value.abs() <= TAU + ROUNDING_RAD);
        let fine = self.fov_rad.is_none_or(|fov| fov > 0.0) && self.step_rad.is_none_or(|step| step.abs() > 0.0);
        let all = [self.fov_rad, self.first_rad, self.step_rad].into_iter().all(within);
        if all && fine {
            Ok(())
        } else {
            Err("angles from -2 pi to 2 pi rad, the field of view above 0, the step not 0")
        }
    }

    /// The fan of so many beams; none where nothing is known.
    pub fn fan(&self, beams: usize) -> Option<Fan> {
        let Self { fov_rad, first_rad, step_rad } = *self;
        let steps = beams.saturating_sub(1).max(1) as f64;
        let step_rad = match (step_rad, fov_rad, first_rad) {
            (None, None, None) => return None,
            (Some(step_rad), None, None) => return Some(Fan { first_rad: centred(beams, step_rad), step_rad }),
            (Some(step_rad), ..) => step_rad,
            (None, Some(fov_rad), _) => fov_rad / steps_of(beams, fov_rad),
            (None, None, Some(first_rad)) => -2.0 * first_rad / steps_of(beams, 2.0 * first_rad),
        };
        let edge_rad = fov_rad.map_or(0.5 * steps * step_rad.abs(), |fov| 0.5 * fov);
        Some(Fan { first_rad: first_rad.unwrap_or(-edge_rad.copysign(step_rad)), step_rad })
    }

    /// Whether field of view and step tell of the same number of beams as there are; true where either is unknown.
    pub(crate) fn fits(&self, beams: usize) -> bool {
        match (self.fov_rad, self.step_rad) {
            (Some(fov_rad), Some(step_rad)) => (fov_rad / step_rad.abs() + 0.5 - beams as f64).abs() <= 1.0,
            _ => true,
        }
    }
}

/// Steps between beams that cover a field of view: in a full turn the last beam of an even number is one step before the first.
fn steps_of(beams: usize, fov_rad: f64) -> f64 {
    let full = fov_rad.abs() >= TAU - ROUNDING_RAD && beams.is_multiple_of(2);
    (if full { beams } else { beams.saturating_sub(1).max(1) }) as f64
}

/// First bearing of beams around the axis. Where a whole beam is missing of a usual field of view, it is the last.
fn centred(beams: usize, step_rad: f64) -> f64 {
    let covers = |steps: usize| (steps as f64 * step_rad.abs()).to_degrees();
    let usual =
        |degrees: f64| [90.0, 180.0, 240.0, 270.0, 360.0].iter().any(|usual: &f64| (usual - degrees).abs() < 0.05);
    let steps = if usual(covers(beams)) { beams } else { beams.saturating_sub(1) };
    -0.5 * step_rad * steps as f64
}

/// The fan of a scanner of so many beams, by what usual scanners have.
pub(crate) fn guessed(beams: usize) -> (Fan, FanSource) {
    let degrees = |first: f64, step: f64| Fan { first_rad: first.to_radians(), step_rad: step.to_radians() };
    let fan = match beams {
        0 | 1 => degrees(0.0, 1.0),
        180 | 181 => degrees(-90.0, 1.0),
        360 | 361 => degrees(-90.0, 0.5),
        401 => degrees(-50.0, 0.25),
        540 | 541 => degrees(-135.0, 0.5),
        682 | 683 => Fan { first_rad: -0.5 * (beams - 1) as f64 * TAU / 1024.0, step_rad: TAU / 1024.0 },
        1080 | 1081 => degrees(-135.0, 0.25),
        _ => return (Fan { first_rad: -0.5 * PI, step_rad: PI / (beams - 1) as f64 }, FanSource::Number),
    };
    (fan, FanSource::UsualNumber)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(fan: Fan, beams: usize) -> [f64; 2] {
        [fan.first_rad, fan.first_rad + (beams - 1) as f64 * fan.step_rad].map(f64::to_degrees)
    }

    #[test]
    fn beams_are_where_usual_scanners_have_them() {
        for (beams, first, last, source) in [
            (180, -90.0, 89.0, FanSource::UsualNumber),
            (181, -90.0, 90.0, FanSource::UsualNumber),
            (360, -90.0, 89.5, FanSource::UsualNumber),
            (361, -90.0, 90.0, FanSource::UsualNumber),
            (401, -50.0, 50.0, FanSource::UsualNumber),
            (541, -135.0, 135.0, FanSource::UsualNumber),
            (682, -119.70703125, 119.70703125, FanSource::UsualNumber),
            (1081, -135.0, 135.0, FanSource::UsualNumber),
            (91, -90.0, 90.0, FanSource::Number),
            (1, 0.0, 0.0, FanSource::UsualNumber),
        ] {
            let (fan, found) = guessed(beams);
            let ends = ends(fan, beams);
            assert!((ends[0] - first).abs() < 1e-9 && (ends[1] - last).abs() < 1e-9, "{beams}: {ends:?}");
            assert_eq!(found, source, "{beams}");
        }
    }

    #[test]
    fn what_is_given_decides() {
        let some = |value: f64| (value.abs() > 0.0).then(|| value.to_radians());
        for (fov, first, step, beams, expected) in [
            (360.0, 0.0, 1.0, 360, [-180.0, 179.0]),
            (360.0, 0.0, 1.0, 361, [-180.0, 180.0]),
            (360.0, 0.0, 0.0, 360, [-180.0, 179.0]),
            (360.0, 0.0, 0.0, 361, [-180.0, 180.0]),
            (0.0, 0.0, 1.0, 360, [-180.0, 179.0]),
            (0.0, 0.0, 1.0, 361, [-180.0, 180.0]),
            (0.0, 0.0, 0.5, 360, [-90.0, 89.5]),
            (0.0, 0.0, 1.0, 101, [-50.0, 50.0]),
            (180.0, 0.0, 1.0, 180, [-90.0, 89.0]),
            (240.0, 0.0, 0.0, 682, [-120.0, 120.0]),
            (0.0, -120.0, 0.0, 682, [-120.0, 120.0]),
            (0.0, -180.0, 0.0, 360, [-180.0, 179.0]),
            (0.0, 90.0, -1.0, 181, [90.0, -90.0]),
            (180.0, 0.0, -1.0, 181, [90.0, -90.0]),
            (0.0, 10.0, 1.0, 11, [10.0, 20.0]),
        ] {
            let options = FanOptions { fov_rad: some(fov), first_rad: some(first), step_rad: some(step) };
            let ends = ends(options.fan(beams).expect("known"), beams);
            assert!((0..2).all(|k| (ends[k] - expected[k]).abs() < 1e-9), "{options:?} {beams}: {ends:?}");
            assert!(options.check().is_ok());
        }
        assert_eq!(FanOptions::default().fan(360), None);
    }

    #[test]
    fn field_of_view_and_step_must_fit_the_number() {
        let options = |fov: f64, step: f64| FanOptions {
            fov_rad: Some(fov.to_radians()),
            step_rad: Some(step.to_radians()),
            first_rad: None,
        };
        for (fov, step, beams, fits) in [
            (180.0, 1.0, 181, true),
            (180.0, 1.0, 180, true),
            (360.0, 1.0, 360, true),
            (180.0, 1.0, 361, false),
            (180.0, 0.5, 181, false),
        ] {
            assert_eq!(options(fov, step).fits(beams), fits, "{fov} {step} {beams}");
        }
    }
}
