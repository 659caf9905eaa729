//! The paper's method, fast: several rays at a time, in single precision where that is enough.
//!
//! | step | equations | where | reference |
//! |---|---|---|---|
//! | eight rays cross the grid in lockstep | Section 2.1 | `crate::lines` | [`grid::DigitalLine`] |
//! | likelihood of the reading per first occupied cell | (21) | [`sensor::SensorModel::likelihood_lanes`] | [`sensor::SensorModel::likelihood`] |
//! | ... beyond the last cell | sum to infinity in (7) | `tail` | [`crate::beyond`] |
//! | posterior of every pair | (1)-(7) | `bundle` | [`crate::exact`] |
//! | agreement between rays | (18)-(20) | `tally`, `agree` | [`crate::PairwiseGrid::reconcile`] |
//!
//! The reference is [`crate::Visibility`]: the same in double precision, ray by ray. One scan on the same map differs
//! from it by less than 1e-5 in any marginal or joint; `tests/lockstep.rs` holds it to that.

mod agree;
mod bundle;
mod silent;
mod tail;
mod tally;

use std::cell::OnceCell;
use std::sync::Arc;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;

use grid::{DigitalLine, GridSpec, Raster};
use rayon::prelude::*;
use sensor::lanes::LANES;
use sensor::{Ray, Scan, SensorModel};

use self::bundle::{Bundle, Reach, World};
use self::tally::Tally;
use crate::beyond::{self, Beyond};
use crate::catalogue::Setup;
use crate::lines::Lines;
use crate::pairs::bounds;
use crate::{Chain, Mapper, PairwiseGrid, Prior, RayPosterior, Reconciliation, Work, exact};

/// Scans of fewer rays are not worth waking other threads for.
const FEW_RAYS: usize = 1024;

/// A cell of the map: 16 bytes.
#[derive(Debug)]
#[repr(align(16))]
struct Cell {
    /// `P(E_i)`.
    occupied: f32,
    /// `P(E_i, E_j)` with the right and the upper neighbour; not used where cells are independent.
    both: [f32; 2],
    /// Number of the cell's entry in the first worker's tally, where it is at hand when the cell is; 0 where it has none.
    slot: AtomicU32,
}

impl Cell {
    /// While rays agree: by how much the cell moved, in the place of the number of its entry.
    fn set_moved(&mut self, by: f32) {
        // Minus nothing is not nothing: the cell was touched.
        *self.slot.get_mut() = if by == 0.0 { (-0.0f32).to_bits() } else { by.to_bits() };
    }

    /// Nothing of a cell that was not touched.
    fn moved(&self) -> f32 {
        f32::from_bits(self.slot.load(Relaxed))
    }

    fn is_touched(&self) -> bool {
        self.slot.load(Relaxed) != 0
    }
}

/// The mapper of the paper, and the same without continuity, in lockstep. O(cells on the ray) per ray.
///
/// 12 bytes per cell, and 4 per cell and thread; 8 more once [`occupancy`](Mapper::occupancy) is asked for; working
/// memory for what one scan touches.
pub struct Lockstep {
    spec: GridSpec,
    map: Vec<Cell>,
    continuity: bool,
    sensor: Arc<dyn SensorModel>,
    onset: f64,
    reconciliation: Reconciliation,
    workers: Vec<Worker>,
    reach: Vec<Reach>,
    /// The map as others see it, made when it is asked for.
    occupancy: OnceCell<Raster<f64>>,
}

/// What one thread needs.
struct Worker {
    bundle: Bundle,
    tally: Tally,
    slow: Slow,
    /// Where the lines of every bundle were, block by block.
    bookmarks: Vec<Vec<Lines>>,
}

/// Double precision, for readings that single precision has no evidence for.
#[derive(Default)]
struct Slow {
    line: DigitalLine,
    chain: Chain,
    likelihood: Vec<f64>,
    posterior: RayPosterior,
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

    fn new(setup: &Setup, continuity: bool) -> Self {
        Self::of(setup, continuity, &PairwiseGrid::prior(setup.grid, &setup.prior))
    }

    fn of(setup: &Setup, continuity: bool, pairs: &PairwiseGrid) -> Self {
        let cell = |cell: usize| Cell {
            occupied: (pairs.marginal[cell] as f32).clamp(agree::LEAST, agree::MOST),
            both: [0, 1].map(|axis| pairs.both[2 * cell + axis] as f32),
            slot: AtomicU32::new(0),
        };
        Self {
            spec: setup.grid,
            map: (0..setup.grid.cells()).map(cell).collect(),
            continuity,
            sensor: Arc::clone(&setup.sensor),
            onset: setup.prior.onset(setup.grid.cell_m),
            reconciliation: setup.reconciliation,
            workers: vec![Worker::new(Tally::first())],
            reach: Vec::new(),
            occupancy: OnceCell::new(),
        }
    }

    /// The map in double precision.
    pub fn pairs(&self) -> PairwiseGrid {
        let marginal = Raster::new(self.spec, self.map.iter().map(|cell| f64::from(cell.occupied)).collect());
        let mut both = vec![0.0; 2 * self.map.len()];
        for cell in 0..self.map.len() {
            for n in self.spec.neighbours(cell).filter(|n| n.cell > cell) {
                let (p, q) = (marginal[cell], marginal[n.cell]);
                // What is possible in single precision may miss the bounds of double precision by a last digit.
                let (low, high) = bounds(p, q);
                let joint = f64::from(self.map[cell].both[n.edge % 2]).clamp(low, high);
                both[n.edge] = if self.continuity { joint } else { p * q };
            }
        }
        PairwiseGrid { marginal, both }
    }

