//! The estimator against worlds made to have a given prior.

use crate::mosaic::mosaic;
use grid::{GridSpec, Raster};
use mapper::estimate::law;
use mapper::{Estimate, Prior};

fn spec(width: usize, height: usize) -> GridSpec {
    GridSpec { cell_m: 0.05, origin_m: [0.0; 2], width, height }
}

/// The mean over seeds and four standard errors of it, or a floor where they are smaller.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    (mean, 4.0 * (variance / n).sqrt())
}

/// Fails where the mean is further from what is expected than sampling error, or where that is too large to tell.
fn is(values: &[f64], expected: f64, telling: f64, what: &str) {
    let (mean, bound) = mean(values);
    assert!(bound < telling * expected, "{what}: an error of {bound} tells nothing");
    assert!((mean - expected).abs() < bound, "{what}: {mean}, expected {expected} +- {bound}");
}

#[test]
fn a_world_made_to_have_the_papers_prior_gives_it_back() {
    let length_m = -0.05 / (0.9 * 0.871f64.ln());
    for (name, shape) in [("a Markov chain", spec(200_000, 1)), ("a mosaic", spec(700, 700))] {
        let found: Vec<Estimate> = (0..24).map(|seed| Estimate::of(&mosaic(shape, 0.1, 0.871, seed))).collect();
        let each =
            |f: &dyn Fn(&Estimate) -> Option<f64>| found.iter().map(|e| f(e).expect("a value")).collect::<Vec<_>>();
        let prior = |e: &Estimate| e.prior();
        is(&each(&|e| Some(prior(e)?.occupancy)), 0.1, 0.07, name);
        is(&each(&|e| Some(prior(e)?.correlation)), 0.871, 0.02, name);
        is(&each(&Estimate::length_m), length_m, 0.1, name);
        is(&each(&Estimate::length_fit_m), length_m, 0.1, name);
        // Runs of sampled cells are geometric: 1 / ((1 - p)(1 - c)) cells.
        is(&each(&|e| e.mean_run_m), 0.05 / (0.9 * 0.129), 0.1, name);
    }
}

/// Every second and every fourth cell of a mosaic: coarser cells that count by their centres.
#[test]
fn coarser_cells_follow_the_law_and_give_the_same_prior() {
    for step in [2, 4] {
        let mut correlations = Vec::new();
        let mut priors = Vec::new();
        for seed in 0..24 {
            let fine = mosaic(spec(800, 800), 0.1, 0.871, seed);
            let coarse = GridSpec { cell_m: 0.05 * step as f64, ..spec(800 / step, 800 / step) };
            let cell = |index| {
                let (column, row) = coarse.column_row(index);
                fine[fine.spec().index(step * column, step * row)]
            };
            let found = Estimate::of(&Raster::new(coarse, (0..coarse.cells()).map(cell).collect()));
            correlations.push(found.correlation().expect("a value"));
            priors.push(found.prior().expect("a value").correlation);
        }
        let length_m = -0.05 / (0.9 * 0.871f64.ln());
        is(&correlations, law(0.1, length_m, 0.05 * step as f64), 0.05, "coarse");
        is(&priors, Prior::default().correlation, 0.02, "at 5 cm");
    }
}

/// Cut a chain into windows of 20 cells: the runs with two ends are then the short ones.
#[test]
fn cut_off_runs_are_counted_as_far_as_they_are_seen() {
    let (mut all, mut complete) = (Vec::new(), Vec::new());
    for seed in 0..24 {
        let mut map = mosaic(spec(200_000, 1), 0.1, 0.871, seed);
        for cell in (0..200_000).step_by(21) {
            map[cell] = None;
        }
        let found = Estimate::of(&map);
        all.push(found.mean_run_m.expect("runs"));
        complete.push(found.mean_complete_run_m.expect("runs"));
    }
    let length = 0.05 / (0.9 * 0.129);
    is(&all, length, 0.1, "all runs");
    assert!(mean(&complete).0 < 0.8 * length, "{:?}", mean(&complete));
}
