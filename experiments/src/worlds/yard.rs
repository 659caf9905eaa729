//! Where drives that were planned on a map are driven: the world as it stands at one moment, without people.
//!
//! People have walked on before a planned drive comes to where they were; doors and chairs are still there.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use scene::{Drive, Obstacle, Scene, SeenBy, ThingKind, World};
use score::navigation::{Navigation, Planning};

/// The world at a moment, and the drives that are asked for in it.
pub struct Yard {
    /// The pairs of places, drawn from what stands there.
    pub navigation: Navigation,
    /// What stands in the way, where that is more than the obstacles of the scene.
    pub stopped: Option<World>,
}

/// The yards of a drive, made when they are first asked for. In a world at rest there is one.
#[derive(Default)]
pub struct Yards(Mutex<BTreeMap<usize, Arc<Yard>>>);

impl Yards {
    /// The yard after so many scans.
    pub fn after(&self, scans: usize, scene: &Scene, drive: &Drive, planning: Planning) -> Arc<Yard> {
        let mut yards = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let moment = if drive.motion.is_empty() { 0 } else { scans };
        yards.entry(moment).or_insert_with(|| Arc::new(Yard::after(scans, scene, drive, planning))).clone()
    }
}

impl Yard {
    fn after(scans: usize, scene: &Scene, drive: &Drive, planning: Planning) -> Self {
        if drive.motion.is_empty() {
            return Self { navigation: Navigation::new(&scene::truth(scene), planning), stopped: None };
        }
        let scene = stopped(scans, scene, drive);
        Self { navigation: Navigation::new(&scene::truth(&scene), planning), stopped: Some(World::new(&scene)) }
    }
}

/// The scene with its doors and chairs as they stood at the last of so many scans, at least one.
fn stopped(scans: usize, scene: &Scene, drive: &Drive) -> Scene {
    let mut scene = scene.clone();
    let motion = &drive.motion;
    let standing =
        motion.shapes_at(scans.saturating_sub(1)).filter(|(thing, _)| motion.kind(*thing) != ThingKind::Person);
    scene.obstacles.extend(standing.map(|(thing, shape)| Obstacle {
        shape: shape.clone(),
        texture: motion.texture(thing),
        seen_by: SeenBy::ALL,
        origin: motion.origin(thing).clone(),
    }));
    scene
}
