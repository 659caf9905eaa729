//! The generic solution: a Markov random field over the whole map, all readings at once.
//!
//! Rachlin, Dolan and Khosla, "Efficient mapping through exploitation of spatial dependencies", IROS 2005,
//! pose mapping as inference in such a field; the paper calls it the generic solution whose cost is huge.
//! Here the ray potentials are exact and yet linear in the cells of a ray, since a reading explains only
//! the first occupied one.

use grid::{GridSpec, Raster};
use sensor::Scan;

use crate::belief::probability::{from_log_odds, log_odds};
use crate::fit::{Candidate, Fit, Fitted, Setting, numbers};
use crate::mapper::{Mapper, Work};
use crate::memory::Held as _;
use crate::model::Model;
use crate::pairs::joint::both_occupied;
use crate::rules::readings::Readings;
use crate::tuning::Tuning;

/// The field between neighbouring cells, and how it is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Correlation of two neighbours that knew of no others, 0 to 1, whatever the size of a cell. Above
    /// 1/3 an unseen map is no longer stable: a cell then hears more from its three other neighbours than
    /// it passes on, and the map freezes into one phase.
    pub coupling: f64,
    /// Share of a message that is kept from the sweep before, 0 up to but not including 1.
    pub damping: f64,
    /// At most so many sweeps over all rays and edges.
    pub sweeps: usize,
    /// A sweep that changes no message by more than this, in log odds, is the last; above 0.
    pub tolerance: f64,
}

impl Field {
    /// The coupling that the `tune` command finds best on the tuning scenes, which are not the scenes
    /// that results are reported on. Without damping a room never settles; with it the last few
    /// surface cells drift on for hundreds of sweeps, by less than the tolerance: 0.0125 in probability.
    pub const TUNED: Self = Self { coupling: 0.225, damping: 0.3, sweeps: 40, tolerance: 0.05 };

    /// Candidates and choice.
    pub(crate) const FIT: Fit = Fit {
        mapper: "mrf",
        built_in: || Candidate::of(Self::TUNED),
        tried: || Candidate::all(COUPLINGS.map(|coupling| Self { coupling, ..Self::TUNED })),
    };

    /// The field with the values given.
    pub fn tuned(self, tuning: &Tuning) -> Self {
        Self {
            coupling: tuning.coupling.unwrap_or(self.coupling),
            damping: tuning.damping.unwrap_or(self.damping),
            sweeps: tuning.sweeps.unwrap_or(self.sweeps),
            ..self
        }
    }
}

/// Correlations of neighbours. A map is unstable from 1/3 on: the last shows the cliff before it.
const COUPLINGS: [f64; 8] = [0.0, 0.1, 0.15, 0.2, 0.225, 0.25, 0.27, 0.3];

impl Fitted for Field {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        numbers([("coupling", self.coupling), ("damping", self.damping)])
    }

    fn label(&self) -> String {
        format!("coupling {}, damping {}", self.coupling, self.damping)
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(Mrf::new(model, *self))
    }
}

/// Messages stay within this, in log odds: beyond it nothing changes, and infinities would stay for ever.
const MOST: f64 = 40.0;

/// Below this, what is left in front is nothing: it stops the walk through subnormal numbers.
const NEGLIGIBLE: f64 = 1e-280;

/// Writes the message of a reading to each cell of its ray, as log odds, if the others are occupied
/// independently with probabilities `occupied`: the exact sum over all 2^N states, in O(N).
///
/// `likelihood[k]` is `P(o | F_k)`, `none` the same for a ray that hits none of its cells. A reading that
/// is impossible whatever the cell gives a message of 0.
///
/// # Panics
/// Unless all slices have the same length.
pub fn ray_messages(occupied: &[f64], likelihood: &[f64], none: f64, messages: &mut [f64]) {
    let n = messages.len();
    assert!(occupied.len() == n && likelihood.len() == n, "one probability and one likelihood per cell");
    let mut behind = none; // the reading's likelihood if all cells up to j are free
    for j in (0..n).rev() {
        messages[j] = behind;
        behind = occupied[j] * likelihood[j] + (1.0 - occupied[j]) * behind;
    }
    let (mut hit, mut clear) = (0.0, 1.0); // hit in front of j with its likelihood; all in front of j free
    for j in 0..n {
        messages[j] = ratio(hit + clear * likelihood[j], hit + clear * messages[j]);
        hit += clear * occupied[j] * likelihood[j];
        clear *= 1.0 - occupied[j];
        if clear < NEGLIGIBLE {
            clear = 0.0;
        }
    }
}

/// Logarithm of `yes / no`, bounded; 0 of two zeros.
fn ratio(yes: f64, no: f64) -> f64 {
    if yes.max(no) > 0.0 { libm::log(yes / no).clamp(-MOST, MOST) } else { 0.0 }
}

/// The potential of two neighbours: `psi(a, b) = P(a, b) / (P(a) P(b))`, so that unseen cells of a
/// map without loops keep their prior.
struct Edge {
    /// `psi` of both occupied, of one of the two, and of none.
    both: f64,
    one: f64,
    neither: f64,
}

impl Edge {
    fn new(p: f64, coupling: f64) -> Self {
        let both = both_occupied(p, p, coupling);
        let (q, one) = (1.0 - p, p - both);
        Self { both: both / (p * p), one: one / (p * q), neither: (q - one) / (q * q) }
    }

