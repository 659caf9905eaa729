//! The paper's method, fast: several rays at a time, in single precision where that is enough.
//!
//! | step | equations | where | reference |
//! |---|---|---|---|
//! | eight rays cross the grid in lockstep | Section 2.1 | `crate::lines` | [`grid::DigitalLine`] |
//! | likelihood of the reading per first occupied cell | (21) | [`sensor::SensorModel::likelihood_lanes`] | [`sensor::SensorModel::likelihood`] |
//! | ... beyond the last cell | sum to infinity in (7) | `tail` | [`crate::beyond`] |
//! | posterior of every pair | (1)-(7) | `bundle` | [`crate::exact`] |
//! | agreement between rays | (18)-(20) | `tally`, `agree` | [`crate::PairwiseGrid::reconcile`] |
//! | ... with continuity across rays | | `crate::lateral`, `lateral` | [`crate::PairwiseGrid::reconcile_laterally`] |
//!
//! The reference is [`crate::Visibility`]: the same in double precision, ray by ray. One scan on the same map differs
//! from it by less than 1e-5 in any marginal or joint; `tests/lockstep.rs` holds it to that.

mod agree;
mod bundle;
mod lateral;
mod silent;
mod tail;
mod tally;
mod touched;

use std::cell::OnceCell;
use std::sync::Arc;

use grid::{GridSpec, Raster};
use rayon::prelude::*;
use sensor::lanes::LANES;
use sensor::{Ray, Scan, SensorModel};

use self::agree::Moved;
use self::bundle::{Bundle, Reach, World};
use self::lateral::Layers;
use self::tally::Tally;
use crate::catalogue::Setup;
use crate::lateral::{Across, Surfaces};
use crate::lines::Lines;
use crate::pairs::bounds;
use crate::ray::RayUpdate;
use crate::tiles::{Numbering, TILE, Tiles, split};
use crate::work::{Held as _, Work};
use crate::{Chain, Lateral, Mapper, PairwiseGrid, Prior, Reconciliation, exact};

/// Scans of fewer rays are not worth waking other threads for.
const FEW_RAYS: usize = 1024;

/// A joint that single precision allows may miss the bounds of double precision by a last digit: by no more than this.
const REPAIRED: f64 = 1e-6;

/// A tile of the map: 12 bytes per cell.
#[derive(Debug, Clone)]
struct Tile {
    /// `P(E_i)`.
    occupied: [f32; TILE],
    /// `P(E_i, E_j)` with the right and the upper neighbour; not used where cells are independent.
    both: [[f32; TILE]; 2],
}

/// The map.
type Map = Tiles<Tile>;

impl Map {
    /// `P(E_i)`.
    #[inline(always)]
    fn occupied(&self, cell: u32) -> f32 {
        let (tile, place) = split(cell);
        self.at(tile).occupied[place]
    }

    /// `P(E_i, E_j)` with the right (0) or the upper (1) neighbour.
    #[inline(always)]
    fn both(&self, cell: u32, axis: usize) -> f32 {
        let (tile, place) = split(cell);
        self.at(tile).both[axis][place]
    }
}

/// The mapper of the paper, and the same without continuity, in lockstep. O(cells on the ray) per ray.
///
/// 12 bytes per cell of the tiles that readings have said something of; 8 per cell of the grid once
/// [`occupancy`](Mapper::occupancy) is asked for; working memory for what one scan touches.
pub struct Lockstep {
    map: Map,
    continuity: bool,
    sensor: Arc<dyn SensorModel>,
    onset: f64,
    reconciliation: Reconciliation,
    lateral: Option<(Lateral, Surfaces)>,
    workers: Vec<Worker>,
    moved: Vec<Moved>,
    layers: Layers,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
}

/// What one thread needs.
struct Worker {
    bundle: Bundle,
    tally: Tally,
    /// Double precision, for readings that single precision has no evidence for.
    slow: RayUpdate,
    /// How far each of its rays has something to say.
    reach: Vec<Reach>,
    /// Where the lines of every bundle were, block by block.
    bookmarks: Vec<Vec<Lines>>,
}

impl Lockstep {
    /// The paper's method.
    pub fn visibility(setup: &Setup) -> Self {
        Self::new(setup, true)
    }

    /// Every cell independent of the others, as [`crate::Visibility::independent`].
    pub fn independent(setup: &Setup) -> Self {
        let prior = Prior { correlation: 0.0, ..setup.prior };
        Self::new(&Setup { prior, ..setup.clone() }, false)
    }

