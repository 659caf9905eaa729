//! The likelihood of one reading of a laser for a surface at every range: two levels, with a bump between.

use super::Laser;
use crate::in_lanes;
use crate::lanes::{Beams, Lanes, each};
use crate::normal::{self, LaneTable};

/// Density of surfaces, as a share of that of all else, that counts as nothing.
const NEGLIGIBLE: f64 = 1e-11;

/// What tables of the normal distribution leave out, as a share of the density ...
const LEFT_OUT: f64 = 1e-12;

/// ... may be this share of the level in front, ...
const HIDDEN: f64 = 5e-7;

/// ... of chords as wide as this, in standard deviations.
const LEAST_WIDTH: f64 = 0.5;

/// The likelihood of a reading as a function of the range of the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Curve {
    /// Range at which the levels meet, m.
    centre_m: f64,
    /// 1 / sigma, 1/m.
    sharpness: f64,
    /// Level in front ...
    floor: f64,
    /// ... and what is added to it behind.
    step: f64,
    /// Factor on the standard normal density about the centre.
    bump: f64,
    /// Standard deviations from the centre beyond which the levels are reached.
    reach: f64,
    /// Whether the level in front hides what tables leave out.
    tables_do: bool,
    /// Range up to which a surface that appears behind the sensor can give the reading, m; 0 where none can.
    mirror_m: f64,
    /// Ranges between which the likelihood leaves the one level and reaches the other, m.
    from_m: f64,
    until_m: f64,
    /// Whether there was no echo.
    endless: bool,
}

impl Curve {
    pub(super) fn new(laser: &Laser, reading: f64) -> Self {
        let centre_m = if reading.is_infinite() { laser.max_range_m } else { reading };
        let sharpness = 1.0 / laser.range_sigma_m;
        let alone = laser.hit * laser.passes(centre_m);
        let [floor, step, bump] = if reading.is_infinite() {
            [laser.no_echo, alone, 0.0]
        } else {
            [laser.outlier() / laser.max_range_m, alone * laser.early_per_m, alone * sharpness]
        };
        let reach = reach(bump.max(step), floor);
        let reach_m = reach * laser.range_sigma_m;
        let [mirror_m, from_m, until_m] =
            [reach_m - centre_m, centre_m - reach_m, centre_m + reach_m].map(|m| m.max(0.0));
        let tables_do = (bump + step) * LEFT_OUT <= HIDDEN * LEAST_WIDTH * floor;
        Self {
            centre_m,
            sharpness,
            floor,
            step,
            bump,
            reach,
            tables_do,
            mirror_m,
            from_m,
            until_m,
            endless: reading.is_infinite(),
        }
    }

    /// Ranges between which all is on the level in front, m.
    pub(super) fn front_m(&self) -> [f64; 2] {
        [self.mirror_m, self.from_m]
    }

    /// Range from which on all is on the level behind, m.
    pub(super) fn behind_m(&self) -> f64 {
        self.until_m * (1.0 + 1e-9)
    }

    /// [`crate::FastKernel::spread_from`]: none behind an echo, and behind the largest range for no echo, whose probability is at
    /// most one before.
    pub(super) fn spread_from(&self, range: f64) -> f64 {
        match range < self.behind_m() {
            true if self.endless => 1.0,
            true => f64::INFINITY,
            false => 0.0,
        }
    }

    /// Mean over the chord `enter ..= exit` (m).
    pub(super) fn mean(&self, enter: f64, exit: f64) -> f64 {
        let mirrored = if enter <= self.mirror_m { self.above_floor(-exit, -enter) } else { 0.0 };
        self.floor + self.above_floor(enter, exit) + mirrored
    }

    fn above_floor(&self, enter: f64, exit: f64) -> f64 {
        let [near, far] = [enter, exit].map(|range| (range - self.centre_m) * self.sharpness);
        if near > self.reach {
            self.step
        } else if far >= -self.reach {
            let width = far - near;
            if self.tables_do && (LEAST_WIDTH..f64::INFINITY).contains(&width) {
                let density = normal::cumulative(far) - normal::cumulative(near);
                let beyond = normal::cumulative_integral(far) - normal::cumulative_integral(near);
                return (self.bump * density.max(0.0) + self.step * beyond.max(0.0)) / width;
            }
            let density = normal::mean_density(near, far, self.reach);
            self.bump * density + self.step * normal::mean_cumulative(near, far, self.reach)
        } else {
            0.0
        }
    }
}

/// Standard deviations beyond which so much beside such a floor counts for nothing: where there is no other
/// explanation, farther tails matter.
fn reach(most: f64, floor: f64) -> f64 {
    let reach = libm::sqrt(2.0 * libm::log(most / (NEGLIGIBLE * floor)).max(0.0));
    reach.clamp(normal::REACH, normal::FARTHEST)
}

