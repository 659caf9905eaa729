//! Mapping the same scans by every mapper, with a clock.

use std::hint::black_box;
use std::time::Instant;

use mapper::Model;
use mapper::catalogue::Entry;
use mapper::{Mapper, Outside, Work, moments};

use super::scans::{ScanSet, Visited};
use super::world::Known;
use crate::failure::Failure;

/// What one mapper took for the scans.
#[derive(Debug, Clone)]
pub struct Speed {
    /// Name of the mapper.
    pub mapper: &'static str,
    /// Time of every repeat, s, least first.
    pub seconds: Vec<f64>,
    /// What it did and held in a repeat.
    pub work: Work,
    /// Of the cells of `work`, those that rays leapt over.
    pub skipped: u64,
    /// What became of the program, of a mapper that works in another process: in the last repeat, or in the first that failed.
    pub outside: Option<Outside>,
}

/// The mappers in the order of a repeat: each begins once before any begins twice, so that what the machine does
/// meanwhile, and what a mapper leaves in its caches, hits all alike.
pub fn rotated<T>(mappers: &[T], repeat: usize) -> impl Iterator<Item = (usize, &T)> {
    let first = repeat % mappers.len().max(1);
    mappers.iter().enumerate().cycle().skip(first).take(mappers.len())
}

