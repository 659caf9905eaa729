//! A log that is read as often as it is needed.

use logs::Log;

use super::options::{Body, ReplayOptions};
use crate::failure::Failure;
use crate::worlds::source::{Asked, Source};

pub(super) use crate::worlds::source::refused;

/// Where a log is and how to read it.
pub(super) struct Recording {
    source: Source,
    options: logs::Options,
}

impl Recording {
    /// The log that the options name; its trajectory is read. What a bag tells of its camera goes into the options. None where the
    /// topics of a bag were to be listed.
    pub(super) fn of(options: &mut ReplayOptions) -> Result<Option<Self>, Failure> {
        let body = match options.body {
            Body::Sensor => logs::Body::Sensor,
            Body::Robot => logs::Body::Robot,
        };
        let asked = Asked {
            command: "replay",
            path: &options.log,
            bag: &options.bag,
            trajectory: options.trajectory.as_deref(),
            body,
            focal_baseline: options.stereo.focal_baseline,
            given: &options.given,
        };
        let Some(source) = Source::open(&asked)? else { return Ok(None) };
        let stereo = &mut options.stereo;
        source.adapt(&options.given, &mut stereo.focal_baseline, &mut stereo.max_disparity);
        if !source.is_along() {
            options.given.warn(&["body"], &source.place(), "a log whose poses no file gives");
        }
        Ok(Some(Self { source, options: options.reading() }))
    }

    /// The log from its beginning.
    pub(super) fn scans(&self) -> Result<Log<'static>, Failure> {
        self.source.log(&self.options)
    }

    /// How messages call it.
    pub(super) fn place(&self) -> String {
        self.source.place()
    }
}
