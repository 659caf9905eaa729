//! The simulator asks for memory by scans, never by rays.
//!
//! Alone in its binary: what another test allocates meanwhile would be counted.

use std::alloc::System;
use std::fmt::Write as _;
use std::path::Path;

use scene::{Scene, World};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static COUNTED: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Surfaces, true disparities, true ranges, readings and bearings.
const MOST_PER_SCAN: usize = 5;

/// What sharing out the scans takes, whatever their number.
const MOST_ONCE: usize = 50;

/// A hall with 400 boxes, discs and triangles in turn, seen by a camera of so many columns.
fn hall(columns: usize, mismatches: &str) -> Scene {
    let mut text = format!(
        "name = \"hall\"\nbounds = {{ min = [-2.0, 0.0], max = [20.0, 20.0] }}\n\
         waypoints = {{ A = [-1.0, 2.0], B = [-1.0, 18.0] }}\nroute.stops = [\"A\", \"B\"]\n\
         camera = {{ columns = {columns}, field_of_view_deg = 120.0 }}\n[sensor]\nmismatches = \"{mismatches}\"\n"
    );
    for k in 0..400 {
        let [x, y] = [k % 20, k / 20].map(|v| f64::from(v) + 0.5);
        let _ = match k % 3 {
            0 => writeln!(text, "[[box]]\ncenter = [{x:?}, {y:?}]\nsize = [0.1, 0.2]\nrotation_deg = {}.0", k % 90),
            1 => writeln!(text, "[[disc]]\ncenter = [{x:?}, {y:?}]\nradius = 0.1"),
            _ => {
                writeln!(text, "[[polygon]]\npoints = [[{x:?}, {y:?}], [{:?}, {y:?}], [{x:?}, {:?}]]", x + 0.2, y + 0.2)
            }
        };
    }
    Scene::parse(&text, Path::new("hall.toml"), None).expect("a valid hall")
}

/// How often a drive's readings ask for memory on one thread, and the number of scans. The least of some times: the threads of
/// the pool and of the test harness now and then ask for something meanwhile.
fn allocations(columns: usize, mismatches: &str) -> [usize; 2] {
    let scene = hall(columns, mismatches);
    let (world, drive) = (World::new(&scene), scene::drive(&scene).expect("a free way"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    let times = (0..5).map(|_| {
        pool.install(|| {
            let before = Region::new(COUNTED);
            let simulation = scene::simulate(&scene, &world, &drive, 1);
            let change = before.change();
            let seen = simulation.scans.iter().flat_map(|scan| &scan.true_ranges_m).flatten().count();
            assert!(4 * seen > simulation.scans.len() * columns, "enough rays end on something: {seen}");
            [change.allocations + change.reallocations, simulation.scans.len()]
        })
    });
    times.min().expect("some times")
}

#[test]
fn memory_is_asked_for_by_scans_never_by_rays() {
    for mismatches in ["independent", "clustered"] {
        let [few, many] = [100, 1_000].map(|columns| allocations(columns, mismatches));
        assert_eq!(few, many, "{mismatches}: as often for 1,000 columns as for 100");
        let [asked, scans] = many;
        assert!(scans > 100, "{scans}");
        assert!((1..=MOST_PER_SCAN * scans + MOST_ONCE).contains(&asked), "{mismatches}: {asked} for {scans} scans");
    }
}