    /// The paper's method with continuity across rays.
    pub fn lateral(setup: &Setup, lateral: Lateral) -> Self {
        let cell_m = setup.grid.cell_m;
        let prior = lateral.prior(&setup.prior, cell_m);
        let surfaces = Surfaces::new(&setup.prior, prior.onset(cell_m), cell_m);
        Self { lateral: Some((lateral, surfaces)), ..Self::new(&Setup { prior, ..setup.clone() }, true) }
    }

    /// Readings up to which the sums over the rays of a scan are exact: so many, twice in a cell, and 2^-36 are the 53 bits
    /// of a double. A count has 20 bits.
    pub const MOST_RAYS: usize = 1 << 16;

    fn new(setup: &Setup, continuity: bool) -> Self {
        let numbering = Numbering::new(setup.grid);
        // An unseen pair.
        let pair = PairwiseGrid::prior(GridSpec { width: 2, height: 1, ..setup.grid }, &setup.prior);
        let occupied = (pair.marginal[0] as f32).clamp(agree::LEAST, agree::MOST);
        let unseen = Tile { occupied: [occupied; TILE], both: [[pair.both[0] as f32; TILE]; 2] };
        Self {
            map: Tiles::new(numbering, unseen),
            continuity,
            sensor: Arc::clone(&setup.sensor),
            onset: setup.prior.onset(setup.grid.cell_m),
            reconciliation: setup.reconciliation,
            lateral: None,
            layers: Layers::default(),
            workers: vec![Worker::new(numbering)],
            moved: Vec::new(),
            occupancy: OnceCell::new(),
        }
    }

    /// The map in double precision.
    ///
    /// # Panics
    /// If a joint is farther than 1e-6 from what its marginals allow: a defect, never a consequence of the readings.
    pub fn pairs(&self) -> PairwiseGrid {
        let (numbering, spec) = (self.map.numbering, *self.map.numbering.spec());
        let marginal = self.occupancy().clone();
        let mut both = vec![0.0; 2 * spec.cells()];
        for cell in 0..spec.cells() {
            for n in spec.neighbours(cell).filter(|n| n.cell > cell) {
                let (p, q) = (marginal[cell], marginal[n.cell]);
                if !self.continuity {
                    both[n.edge] = p * q;
                    continue;
                }
                let (low, high) = bounds(p, q);
                let held = f64::from(self.map.both(numbering.of(cell), n.edge % 2));
                both[n.edge] = held.clamp(low, high);
                let repaired = (both[n.edge] - held).abs();
                assert!(repaired <= REPAIRED, "edge {}: joint {held} is not in {low} ..= {high}", n.edge);
            }
        }
        PairwiseGrid { marginal, both }
    }

    /// The part of the map that readings have said something of, as [`occupancy`](Mapper::occupancy) has it, up to a tile
    /// more on every side; none before the first. A world may be far larger than what is ever seen of it.
    pub fn seen(&self) -> Option<Raster<f64>> {
        let (from, window) = self.map.seen()?;
        Some(self.map.raster(from, window, |tile, place| f64::from(tile.occupied[place])))
    }

    /// Takes a scan's rays on so many threads; the map does not depend on how many.
    ///
    /// A scan of more than [`MOST_RAYS`](Self::MOST_RAYS) readings is taken as so many scans as it needs, each of every n-th ray.
    pub fn integrate_on(&mut self, scan: &Scan, threads: usize) {
        let rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
        let passes = rays.len().div_ceil(Self::MOST_RAYS);
        for pass in 0..passes {
            self.take(rays.iter().skip(pass).step_by(passes).copied().collect(), threads);
        }
    }

