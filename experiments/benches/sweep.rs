//! What threads bring and what shards cost: `cargo bench -p experiments --bench sweep`, from the top of the project.
//!
//! Prints the throughput of two threads against that of one on cell size × correlation, and the time that an engine
//! with one thread takes beyond the jobs themselves. Every ratio is of runs that take turns, since machines are busy.

use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use experiments::commands::sweep::{engine, file, manifest};

/// Cell size × correlation, as the shipped sweep has it, over fewer worlds.
const SWEEP: &str = r#"
families = ["clutter", "two-rooms"]
mappers = ["visibility"]
seeds = { first = 1, count = 1 }
[vary]
grid = [0.025, 0.05, 0.1, 0.2]
correlation = [0.0, 0.5, 0.8, 0.871, 0.95]
correlation_law = ["scaled", "fixed"]
"#;

/// Jobs of about 50 ms.
const SHORT: &str = r#"
families = ["clutter"]
mappers = ["visibility"]
seeds = { first = 1, count = 100 }
[set]
grid = 0.1
scans = 30
"#;

const TURNS: usize = 3;

fn main() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    std::env::set_current_dir(top).expect("the top of the project");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let fresh = |name: &str, text: &str, number: usize| {
        let sweep = file::parse(text, name).expect("valid");
        let place: PathBuf = folder.path().join(format!("{name}-{number}"));
        manifest::plan(&sweep, &place, None, manifest::Replace::Never).expect("planned")
    };
    let seconds = |text: &str, name: &str, number: usize, threads: usize| {
        let manifest = fresh(name, text, number);
        let shards: Vec<u32> = (0..manifest.head.shards).collect();
        let start = Instant::now();
        engine::run(&manifest, &shards, threads).expect("ran");
        start.elapsed().as_secs_f64()
    };
    let mut out = std::io::stdout();
    let mut ratios: Vec<f64> =
        (0..TURNS).map(|turn| seconds(SWEEP, "one", turn, 1) / seconds(SWEEP, "two", turn, 2)).collect();
    ratios.sort_by(f64::total_cmp);
    let _ = writeln!(
        out,
        "cell size x correlation: two threads do {:.2} times the work of one ({ratios:.2?})",
        ratios[TURNS / 2]
    );

    let mut costs: Vec<f64> = Vec::new();
    let mut job_s = 0.0;
    for turn in 0..TURNS {
        let manifest = fresh("bare", SHORT, turn);
        let start = Instant::now();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
        for shard in 0..manifest.head.shards {
            manifest
                .each_job(shard, |_, job| {
                    pool.install(|| std::hint::black_box(job.run()))?;
                    Ok(ControlFlow::Continue(()))
                })
                .expect("ran");
        }
        let bare = start.elapsed().as_secs_f64();
        job_s = bare / manifest.head.jobs as f64;
        costs.push(100.0 * (seconds(SHORT, "engine", turn, 1) / bare - 1.0));
    }
    costs.sort_by(f64::total_cmp);
    let _ = writeln!(
        out,
        "jobs of {:.0} ms: the engine takes {:+.2} % more than the jobs alone ({costs:+.2?})",
        1e3 * job_s,
        costs[TURNS / 2]
    );
}
