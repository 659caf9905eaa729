//! Where drives that were planned on a map are driven: the world as it stands at one moment.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use scene::{Obstacle, Scene, World};
use score::navigation::{Navigation, Planning};

use super::run::Ground;

/// The world at a moment, and the drives that are asked for in it.
pub struct Yard {
    /// The pairs of places, drawn from the truth of the moment.
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
        let truth = ground.truth_after(scans);
        let stopped = ground.moves().then(|| World::new(&stopped(scans, ground)));
        Self { navigation: Navigation::new(&truth, planning), stopped }
    }

    /// What stands in the way.
    pub fn world<'a>(&'a self, ground: &'a Ground) -> &'a World {
        self.stopped.as_ref().unwrap_or(&ground.world)
    }
}

/// The scene with everything that moves standing where it was at the last of so many scans.
fn stopped(scans: usize, ground: &Ground) -> Scene {
    let mut scene = ground.scene.clone();
    if let Some(scan) = scans.checked_sub(1).filter(|_| ground.moves()) {
        let motion = &ground.drive.motion;
        scene.obstacles.extend(motion.shapes_at(scan).map(|(thing, shape)| Obstacle {
            shape: shape.clone(),
            texture: motion.texture(thing),
            origin: motion.origin(thing).clone(),
        }));
    }
    scene
}
