//! What is true: a scene, or a map that is believed.

use std::path::PathBuf;

use grid::{Frame, GridSpec, Raster};
use scene::Scene;

use super::options::ScoreOptions;
use crate::failure::Failure;
use crate::output::{note, warn};
use crate::worlds::map_file::{self, MapFile, Reading, extension};

/// The truth and where it lies.
pub(super) struct Truth {
    /// Its cells.
    pub(super) frame: Frame,
    /// Occupied, free, or not known.
    pub(super) cells: Raster<Option<bool>>,
    /// The scene that it comes from, if any.
    pub(super) scene: Option<Scene>,
    /// The files that it was read from.
    pub(super) sources: Vec<PathBuf>,
}

impl Truth {
    /// Reads the truth and says what is suspicious about it.
    pub(super) fn read(options: &ScoreOptions) -> Result<Self, Failure> {
        let is_map = ["yaml", "yml", "npy", "pgm", "png"].contains(&extension(&options.truth).as_str());
        let truth = if is_map { Self::of_map(options)? } else { Self::of_scene(options)? };
        if truth.cells.values().iter().all(Option::is_none) {
            return Err(Failure::BadInput(format!(
                "{}: knows none of its {} cells to be free or occupied, so that there is nothing to score; give another truth",
                options.truth.display(),
                truth.cells.spec().cells()
            )));
        }
        Ok(truth)
    }

    fn of_scene(options: &ScoreOptions) -> Result<Self, Failure> {
        let scene = scene::load(&options.truth, options.grid, options.layout)?;
        warn(&scene.warnings);
        if scene.moves() {
            let path = options.truth.display();
            warn(&[format!(
                "{path}: things move in it, and maps are held against what does not; `room` scores them at every moment, and its truth.npy is the truth at the end"
            )]);
        }
        let cells = scene::truth(&scene);
        let frame = Frame::straight(scene.grid);
        Ok(Self { frame, cells, scene: Some(scene), sources: vec![options.truth.clone()] })
    }

    fn of_map(options: &ScoreOptions) -> Result<Self, Failure> {
        for (name, given) in [("--grid", options.grid.is_some()), ("--layout", options.layout.is_some())] {
            if given {
                return Err(Failure::BadInput(format!(
                    "{name}: must stand with a scene as the truth, not {}; leave it out",
                    options.truth.display()
                )));
            }
        }
        let reading = Reading { shading: options.read_as.unwrap_or_default(), ..Reading::default() };
        let map = map_file::read(&options.truth, reading)?;
        warn(&map.warnings);
        let Some(frame) = placed(&map, options) else {
            return Err(Failure::BadInput(format!(
                "{}: has no resolution and origin; give --resolution M and --origin X,Y,YAW, which hold for all files without a place",
                options.truth.display()
            )));
        };
        let cells = Raster::new(frame.spec, map.occupancy.map(|&share| map.thresholds.state(share)).values().to_vec());
        let between = map
            .occupancy
            .values()
            .iter()
            .zip(cells.values())
            .filter(|(share, state)| share.is_some() && state.is_none());
        let between = between.count();
        if between > 0 {
            note(format_args!(
                "warning: {}: {between} of {} cells lie between {} and {}, neither free nor occupied: they are not scored",
                options.truth.display(),
                frame.spec.cells(),
                map.thresholds.free,
                map.thresholds.occupied
            ));
        }
        Ok(Self { frame, cells, scene: None, sources: map.sources })
    }

    /// Free, occupied and unknown cells.
    pub(super) fn counts(&self) -> [usize; 3] {
        [Some(false), Some(true), None].map(|state| self.cells.values().iter().filter(|cell| **cell == state).count())
    }
}

/// Where a map lies: as its file says, else as the options say.
pub(super) fn placed(map: &MapFile, options: &ScoreOptions) -> Option<Frame> {
    if let Some((spec, yaw_rad)) = map.place {
        return Some(Frame { spec, yaw_rad });
    }
    let (cell_m, origin) = options.resolution.zip(options.origin)?;
    let spec = GridSpec { cell_m, origin_m: origin.corner_m, ..*map.occupancy.spec() };
    Some(Frame { spec, yaw_rad: origin.yaw_rad })
}