/// The curves of several readings, a lane to each.
pub(super) struct Curves {
    pub(super) curves: Lanes<Curve>,
    centre_m: Lanes<f64>,
    sharpness: Lanes<f64>,
    floor: Lanes<f64>,
    step: Lanes<f64>,
    bump: Lanes<f64>,
    reach: Lanes<f64>,
    /// Chords narrower than this, in standard deviations, are not taken from tables; infinite where none is.
    narrow: Lanes<f64>,
    mirror_m: Lanes<f64>,
    from_m: Lanes<f64>,
    until_m: Lanes<f64>,
}

impl Curves {
    pub(super) fn new(laser: &Laser, beams: &Beams) -> Self {
        let curves: Lanes<Curve> = std::array::from_fn(|l| Curve::new(laser, beams.reading[l]));
        Self {
            centre_m: each(|l| curves[l].centre_m),
            sharpness: each(|l| curves[l].sharpness),
            floor: each(|l| curves[l].floor),
            step: each(|l| curves[l].step),
            bump: each(|l| curves[l].bump),
            reach: each(|l| curves[l].reach),
            narrow: each(|l| if curves[l].tables_do { LEAST_WIDTH } else { f64::INFINITY }),
            mirror_m: each(|l| curves[l].mirror_m),
            from_m: each(|l| curves[l].from_m),
            until_m: each(|l| curves[l].until_m),
            curves,
        }
    }
}

/// A grid line that rays cross: its standard deviations from the readings, and what tables hold of them.
#[derive(Clone, Copy)]
struct Line {
    z: Lanes<f64>,
    cumulative: Lanes<f64>,
    integral: Lanes<f64>,
}

impl Line {
    #[inline(always)]
    fn at(curves: &Curves, (cumulatives, integrals): (LaneTable, LaneTable), range: &Lanes<f64>) -> Self {
        let z = each(|l| (range[l] - curves.centre_m[l]) * curves.sharpness[l]);
        Self { z, cumulative: cumulatives.at(&z), integral: integrals.at(&z) }
    }
}

in_lanes! {
    /// [`Curve::mean`] of one curve per lane, in lanes.
    pub(super) fn fill<'a>(curves: &'a Curves, ranges: &'a [Lanes<f64>], likelihood: &'a mut [Lanes<f32>]) {
        fill_levels(curves, ranges, likelihood);
    }
}

/// All but a few chords of a ray lie on a level. Those next to the reading are taken from tables, and what these do not do is as in
/// double precision, one by one.
#[inline(always)]
fn fill_levels(curves: &Curves, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
    let Curves { floor, step, bump, reach, narrow, mirror_m, from_m, until_m, .. } = curves;
    let tables = (LaneTable::cumulative(), LaneTable::cumulative_integral());
    let behind = each(|l| floor[l] + step[l]);
    let mut before: Option<Line> = None;
    for (out, chord) in likelihood.iter_mut().zip(ranges.windows(2)) {
        let (enter, exit) = (chord[0], chord[1]);
        let level = each(|l| if enter[l] > until_m[l] { behind[l] } else { floor[l] });
        let between = each(|l| if enter[l] <= until_m[l] { 1.0 } else { 0.0 });
        let between = each(|l| if exit[l] >= from_m[l] { between[l] } else { 0.0 });
        let between = each(|l| if enter[l] <= mirror_m[l] { 1.0 } else { between[l] });
        if between.iter().sum::<f64>() <= 0.0 {
            *out = each(|l| level[l] as f32);
            before = None;
            continue;
        }
        let near = before.unwrap_or_else(|| Line::at(curves, tables, &enter));
        let far = Line::at(curves, tables, &exit);
        before = Some(far);
        let width = each(|l| far.z[l] - near.z[l]);
        let density = each(|l| far.cumulative[l] - near.cumulative[l]);
        let density = each(|l| if density[l] > 0.0 { density[l] } else { 0.0 });
        let beyond = each(|l| far.integral[l] - near.integral[l]);
        let beyond = each(|l| if beyond[l] > 0.0 { beyond[l] } else { 0.0 });
        let above = each(|l| (bump[l] * density[l] + step[l] * beyond[l]) / width[l]);
        let above = each(|l| if far.z[l] >= -reach[l] { above[l] } else { 0.0 });
        let above = each(|l| if near.z[l] > reach[l] { step[l] } else { above[l] });
        let mean = each(|l| floor[l] + above[l]);
        *out = each(|l| if between[l] > 0.0 { mean[l] } else { level[l] } as f32);
        let left = each(|l| if width[l] >= narrow[l] { 0.0 } else { between[l] });
        let left = each(|l| if width[l] < f64::INFINITY { left[l] } else { between[l] });
        let left = each(|l| if enter[l] <= mirror_m[l] { 1.0 } else { left[l] });
        if left.iter().sum::<f64>() > 0.0 {
            one_by_one(&curves.curves, &left, &enter, &exit, out);
        }
    }
}

/// The lanes that are marked.
#[inline(never)]
fn one_by_one(curves: &Lanes<Curve>, marked: &Lanes<f64>, enter: &Lanes<f64>, exit: &Lanes<f64>, out: &mut Lanes<f32>) {
    for (l, curve) in curves.iter().enumerate() {
        if marked[l] > 0.0 {
            out[l] = curve.mean(enter[l], exit[l]) as f32;
        }
    }
}