    /// The message to a neighbour from a cell that is occupied with the given log odds by all else.
    fn message(&self, log_odds: f64) -> f64 {
        let p = from_log_odds(log_odds);
        ratio((1.0 - p) * self.one + p * self.both, (1.0 - p) * self.neither + p * self.one)
    }
}

/// Loopy sum-product over a pairwise field of 4-neighbours with the exact potential of every ray. Batch;
/// O(cells on the ray) per ray and sweep, at most [`Field::sweeps`] sweeps.
///
/// Exact where factors form no loop; on maps it is the usual approximation (Bethe). Every call of
/// [`settle`](Mapper::settle) starts from the unseen map, so that the result does not depend on how often
/// it was called.
#[derive(Clone)]
pub struct Mrf {
    field: Field,
    prior: f64,
    readings: Readings,
    solved: usize,
    sweeps: usize,
    occupancy: Raster<f64>,
}

impl Mrf {
    /// The unseen map.
    pub fn new(model: &Model, field: Field) -> Self {
        let prior = model.prior.marginal();
        let occupancy = Raster::filled(model.grid, prior);
        Self { field, prior, readings: Readings::new(model), solved: 0, sweeps: 0, occupancy }
    }

    /// Sweeps of the last solution; below [`Field::sweeps`] if it converged.
    pub fn sweeps(&self) -> usize {
        self.sweeps
    }
}

impl Mapper for Mrf {
    fn integrate(&mut self, scan: &Scan) {
        self.readings.add(scan);
    }

    fn settle(&mut self) {
        if self.solved == self.readings.rays() {
            return;
        }
        self.solved = self.readings.rays();
        let mut beliefs = Beliefs::new(*self.occupancy.spec(), self.prior, &self.field, &self.readings);
        self.sweeps = 0;
        while self.sweeps < self.field.sweeps {
            self.sweeps += 1;
            if beliefs.sweep(&self.readings) < self.field.tolerance {
                break;
            }
        }
        for (p, &log_odds) in self.occupancy.values_mut().iter_mut().zip(&beliefs.total) {
            *p = from_log_odds(log_odds);
        }
    }

    fn occupancy(&self) -> &Raster<f64> {
        &self.occupancy
    }

    fn fork(&self) -> Option<Box<dyn Mapper>> {
        Some(Box::new(self.clone()))
    }

    /// Does not count cells; keeps every reading.
    fn work(&self) -> Work {
        Work { cells: 0, bytes: self.occupancy.held() + self.readings.held() }
    }
}

/// All messages, as log odds.
struct Beliefs {
    spec: GridSpec,
    edge: Edge,
    damping: f64,
    /// The prior of each cell and all messages to it.
    total: Vec<f64>,
    /// From each ray to each of its cells.
    from_rays: Vec<f64>,
    /// Along each edge to its higher and to its lower cell.
    along_edges: Vec<[f64; 2]>,
    /// Of one ray: its cells without its last messages to them, and its new messages.
    occupied: Vec<f64>,
    messages: Vec<f64>,
}

impl Beliefs {
    fn new(spec: GridSpec, prior: f64, field: &Field, readings: &Readings) -> Self {
        Self {
            spec,
            edge: Edge::new(prior, field.coupling),
            damping: field.damping,
            total: vec![log_odds(prior); spec.cells()],
            from_rays: vec![0.0; readings.cells().len()],
            along_edges: vec![[0.0; 2]; 2 * spec.cells()],
            occupied: Vec::new(),
            messages: Vec::new(),
        }
    }

    /// Every ray in the order in which it came, then every edge; the largest change before damping.
    fn sweep(&mut self, readings: &Readings) -> f64 {
        let rays = (0..readings.rays()).map(|ray| self.ray(readings, ray)).fold(0.0, f64::max);
        let cells = 0..self.spec.cells();
        cells.map(|cell| self.edges_above(cell)).fold(rays, f64::max)
    }

    fn ray(&mut self, readings: &Readings, ray: usize) -> f64 {
        let span = readings.span(ray);
        let cells = &readings.cells()[span.clone()];
        let before = &mut self.from_rays[span.clone()];
        self.occupied.clear();
        self.occupied.extend(
            cells.iter().zip(&*before).map(|(&cell, message)| from_log_odds(self.total[cell as usize] - message)),
        );
        self.messages.resize(cells.len(), 0.0);
        ray_messages(&self.occupied, &readings.likelihood()[span], readings.none(ray), &mut self.messages);
        let mut moved: f64 = 0.0;
        for ((&cell, before), &now) in cells.iter().zip(before).zip(&self.messages) {
            let change = now - *before;
            moved = moved.max(change.abs());
            *before += (1.0 - self.damping) * change;
            self.total[cell as usize] += (1.0 - self.damping) * change;
        }
        moved
    }

    /// The edges from a cell to its right and its upper neighbour, both ways.
    fn edges_above(&mut self, cell: usize) -> f64 {
        let mut moved: f64 = 0.0;
        for n in self.spec.neighbours(cell).filter(|n| n.cell > cell) {
            for (from, to, way) in [(cell, n.cell, 0), (n.cell, cell, 1)] {
                let back = self.along_edges[n.edge][1 - way];
                let change = self.edge.message(self.total[from] - back) - self.along_edges[n.edge][way];
                moved = moved.max(change.abs());
                self.along_edges[n.edge][way] += (1.0 - self.damping) * change;
                self.total[to] += (1.0 - self.damping) * change;
            }
        }
        moved
    }
}
