//! Mappers that are done in a moment.

use mapper::catalogue::{Entry, MAPPERS};

/// All but `gibbs`, which draws as `gibbs-unchecked` does, for longer.
pub(crate) fn quick() -> impl Iterator<Item = &'static Entry> {
    MAPPERS.iter().filter(|entry| entry.name != "gibbs")
}
