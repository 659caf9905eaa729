//! The files that the worlds of gates come from: families of scenes and single scenes.

use std::path::PathBuf;

use scene::{Family, Scene, SceneError};
use score::Region;

use crate::failure::Failure;
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
    Scene { regions: Vec<String> },
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
        let regions = scene.regions.into_iter().map(|region| region.name).collect();
        Ok(Self { name: scene.name, path, content: Content::Scene { regions } })
    }

    /// Names of the regions that maps of it can be judged in.
    pub fn regions(&self) -> Vec<&str> {
        let own: &[String] = match &self.content {
            Content::Family(_) => &[],
            Content::Scene { regions } => regions,
        };
        Region::ALL.iter().map(|region| region.name()).chain(own.iter().map(String::as_str)).collect()
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
