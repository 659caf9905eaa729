//! A log that is read as often as it is needed.

use std::path::PathBuf;

use logs::{Log, LogError, Trajectory};

use super::options::{Body, ReplayOptions};
use crate::failure::Failure;

/// Where a log is and how to read it.
pub(super) struct Recording {
    path: PathBuf,
    options: logs::Options,
    trajectory: Option<(Trajectory, logs::Body)>,
}

impl Recording {
    /// The log that the options name; its trajectory is read.
    pub(super) fn of(options: &ReplayOptions) -> Result<Self, Failure> {
        let body = match options.body {
            Body::Sensor => logs::Body::Sensor,
            Body::Robot => logs::Body::Robot,
        };
        let trajectory = match &options.trajectory {
            Some(path) => Some((Trajectory::open(path).map_err(refused)?, body)),
            None => None,
        };
        Ok(Self { path: options.log.clone(), options: options.reading(), trajectory })
    }

    /// The log from its beginning.
    pub(super) fn scans(&self) -> Result<Log<'static>, Failure> {
        let log = Log::open(&self.path, &self.options).map_err(refused)?;
        match &self.trajectory {
            Some((trajectory, body)) => log.along(trajectory.clone(), *body).map_err(refused),
            None => Ok(log),
        }
    }

    /// How messages call it.
    pub(super) fn place(&self) -> String {
        self.path.display().to_string()
    }
}

/// A log is input: what is wrong with it, the user can correct.
pub(super) fn refused(error: LogError) -> Failure {
    Failure::BadInput(error.to_string())
}
