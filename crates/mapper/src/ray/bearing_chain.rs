//! Where the rays of a scan end, as a chain over their bearings: the forward-backward algorithm, Rabiner 1989.
//!
//! The hidden state of a ray is the range at which it ends. From a ray to its neighbour, the surface goes on with
//! probability `s(w)`, which falls with the distance `w` between the rays at that range, and then lies nearer or farther by
//! about half of `w`; otherwise the neighbour ends anywhere, as in an unseen world. `A` and `B` are the messages of the rays on
//! either side: the likelihood of all their readings, given where the ray ends.
//!
//! The likelihood of a reading `P(o | F_k)` becomes `P(o | F_k)^2 A B`. This is a heuristic: the algorithm itself gives
//! `P(o | F_k) A B`. The geometric mean of the two sides times the ray's own is taken, and all that squared, since the least squares between
//! rays take about half of it back. It was chosen with the numbers of [`Lateral`](crate::Lateral) on the tuning scenes, on which no
//! result is reported, for the least log loss with no more phantoms than `visibility` has.

use grid::GridSpec;
use sensor::lanes::{Beams, LANES, Lanes, each};
use sensor::{Ray, SensorModel, in_lanes};

use crate::belief::prior::Prior;

/// Ranges are told apart by this much near the sensor, m ...
const STEP_M: f64 = 0.05;

/// ... and by twice as much after so many steps, by four times as much after twice as many more, and so on.
const STEPS: usize = 128;

/// Bits of a single's mantissa below those that count steps.
const BELOW: u32 = 16;

/// A surface lies nearer or farther by this share of the distance to the next ray, as one that stands 27 degrees from
/// square to the rays; distances are exponential about that.
const SLOPE: f64 = 0.5;

/// What the other rays of a scan make of the end of each: a factor on the likelihood of every range.
pub(crate) struct BearingChain {
    /// Place of every ray in the order of their bearings, in which all that follows is.
    rank: Vec<usize>,
    nodes: Nodes,
    /// `A B` of every ray at every node.
    factors: Vec<f32>,
    /// The likelihood of all readings, `P(o | F)^2 A B`, of every ray at every node.
    joint: Vec<f32>,
    /// By how much that differs between any two nodes from each on.
    spread: Vec<f32>,
}

/// What is assumed of surfaces.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surfaces {
    /// Rays at least this far apart, m, learn nothing from each other.
    reach_m: f64,
    /// Where a surface is within a cell is not known, m.
    blur_m: f64,
    /// Obstacles that begin per metre of free space in an unseen world.
    rate: f64,
}

impl Surfaces {
    /// Rays know of each other as far as obstacles are correlated: over the correlation length of the prior.
    /// `onset` is that of the chain along a ray.
    pub(crate) fn new(prior: &Prior, onset: f64, cell_m: f64) -> Self {
        let reach_m = -cell_m / libm::log(prior.neighbour_correlation(cell_m));
        Self { reach_m: reach_m.max(0.0), blur_m: 0.5 * cell_m, rate: -libm::log1p(-onset.min(0.999)) / cell_m }
    }
}

/// Range of a node, m.
fn node_m(node: usize) -> f64 {
    let steps = ((STEPS + node % STEPS) << (node / STEPS)) - STEPS;
    STEP_M * steps as f64
}

/// The node before a range (m), and how much of the way to the next one it is: read off the bits of a single.
#[inline(always)]
fn node_before(range_m: f64) -> (u32, f32) {
    let bits = ((range_m * (1.0 / STEP_M)) as f32 + STEPS as f32).to_bits() - (STEPS as f32).to_bits();
    (bits >> BELOW, (bits & ((1 << BELOW) - 1)) as f32 * (1.0 / (1 << BELOW) as f32))
}

/// The nodes of a scan and what is the same for all its rays.
struct Nodes {
    range_m: Vec<f64>,
    /// Borders of what a node stands for, m.
    borders_m: Vec<f64>,
    range: Vec<f32>,
    width: Vec<f32>,
    per_width: Vec<f32>,
    /// Probability that a ray ends there in an unseen world; of the last, there or farther.
    unseen: Vec<f32>,
}

