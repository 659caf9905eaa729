//! A map to score, in the cells of the truth.

use std::path::{Path, PathBuf};

use grid::{Frame, Raster};
use score::{Resampling, resample};

use super::options::{ScoreOptions, Unknown};
use super::truth::{Truth, placed};
use crate::failure::Failure;
use crate::worlds::map_file::{self, Reading};

/// A map as a file has it, and where it lies.
pub(super) struct Candidate {
    /// What tables call it.
    pub(super) name: String,
    pub(super) path: PathBuf,
    pub(super) shares: Raster<Option<f32>>,
    /// The same in double precision, where that says something else.
    in_full: Option<Raster<Option<f64>>>,
    pub(super) frame: Frame,
    /// Whether its file says no place, so that it was given the truth's.
    pub(super) assumed: bool,
    pub(super) sources: Vec<PathBuf>,
    /// What is suspicious about it.
    pub(super) warnings: Vec<String>,
}

/// A map ready to be scored.
pub(super) struct Scorable {
    /// Probabilities in the cells of the truth, unknown cells as they count.
    pub(super) occupancy: Raster<f64>,
    /// The cells of which the map knows something.
    pub(super) known: Raster<bool>,
    /// The cells beyond its border.
    pub(super) outside: Raster<bool>,
    pub(super) how: Resampling,
}

impl Candidate {
    /// Reads a map and finds its place.
    pub(super) fn read(path: &Path, name: &str, truth: &Truth, options: &ScoreOptions) -> Result<Self, Failure> {
        let reading = Reading {
            shading: options.read_as.unwrap_or_default(),
            row_order: options.row_order.unwrap_or_default(),
            placed: false,
            in_full: true,
        };
        let map = map_file::read(path, reading)?;
        let (spec, same) = (*map.occupancy.spec(), |of: &grid::GridSpec| [of.width, of.height]);
        let (frame, assumed) = match placed(&map, options) {
            Some(frame) => (frame, false),
            None if same(&spec) == same(&truth.frame.spec) => (truth.frame, true),
            None => {
                return Err(Failure::BadInput(format!(
                    "{}: has no resolution and origin, and {} x {} cells where the truth has {} x {}; give --resolution M and --origin X,Y,YAW",
                    path.display(),
                    spec.width,
                    spec.height,
                    truth.frame.spec.width,
                    truth.frame.spec.height
                )));
            }
        };
        Ok(Self {
            name: name.to_owned(),
            path: path.to_owned(),
            shares: map.occupancy,
            in_full: map.in_full,
            frame,
            assumed,
            sources: map.sources,
            warnings: map.warnings.iter().map(ToString::to_string).collect(),
        })
    }

    /// Brings the map, were it at `frame`, into the cells of the truth.
    ///
    /// # Errors
    /// A map beside the truth; memory that the system does not give.
    pub(super) fn in_cells_of(
        &self,
        truth: &Truth,
        frame: &Frame,
        options: &ScoreOptions,
    ) -> Result<Scorable, Failure> {
        let finer = options.finer.into();
        let resampled = match &self.in_full {
            Some(shares) => resample(shares, frame, &truth.frame, finer),
            None => resample(&self.shares, frame, &truth.frame, finer),
        };
        let resampled = resampled.map_err(|error| Failure::BadInput(format!("{}: {error}", self.path.display())))?;
        let judged = truth.cells.values().iter().zip(resampled.outside.values());
        if judged.filter(|(cell, _)| cell.is_some()).all(|(_, outside)| *outside) {
            let at = |frame: &Frame| {
                let [x, y] = frame.spec.origin_m;
                let [width, height] = [frame.spec.width, frame.spec.height].map(|n| n as f64 * frame.spec.cell_m);
                format!("{width} x {height} m from ({x}, {y}) m")
            };
            return Err(Failure::BadInput(format!(
                "{}: covers {}, which holds no known cell of the truth, {}; correct its origin and resolution",
                self.path.display(),
                at(frame),
                at(&truth.frame)
            )));
        }
        let counts_as = match options.unknown {
            Unknown::Prior | Unknown::Skip => options.prior,
            Unknown::Occupied => 1.0,
        };
        let known = resampled.occupancy.map(|share| !share.is_nan());
        let mut occupancy = resampled.occupancy;
        occupancy.values_mut().iter_mut().filter(|share| share.is_nan()).for_each(|share| *share = counts_as);
        Ok(Scorable { occupancy, known, outside: resampled.outside, how: resampled.how })
    }
}

/// What tables call the maps: their files' names, or their paths where two would be the same.
pub(super) fn names(maps: &[PathBuf]) -> Result<Vec<String>, Failure> {
    let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let stems: Vec<String> = maps.iter().map(|path| stem(path)).collect();
    let twice = |name: &String| stems.iter().filter(|other| *other == name).count() > 1;
    let name = |(stem, path): (&String, &PathBuf)| if twice(stem) { path.display().to_string() } else { stem.clone() };
    let names: Vec<String> = stems.iter().zip(maps).map(name).collect();
    match names.iter().enumerate().find(|(k, name)| names[..*k].contains(name)) {
        Some((_, name)) => Err(Failure::BadInput(format!("{name}: must be named once; leave the second one out"))),
        None => Ok(names),
    }
}
