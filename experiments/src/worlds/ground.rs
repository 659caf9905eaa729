//! What does not depend on the seed: a scene, the way through it, and what is true of it at every moment.

use std::borrow::Cow;

use grid::Raster;
use scene::{Drive, Scene, World};
use score::navigation::Planning;

use super::drives::DriveOptions;
use super::poses::WrongPoses;
use super::sensed::Sensed;
use super::yard::Yards;
use crate::failure::Failure;

/// What does not depend on the seed: the scene, the way through it, and the truth.
pub struct Ground {
    /// The scene.
    pub scene: Scene,
    /// What rays are cast in.
    pub world: World,
    /// The robot's poses.
    pub drive: Drive,
    /// The truth at the end of the drive: occupied, free, or not known and not scored.
    pub truth: Raster<Option<bool>>,
    /// The truth without what moves, where anything does.
    still: Option<Raster<Option<bool>>>,
    /// Occupancy that the mappers expect of an unseen cell: what pictures show as not known.
    pub prior: f64,
    /// How wrong the poses are that mappers are told.
    pub poses: WrongPoses,
    /// What suites of sensors have in common to be judged by; none of a robot with its own sensors.
    pub sensed: Option<Sensed>,
    /// How drives are planned on the maps ...
    pub planning: Planning,
    /// ... and on which of them.
    pub driven: Driven,
    /// The drives, drawn when the first map is scored.
    pub(super) yards: Yards,
}

/// The maps on which drives are planned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Driven {
    /// Those at the end of every stage.
    EveryStage,
    /// Those at the end of the drive.
    #[default]
    Last,
}

impl Ground {
    /// Loads the scene's world, drives the route, and rasters the truth.
    ///
    /// # Errors
    /// A route that is blocked.
    pub fn new(scene: Scene, prior: f64) -> Result<Self, Failure> {
        let drive = scene::drive(&scene)?;
        let ground = Self {
            world: World::new(&scene),
            truth: scene::truth(&scene),
            still: None,
            drive,
            poses: WrongPoses::NONE,
            sensed: None,
            planning: DriveOptions::default().planning(scene.robot.radius_m),
            driven: Driven::default(),
            yards: Yards::default(),
            scene,
            prior,
        };
        Ok(ground.at_its_end())
    }

    /// The same, with the truth of the end of the drive.
    fn at_its_end(mut self) -> Self {
        if self.moves() {
            self.still.get_or_insert_with(|| self.truth.clone());
            self.truth = self.truth_after(self.scans()).into_owned();
        }
        self
    }

    /// Whether anything moves but the robot.
    pub fn moves(&self) -> bool {
        !self.drive.motion.is_empty()
    }

    /// The truth without what moves.
    pub fn still(&self) -> &Raster<Option<bool>> {
        self.still.as_ref().unwrap_or(&self.truth)
    }

    /// The cells that moving things cover at a scan, counted from 0.
    pub fn covered_at(&self, scan: usize) -> Raster<bool> {
        scene::covered_at(&self.scene, &self.drive, scan)
    }

    /// The truth as it was at the last of so many scans: occupied is what stands there, moving or not.
    pub fn truth_after(&self, scans: usize) -> Cow<'_, Raster<Option<bool>>> {
        let Some(scan) = scans.checked_sub(1).filter(|_| self.moves()) else { return Cow::Borrowed(self.still()) };
        let mut truth = self.still().clone();
        for (cell, covered) in truth.values_mut().iter_mut().zip(self.covered_at(scan).values()) {
            if *cell == Some(false) {
                *cell = Some(*covered);
            }
        }
        Cow::Owned(truth)
    }

    /// Leaves in the drive the scans of these numbers, from 0 and rising, as one stage: that of the last one.
    pub fn with_scans(mut self, scans: &[usize]) -> Self {
        self.drive.poses = scans.iter().map(|scan| self.drive.poses[*scan]).collect();
        self.drive.motion = self.drive.motion.at(scans);
        if let Some((name, _)) = self.drive.stage_ends.pop() {
            self.drive.stage_ends = vec![(name, scans.len())];
        }
        self.at_its_end()
    }

    /// Has drives planned as the options say, on these maps.
    pub fn with_drives(self, options: &DriveOptions, driven: Driven) -> Self {
        let planning = options.planning(self.scene.robot.radius_m);
        Self { planning, driven, yards: Yards::default(), ..self }
    }

    /// Has mappers told poses that are so wrong; all of them are told the same.
    pub fn with_poses(self, poses: WrongPoses) -> Self {
        Self { poses, ..self }
    }

    /// Has no drives planned: scores take less time.
    pub fn without_drives(mut self) -> Self {
        self.planning.pairs = 0;
        self
    }

    /// Number of scans of one drive.
    pub fn scans(&self) -> usize {
        self.drive.poses.len()
    }
}
