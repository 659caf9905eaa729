//! A bag of which everything but the readings was read.

use std::path::Path;
use std::sync::Arc;

use bags::Bag;

use super::clock::Clock;
use super::contents::Contents;
use super::finding::BagFinding;
use super::options::BagOptions;
use super::plan::{self, Plan, Refusal};
use super::survey::{ScanKind, Survey};
use crate::error::LogError;

/// A bag with its poses, ready for its scans to be read, as often as wanted.
pub struct Drive {
    place: String,
    pub(super) bag: Bag,
    pub(super) plan: Plan,
    pub(super) clock: Clock,
    pub(super) findings: Vec<BagFinding>,
    pub(super) rows: usize,
    pub(super) focal_baseline: f64,
    contents: Contents,
    camera: Option<Camera>,
}

/// What messages tell of a stereo camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Focal length times baseline, px·m.
    pub focal_baseline: f64,
    /// The largest disparity that is searched, px; none where the messages do not say.
    pub max_disparity_px: Option<f64>,
}

impl Drive {
    /// Whether there is a bag at a path, by its first bytes or as a folder of rosbag2.
    pub fn is_at(path: &Path) -> bool {
        Bag::is_at(path)
    }

    /// Opens a bag and reads all but its readings.
    ///
    /// # Errors
    /// No bag; topics or frames that are not there, with those that are; frames that are not connected; [`LogError::Undecided`]
    /// where there is a choice that the options leave open.
    pub fn open(path: &Path, options: &BagOptions) -> Result<Arc<Self>, LogError> {
        Self::of(Bag::open(path).map_err(LogError::Bag)?, &path.display().to_string(), options)
    }

    /// As [`open`](Self::open), in memory; `place` names it in messages.
    ///
    /// # Errors
    /// As [`open`](Self::open).
    pub fn read(bytes: Vec<u8>, place: &str, options: &BagOptions) -> Result<Arc<Self>, LogError> {
        Self::of(Bag::read(bytes, place).map_err(LogError::Bag)?, place, options)
    }

    /// What a bag holds, whatever of it can be used.
    ///
    /// # Errors
    /// No bag.
    pub fn contents_of(path: &Path) -> Result<Contents, LogError> {
        let bag = Bag::open(path).map_err(LogError::Bag)?;
        let place = path.display().to_string();
        Survey::of(&bag).map(|survey| plan::contents(&survey)).map_err(|reason| refused(&place, reason))
    }

    fn of(bag: Bag, place: &str, options: &BagOptions) -> Result<Arc<Self>, LogError> {
        let focal = options.focal_baseline;
        if options.rows == 0 || !(focal > 0.0 && focal.is_finite()) {
            let reason = format!("rows is {}, and focal_baseline {focal}: both must be above 0", options.rows);
            return Err(refused(place, reason));
        }
        let survey = Survey::of(&bag).map_err(|reason| refused(place, reason))?;
        let damage = survey.findings.iter().find(|finding| matches!(finding, BagFinding::Damaged { .. }));
        if survey.is_empty {
            let why = damage.map_or_else(|| "it is empty".to_owned(), ToString::to_string);
            return Err(refused(place, format!("no message can be read of it: {why}")));
        }
        let contents = plan::contents(&survey);
        let plan = plan::plan(&survey, &contents, options).map_err(|Refusal { reason, is_open }| {
            let place = place.to_owned();
            if is_open {
                LogError::Undecided { place, reason, contents: Box::new(contents.clone()) }
            } else {
                let damage = damage.map(|damage| format!("; {damage}")).unwrap_or_default();
                LogError::Unusable { place, reason: reason + &damage }
            }
        })?;
        let findings = survey.findings.iter().chain(&plan.findings).filter(|finding| plan.concerns(finding)).cloned();
        Ok(Arc::new(Self {
            place: place.to_owned(),
            findings: findings.collect(),
            camera: camera(&plan, place)?,
            bag,
            clock: survey.clock,
            rows: options.rows,
            focal_baseline: focal,
            contents,
            plan,
        }))
    }

    /// How messages call the bag.
    pub fn place(&self) -> &str {
        &self.place
    }

    /// Everything that is in the bag.
    pub fn contents(&self) -> &Contents {
        &self.contents
    }

    /// What the messages of disparities tell of their camera; none where there are none.
    pub fn camera(&self) -> Option<Camera> {
        self.camera
    }
}

fn refused(place: &str, reason: String) -> LogError {
    LogError::Unusable { place: place.to_owned(), reason }
}

/// The one stereo camera of a bag: one kernel is made for all disparities.
fn camera(plan: &Plan, place: &str) -> Result<Option<Camera>, LogError> {
    let mut found: Option<(&str, Camera)> = None;
    for sensor in &plan.sensors {
        let ScanKind::Disparities { focal_baseline, max_px, .. } = sensor.kind else { continue };
        let max_disparity_px = Some(max_px).filter(|max| *max > 0.0 && max.is_finite());
        let camera = Camera { focal_baseline, max_disparity_px };
        match found {
            Some((other, known)) if (known.focal_baseline / focal_baseline - 1.0).abs() > 1e-3 => {
                return Err(refused(
                    place,
                    format!(
                        "{other} and {} are of cameras that differ: focal length times baseline is {} and {focal_baseline} px·m; give one of them \
                         by --scan",
                        sensor.topic, known.focal_baseline
                    ),
                ));
            }
            Some(_) => {}
            None => found = Some((&sensor.topic, camera)),
        }
    }
    Ok(found.map(|(_, camera)| camera))
}
