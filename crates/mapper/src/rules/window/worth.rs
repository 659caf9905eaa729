//! What a ray is worth by its first occupied cell, several rays at a time.

use grid::{DigitalLine, GridSpec};
use sensor::lanes::{Beams, LANES, Lanes, each};
use sensor::{Ray, Scan, SensorModel};

use crate::fast::tail::Tail;
use crate::ray::past_the_map::PastTheMap;
use crate::rules::window::rays::Moment;

/// A likelihood below this share of the ray's largest counts as this: it keeps logarithms finite.
const LEAST: f32 = 1e-12;

/// Chance that a ray that has passed its first occupied cell passes the next one too.
const GOES_ON: f32 = 0.7;

/// Likelihoods that differ by less than this share have one logarithm.
const ALIKE: f32 = 1e-5;

/// What a reading says, beyond the likelihood of its sensor, and where rays go.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reading {
    /// Weight of its log likelihood, above 0.
    pub(super) weight: f64,
    /// Share of rays that pass the first occupied cell, of which they see a part, 0 up to but not including 1.
    pub(super) leak: f64,
    /// `u0 = P(E_{j+1} | not E_j)` of an unseen world.
    pub(super) onset: f64,
}

/// Reads scans. Buffers to fill again and again.
#[derive(Debug, Clone, Default)]
pub(super) struct Reader {
    lines: Lanes<DigitalLine>,
    ranges: Vec<Lanes<f64>>,
    likelihood: Vec<Lanes<f32>>,
    tail: Tail,
    log: Vec<f32>,
}

impl Reader {
    /// Adds the rays of a scan that have a reading and start on the map, by rising bearing, so that their order in the scan does not matter.
    pub(super) fn read(
        &mut self,
        scan: &Scan,
        spec: &GridSpec,
        sensor: &dyn SensorModel,
        reading: &Reading,
        to: &mut Moment,
    ) {
        let mut rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
        let key = |ray: &Ray| (ray.bearing_rad, ray.reading.unwrap_or_default());
        rays.sort_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
        for rays in rays.chunks(LANES) {
            let beams = self.likelihoods(rays, spec, sensor);
            let past = std::array::from_fn(|l| {
                let ray = &rays[l.min(rays.len() - 1)];
                PastTheMap::after(&self.lines[l], ray.direction, spec.cell_m, reading.onset)
            });
            let wanted = each(|l| l < rays.len() && !self.lines[l].is_empty());
            let none = self.tail.likelihood(sensor, &beams, &wanted, &past); // k to infinity, Eq. (7)
            for l in (0..LANES).filter(|l| wanted[*l]) {
                let none = self.worth(l, none[l], reading);
                to.push(self.lines[l].cells(), &self.log, none);
            }
        }
    }

    /// `P(o | F_k)` of all chords of up to [`LANES`] rays, Eq. (21). Chords past the end of a ray have no length.
    fn likelihoods(&mut self, rays: &[Ray], spec: &GridSpec, sensor: &dyn SensorModel) -> Beams {
        let Self { lines, ranges, likelihood, .. } = self;
        let mut beams = Beams::default();
        for (l, line) in lines.iter_mut().enumerate() {
            let ray = &rays[l.min(rays.len() - 1)];
            beams.reading[l] = ray.reading.unwrap_or_default();
            beams.bearing_rad[l] = ray.bearing_rad;
            line.trace(spec, ray.origin_m, ray.direction, f64::INFINITY);
        }
        let longest = lines.iter().map(DigitalLine::len).max().unwrap_or_default();
        ranges.clear();
        ranges.resize(longest + 1, [0.0; LANES]);
        for (l, line) in lines.iter().enumerate() {
            let (mut range_m, given) = (0.0, line.ranges());
            for (k, ranges) in ranges.iter_mut().enumerate() {
                range_m = given.get(k).copied().unwrap_or(range_m);
                ranges[l] = range_m;
            }
        }
        likelihood.clear();
        likelihood.resize(longest, [0.0; LANES]);
        if longest > 0 {
            sensor.likelihood_lanes(&beams, ranges, likelihood);
        }
        beams
    }

    /// Writes what a ray is worth by its first occupied cell, nats, and returns what it is worth if there is none.
    ///
    /// A cell is occupied where a wall covers it in part, and rays pass it then, most of all those that graze the wall: with the chance
    /// [`Reading::leak`] the ray ends in one of the cells behind, in the next with the chance 0.3, in the one after that with 0.7 times 0.3,
    /// and so on, whatever stands there. A reading that no map explains says nothing.
    fn worth(&mut self, lane: usize, none: f32, reading: &Reading) -> f32 {
        let Self { lines, likelihood, log, .. } = self;
        let likelihood = &likelihood[..lines[lane].len()];
        let most = likelihood.iter().fold(none, |most, likelihood| most.max(likelihood[lane]));
        let (weight, leak) = (reading.weight as f32, reading.leak as f32);
        let of = |l: f32| if most > 0.0 { weight * libm::logf((l / most).max(LEAST)) } else { 0.0 };
        log.clear();
        let (mut behind, mut last) = (none, None);
        for likelihood in likelihood.iter().rev() {
            let value = (1.0 - leak) * likelihood[lane] + leak * behind;
            let alike = |(of, _): &(f32, f32)| (value - of).abs() <= ALIKE * value;
            let (of_value, worth) = last.filter(alike).unwrap_or_else(|| (value, of(value)));
            last = Some((of_value, worth));
            log.push(worth);
            behind = GOES_ON * behind + (1.0 - GOES_ON) * likelihood[lane];
        }
        log.reverse();
        of(none)
    }
}
