//! [`posterior`](super::posterior) of several rays in lockstep, a lane to each, to the bit.

use grid::DigitalLine;
use sensor::in_lanes;
use sensor::lanes::{LANES, Lanes, each};

use super::relative;
use crate::memory::Held;
use crate::pairs::grid::PairwiseGrid;
use crate::pairs::moments::RayMoments;

/// Rays that are updated together. A buffer to fill again and again.
#[derive(Clone, Default)]
pub(super) struct Bundle {
    /// Cells of each ray; 0 in a lane without one.
    cells: Lanes<f64>,
    /// By the number of a cell on its ray: what is known of it, and of it with the next.
    prior: Vec<Prior>,
    /// Likelihoods of what was seen at the cell if it is occupied and if it is free.
    unary: Vec<[Lanes<f64>; 2]>,
    /// The same of all that was seen behind it, up to a factor.
    behind: Vec<[Lanes<f64>; 2]>,
    /// Moments of the posterior of it and the next; of the last cell of a ray, nothing.
    moments: Vec<[Lanes<f64>; 3]>,
    /// Posterior marginals of the first cells.
    first: Lanes<f64>,
    /// 1 where some state of all cells of the ray is possible, 0 where none is.
    possible: Lanes<f64>,
}

/// A cell of each ray, as it was before the scan.
#[derive(Clone, Copy, Default)]
struct Prior {
    /// `P(E_j)`.
    marginal: Lanes<f64>,
    /// `P(E_j, E_{j+1})`.
    both: Lanes<f64>,
    /// [`Chain::stays_occupied`](crate::Chain::stays_occupied) and [`Chain::becomes_occupied`](crate::Chain::becomes_occupied).
    stays: Lanes<f64>,
    becomes: Lanes<f64>,
}

impl Bundle {
    /// No ray in any lane.
    pub(super) fn clear(&mut self) {
        self.cells = [0.0; LANES];
    }

    /// Puts a ray into a lane: its cells, of which there is at least one, and what was seen at each.
    pub(super) fn gather(&mut self, lane: usize, pairs: &PairwiseGrid, line: &DigitalLine, unaries: &[[f64; 2]]) {
        let cells = line.cells();
        self.cells[lane] = cells.len() as f64;
        if self.prior.len() < cells.len() {
            self.prior.resize(cells.len(), Prior::default());
            self.unary.resize(cells.len(), <[Lanes<f64>; 2]>::default());
            self.behind.resize(cells.len(), <[Lanes<f64>; 2]>::default());
            self.moments.resize(cells.len(), <[Lanes<f64>; 3]>::default());
        }
        let (marginal, spec) = (pairs.marginal.values(), pairs.spec());
        for ((prior, unary), (cell, seen)) in self.prior.iter_mut().zip(&mut self.unary).zip(cells.iter().zip(unaries))
        {
            prior.marginal[lane] = marginal[*cell];
            let [occupied, free] = relative(*seen);
            (unary[0][lane], unary[1][lane]) = (occupied, free);
        }
        for (prior, pair) in self.prior.iter_mut().zip(cells.windows(2)) {
            prior.both[lane] = pairs.both[spec.edge_between(pair[0], pair[1])];
        }
    }

    /// Brings the posteriors of all lanes up to date.
    pub(super) fn update(&mut self) {
        recur(self);
    }

    /// The posterior of a ray; none where what was seen rules out every state.
    pub(super) fn moments(&self, lane: usize) -> Option<RayMoments<'_>> {
        (self.possible[lane] > 0.0).then(|| RayMoments { lane, first: self.first[lane], pairs: &self.moments })
    }
}

in_lanes! {
    fn recur<'a>(bundle: &'a mut Bundle) {
        backward(bundle);
        forward(bundle);
    }
}

/// The longest ray's number of cells.
#[inline(always)]
fn longest(cells: &Lanes<f64>) -> usize {
    cells.iter().fold(0.0f64, |longest, cells| longest.max(*cells)) as usize
}