impl Nodes {
    fn new(farthest_m: f64, rate: f64) -> Self {
        let count = node_before(farthest_m).0 as usize + 2;
        let range_m: Vec<f64> = (0..count).map(node_m).collect();
        // The last stands for all that lies beyond: as far as a ray gets there on average.
        let far_m = node_m(count - 1) + (1.0 / rate).min(farthest_m + 1.0);
        let between = (0..count).map(|k| if k + 1 < count { 0.5 * (node_m(k) + node_m(k + 1)) } else { far_m });
        let borders_m: Vec<f64> = std::iter::once(0.0).chain(between).collect();
        let passed: Vec<f64> = borders_m.iter().map(|border_m| libm::exp(-rate * border_m)).collect();
        let ends = |k: usize| passed[k] - if k + 1 < count { passed[k + 1] } else { 0.0 };
        Self {
            range: range_m.iter().map(|range_m| *range_m as f32).collect(),
            width: borders_m.windows(2).map(|pair| (pair[1] - pair[0]) as f32).collect(),
            per_width: borders_m.windows(2).map(|pair| (1.0 / (pair[1] - pair[0])) as f32).collect(),
            unseen: (0..count).map(|k| ends(k) as f32).collect(),
            range_m,
            borders_m,
        }
    }
}

impl BearingChain {
    /// For rays with readings from one place, in any order.
    pub(crate) fn new(sensor: &dyn SensorModel, rays: &[Ray], spec: &GridSpec, surfaces: &Surfaces) -> Self {
        let nodes = Nodes::new(farthest_m(spec, rays), surfaces.rate);
        let count = nodes.range_m.len();
        let mut order: Vec<usize> = (0..rays.len()).collect();
        order.sort_by(|a, b| rays[*a].bearing_rad.total_cmp(&rays[*b].bearing_rad));
        let mut rank = vec![0; rays.len()];
        order.iter().enumerate().for_each(|(place, ray)| rank[*ray] = place);
        let rays: Vec<Ray> = order.iter().map(|ray| rays[*ray]).collect();
        let likelihood = likelihoods(sensor, &rays, &nodes);
        let mut factors = vec![1.0; rays.len() * count];
        if rays.len() > 1 && surfaces.reach_m > 0.0 {
            let walk = Walk { nodes: &nodes, surfaces, rays: &rays, likelihood: &likelihood };
            both_sides(&walk, &mut factors);
        }
        let mut joint = likelihood;
        let mut spread = vec![0.0; joint.len()];
        of_all(count, &mut factors, &mut joint, &mut spread);
        Self { rank, nodes, factors, joint, spread }
    }

    /// The factor of a ray at a range (m).
    pub(crate) fn factor(&self, ray: usize, range_m: f64) -> f32 {
        self.at(self.rank[ray], node_before(range_m))
    }

    #[inline(always)]
    fn at(&self, place: usize, (node, part): (u32, f32)) -> f32 {
        let count = self.nodes.range_m.len();
        let last = count - 2;
        let (node, part) = if node as usize > last { (last, 1.0) } else { (node as usize, part) };
        let row = &self.factors[place * count..][..count];
        row[node] * (1.0 - part) + row[node + 1] * part
    }

    /// The likelihood of all readings if a ray ends beyond a range (m), somewhere in an unseen world: the sum to infinity
    /// in Eq. (7), over nodes.
    pub(crate) fn past_the_map(&self, ray: usize, from_m: f64) -> f32 {
        let Nodes { borders_m, width, unseen, .. } = &self.nodes;
        let count = unseen.len();
        let joint = &self.joint[self.rank[ray] * count..][..count];
        let (node, part) = node_before(from_m);
        let first = (node as usize + usize::from(part > 0.5)).min(count - 1);
        let share = (((borders_m[first + 1] - from_m) as f32) / width[first]).clamp(0.0, 1.0);
        let (mut sum, mut mass) = (share * unseen[first] * joint[first], share * unseen[first]);
        for node in first + 1..count {
            sum += unseen[node] * joint[node];
            mass += unseen[node];
        }
        if mass > f32::MIN_POSITIVE { sum / mass } else { joint[count - 1] }
    }

    /// By how much the likelihoods of all readings differ between cells from a range (m) on.
    pub(crate) fn spread_from(&self, ray: usize, from_m: f64) -> f64 {
        let count = self.nodes.range_m.len();
        let node = (node_before(from_m).0 as usize).min(count - 1);
        // Cells are not nodes.
        1.5 * f64::from(self.spread[self.rank[ray] * count + node])
    }

