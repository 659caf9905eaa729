//! Reads scans: where rays go, and what they are worth by their first occupied cell, several rays at a time.

use grid::{DigitalLine, GridSpec};
use sensor::lanes::{Beams, LANES, Lanes, each};
use sensor::{Ray, Scan, SensorModel};

use crate::fast::tail::Tail;
use crate::ray::past_the_map::PastTheMap;
use crate::ray::worth::{Explained, Reading, Worth};
use crate::rules::window::rays::Moment;

/// Likelihoods that differ by less than this share have one logarithm.
const ALIKE: f64 = 1e-5;

/// Reads scans. Buffers to fill again and again.
#[derive(Debug, Clone, Default)]
pub(super) struct Reader {
    lines: Lanes<DigitalLine>,
    ranges: Vec<Lanes<f64>>,
    likelihood: Vec<Lanes<f32>>,
    tail: Tail,
    of_lane: Vec<f64>,
    worth: Worth,
    log: Vec<f64>,
}

impl Reader {
    /// Adds the rays of a scan that have a reading and start on the map, by rising bearing, so that their order in the scan does not matter.
    pub(super) fn read(
        &mut self,
        scan: &Scan,
        spec: &GridSpec,
        sensor: &dyn SensorModel,
        (reading, onset): (&Reading, f64),
        to: &mut Moment,
    ) {
        let mut rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
        let key = |ray: &Ray| (ray.bearing_rad, ray.reading.unwrap_or_default());
        rays.sort_by(|a, b| key(a).0.total_cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
        for rays in rays.chunks(LANES) {
            let beams = self.likelihoods(rays, spec, sensor);
            let past = std::array::from_fn(|l| {
                let ray = &rays[l.min(rays.len() - 1)];
                PastTheMap::after(&self.lines[l], ray.direction, spec.cell_m, onset)
            });
            let wanted = each(|l| l < rays.len() && !self.lines[l].is_empty());
            let none = self.tail.likelihood(sensor, &beams, &wanted, &past); // k to infinity, Eq. (7)
            for l in (0..LANES).filter(|l| wanted[*l]) {
                let Self { lines, likelihood, of_lane, worth, log, .. } = self;
                let line = &lines[l];
                of_lane.clear();
                of_lane.extend(likelihood[..line.len()].iter().map(|likelihood| f64::from(likelihood[l])));
                let (direction, none) = (rays[l].direction, f64::from(none[l]));
                let none =
                    worth.of(reading, spec, &Explained { line, direction, likelihood: of_lane, none }, ALIKE, log);
                to.push(line.cells(), log.iter().map(|log| *log as f32), none as f32);
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
            // From there on cells are worth what none is worth. The last chord, which ends early, lies behind it as a whole.
            let constant_m = sensor.constant_from(beams.reading[l], ray.bearing_rad);
            line.trace(spec, ray.origin_m, ray.direction, constant_m + 2.0 * spec.cell_m);
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
}
