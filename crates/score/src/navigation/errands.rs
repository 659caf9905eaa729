//! The pairs of places, drawn from the truth.

use grid::{Lattice, UNREACHED};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};

/// Pairs that share their start: one search answers them all.
pub const GOALS: usize = 10;

/// The places of a pair are at least this far apart, m.
pub const APART_M: f64 = 1.0;

/// The pairs depend on the truth and the robot alone, not on the readings.
const SEED: u64 = 1959;

/// Starts are tried at most so many times as are needed: where no place that can be reached is far enough, there is
/// no pair.
const TRIES: usize = 20;

/// A start and where to go from there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Errand {
    pub(super) start: usize,
    pub(super) goals: Vec<Goal>,
}

/// A place to go to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Goal {
    pub(super) cell: usize,
    /// Cost of a shortest way from the start over the truth.
    pub(super) shortest: u32,
}

/// Draws pairs of places of `free`, the cells at which the robot really stands clear; fewer than asked for where there
/// are no more. Starts are different, and so are the goals of a start.
pub(super) fn draw(free: &Lattice, pairs: usize) -> Vec<Errand> {
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut starts: Vec<usize> = free.cells().collect();
    let mut errands = Vec::new();
    let (mut left, mut tries) = (pairs, TRIES * pairs.div_ceil(GOALS));
    while left > 0 && tries > 0 && !starts.is_empty() {
        tries -= 1;
        let start = starts.swap_remove(below(&mut random, starts.len()));
        let costs = free.costs(start, &[]);
        let reachable = |&cell: &usize| costs[cell] != UNREACHED && apart_m(free, start, cell) >= APART_M;
        let mut places: Vec<usize> = free.cells().filter(reachable).collect();
        let wanted = GOALS.min(left).min(places.len());
        let mut goal = || {
            let cell = places.swap_remove(below(&mut random, places.len()));
            Goal { cell, shortest: costs[cell] }
        };
        let goals: Vec<Goal> = (0..wanted).map(|_| goal()).collect();
        left -= goals.len();
        errands.extend((!goals.is_empty()).then_some(Errand { start, goals }));
    }
    errands
}

/// A number below `count`, which is at least 1.
fn below(random: &mut ChaCha8Rng, count: usize) -> usize {
    ((u128::from(random.next_u64()) * count as u128) >> 64) as usize
}

fn apart_m(free: &Lattice, a: usize, b: usize) -> f64 {
    let ([ax, ay], [bx, by]) = (free.spec().centre(a), free.spec().centre(b));
    libm::hypot(ax - bx, ay - by)
}