    /// Turns the likelihoods of a ray's own reading, for chords between the given ranges (m), into those of all.
    pub(crate) fn join(&self, ray: usize, ranges: &[f64], likelihood: &mut [f64]) {
        for (likelihood, chord) in likelihood.iter_mut().zip(ranges.windows(2)) {
            let factor = self.factor(ray, 0.5 * (chord[0] + chord[1]));
            *likelihood = *likelihood * *likelihood * f64::from(factor);
        }
    }

    /// The same for the rays from `first` on, one to a lane.
    pub(crate) fn join_lanes(&self, first: usize, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        join(self, first, ranges, likelihood);
    }

    #[inline(always)]
    fn join_each(&self, first: usize, ranges: &[Lanes<f64>], likelihood: &mut [Lanes<f32>]) {
        let places = each(|l| self.rank[(first + l).min(self.rank.len() - 1)]);
        for (likelihood, chord) in likelihood.iter_mut().zip(ranges.windows(2)) {
            let nodes = each(|l| node_before(0.5 * (chord[0][l] + chord[1][l])));
            let factor = each(|l| self.at(places[l], nodes[l]));
            *likelihood = each(|l| likelihood[l] * likelihood[l] * factor[l]);
        }
    }
}

in_lanes! {
    fn join<'a>(chain: &'a BearingChain, first: usize, ranges: &'a [Lanes<f64>], likelihood: &'a mut [Lanes<f32>]) {
        chain.join_each(first, ranges, likelihood);
    }
}

/// No cell of the grid is farther from where the rays start, m.
fn farthest_m(spec: &GridSpec, rays: &[Ray]) -> f64 {
    let size_m = [spec.width, spec.height].map(|cells| cells as f64 * spec.cell_m);
    let origin_m = rays.first().map_or(spec.origin_m, |ray| ray.origin_m);
    let side = |k: usize| {
        let from_m = origin_m[k] - spec.origin_m[k];
        from_m.abs().max((size_m[k] - from_m).abs())
    };
    libm::hypot(side(0), side(1))
}

/// The likelihood of every reading at every node, one ray after the other.
fn likelihoods(sensor: &dyn SensorModel, rays: &[Ray], nodes: &Nodes) -> Vec<f32> {
    let count = nodes.range_m.len();
    let borders: Vec<Lanes<f64>> = nodes.borders_m.iter().map(|border_m| [*border_m; LANES]).collect();
    let mut lanes = vec![[0.0; LANES]; count];
    let mut likelihood = vec![0.0; rays.len() * count];
    for (rays, rows) in rays.chunks(LANES).zip(likelihood.chunks_mut(LANES * count)) {
        let mut beams = Beams::default();
        for (lane, ray) in rays.iter().enumerate() {
            beams.reading[lane] = ray.reading.unwrap_or_default();
            beams.bearing_rad[lane] = ray.bearing_rad;
        }
        sensor.likelihood_lanes(&beams, &borders, &mut lanes);
        for (lane, row) in rows.chunks_mut(count).enumerate() {
            row.iter_mut().zip(&lanes).for_each(|(likelihood, lanes)| *likelihood = lanes[lane]);
        }
    }
    likelihood
}

in_lanes! {
    /// From the likelihood of every ray's own reading, in `joint`, that of all readings, to scale with the factors, and how much it spreads.
    fn of_all<'a>(count: usize, factors: &'a mut [f32], joint: &'a mut [f32], spread: &'a mut [f32]) {
        of_each(count, factors, joint, spread);
    }
}

#[inline(always)]
fn of_each(count: usize, factors: &mut [f32], joint: &mut [f32], spread: &mut [f32]) {
    let rows = factors.chunks_exact_mut(count).zip(joint.chunks_exact_mut(count)).zip(spread.chunks_exact_mut(count));
    for ((factors, joint), spread) in rows {
        joint.iter_mut().zip(&*factors).for_each(|(own, factor)| *own = *own * (*own * factor));
        // Evidence is then at most about one, whatever the others measured.
        let peak = most(joint);
        let scale = if peak > f32::MIN_POSITIVE { 1.0 / peak } else { 1.0 };
        factors.iter_mut().for_each(|factor| *factor *= scale);
        joint.iter_mut().for_each(|joint| *joint *= scale);
        let (mut least, mut most) = (f32::INFINITY, 0.0f32);
        for (spread, joint) in spread.iter_mut().zip(&*joint).rev() {
            least = if *joint < least { *joint } else { least };
            most = if *joint > most { *joint } else { most };
            *spread = most - least;
        }
    }
}

