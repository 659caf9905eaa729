//! Programs of somebody else's as mappers: each works in a process of its own, by the messages of `experiments/MAPPERS.md`.
//!
//! Such a program is not trusted: it may hang, flood its outputs, leave children behind or write anything for a map. What it
//! does wrong is a fault, which costs its own map alone.

use std::sync::atomic::{AtomicU64, Ordering};

mod adopted;
mod batch;
mod described;
mod exchange;
mod fault;
mod kept;
mod online;
pub mod options;
mod orphans;
mod process;
pub mod program;
pub mod serve;
mod talk;
pub mod times;
pub(crate) mod watcher;

/// A word that no other process or folder of this or another run is called by.
fn unique() -> String {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    let now = std::time::UNIX_EPOCH.elapsed().map_or(0, |since| since.as_nanos());
    format!("{}-{}-{now}", std::process::id(), NEXT.fetch_add(1, Ordering::SeqCst))
}
