//! The trait of all mappers, and what a mapper reports of its work.

use grid::Raster;
use sensor::Scan;
use serde::{Deserialize, Serialize};

use crate::memory::Held as _;
use crate::pairs::grid::PairwiseGrid;

/// Scans in their order by the time at which they were taken: what several sensors read at once is one scan for
/// [`integrate_together`](Mapper::integrate_together). Scans of one sensor are never together.
pub fn moments(scans: &[Scan]) -> impl Iterator<Item = &[Scan]> {
    scans.chunk_by(Scan::is_with)
}

/// A rule that turns scans into a map.
pub trait Mapper: Send {
    /// Updates the map with one scan. Rays without a reading, and rays that start outside the map, change nothing.
    ///
    /// # Panics
    /// If the scan names a sensor that the mapper was not made for.
    fn integrate(&mut self, scan: &Scan);

    /// Updates the map with what several sensors read at one time, as one scan: rays that cross are averaged, whichever
    /// sensor they are of. By default one scan after the other.
    ///
    /// # Panics
    /// As [`integrate`](Self::integrate).
    fn integrate_together(&mut self, scans: &[Scan]) {
        scans.iter().for_each(|scan| self.integrate(scan));
    }

    /// Brings the map up to date with the scans so far. A batch mapper, which sees all scans at once,
    /// solves here; others are always up to date.
    fn settle(&mut self) {}

    /// Probability, 0 to 1, that each cell is occupied, given the scans up to the last
    /// [`settle`](Self::settle), or so far if the mapper is no batch mapper.
    fn occupancy(&self) -> &Raster<f64>;

    /// Probability that one cell, by its index, is occupied: as [`occupancy`](Self::occupancy) has it, of a mapper that can tell it
    /// without a raster of all.
    fn occupied(&self, cell: usize) -> f64 {
        self.occupancy()[cell]
    }

    /// The joint probabilities of neighbours, of a map that holds them; made for the call.
    fn pairwise(&self) -> Option<PairwiseGrid> {
        None
    }

    /// `ln P(readings of the scan | map)`, nats, of a scan that is not integrated, the rays taken for independent of each other; a
    /// reading's density is per its unit. None of a mapper that does not predict readings, and of a scan that starts outside the map.
    fn evidence(&self, _scan: &Scan) -> Option<f64> {
        None
    }

    /// A copy that goes on by itself from the map as it is; none of a mapper that cannot be copied.
    fn fork(&self) -> Option<Box<dyn Mapper>> {
        None
    }

    /// What it has done since it was made, and the memory that it holds. A mapper without a count is taken to hold
    /// its occupancy alone.
    fn work(&self) -> Work {
        Work::uncounted(self.occupancy())
    }

    /// Of the cells that [`work`](Self::work) counts, those that rays leapt over together, since nothing was left to learn of them;
    /// also where a ray was then taken once more, cell by cell.
    fn skipped(&self) -> u64 {
        0
    }

    /// Whether the rule itself updates fewer cells than lie between sensors and readings: it throws readings away, cuts rays
    /// short, or updates a cell once for many rays.
    fn leaves_out(&self) -> bool {
        false
    }

    /// How well the draws of a mapper that samples agree, of the last [`settle`](Self::settle); none of any other.
    fn mixing(&self) -> Option<&Mixing> {
        None
    }

    /// Why there is no map: what [`occupancy`](Self::occupancy) then gives is the prior, and is not to be scored. A program that
    /// failed, or draws that do not agree.
    fn fault(&self) -> Option<String> {
        self.outside().and_then(|outside| outside.fault.clone())
    }

    /// What became of the program that does the work of a mapper in another process; none of a mapper that works in this one.
    fn outside(&self) -> Option<&Outside> {
        None
    }
}

/// What became of a program that does the work of a mapper in another process.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Outside {
    /// Time that the process took, or was waited for, s.
    pub seconds: f64,
    /// Why there is no map: what [`Mapper::occupancy`] then gives is the prior, and is not to be scored.
    pub fault: Option<String>,
    /// What the process wrote to its standard error, as far as that is kept.
    pub stderr: String,
}

/// How well the chains of a mapper that samples agree, and what their draws are worth.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mixing {
    /// Number of chains.
    pub chains: usize,
    /// Sweeps of each chain that are averaged.
    pub sweeps: usize,
    /// Split R-hat of the log posterior.
    pub log_posterior: f64,
    /// Cells with 0.1 < p < 0.9 ...
    pub cells: usize,
    /// ... and the share of them whose split R-hat is below [`R_HAT`](Self::R_HAT); 1 where there are none.
    pub share: f64,
    /// Effective sample size of the log posterior.
    pub effective_log_posterior: f64,
    /// Median over these cells of the effective sample size of their probability.
    pub effective: f64,
}

impl Mixing {
    /// Chains agree on a number where its split R-hat is less.
    pub const R_HAT: f64 = 1.05;
    /// Share of the cells with 0.1 < p < 0.9 that chains must agree on.
    pub const SHARE: f64 = 0.95;

    /// Whether the chains agree on the log posterior and on enough cells.
    pub fn is_enough(&self) -> bool {
        self.log_posterior < Self::R_HAT && self.share >= Self::SHARE
    }
}

impl std::fmt::Display for Mixing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { chains, sweeps, log_posterior, cells, share, effective_log_posterior, effective } = self;
        write!(
            f,
            "{chains} chains of {sweeps} sweeps: R-hat {log_posterior:.3} of the log posterior, below {} on {:.1} % of {cells} cells with 0.1 < p < 0.9; \
             effective samples {effective_log_posterior:.0} of the log posterior, {effective:.0} of such a cell",
            Self::R_HAT,
            100.0 * share
        )
    }
}

/// What a mapper has done since it was made, and the memory that it holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Work {
    /// Cells that its rays were updated over, a cell once for every ray that it was updated for; 0 of a mapper that
    /// does not count.
    pub cells: u64,
    /// Memory, bytes: the map, the readings of a mapper that keeps them, and the working state that is kept from one
    /// scan to the next.
    pub bytes: usize,
}

impl Work {
    /// Of a mapper that does not count and holds nothing but the map that it shows.
    pub fn uncounted(occupancy: &Raster<f64>) -> Self {
        Self { cells: 0, bytes: occupancy.held() }
    }
}
