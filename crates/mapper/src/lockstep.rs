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

use grid::{GridSpec, Raster};
use rayon::prelude::*;
use sensor::lanes::LANES;
use sensor::{Ray, Scan, SensorModel};

use self::bundle::{Bundle, Reach, World};
use self::tally::Tally;
use crate::catalogue::Setup;
use crate::lines::Lines;
use crate::pairs::bounds;
use crate::ray::RayUpdate;
use crate::work::{Held as _, Work};
use crate::{Chain, Mapper, PairwiseGrid, Prior, Reconciliation, exact};

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
/// 16 bytes per cell, and 4 for every thread but the first; 8 more once [`occupancy`](Mapper::occupancy) is asked for;
/// working memory for what one scan touches.
pub struct Lockstep {
    spec: GridSpec,
    map: Vec<Cell>,
    continuity: bool,
    sensor: Arc<dyn SensorModel>,
    onset: f64,
    reconciliation: Reconciliation,
    workers: Vec<Worker>,
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

    fn new(setup: &Setup, continuity: bool) -> Self {
        let pairs = PairwiseGrid::prior(setup.grid, &setup.prior);
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
            occupancy: OnceCell::new(),
        }
    }

    /// The map in double precision.
    pub fn pairs(&self) -> PairwiseGrid {
        let marginal = self.occupancy().clone();
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
        let share = bundles.div_ceil(threads) * LANES;
        let workers = &mut self.workers[..threads];
        together(workers, |k, worker| worker.update(&world, rays.chunks(share).nth(k).unwrap_or_default()));
        merge(workers, &self.map);
        let reach: Vec<Reach> = workers.iter().flat_map(|worker| worker.reach.iter().copied()).collect();
        let until_m = silent::farthest(&self.spec, &rays, &reach);
        together(workers, |k, Worker { reach, bookmarks, tally, .. }| {
            silent::add(&world, reach, until_m.chunks(share).nth(k).unwrap_or_default(), bookmarks, tally);
        });
        merge(workers, &self.map);
        let Some(Worker { tally, .. }) = self.workers.first_mut() else { return };
        agree::agree(&self.spec, &mut self.map, self.continuity, tally, self.reconciliation);
        self.occupancy.take();
    }
}

/// What every worker does, each told its number; one of them alone wakes no thread.
fn together(workers: &mut [Worker], work: impl Fn(usize, &mut Worker) + Sync) {
    match workers {
        [only] => work(0, only),
        several => several.par_iter_mut().enumerate().for_each(|(number, worker)| work(number, worker)),
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
        Self { bundle: Bundle::default(), tally, slow: RayUpdate::default(), reach: Vec::new(), bookmarks: Vec::new() }
    }

    fn update(&mut self, world: &World, rays: &[Ray]) {
        self.bookmarks.resize_with(rays.len().div_ceil(LANES), Vec::new);
        self.reach.clear();
        for (number, rays) in rays.chunks(LANES).enumerate() {
            let reach = self.bundle.update(world, rays, &mut self.tally, &mut self.bookmarks[number]);
            for (ray, reach) in rays.iter().zip(reach) {
                let reach = if reach.unlikely { self.update_slowly(world, ray) } else { reach };
                self.reach.push(reach);
            }
        }
    }

    fn update_slowly(&mut self, world: &World, ray: &Ray) -> Reach {
        let occupied = |cell: usize| f64::from(world.map[cell].occupied);
        let both = |pair: &[usize]| {
            let edge = world.spec.edge_between(pair[0], pair[1]);
            let joint = f64::from(world.map[edge / 2].both[edge % 2]);
            if world.continuity { joint } else { occupied(pair[0]) * occupied(pair[1]) }
        };
        let gather = |chain: &mut Chain, cells: &[usize]| {
            *chain =
                Chain::new(cells.iter().map(|cell| occupied(*cell)).collect(), cells.windows(2).map(both).collect());
        };
        self.slow.update(ray, world.spec, (world.sensor, world.onset), exact::posterior, gather);
        let (RayUpdate { line, posterior, .. }, tally) = (&self.slow, &mut self.tally);
        let cells = line.cells();
        tally.reserve(cells.len());
        if let &[only] = cells {
            let entry = tally.entry(world.map, only as u32);
            tally.cell_of(entry, 1, rounded(posterior.first));
        }
        for (pair, joint) in cells.windows(2).zip(&posterior.pairs) {
            let [first, second] = [pair[0], pair[1]].map(|cell| tally.entry(world.map, cell as u32));
            tally.cell_of(first, 1, rounded(joint.first()));
            tally.cell_of(second, 1, rounded(joint.second()));
            let edge = world.spec.edge_between(pair[0], pair[1]);
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
        let occupied = || self.map.iter().map(|cell| f64::from(cell.occupied)).collect();
        self.occupancy.get_or_init(|| Raster::new(self.spec, occupied()))
    }

    fn work(&self) -> Work {
        let held = self.workers.iter().map(|worker| worker.bundle.bytes() + worker.tally.bytes());
        Work {
            cells: self.workers.iter().map(|worker| worker.bundle.cells).sum(),
            bytes: self.map.held() + self.occupancy.held() + held.sum::<usize>(),
        }
    }
}
