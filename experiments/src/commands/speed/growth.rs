//! How the time of a mapper grows with what it is given.

mod cases;
mod curve;
pub mod fit;
mod views;

pub use curve::{Against, Curve, Sizes};
pub use views::{draw, table, text};

use std::hint::black_box;
use std::time::Instant;

use mapper::catalogue::{Entry, Kind};

use self::cases::GrowthCase;
use super::hall::Hall;
use super::measure::rotated;
use crate::failure::Failure;

/// A measurement goes on for so long, s, so that the clock is fine enough.
const LEAST_S: f64 = 0.02;

/// The mappers whose growth can be measured.
///
/// # Errors
/// A mapper that solves for all scans at once: the time of one ray or scan is none of its.
pub fn online(entries: &[&'static Entry]) -> Result<(), Failure> {
    match entries.iter().find(|entry| entry.kind == Kind::Batch) {
        Some(entry) => Err(Failure::BadInput(format!(
            "--growth: '{}' solves for all scans at once, so that no ray or scan has a time of its own; leave it out of --mappers",
            entry.name
        ))),
        None => Ok(()),
    }
}

/// Number of measurements, for a bar.
pub fn steps(sizes: &Sizes, mappers: usize, repeats: usize) -> usize {
    (sizes.cells_per_ray.len() + sizes.rays_per_scan.len() + sizes.map_cells.len() + 1) * mappers * repeats
}

/// Measures every mapper in turns, so many times; `watch` is told of every measurement.
///
/// # Errors
/// None but a defect.
pub fn measure(
    entries: &[&'static Entry],
    sizes: &Sizes,
    repeats: usize,
    watch: impl Fn(),
) -> Result<Vec<Curve>, Failure> {
    let hall = Hall::new()?;
    let mut curves = Vec::new();
    for against in Against::ALL {
        let first = curves.len();
        let new = |entry: &&'static Entry| Curve { mapper: entry.name, against, points: Vec::new() };
        curves.extend(entries.iter().map(new));
        for case in GrowthCase::all(against, sizes, &hall)? {
            let mut best = vec![vec![f64::INFINITY; case.sizes.len()]; entries.len()];
            for repeat in 0..repeats {
                for (number, entry) in rotated(entries, repeat) {
                    let times =
                        if against == Against::Scans { drive(entry, &case) } else { vec![repeated(entry, &case)] };
                    best[number].iter_mut().zip(times).for_each(|(best, time)| *best = best.min(time));
                    watch();
                }
            }
            for (curve, best) in curves[first..].iter_mut().zip(best) {
                curve.points.extend(case.sizes.iter().copied().zip(best));
            }
        }
    }
    Ok(curves)
}

/// Time of one scan that is mapped again and again, s. The first time, which meets fresh memory, is not counted.
fn repeated(entry: &Entry, case: &GrowthCase) -> f64 {
    let mut mapper = (entry.build)(&case.setup);
    let mut integrate = || case.scans.iter().for_each(|scan| mapper.integrate(scan));
    integrate();
    let start = Instant::now();
    let mut times = 0;
    while times == 0 || start.elapsed().as_secs_f64() < LEAST_S {
        integrate();
        times += 1;
    }
    let seconds = start.elapsed().as_secs_f64() / f64::from(times);
    black_box(mapper.occupancy());
    seconds
}

/// Times after each of the case's numbers of scans, s.
fn drive(entry: &Entry, case: &GrowthCase) -> Vec<f64> {
    let mut mapper = (entry.build)(&case.setup);
    let start = Instant::now();
    let mut times = Vec::new();
    for (number, scan) in case.scans.iter().enumerate() {
        mapper.integrate(scan);
        if case.sizes.contains(&((number + 1) as f64)) {
            times.push(start.elapsed().as_secs_f64());
        }
    }
    black_box(mapper.occupancy());
    times
}
