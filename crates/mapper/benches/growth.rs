//! Cost of one ray against its number of cells: `visibility` must grow linearly.
//!
//! `cargo bench -p mapper --bench growth`. The throughput column is cells per second; it must not
//! fall from 100 to 10,000 cells.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mapper::{Chain, RayPosterior, RayRule, exact, printed};
use sensor::{Kernel as _, Stereo};

fn rays(criterion: &mut Criterion) {
    let rules: [(&str, RayRule); 2] = [("visibility", exact::posterior), ("visibility-printed", printed::posterior)];
    for (name, rule) in rules {
        let mut group = criterion.benchmark_group(name);
        for cells in [100, 300, 1_000, 3_000, 10_000] {
            let chain = Chain::new(vec![0.1; cells], vec![0.088_39; cells - 1]);
            let ranges: Vec<f64> = (0..=cells).map(|k| 0.05 * k as f64).collect();
            let mut likelihood = vec![0.0; cells];
            let mut posterior = RayPosterior::default();
            group.throughput(Throughput::Elements(cells as u64));
            group.bench_function(BenchmarkId::from_parameter(cells), |bencher| {
                bencher.iter(|| {
                    Stereo::default().likelihood(10.0, 0.1, &ranges, &mut likelihood);
                    rule(&chain, &likelihood, 0.004, &mut posterior);
                    assert_eq!(posterior.pairs.len(), cells - 1);
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, rays);
criterion_main!(benches);