    fn take(&mut self, mut rays: Vec<Ray>, threads: usize) {
        if rays.is_empty() || self.map.numbering.spec().locate(rays[0].origin_m).is_none() {
            return;
        }
        // Rays that can be cut soon are taken together.
        let far = |ray: &Ray| {
            ray.reading.is_none_or(|reading| self.sensor.settled_from(reading, ray.bearing_rad).is_infinite())
        };
        rays.sort_by_key(far);
        let bundles = rays.len().div_ceil(LANES);
        let threads = threads.clamp(1, bundles);
        let rays = dealt(&rays, threads);
        while self.workers.len() < threads {
            self.workers.push(Worker::new(self.map.numbering));
        }
        let hops = self.lateral.as_ref().filter(|(lateral, _)| lateral.edges);
        let hops = hops.map_or(0, |(lateral, _)| lateral.hops(self.map.numbering.spec().cell_m));
        let across = self.lateral.as_ref().filter(|(lateral, _)| lateral.rays);
        let across = across.map(|(_, on)| Across::new(&*self.sensor, &rays, self.map.numbering.spec(), on));
        let world = World {
            map: &self.map,
            continuity: self.continuity,
            sensor: &*self.sensor,
            onset: self.onset,
            across: across.as_ref(),
            lateral: hops > 0,
        };
        let share = bundles.div_ceil(threads) * LANES;
        let workers = &mut self.workers[..threads];
        let of = |k: usize| (k * share, rays.chunks(share).nth(k).unwrap_or_default());
        together(workers, |k, worker| worker.update(&world, of(k)));
        merge(workers);
        let reach: Vec<Reach> = workers.iter().flat_map(|worker| worker.reach.iter().copied()).collect();
        if hops > 0 {
            lateral::open(&self.map, &mut workers[0].tally, hops);
        }
        let until_m = silent::farthest(self.map.numbering.spec(), &rays, &reach, 1 + hops);
        let until_m = |k: usize| until_m.chunks(share).nth(k).unwrap_or_default();
        // Several threads read what one of them alone can add to meanwhile.
        let spoken = (threads > 1).then(|| std::mem::replace(&mut workers[0].tally, Tally::new(self.map.numbering)));
        together(workers, |k, Worker { reach, bookmarks, tally, .. }| {
            silent::add(&world, reach, until_m(k), bookmarks, (spoken.as_ref(), tally));
        });
        let first = &mut self.workers[0];
        if let Some(spoken) = spoken {
            let mut said = std::mem::replace(&mut first.tally, spoken);
            first.tally.take(&mut said);
            merge(&mut self.workers[..threads]);
        }
        let tally = &mut self.workers[0].tally;
        match &self.lateral {
            Some((lateral, _)) if hops > 0 => {
                lateral::agree(&mut self.map, tally, lateral, hops, &mut self.layers);
            }
            _ => agree::agree(&mut self.map, self.continuity, tally, self.reconciliation, &mut self.moved),
        }
        self.occupancy.take();
    }
}

/// The rays in an order in which equal shares of them are equal work: bundle by bundle to every thread in turn. Bundles
/// stay together, the one that is not full at the end.
fn dealt(rays: &[Ray], threads: usize) -> Vec<Ray> {
    let (bundles, rest) = rays.as_chunks::<LANES>();
    let turns = (0..threads).flat_map(|k| bundles.iter().skip(k).step_by(threads));
    turns.flatten().chain(rest).copied().collect()
}

/// What every worker does, each told its number; one of them alone wakes no thread.
fn together(workers: &mut [Worker], work: impl Fn(usize, &mut Worker) + Sync) {
    match workers {
        [only] => work(0, only),
        several => several.par_iter_mut().enumerate().for_each(|(number, worker)| work(number, worker)),
    }
}

/// All that workers know, in the tally of the first.
fn merge(workers: &mut [Worker]) {
    if let Some((first, others)) = workers.split_first_mut() {
        others.iter_mut().for_each(|other| first.tally.take(&mut other.tally));
    }
}

impl Worker {
    fn new(numbering: Numbering) -> Self {
        Self {
            bundle: Bundle::new(numbering),
            tally: Tally::new(numbering),
            slow: RayUpdate::default(),
            reach: Vec::new(),
            bookmarks: Vec::new(),
        }
    }

    /// Takes rays, the first of which has the given number among those of the scan.
    fn update(&mut self, world: &World, (from, rays): (usize, &[Ray])) {
        self.bookmarks.resize_with(rays.len().div_ceil(LANES), Vec::new);
        self.reach.clear();
        for (number, rays) in rays.chunks(LANES).enumerate() {
            let first = from + number * LANES;
            let reach = self.bundle.update(world, (first, rays), &mut self.tally, &mut self.bookmarks[number]);
            for ((k, ray), reach) in rays.iter().enumerate().zip(reach) {
                let reach = if reach.unlikely { self.update_slowly(world, first + k, ray) } else { reach };
                self.reach.push(reach);
            }
        }
    }