/// Maps the scans so many times by every mapper, in turns; `watch` is told of every map that is finished.
///
/// # Errors
/// A mapper that counts its cells and did fewer than the rays ask for: its time would be worth nothing.
pub fn measure(
    entries: &[&'static Entry],
    setup: &Model,
    (set, world): (&ScanSet, Known),
    visited: &Visited,
    repeats: usize,
    watch: impl Fn(),
) -> Result<Vec<Speed>, Failure> {
    let mut speeds: Vec<Speed> =
        entries.iter().map(|entry| Speed::of(entry.name, Vec::new(), Work::default())).collect();
    for repeat in 0..repeats {
        for (number, entry) in rotated(entries, repeat) {
            let speed = &mut speeds[number];
            if speed.fault().is_none() {
                let Done { seconds, work, skipped, leaves_out, outside } = once(entry, setup, set, world);
                check(entry.name, work, leaves_out, visited)?;
                speed.seconds.push(seconds);
                (speed.work, speed.skipped, speed.outside) = (work, skipped, outside);
            }
            watch();
        }
    }
    for speed in &mut speeds {
        speed.seconds.sort_by(f64::total_cmp);
        if speed.fault().is_some() {
            speed.seconds.clear();
        }
    }
    Ok(speeds)
}

/// One map from all scans.
struct Done {
    /// Time, s, without that for the unseen map.
    seconds: f64,
    work: Work,
    skipped: u64,
    leaves_out: bool,
    outside: Option<Outside>,
}

fn once(entry: &Entry, setup: &Model, set: &ScanSet, world: Known) -> Done {
    if world == Known::Unknown {
        return one_by_one(entry, setup, set);
    }
    let mut mapper = (entry.build)(setup);
    // What several sensors read at one time is one scan.
    let take = |mapper: &mut dyn Mapper| moments(&set.scans).for_each(|scans| mapper.integrate_together(scans));
    if world == Known::Settled {
        (0..2).for_each(|_| take(&mut *mapper));
    }
    let before = [mapper.work().cells, mapper.skipped()];
    let start = Instant::now();
    take(&mut *mapper);
    mapper.settle();
    let seconds = start.elapsed().as_secs_f64();
    // What it holds before it shows its map to others, which may take a copy.
    let Work { cells, bytes } = mapper.work();
    let work = Work { cells: cells - before[0], bytes };
    black_box(mapper.occupancy());
    let skipped = mapper.skipped() - before[1];
    Done { seconds, work, skipped, leaves_out: mapper.leaves_out(), outside: mapper.outside().cloned() }
}

/// Every scan on a map of its own, without the time to make it.
fn one_by_one(entry: &Entry, setup: &Model, set: &ScanSet) -> Done {
    let mut done = Done { seconds: 0.0, work: Work::default(), skipped: 0, leaves_out: false, outside: None };
    for scans in moments(&set.scans) {
        let mut mapper = (entry.build)(setup);
        let start = Instant::now();
        mapper.integrate_together(scans);
        done.seconds += start.elapsed().as_secs_f64();
        let work = mapper.work();
        done.work = Work { cells: done.work.cells + work.cells, bytes: done.work.bytes.max(work.bytes) };
        done.skipped += mapper.skipped();
        done.leaves_out |= mapper.leaves_out();
        black_box(mapper.occupancy());
    }
    done
}

/// Whether a mapper that counts did what the rays ask for, or has a rule that asks for less.
fn check(name: &str, work: Work, leaves_out: bool, visited: &Visited) -> Result<(), Failure> {
    if work.cells == 0 || leaves_out || work.cells >= visited.owed {
        return Ok(());
    }
    Err(Failure::Internal(format!(
        "{name}: updated {} cells; must be at least the {} that lie between sensors and ends of ranges; its time is not \
         that of the work, and the mapper is to be mended",
        work.cells, visited.owed
    )))
}

impl Speed {
    /// The speed of a mapper that took so long, s, in its repeats.
    pub fn of(mapper: &'static str, mut seconds: Vec<f64>, work: Work) -> Self {
        seconds.sort_by(f64::total_cmp);
        Self { mapper, seconds, work, skipped: 0, outside: None }
    }

    /// Why a program has no time: it gave no map.
    pub fn fault(&self) -> Option<&str> {
        self.outside.as_ref()?.fault.as_deref()
    }

    /// Time of the best repeat, s.
    pub fn best_s(&self) -> f64 {
        self.seconds.first().copied().unwrap_or(f64::NAN)
    }

    /// Time of the middle repeat, s; of an even number, the mean of the two.
    pub fn median_s(&self) -> f64 {
        let (half, odd) = (self.seconds.len() / 2, self.seconds.len() % 2 == 1);
        match self.seconds.get(half) {
            Some(middle) if odd => *middle,
            Some(upper) => 0.5 * (self.seconds[half - 1] + upper),
            None => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use grid::Raster;
    use mapper::catalogue::Kind;
    use sensor::{Pose, Scan, Stereo};

    use super::*;

    /// Updates the first cell of every ray, and says so.
    struct Lazy {
        occupancy: Raster<f64>,
        cells: u64,
    }

    impl Mapper for Lazy {
        fn integrate(&mut self, scan: &Scan) {
            self.cells += scan.rays().filter(|ray| ray.reading.is_some()).count() as u64;
        }

        fn occupancy(&self) -> &Raster<f64> {
            &self.occupancy
        }

        fn work(&self) -> Work {
            Work { cells: self.cells, ..Work::default() }
        }
    }

    const LAZY: Entry = Entry {
        name: "lazy",
        summary: "",
        source: "",
        kind: Kind::Online,
        build: &|setup| Box::new(Lazy { occupancy: Raster::filled(setup.grid, 0.5), cells: 0 }),
    };

    fn set() -> (ScanSet, Model) {
        let mut set = ScanSet::default();
        set.begin(Pose::default());
        [-0.5, 0.0, 0.5].into_iter().for_each(|bearing| set.ray(bearing, Some(2.0)));
        let grid = set.grid(0.1).expect("small");
        let sensor = Arc::new(Stereo::default());
        (set, Model::new(grid, sensor))
    }

    #[test]
    fn a_mapper_that_leaves_cells_out_is_caught() {
        let (set, setup) = set();
        let visited = set.visited(&setup.grid);
        let error =
            measure(&[&LAZY], &setup, (&set, Known::Mixed), &visited, 1, || ()).expect_err("three cells of sixty");
        assert!(matches!(error, Failure::Internal(_)));
        let message = error.to_string();
        assert!(
            message.starts_with(&format!("lazy: updated 3 cells; must be at least the {} ", visited.owed)),
            "{message}"
        );
    }

    #[test]
    fn every_mapper_of_the_catalogue_does_its_work() {
        let (set, setup) = set();
        let visited = set.visited(&setup.grid);
        // `gibbs` draws as `gibbs-unchecked` does, for longer.
        let entries = mapper::catalogue::MAPPERS.iter().filter(|entry| entry.name != "gibbs");
        let entries: Vec<&'static Entry> = entries.collect();
        let speeds = measure(&entries, &setup, (&set, Known::Mixed), &visited, 2, || ()).expect("all work");
        assert!(speeds.iter().all(|speed| speed.seconds.len() == 2 && speed.seconds[0] > 0.0));
        let log_odds = speeds.iter().find(|speed| speed.mapper == "log-odds-octomap").expect("in the catalogue");
        assert!((visited.owed..=visited.cells).contains(&log_odds.work.cells), "{log_odds:?} {visited:?}");
    }

    #[test]
    fn every_mapper_has_its_turn_first() {
        let order = |repeat| rotated(&["a", "b", "c"], repeat).map(|(_, name)| *name).collect::<String>();
        assert_eq!([0, 1, 2, 3].map(order), ["abc", "bca", "cab", "abc"]);
    }

    #[test]
    fn best_and_median() {
        let of = |seconds: &[f64]| Speed::of("", seconds.to_vec(), Work::default());
        let speeds = [of(&[1.0]), of(&[3.0, 1.0]), of(&[9.0, 1.0, 2.0])];
        assert_eq!(speeds.map(|s| format!("{} {}", s.best_s(), s.median_s())), ["1 1", "1 2", "1 2"]);
    }
}