    /// Takes a scan's rays on so many threads; the map does not depend on how many.
    pub fn integrate_on(&mut self, scan: &Scan, threads: usize) {
        let rays: Vec<Ray> = scan.rays().filter(|ray| ray.reading.is_some()).collect();
        if rays.is_empty() || self.spec.locate(rays[0].origin_m).is_none() {
            return;
        }
        let bundles = rays.len().div_ceil(LANES);
        let threads = threads.clamp(1, bundles);
        while self.workers.len() < threads {
            self.workers.push(Worker::new(Tally::further(self.map.len())));
        }
        let world = World {
            spec: &self.spec,
            map: &self.map,
            continuity: self.continuity,
            sensor: &*self.sensor,
            onset: self.onset,
        };
        self.reach.clear();
        self.reach.resize(rays.len(), Reach { cells: 0, end_m: 0.0, whole: true, unlikely: false });
        let share = bundles.div_ceil(threads) * LANES;
        if threads == 1 {
            self.workers[0].update(&world, &rays, &mut self.reach);
        } else {
            let parts = rays.par_chunks(share).zip(self.reach.par_chunks_mut(share));
            let workers = self.workers[..threads].par_iter_mut();
            workers.zip(parts).for_each(|(worker, (rays, reach))| worker.update(&world, rays, reach));
        }
        merge(&mut self.workers, &self.map);
        let until_m = silent::farthest(&self.spec, &rays, &self.reach);
        let parts = self.reach.par_chunks(share).zip(until_m.par_chunks(share));
        self.workers[..threads].par_iter_mut().zip(parts).for_each(|(worker, (reach, until_m))| {
            silent::add(&world, reach, until_m, &worker.bookmarks, &mut worker.tally);
        });
        merge(&mut self.workers, &self.map);
        let Some(Worker { tally, .. }) = self.workers.first_mut() else { return };
        agree::agree(&self.spec, &mut self.map, self.continuity, tally, self.reconciliation);
        self.occupancy.take();
    }
}

/// All that workers know, in the tally of the first.
fn merge(workers: &mut [Worker], map: &[Cell]) {
    if let Some((first, others)) = workers.split_first_mut() {
        others.iter_mut().for_each(|other| first.tally.take(&mut other.tally, map));
    }
}

impl Worker {
    fn new(tally: Tally) -> Self {
        Self { bundle: Bundle::default(), tally, slow: Slow::default(), bookmarks: Vec::new() }
    }

    fn update(&mut self, world: &World, rays: &[Ray], reach: &mut [Reach]) {
        self.bookmarks.resize_with(rays.len().div_ceil(LANES), Vec::new);
        for ((rays, reach), bookmarks) in rays.chunks(LANES).zip(reach.chunks_mut(LANES)).zip(&mut self.bookmarks) {
            let reached = self.bundle.update(world, rays, &mut self.tally, bookmarks);
            for ((ray, reach), reached) in rays.iter().zip(reach).zip(reached) {
                *reach = if reached.unlikely { self.slow.update(world, ray, &mut self.tally) } else { reached };
            }
        }
    }
}

impl Slow {
    fn update(&mut self, world: &World, ray: &Ray, tally: &mut Tally) -> Reach {
        self.line.trace(world.spec, ray.origin_m, ray.direction, f64::INFINITY);
        let cells = self.line.cells();
        let end_m = self.line.ranges()[cells.len()];
        let reach = Reach { cells: cells.len() as u32, end_m, whole: true, unlikely: true };
        let Some(reading) = ray.reading else { return reach };
        let occupied = |cell: usize| f64::from(world.map[cell].occupied);
        let both = |pair: &[usize]| {
            let edge = world.spec.edge_between(pair[0], pair[1]);
            let joint = f64::from(world.map[edge / 2].both[edge % 2]);
            if world.continuity { joint } else { occupied(pair[0]) * occupied(pair[1]) }
        };
        self.chain =
            Chain::new(cells.iter().map(|cell| occupied(*cell)).collect(), cells.windows(2).map(both).collect());
        self.likelihood.resize(cells.len(), 0.0);
        world.sensor.likelihood(reading, ray.bearing_rad, self.line.ranges(), &mut self.likelihood);
        let beyond = Beyond::after(&self.line, ray.direction, world.spec.cell_m, world.onset);
        let none = beyond::likelihood(world.sensor, reading, ray.bearing_rad, &beyond);
        exact::posterior(&self.chain, &self.likelihood, none, &mut self.posterior);
        tally.reserve(cells.len());
        if let &[only] = cells {
            let entry = tally.entry(world.map, only as u32);
            tally.cell_of(entry, 1, rounded(self.posterior.first));
        }
        for (pair, joint) in cells.windows(2).zip(&self.posterior.pairs) {
            let [first, second] = [pair[0], pair[1]].map(|cell| tally.entry(world.map, cell as u32));
            tally.cell_of(first, 1, rounded(joint.first()));
            tally.cell_of(second, 1, rounded(joint.second()));
            let edge = world.spec.edge_between(pair[0], pair[1]);
            let (low, high) = if edge / 2 == pair[0] { (first, second) } else { (second, first) };
            tally.pair(low, high, edge % 2, rounded(joint.ef + joint.fe));
        }
        reach
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
        let occupied = || self.map.iter().map(|cell| f64::from(cell.occupied)).collect();
        self.occupancy.get_or_init(|| Raster::new(self.spec, occupied()))
    }

    fn work(&self) -> Work {
        let held = self.workers.iter().map(|worker| worker.bundle.bytes() + worker.tally.bytes());
        Work {
            cells: self.workers.iter().map(|worker| worker.bundle.cells).sum(),
            bytes: size_of_val(&*self.map)
                + self.occupancy.get().map_or(0, |map| size_of_val(map.values()))
                + held.sum::<usize>(),
        }
    }
}