    fn update_slowly(&mut self, world: &World, number: usize, ray: &Ray) -> Reach {
        let numbering = world.map.numbering;
        let spec = numbering.spec();
        let occupied = |cell: usize| f64::from(world.map.occupied(numbering.of(cell)));
        let both = |pair: &[usize]| {
            let edge = spec.edge_between(pair[0], pair[1]);
            let joint = f64::from(world.map.both(numbering.of(edge / 2), edge % 2));
            if world.continuity { joint } else { occupied(pair[0]) * occupied(pair[1]) }
        };
        let gather = |chain: &mut Chain, cells: &[usize]| {
            *chain =
                Chain::new(cells.iter().map(|cell| occupied(*cell)).collect(), cells.windows(2).map(both).collect());
        };
        let across = world.across.map(|across| (across, number));
        self.slow.update(ray, spec, (world.sensor, world.onset), across, exact::posterior, gather);
        let (RayUpdate { line, posterior, .. }, tally) = (&self.slow, &mut self.tally);
        let cells = line.cells();
        if let &[only] = cells {
            let entry = tally.entry(numbering.of(only));
            tally.cell_of(entry, 1, rounded(posterior.first));
        }
        for (pair, joint) in cells.windows(2).zip(&posterior.pairs) {
            let [first, second] = [pair[0], pair[1]].map(|cell| tally.entry(numbering.of(cell)));
            tally.cell_of(first, 1, rounded(joint.first()));
            tally.cell_of(second, 1, rounded(joint.second()));
            let edge = spec.edge_between(pair[0], pair[1]);
            let (low, high) = if edge / 2 == pair[0] { (first, second) } else { (second, first) };
            tally.pair(low, high, edge % 2, rounded(joint.ef + joint.fe));
        }
        Reach { cells: cells.len() as u32, end_m: line.ranges()[cells.len()], whole: true, unlikely: true }
    }
}

fn rounded(probability: f64) -> f64 {
    tally::rounded(&[probability as f32; LANES])[0]
}

impl Mapper for Lockstep {
    fn integrate(&mut self, scan: &Scan) {
        let threads = if scan.readings.len() < FEW_RAYS { 1 } else { rayon::current_num_threads() };
        self.integrate_on(scan, threads);
    }

    fn occupancy(&self) -> &Raster<f64> {
        let spec = *self.map.numbering.spec();
        self.occupancy.get_or_init(|| self.map.raster([0, 0], spec, |tile, place| f64::from(tile.occupied[place])))
    }

    fn pairwise(&self) -> Option<PairwiseGrid> {
        self.continuity.then(|| self.pairs())
    }

    fn work(&self) -> Work {
        let held = self.workers.iter().map(|worker| worker.bundle.bytes() + worker.tally.bytes());
        let held = held.sum::<usize>() + self.moved.held() + self.layers.bytes();
        Work {
            cells: self.workers.iter().map(|worker| worker.bundle.cells).sum(),
            bytes: self.map.held() + self.occupancy.held() + held,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sensor::{Pose, Stereo};

    /// A drive through a world that is far larger than what is seen of it.
    fn drive() -> Vec<Scan> {
        let bearings_rad: Vec<f64> = (0..60).map(|k| 0.02 * (f64::from(k) - 29.5)).collect();
        let reading = |number: usize, k: usize| Some(60.0 * (0.618 * (number * 60 + k) as f64).fract().powi(3));
        let scan = |number: usize| Scan {
            time_s: 0.0,
            pose: Pose { x_m: 12.0 + 0.4 * number as f64, y_m: 20.0, theta_rad: 0.03 * number as f64 },
            bearings_rad: bearings_rad.clone(),
            readings: (0..60).map(|k| reading(number, k)).collect(),
        };
        (0..12).map(scan).collect()
    }

    type Unseen = fn(&Setup) -> Lockstep;

    #[test]
    fn a_map_that_grows_is_the_map_that_was_all_there_to_the_bit() {
        let grid = GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width: 1000, height: 1800 };
        let lateral = |setup: &Setup| Lockstep::lateral(setup, Lateral::default());
        let kinds: [(Unseen, Reconciliation); 5] = [
            (Lockstep::visibility, Reconciliation::AllEdges),
            (Lockstep::visibility, Reconciliation::Touched),
            (Lockstep::independent, Reconciliation::AllEdges),
            (Lockstep::independent, Reconciliation::Touched),
            (lateral, Reconciliation::AllEdges),
        ];
        for (unseen, reconciliation) in kinds {
            let setup = Setup { reconciliation, ..Setup::new(grid, Arc::new(Stereo::default())) };
            let (mut grows, mut dense) = (unseen(&setup), unseen(&setup));
            (0..dense.map.numbering.tiles()).for_each(|tile| {
                dense.map.make(tile);
            });
            for scan in drive() {
                grows.integrate_on(&scan, 1);
                dense.integrate_on(&scan, 1);
            }
            let (grown, all) = (grows.pairs(), dense.pairs());
            assert!(grown == all && grown != unseen(&setup).pairs());
            let seen = grows.seen().expect("scans were taken");
            assert!(seen.values().len() < grid.cells() / 2, "{:?}", seen.spec());
            for cell in 0..grid.cells() {
                match seen.spec().locate(grid.centre(cell)) {
                    Some(there) => assert_eq!(seen[there].to_bits(), all.marginal[cell].to_bits()),
                    None => assert_eq!(all.marginal[cell].to_bits(), all.marginal[0].to_bits()),
                }
            }
            assert!(grows.map.held() < dense.map.held() / 2);
        }
    }
}
