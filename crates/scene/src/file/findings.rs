//! All that is wrong with a scene or a family.

use crate::{Problem, SceneError};

/// What was found wrong so far, in the order in which a file is read.
pub(super) type Findings = strict::Findings<SceneError>;

impl strict::Finding for SceneError {
    fn problem(&self) -> Option<&strict::Problem> {
        match self {
            Self::Invalid { problem, .. } => match &**problem {
                Problem::File(problem) => Some(problem),
                _ => None,
            },
            Self::Unreadable { .. } => None,
        }
    }

    fn place(&self) -> Option<&strict::Place> {
        self.place()
    }
}
