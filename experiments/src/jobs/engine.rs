//! Many worlds over all processors.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::failure::Failure;

/// Does `work` on every job, one job to a thread at a time, and gives the results in the order of the
/// jobs. The first failure ends it; jobs that run are finished.
///
/// Each thread has a pool of its own for what is parallel inside a job: a thread that waits would
/// otherwise begin another job in the middle of its own, and hold the memory of both.
///
/// # Errors
/// The failure of the first job, in their order, that failed; threads that the system will not give.
pub fn each<J: Sync, T: Send>(
    jobs: &[J],
    threads: usize,
    work: impl Fn(&J) -> Result<T, Failure> + Sync,
) -> Result<Vec<T>, Failure> {
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let done: Vec<Mutex<Option<Result<T, Failure>>>> = jobs.iter().map(|_| Mutex::new(None)).collect();
    let worker = || {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(Failure::internal)?;
        pool.install(|| {
            while !failed.load(Ordering::Relaxed) {
                let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|n| *n < jobs.len()) else {
                    break;
                };
                let result = work(&jobs[number]);
                failed.fetch_or(result.is_err(), Ordering::Relaxed);
                if let Ok(mut place) = done[number].lock() {
                    *place = Some(result);
                }
            }
        });
        Ok::<(), Failure>(())
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads.clamp(1, jobs.len().max(1))).map(|_| scope.spawn(worker)).collect();
        workers.into_iter().try_for_each(|worker| {
            worker.join().unwrap_or_else(|_| Err(Failure::Internal("a worker thread has died".to_owned())))
        })
    })?;
    let results = done.into_iter().filter_map(|place| place.into_inner().ok().flatten());
    results.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_the_order_of_the_jobs_whatever_the_threads() {
        let jobs: Vec<u32> = (0..100).collect();
        for threads in [0, 1, 3, 200] {
            let squares = each(&jobs, threads, |job| Ok(job * job)).expect("no failure");
            assert_eq!(squares, jobs.iter().map(|job| job * job).collect::<Vec<_>>());
        }
        assert_eq!(each(&[], 2, |job: &u32| Ok(*job)).expect("nothing to do"), [] as [u32; 0]);
    }

    #[test]
    fn the_first_failure_ends_it() {
        let ran = AtomicUsize::new(0);
        let result = each(&(0..1000).collect::<Vec<u32>>(), 2, |job| {
            ran.fetch_add(1, Ordering::Relaxed);
            if *job >= 5 { Err(Failure::BadInput(format!("job {job}"))) } else { Ok(*job) }
        });
        assert_eq!(result.expect_err("failed").to_string(), "job 5");
        assert!(ran.into_inner() < 20);
    }
}
