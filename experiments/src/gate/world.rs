//! Where maps are made to judge them: families of scenes and single scenes.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use mapper::Model;
use mapper::Prior;
use scene::{Family, Scene, SceneError, Variation};
use score::Region;

use crate::compare::conditions::{AS_BELIEVED, Condition, condition};
use crate::failure::Failure;
use crate::trial::Ground;

/// A world to map: all that its readings follow from.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct World {
    /// Name of the family, or of the scene.
    pub family: String,
    /// Name of the condition, see [`crate::compare::conditions`].
    pub condition: &'static str,
    /// Side of a cell in µm, where it is not the scene's own.
    pub cell_um: Option<u32>,
    /// Seed of the readings; of a family, its layout too.
    pub seed: u64,
}

/// Micrometres in a metre.
pub const MICROMETRES: f64 = 1e6;

/// A scene file, or a file of a family of scenes.
#[derive(Debug, Clone)]
pub struct Site {
    /// Its name.
    pub name: String,
    /// Its file.
    pub path: PathBuf,
    kind: Kind,
}

#[derive(Debug, Clone)]
enum Kind {
    Family(Box<Family>),
    Scene { regions: Vec<String> },
}

impl World {
    /// Side of a cell in m, where it is not the scene's own.
    pub fn cell_m(&self) -> Option<f64> {
        self.cell_um.map(|cell_um| f64::from(cell_um) / MICROMETRES)
    }
}

impl fmt::Display for World {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} seed {}", self.family, self.condition, self.seed)?;
        self.cell_m().map_or(Ok(()), |cell_m| write!(f, ", cells of {cell_m} m"))
    }
}

impl Site {
    /// Reads the file of a family.
    ///
    /// # Errors
    /// As [`Family::load`].
    pub fn family(path: PathBuf) -> Result<Self, SceneError> {
        let family = Family::load(&path)?;
        Ok(Self { name: family.name.clone(), path, kind: Kind::Family(Box::new(family)) })
    }

    /// Reads the file of a scene.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn scene(path: PathBuf) -> Result<Self, SceneError> {
        let scene = Scene::load(&path, None)?;
        let regions = scene.regions.into_iter().map(|region| region.name).collect();
        Ok(Self { name: scene.name, path, kind: Kind::Scene { regions } })
    }

    /// Names of the regions that maps of it can be judged in.
    pub fn regions(&self) -> Vec<&str> {
        let own: &[String] = match &self.kind {
            Kind::Family(_) => &[],
            Kind::Scene { regions } => regions,
        };
        Region::ALL.iter().map(|region| region.name()).chain(own.iter().map(String::as_str)).collect()
    }

    /// Builds a world of it: its ground, and what the mappers believe of it. They believe the camera of the
    /// file, whatever the condition makes of it.
    ///
    /// # Errors
    /// A layout that cannot be made; a route that is blocked.
    pub fn ground(&self, world: &World) -> Result<(Ground, Model), Failure> {
        let Condition { size_factor, camera, .. } = *condition(world.condition).unwrap_or(&AS_BELIEVED);
        let mut scene = match &self.kind {
            Kind::Family(family) => family.scene(world.seed, world.cell_m(), &Variation { size_factor })?,
            Kind::Scene { .. } => Scene::load(&self.path, world.cell_m())?,
        };
        let prior = Prior::default();
        let setup = Model { prior, ..Model::new(scene.grid, Arc::new(scene.matcher.stereo)) };
        camera(&mut scene.matcher);
        Ok((Ground::new(scene, prior.occupancy)?, setup))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_size_is_the_number_that_was_given() {
        for cell_m in [0.05, 0.1, 0.2, 0.0375] {
            let cell_um = Some((cell_m * MICROMETRES).round() as u32);
            let world = World { family: "f".to_owned(), condition: AS_BELIEVED.name, cell_um, seed: 3 };
            assert_eq!(world.cell_m().map(f64::to_bits), Some(f64::to_bits(cell_m)));
        }
        let world = World { family: "f".to_owned(), condition: AS_BELIEVED.name, cell_um: Some(200_000), seed: 3 };
        assert_eq!(world.to_string(), "f as-believed seed 3, cells of 0.2 m");
    }
}
