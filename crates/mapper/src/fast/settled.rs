//! Patches in which a reading can move nothing: rays leap over them.
//!
//! Up to some range before its reading, the likelihood `c` of a kernel is the same for all chords. Whatever is hit there, a cell
//! has the posterior `P'(E) = P(E) c / Z`, so that one of at most [`SETTLED`] moves by no more than that, as long as `c` is not
//! more than the evidence `Z`. What lies farther learns from such cells only how likely the ray was to pass: by the hazard of
//! each, of which a patch knows the mean.

use sensor::lanes::{LANES, Lanes, each};
use sensor::{Ray, ReadingKernel};

use crate::fast::budget::{LEAPT, SETTLED};
use crate::fast::inputs::Inputs;
use crate::fast::map::Map;
use crate::fast::passage::Passage;
use crate::fast::tiles::SIDE;
use crate::fast::walk::{Place, Walk};

/// Fewer cells are not worth it.
const FEWEST: u32 = 2 * SIDE as u32;

/// Cells that a ray has leapt over.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leap {
    /// The cell behind them, still in a settled patch.
    pub(super) landing: Place,
    /// Their number.
    pub(super) cells: u32,
    /// Sum of their `P(E_{j+1} | not E_j)`.
    pub(super) hazard: f32,
}

/// The leap from a cell over settled patches, up to a range (m) that the last of them does not exceed; none over few cells.
pub(super) fn leap(map: &Map, ray: &Ray, from: Place, until_m: f64) -> Option<Leap> {
    let (mut cells, mut hazard, mut landing) = (0, 0.0f32, from);
    let mut walk = Walk::new(&map.numbering, ray.origin_m, ray.direction, from);
    loop {
        let summary = map.summary(map.numbering.at(walk.place.at));
        if summary.most > SETTLED {
            break;
        }
        let crossing = walk.crossing();
        let Some(next) = crossing.next.filter(|_| crossing.exit <= until_m) else { break };
        cells += crossing.cells;
        hazard += crossing.cells as f32 * summary.onset;
        landing = crossing.last;
        walk.place = next;
    }
    (cells >= FEWEST).then(|| Leap { landing, cells: cells - 1, hazard })
}

/// Where rays may leap, and have leapt.
#[derive(Default)]
pub(super) struct Leaps {
    /// Ranges between which the likelihood is flat, m.
    pub(super) flat_m: Lanes<[f64; 2]>,
    /// The likelihood there.
    pub(super) likelihood: Lanes<f32>,
    /// Probability that a ray ends in cells leapt over.
    pub(super) hit: Lanes<f32>,
    /// Their number.
    pub(super) cells: Lanes<u32>,
    /// The cells leapt over by rays of these lanes.
    pub(super) passages: Vec<(usize, Passage)>,
}

impl Leaps {
    /// Rays with these readings, on their starts; none may leap where that is not `wanted`.
    pub(super) fn start(&mut self, inputs: &Inputs, kernel: &dyn ReadingKernel, wanted: bool) {
        self.passages.clear();
        (self.hit, self.cells, self.flat_m) = ([0.0; LANES], [0; LANES], [[0.0; 2]; LANES]);
        if !wanted || inputs.others.is_some() {
            return;
        }
        self.flat_m = std::array::from_fn(|l| kernel.constant_between(l));
        let middle = each(|l| {
            let [from_m, until_m] = self.flat_m[l];
            if from_m < until_m { 0.5 * (from_m + until_m.min(from_m + 1.0)) } else { 0.0 }
        });
        let mut likelihood = [[0.0; LANES]];
        kernel.likelihood(&[middle; 2], &mut likelihood);
        [self.likelihood] = likelihood;
    }

    /// Whether what a ray leapt over was as good as settled, given the evidence for its reading.
    pub(super) fn hold(&self, l: usize, evidence: f32) -> bool {
        self.cells[l] == 0 || self.likelihood[l] <= evidence && self.hit[l] * self.likelihood[l] <= LEAPT * evidence
    }
}
