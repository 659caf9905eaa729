//! How many threads to use.

use crate::failure::Failure;

/// Limits what runs in parallel to so many threads, all processors if not given.
///
/// # Errors
/// More threads than the system gives.
pub fn limit(threads: Option<u32>) -> Result<(), Failure> {
    let Some(threads) = threads else { return Ok(()) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads as usize);
    pool.build_global().map_err(|e| Failure::BadInput(format!("--threads {threads}: {e}; ask for fewer")))
}