/// The largest of some values, 0 at least.
#[inline(always)]
fn most(values: &[f32]) -> f32 {
    let (values, rest) = values.as_chunks::<LANES>();
    let larger = |most: f32, value: f32| if value > most { value } else { most };
    let lanes = values.iter().fold([0.0; LANES], |most: Lanes<f32>, value| each(|l| larger(most[l], value[l])));
    lanes.into_iter().chain(rest.iter().copied()).fold(0.0, larger)
}

/// Rays in the order of their bearings.
struct Walk<'a> {
    nodes: &'a Nodes,
    surfaces: &'a Surfaces,
    rays: &'a [Ray],
    likelihood: &'a [f32],
}

in_lanes! {
    /// Multiplies the messages of both sides into the factors.
    fn both_sides<'a>(walk: &'a Walk<'a>, factors: &'a mut [f32]) {
        walk_both(walk, factors);
    }
}

/// Both directions at once, which do not need each other.
#[inline(always)]
fn walk_both(walk: &Walk, factors: &mut [f32]) {
    let count = walk.nodes.range_m.len();
    let mut sides = [Side::new(count), Side::new(count)];
    for k in 1..walk.rays.len() {
        let back = walk.rays.len() - 1 - k;
        let steps = [[k - 1, k], [back + 1, back]];
        for (side, step) in sides.iter_mut().zip(steps) {
            side.begin(walk, step);
        }
        sums(&mut sides, &walk.nodes.width);
        for (side, [from, to]) in sides.iter_mut().zip(steps) {
            side.end(walk, [from, to]);
            let row = &mut factors[to * count..][..count];
            row.iter_mut().zip(&side.message).for_each(|(factor, message)| *factor *= message);
        }
    }
}

/// The message of the rays on one side to the next one. A buffer: all are values at nodes.
struct Side {
    message: Vec<f32>,
    /// What is known of where the ray before it ends: the message and its own reading.
    known: Vec<f32>,
    /// How much a node counts at the next.
    decay: Vec<f32>,
    nearer: Summed,
    farther: Summed,
}

/// Sums over nodes up to each, or over those beyond it.
struct Summed {
    /// Of what is known.
    known: Vec<f32>,
    /// Of what it weighs.
    weight: Vec<f32>,
}

impl Summed {
    fn new(count: usize) -> Self {
        Self { known: vec![0.0; count], weight: vec![0.0; count] }
    }
}

impl Side {
    fn new(count: usize) -> Self {
        let (nearer, farther) = (Summed::new(count), Summed::new(count));
        Self { message: vec![1.0; count], known: vec![0.0; count], decay: vec![0.0; count], nearer, farther }
    }

    /// Everything that needs no sum.
    #[inline(always)]
    fn begin(&mut self, walk: &Walk, [from, to]: [usize; 2]) {
        let count = self.message.len();
        let slope = (SLOPE * apart(walk.rays, [from, to])) as f32;
        let blur_m = walk.surfaces.blur_m as f32;
        let own = &walk.likelihood[from * count..][..count];
        let known = self.known.iter_mut().zip(&self.message).zip(own);
        known.for_each(|((known, message), own)| *known = message * own);
        for ((decay, range), per_width) in self.decay.iter_mut().zip(&walk.nodes.range).zip(&walk.nodes.per_width) {
            let widths = (range * slope + blur_m) * per_width;
            *decay = widths / (1.0 + widths);
        }
    }

    /// The new message, from the sums.
    #[inline(always)]
    fn end(&mut self, walk: &Walk, rays: [usize; 2]) {
        let nodes = walk.nodes;
        let anywhere = sum(&self.known, &nodes.unseen);
        let per_metre = (apart(walk.rays, rays) / walk.surfaces.reach_m) as f32;
        let sums = self.nearer.known.iter().zip(&self.nearer.weight).zip(&self.farther.known).zip(&self.farther.weight);
        let places = self.message.iter_mut().zip(&self.decay).zip(&nodes.range);
        for (((message, decay), range), (((near, weight), beyond), further)) in places.zip(sums) {
            let near = (near + decay * beyond) / (weight + decay * further);
            // The surface goes on: surely where rays touch, not at all from the reach on.
            let left = 1.0 - range * per_metre;
            let left = if left > 0.0 { left } else { 0.0 };
            *message = anywhere + left * left * (near - anywhere);
        }
        // Of readings that are impossible wherever the ray ends, nothing is learnt.
        let total = sum(&self.message, &nodes.unseen);
        if total > f32::MIN_POSITIVE {
            let scale = 1.0 / total;
            self.message.iter_mut().for_each(|message| *message *= scale);
        } else {
            self.message.fill(1.0);
        }
    }
}

