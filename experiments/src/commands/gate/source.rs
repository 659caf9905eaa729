//! The files that the worlds of gates come from: families of scenes and single scenes.

use std::path::PathBuf;

use scene::{Family, Scene, SceneError};
use score::{MovingRegion, Region};

use crate::failure::Failure;
use crate::worlds::aligned::ALIGNED;
use crate::worlds::site::{Assumptions, Site, WorldId};

/// A scene file, or a file of a family of scenes.
#[derive(Debug, Clone)]
pub struct GateSource {
    /// Its name.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    content: Content,
}

#[derive(Debug, Clone)]
enum Content {
    Family(Box<Family>),
    Scene { regions: Vec<String>, moves: bool },
}

impl GateSource {
    /// Reads the file of a family.
    ///
    /// # Errors
    /// As [`Family::load`].
    pub fn family(path: PathBuf) -> Result<Self, SceneError> {
        let family = Family::load(&path)?;
        Ok(Self { name: family.name.clone(), path, content: Content::Family(Box::new(family)) })
    }

    /// Reads the file of a scene.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn scene(path: PathBuf) -> Result<Self, SceneError> {
        let scene = Scene::load(&path, None)?;
        let moves = scene.moves();
        let regions = scene.regions.into_iter().map(|region| region.name).collect();
        Ok(Self { name: scene.name, path, content: Content::Scene { regions, moves } })
    }

    /// Names of the regions that maps of it can be judged in.
    pub fn regions(&self) -> Vec<&str> {
        let own: &[String] = match &self.content {
            Content::Family(_) => &[],
            Content::Scene { regions, .. } => regions,
        };
        let moving = MovingRegion::ALL.iter().map(|region| region.name()).filter(|_| self.moves());
        Region::ALL
            .iter()
            .map(|region| region.name())
            .chain(own.iter().map(String::as_str))
            .chain([ALIGNED])
            .chain(moving)
            .collect()
    }

    /// Whether anything moves in it but the robot.
    pub fn moves(&self) -> bool {
        match &self.content {
            Content::Family(family) => family.moves(),
            Content::Scene { moves, .. } => *moves,
        }
    }

    /// Builds a world of it.
    ///
    /// # Errors
    /// A layout that cannot be made; a route that is blocked.
    pub fn site(&self, world: &WorldId) -> Result<Site, Failure> {
        let assumed = Assumptions::default();
        match &self.content {
            Content::Family(family) => Site::of_family(family, world, &assumed),
            Content::Scene { .. } => Site::of(Scene::load(&self.path, world.cell_m())?, world.condition()?, &assumed),
        }
    }
}