#[inline(always)]
fn backward(Bundle { cells, prior, unary, behind, .. }: &mut Bundle) {
    let longest = longest(cells);
    let mut after = [[1.0; LANES]; 2];
    if let Some(last) = longest.checked_sub(1) {
        behind[last] = after;
    }
    for j in (0..longest.saturating_sub(1)).rev() {
        let next = prior[j + 1].marginal;
        let Prior { marginal, both, stays, becomes } = &mut prior[j];
        let begins = each(|l| next[l] - both[l]);
        let free = each(|l| 1.0 - marginal[l]);
        *stays = share(both, marginal);
        *becomes = share(&begins, &free);
        let yes = each(|l| unary[j + 1][0][l] * after[0][l]);
        let no = each(|l| unary[j + 1][1][l] * after[1][l]);
        let occupied = each(|l| stays[l] * yes[l] + (1.0 - stays[l]) * no[l]);
        let free = each(|l| becomes[l] * yes[l] + (1.0 - becomes[l]) * no[l]);
        let (occupied, free, _) = normalised(&occupied, &free);
        // A ray that ends before cell j + 1 has nothing behind cell j.
        let next = (j + 1) as f64;
        after = [
            each(|l| if next < cells[l] { occupied[l] } else { 1.0 }),
            each(|l| if next < cells[l] { free[l] } else { 1.0 }),
        ];
        behind[j] = after;
    }
}

#[inline(always)]
fn forward(Bundle { cells, prior, unary, behind, moments, first, possible }: &mut Bundle) {
    let longest = longest(cells);
    let Some(start) = prior.first().filter(|_| longest > 0) else { return };
    let p = start.marginal;
    let occupied = each(|l| p[l] * unary[0][0][l]);
    let free = each(|l| (1.0 - p[l]) * unary[0][1][l]);
    let (mut occupied, mut free, _) = normalised(&occupied, &free);
    let (here, _, all) = normalised(&each(|l| occupied[l] * behind[0][0][l]), &each(|l| free[l] * behind[0][1][l]));
    *first = here;
    *possible = each(|l| if all[l] > 0.0 { 1.0 } else { 0.0 });
    for j in 0..longest - 1 {
        let Prior { stays: t, becomes: u, .. } = &prior[j];
        let [on, off] = &unary[j + 1];
        let ee = each(|l| occupied[l] * t[l] * on[l]);
        let ef = each(|l| occupied[l] * (1.0 - t[l]) * off[l]);
        let fe = each(|l| free[l] * u[l] * on[l]);
        let ff = each(|l| free[l] * (1.0 - u[l]) * off[l]);
        (occupied, free, _) = normalised(&each(|l| ee[l] + fe[l]), &each(|l| ef[l] + ff[l]));
        let [yes, no] = &behind[j + 1];
        let ee = each(|l| ee[l] * yes[l]);
        let ef = each(|l| ef[l] * no[l]);
        let fe = each(|l| fe[l] * yes[l]);
        let ff = each(|l| ff[l] * no[l]);
        let total = each(|l| ee[l] + ef[l] + fe[l] + ff[l]);
        let next = (j + 1) as f64;
        let able = each(|l| if total[l] > 0.0 { possible[l] } else { 0.0 });
        *possible = each(|l| if next < cells[l] { able[l] } else { possible[l] });
        let scale = each(|l| 1.0 / total[l]);
        let ee = each(|l| ee[l] * scale[l]);
        let ef = each(|l| ef[l] * scale[l]);
        let fe = each(|l| fe[l] * scale[l]);
        let ff = each(|l| ff[l] * scale[l]);
        moments[j] = [
            each(|l| (ee[l] + ef[l]) - (fe[l] + ff[l])),
            each(|l| (ee[l] + fe[l]) - (ef[l] + ff[l])),
            each(|l| (ee[l] + ff[l]) - (ef[l] + fe[l])),
        ];
    }
}

/// A part over its whole, 0 to 1, and 0 of nothing.
#[inline(always)]
fn share(part: &Lanes<f64>, whole: &Lanes<f64>) -> Lanes<f64> {
    let share = each(|l| part[l] / whole[l]);
    let share = each(|l| if share[l] < 0.0 { 0.0 } else { share[l] });
    let share = each(|l| if share[l] > 1.0 { 1.0 } else { share[l] });
    each(|l| if whole[l] > 0.0 { share[l] } else { 0.0 })
}

/// Scaled to add up to one, and the sum.
#[inline(always)]
fn normalised(a: &Lanes<f64>, b: &Lanes<f64>) -> (Lanes<f64>, Lanes<f64>, Lanes<f64>) {
    let sum = each(|l| a[l] + b[l]);
    let (first, second) = (each(|l| a[l] / sum[l]), each(|l| b[l] / sum[l]));
    (
        each(|l| if sum[l] > 0.0 { first[l] } else { 0.0 }),
        each(|l| if sum[l] > 0.0 { second[l] } else { 0.0 }),
        each(|l| if sum[l] > 0.0 { sum[l] } else { 0.0 }),
    )
}

impl Held for Bundle {
    fn held(&self) -> usize {
        self.prior.held() + self.unary.held() + self.behind.held() + self.moments.held()
    }
}
