//! Where drives that were planned on a map are driven: the world as it stands at one moment, without people.
//!
//! People have walked on before a planned drive comes to where they were; doors and chairs are still there.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use scene::{Obstacle, Scene, ThingKind, World};
use score::navigation::{Navigation, Planning};

use super::run::Ground;

/// The world at a moment, and the drives that are asked for in it.
pub struct Yard {
    /// The pairs of places, drawn from what stands there.
    pub navigation: Navigation,
    /// What stands in the way, where that is more than the obstacles of the scene.
    stopped: Option<World>,
}

/// The yards of a drive, made when they are first asked for. In a world at rest there is one.
#[derive(Default)]
pub struct Yards(Mutex<BTreeMap<usize, Arc<Yard>>>);

impl Yards {
    /// The yard after so many scans.
    pub fn after(&self, scans: usize, ground: &Ground, planning: Planning) -> Arc<Yard> {
        let mut yards = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let moment = if ground.moves() { scans } else { 0 };
        yards.entry(moment).or_insert_with(|| Arc::new(Yard::after(scans, ground, planning))).clone()
    }
}

impl Yard {
    fn after(scans: usize, ground: &Ground, planning: Planning) -> Self {
        if !ground.moves() {
            return Self { navigation: Navigation::new(ground.still(), planning), stopped: None };
        }
        let scene = stopped(scans, ground);
        Self { navigation: Navigation::new(&scene::truth(&scene), planning), stopped: Some(World::new(&scene)) }
    }

    /// What stands in the way.
    pub fn world<'a>(&'a self, ground: &'a Ground) -> &'a World {
        self.stopped.as_ref().unwrap_or(&ground.world)
    }
}

/// The scene with its doors and chairs as they stood at the last of so many scans, at least one.
fn stopped(scans: usize, ground: &Ground) -> Scene {
    let mut scene = ground.scene.clone();
    let motion = &ground.drive.motion;
    let standing =
        motion.shapes_at(scans.saturating_sub(1)).filter(|(thing, _)| motion.kind(*thing) != ThingKind::Person);
    scene.obstacles.extend(standing.map(|(thing, shape)| Obstacle {
        shape: shape.clone(),
        texture: motion.texture(thing),
        origin: motion.origin(thing).clone(),
    }));
    scene
}
