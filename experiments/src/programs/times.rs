//! What the programs of this run have taken, the time in their processes told apart from ours.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use crate::output::note;

/// Seconds in processes and besides, by the names of the programs.
static TIMES: Mutex<BTreeMap<&'static str, [f64; 2]>> = Mutex::new(BTreeMap::new());

/// Adds what a program took since `start`, of which `process_s` seconds were spent waiting for it.
pub(super) fn add(program: &'static str, start: Instant, process_s: f64) {
    let besides_s = (start.elapsed().as_secs_f64() - process_s).max(0.0);
    let mut times = TIMES.lock().unwrap_or_else(PoisonError::into_inner);
    let [process, besides] = times.entry(program).or_default();
    *process += process_s;
    *besides += besides_s;
}

/// Prints what programs have taken since this was last called, in the order of their names.
pub fn tell() {
    let times = std::mem::take(&mut *TIMES.lock().unwrap_or_else(PoisonError::into_inner));
    for (program, [process, besides]) in times {
        note(format_args!(
            "{program}: {process:.2} s in its process, {besides:.2} s to write to it and to read from it"
        ));
    }
}