/// Angle between two rays, rad.
fn apart(rays: &[Ray], [from, to]: [usize; 2]) -> f64 {
    (rays[to].bearing_rad - rays[from].bearing_rad).abs()
}

/// The sum of products, in an order that vectors can follow.
#[inline(always)]
fn sum(values: &[f32], weights: &[f32]) -> f32 {
    let (values, rest) = values.as_chunks::<LANES>();
    let (weights, last) = weights.as_chunks::<LANES>();
    let lanes = values.iter().zip(weights).fold([0.0; LANES], |sum: Lanes<f32>, (v, w)| each(|l| sum[l] + v[l] * w[l]));
    let rest = rest.iter().zip(last).map(|(v, w)| v * w);
    lanes.into_iter().chain(rest).fold(0.0, |sum, value| sum + value)
}

/// The sums of both sides, nearer and farther: four chains that do not wait for each other.
#[inline(always)]
fn sums([a, b]: &mut [Side; 2], width: &[f32]) {
    let mut sums = [[0.0f32; 2]; 4];
    let after = |[sum, weight]: [f32; 2], known: f32, decay: f32, width: f32| {
        [width * known + decay * sum, width + decay * weight]
    };
    let mut forward =
        a.nearer.known.iter_mut().zip(&mut a.nearer.weight).zip(b.nearer.known.iter_mut().zip(&mut b.nearer.weight));
    let mut backward = a
        .farther
        .known
        .iter_mut()
        .zip(&mut a.farther.weight)
        .zip(b.farther.known.iter_mut().zip(&mut b.farther.weight))
        .rev();
    let values = a.known.iter().zip(&a.decay).zip(b.known.iter().zip(&b.decay)).zip(width);
    for ((((ak, ad), (bk, bd)), w), (((end_ak, end_ad), (end_bk, end_bd)), end_w)) in values.clone().zip(values.rev()) {
        sums[0] = after(sums[0], *ak, *ad, *w);
        sums[1] = after(sums[1], *bk, *bd, *w);
        if let Some(((a_sum, a_weight), (b_sum, b_weight))) = forward.next() {
            ([*a_sum, *a_weight], [*b_sum, *b_weight]) = (sums[0], sums[1]);
        }
        if let Some(((a_sum, a_weight), (b_sum, b_weight))) = backward.next() {
            ([*a_sum, *a_weight], [*b_sum, *b_weight]) = (sums[2], sums[3]);
        }
        sums[2] = after(sums[2], *end_ak, *end_ad, *end_w);
        sums[3] = after(sums[3], *end_bk, *end_bd, *end_w);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sensor::{Laser, Stereo};

    /// From where one ray ends to where the next one does, node by node: the sum of what is said above of surfaces.
    fn transition(nodes: &Nodes, surfaces: &Surfaces, angle: f64) -> Vec<Vec<f64>> {
        let count = nodes.range_m.len();
        let width = |k: usize| nodes.borders_m[k + 1] - nodes.borders_m[k];
        let decay = |k: usize| {
            let lengths = (SLOPE * nodes.range_m[k] * angle + surfaces.blur_m) / width(k);
            lengths / (1.0 + lengths)
        };
        let row = |k: usize| {
            let near = |j: usize| {
                let between = if j < k { j + 1..k + 1 } else { k..j };
                width(j) * between.map(decay).product::<f64>()
            };
            let sum: f64 = (0..count).map(near).sum();
            let left = (1.0 - nodes.range_m[k] * angle / surfaces.reach_m).max(0.0);
            let goes_on = left * left;
            let unseen = |j: usize| {
                let passed = |border: usize| (-surfaces.rate * nodes.borders_m[border]).exp();
                passed(j) - if j + 1 < count { passed(j + 1) } else { 0.0 }
            };
            (0..count).map(|j| goes_on * near(j) / sum + (1.0 - goes_on) * unseen(j)).collect()
        };
        (0..count).map(row).collect()
    }

    /// For every node of a ray the sum over all ways in which the others can end.
    fn enumerate(nodes: &Nodes, surfaces: &Surfaces, rays: &[Ray], ray: usize, likelihood: &[Vec<f64>]) -> Vec<f64> {
        let count = nodes.range_m.len();
        let mut sums = vec![0.0; count];
        for number in 0..count.pow(rays.len() as u32) {
            let ends: Vec<usize> = (0..rays.len()).map(|k| number / count.pow(k as u32) % count).collect();
            let mut product = 1.0;
            for k in 0..rays.len() {
                if k != ray {
                    let towards = if k < ray { k + 1 } else { k - 1 };
                    let angle = (rays[k].bearing_rad - rays[towards].bearing_rad).abs();
                    product *= transition(nodes, surfaces, angle)[ends[towards]][ends[k]] * likelihood[k][ends[k]];
                }
            }
            sums[ends[ray]] += product;
        }
        sums
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]
        #[test]
        fn it_is_the_sum_over_all_ends_of_the_other_rays(
            bearings in prop::collection::vec(-0.7f64..0.7, 1..5), readings in prop::collection::vec(0.0f64..60.0, 4),
            correlation in 0.0f64..0.99, laser: bool,
        ) {
            let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 3, height: 1 };
            let prior = Prior { correlation, ..Prior::default() };
            let surfaces = Surfaces::new(&prior, prior.onset(0.05), 0.05);
            let (stereo, beam) = (Stereo { disparity_sigma: 20.0, ..Stereo::default() }, Laser::default());
            let sensor: &dyn SensorModel = if laser { &beam } else { &stereo };
            let ray = |(bearing_rad, reading): (&f64, &f64)| {
                let reading = if laser { reading / 300.0 } else { *reading };
                Ray { origin_m: [0.01, 0.02], direction: [1.0, 0.0], bearing_rad: *bearing_rad, reading: Some(reading) }
            };
            let given: Vec<Ray> = bearings.iter().zip(&readings).map(ray).collect();
            let chain = BearingChain::new(sensor, &given, &spec, &surfaces);
            let mut rays = given.clone();
            rays.sort_by(|a, b| a.bearing_rad.total_cmp(&b.bearing_rad));
            let nodes = Nodes::new(farthest_m(&spec, &given), surfaces.rate);
            let likelihood: Vec<Vec<f64>> = rays.iter().map(|ray| {
                let mut likelihood = vec![0.0; nodes.range_m.len()];
                sensor.likelihood(ray.reading.expect("given"), ray.bearing_rad, &nodes.borders_m, &mut likelihood);
                likelihood
            }).collect();
            for (number, ray) in given.iter().enumerate() {
                let place = rays.iter().position(|other| other.bearing_rad.to_bits() == ray.bearing_rad.to_bits()).expect("it is there");
                let expected = enumerate(&nodes, &surfaces, &rays, place, &likelihood);
                for (k, at_m) in nodes.range_m.iter().enumerate() {
                    let found = f64::from(chain.factor(number, *at_m) / chain.factor(number, 0.0));
                    let expected = expected[k] / expected[0];
                    prop_assert!((found / expected - 1.0).abs() < 1e-4, "ray {number}, node {k}: {found} against {expected}");
                }
            }
        }
    }

    #[test]
    fn nodes_are_found_from_ranges() {
        for node in 0..700 {
            let (at_m, next_m) = (node_m(node), node_m(node + 1));
            for part in [0.0, 0.25, 0.75] {
                let (before, found) = node_before(at_m + part * (next_m - at_m) + 1e-9 * next_m);
                assert!(
                    before as usize == node && (f64::from(found) - part).abs() < 1e-3,
                    "{node} {part}: {before} {found}"
                );
            }
        }
    }

    #[test]
    fn rays_that_do_not_know_of_each_other_say_nothing() {
        let spec = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 100, height: 100 };
        let rays: Vec<Ray> = (0..20)
            .map(|k| Ray {
                origin_m: [1.0; 2],
                direction: [1.0, 0.0],
                bearing_rad: 0.01 * f64::from(k),
                reading: Some(5.0),
            })
            .collect();
        let prior = Prior { correlation: 0.0, ..Prior::default() };
        let chain = BearingChain::new(&Stereo::default(), &rays, &spec, &Surfaces::new(&prior, 0.1, 0.05));
        for row in chain.factors.chunks(chain.nodes.range_m.len()) {
            assert!(row.iter().all(|factor| factor.to_bits() == row[0].to_bits()));
        }
    }
}
