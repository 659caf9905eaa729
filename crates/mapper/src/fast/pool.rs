//! Working memory that a map and its copies share.

use std::sync::{Arc, Mutex, PoisonError};

use crate::fast::scan::Workspace;
use crate::fast::tiles::Numbering;
use crate::memory::Held;

/// Working memory of a map and of all that were copied from it: as many pieces as were ever at work at once. A piece holds nothing
/// from one scan to the next that a result depends on, so that it does not matter which of them a scan is given.
#[derive(Clone)]
pub(super) struct Pool {
    numbering: Numbering,
    idle: Arc<Mutex<Vec<Workspace>>>,
}

impl Pool {
    /// One piece.
    pub(super) fn new(numbering: Numbering) -> Self {
        Self { numbering, idle: Arc::new(Mutex::new(vec![Workspace::new(numbering)])) }
    }

    /// A piece to work with, made where all are at work.
    pub(super) fn take(&self) -> Workspace {
        let taken = self.idle.lock().unwrap_or_else(PoisonError::into_inner).pop();
        taken.unwrap_or_else(|| Workspace::new(self.numbering))
    }

    /// Takes a piece back.
    pub(super) fn give_back(&self, workspace: Workspace) {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner).push(workspace);
    }
}

/// The share of one map in the pieces that are idle.
impl Held for Pool {
    fn held(&self) -> usize {
        let idle = self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        idle.iter().map(Held::held).sum::<usize>() / Arc::strong_count(&self.idle)
    }
}
