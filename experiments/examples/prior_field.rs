//! The prior field of `gibbs`: log weights of blocks of 3 x 3 cells, fitted on the ground truth of the tuning worlds.
//!
//! `cargo run -p experiments --features fitting --example prior_field > crates/mapper/src/rules/gibbs/weights.rs` writes the file anew. The weights have the
//! largest pseudo-likelihood (Besag, "Statistical analysis of non-lattice data", The Statistician 24, 1975): the product over all cells of
//! the probability of the cell given all others, with a small penalty on squares. It is concave: Newton's method finds the one maximum.
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "a program for the terminal")]

use std::collections::BTreeMap;
use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;

use experiments::worlds::scenes::{FAMILIES, SCENES, families};
use grid::Raster;
use mapper::gibbs::field::{PATTERNS, blocks, orbit, patterns};
use nalgebra::{DMatrix, DVector};
use scene::{Set, Variation};

/// Cell sizes that are fitted, m.
const SIZES_M: [f64; 3] = [0.05, 0.1, 0.2];

/// Layouts of each family.
const LAYOUTS: u64 = 20;

/// Penalty on the square of a weight, against 1 for the log probability of a cell.
const PENALTY: f64 = 1.0;

/// Number of patterns that differ by more than turns and mirrors.
const ORBITS: usize = 102;

/// Which features a cell's flip to occupied adds and takes away: how often each orbit.
type Features = Vec<(u8, i8)>;

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<(), Box<dyn Error>> {
    let mut orbits: Vec<usize> = (0..PATTERNS).map(orbit).collect();
    let number: Vec<usize> = {
        let all = orbits.clone();
        orbits.sort_unstable();
        orbits.dedup();
        all.iter().map(|orbit| orbits.binary_search(orbit).map_err(|_| "an orbit of none")).collect::<Result<_, _>>()?
    };
    assert_eq!(orbits.len(), ORBITS, "orbits of the square's eight symmetries");
    let mut columns = Vec::new();
    for size in SIZES_M {
        let counts = counted(size, &number)?;
        columns.push(fitted(&counts, size));
    }
    println!(
        "//! Log weights of blocks of 3 x 3 cells, as `cargo run -p experiments --features fitting --example prior_field` prints them: fitted by"
    );
    println!("//! pseudo-likelihood on {LAYOUTS} layouts of each family of the tuning set. Not edited by hand.\n");
    println!("/// Cell sizes that were fitted, m, rising.");
    println!("pub(super) const SIZES_M: [f64; {}] = {SIZES_M:?};\n", SIZES_M.len());
    println!("/// Pattern, the smallest of its orbit, and its log weight at every size, nats.");
    println!("#[rustfmt::skip]");
    println!("pub(super) const WEIGHTS: [(u16, [f64; {}]); {ORBITS}] = [", SIZES_M.len());
    for (place, orbit) in orbits.iter().enumerate() {
        let row: Vec<String> = columns.iter().map(|column| format!("{:.3}", column[place])).collect();
        println!("    ({orbit}, [{}]),", row.join(", "));
    }
    println!("];");
    Ok(())
}

/// Every kind of neighbourhood with the number of its cells that are free and occupied.
fn counted(cell_m: f64, number: &[usize]) -> Result<BTreeMap<Features, [f64; 2]>, Box<dyn Error>> {
    let paths: Vec<PathBuf> =
        FAMILIES.split(',').map(|name| PathBuf::from(SCENES).join(format!("{name}.toml"))).collect();
    let mut counts: BTreeMap<Features, [f64; 2]> = BTreeMap::new();
    let (mut cells, mut occupied) = (0, 0);
    for family in families(&paths)? {
        for seed in Set::Tuning.seeds(LAYOUTS) {
            let truth = scene::truth(&family.scene(seed, Some(cell_m), &Variation::default())?);
            let spec = *truth.spec();
            let map: Vec<bool> = truth.values().iter().map(|cell| *cell == Some(true)).collect();
            occupied += map.iter().filter(|on| **on).count();
            cells += map.len();
            let around = patterns(&spec, &map);
            for (cell, is_occupied) in map.iter().enumerate() {
                if let Some(features) = features(&truth, &around, cell, number) {
                    counts.entry(features).or_default()[usize::from(*is_occupied)] += 1.0;
                }
            }
        }
    }
    eprintln!("{cell_m} m: {cells} cells, {:.4} occupied, {} kinds", occupied as f64 / cells as f64, counts.len());
    Ok(counts)
}

/// None where a cell beside it is not known.
fn features(truth: &Raster<Option<bool>>, around: &[u16], cell: usize, number: &[usize]) -> Option<Features> {
    let mut change: BTreeMap<u8, i8> = BTreeMap::new();
    let mut known = truth[cell].is_some();
    blocks(truth.spec(), cell, |centre, bits| {
        known &= truth[centre].is_some();
        let pattern = usize::from(around[centre]);
        *change.entry(number[pattern | bits] as u8).or_default() += 1;
        *change.entry(number[pattern & !bits] as u8).or_default() -= 1;
    });
    known.then(|| change.into_iter().filter(|(_, times)| *times != 0).collect())
}

/// The weights of all orbits: Newton's method from 0.
fn fitted(counts: &BTreeMap<Features, [f64; 2]>, cell_m: f64) -> DVector<f64> {
    let mut weights = DVector::<f64>::zeros(ORBITS);
    for step in 0..60 {
        let mut gradient = -PENALTY * &weights;
        let mut hessian = DMatrix::<f64>::identity(ORBITS, ORBITS) * PENALTY;
        let mut loss = 0.0;
        for (features, [free, occupied]) in counts {
            let odds: f64 =
                features.iter().map(|(orbit, times)| weights[usize::from(*orbit)] * f64::from(*times)).sum();
            let p = 1.0 / (1.0 + (-odds).exp());
            loss += free * (1.0 + odds.exp()).ln() + occupied * (1.0 + (-odds).exp()).ln();
            let (residual, curvature) = (occupied - (free + occupied) * p, (free + occupied) * p * (1.0 - p));
            for (a, times) in features {
                gradient[usize::from(*a)] += residual * f64::from(*times);
                for (b, others) in features {
                    hessian[(usize::from(*a), usize::from(*b))] += curvature * f64::from(*times) * f64::from(*others);
                }
            }
        }
        let Some(factor) = hessian.cholesky() else { break };
        let mut change = factor.solve(&gradient);
        let longest = change.amax();
        change *= (2.0 / longest).min(1.0);
        weights += &change;
        if longest < 1e-9 {
            let cells: f64 = counts.values().map(|[free, occupied]| free + occupied).sum();
            eprintln!("{cell_m} m: {:.5} nats per cell after {step} steps", loss / cells);
            break;
        }
    }
    weights
}
