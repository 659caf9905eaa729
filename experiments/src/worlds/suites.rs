//! Robots with one, two or three sensors, in one world with panes of glass and thin legs: what a second sensor is worth.

use scene::{Mounted, Scene, SeenBy, Shape};
use score::Region;
use sensor::{Camera, Device, Laser, Pose, SensorKind, Sonar};

use super::condition::Carried;
use super::ground::Ground;
use super::sensed::Sensed;
use super::witness::Witness;
use crate::failure::Failure;

/// Radius of a leg, m.
const LEG_M: f64 = 0.03;

/// Obstacles that not every reading ends on, by their numbers in the scene.
#[derive(Debug, Default)]
pub(super) struct Furnished {
    glass: Vec<usize>,
    legs: Vec<usize>,
}

/// Has the robot of a scene carry these sensors and no others, and makes every third box of the scene a pane and every second disc a leg:
/// nothing becomes larger, so that the route stays free.
pub(super) fn equip(scene: &mut Scene, suite: &[Carried]) -> Furnished {
    let (mut furnished, mut boxes, mut discs) = (Furnished::default(), 0, 0);
    for (number, obstacle) in scene.obstacles.iter_mut().enumerate() {
        match &mut obstacle.shape {
            Shape::Disc { radius_m, .. } => {
                if discs % 2 == 0 {
                    *radius_m = radius_m.min(LEG_M);
                    obstacle.seen_by = SeenBy::ALL.with(SensorKind::Laser, 0.5);
                    furnished.legs.push(number);
                }
                discs += 1;
            }
            Shape::Box { .. } if obstacle.origin.kind == "box" => {
                if boxes % 3 == 0 {
                    obstacle.seen_by = SeenBy::ALL.with(SensorKind::Laser, 0.1).with(SensorKind::Stereo, 0.05);
                    furnished.glass.push(number);
                }
                boxes += 1;
            }
            _ => {}
        }
    }
    if !suite.contains(&Carried::Camera) {
        scene.camera = Camera { columns: 0, ..scene.camera };
    }
    let mounted = |carried: &Carried| match carried {
        Carried::Camera => None,
        Carried::Laser => Some(laser()),
        Carried::Sonar => Some(sonars()),
    };
    scene.sensors = suite.iter().filter_map(mounted).collect();
    furnished
}

fn laser() -> Mounted {
    let beams = 90;
    let bearing = |beam: usize| std::f64::consts::PI * ((beam as f64 + 0.5) / beams as f64 - 0.5);
    Mounted {
        name: "laser".to_owned(),
        device: Device::Laser(Laser { max_range_m: 30.0, ..Laser::default() }),
        mount: Pose { x_m: 0.1, ..Pose::default() },
        bearings_rad: (0..beams).map(bearing).collect(),
        every: 1,
        grazing_rad: 0.0,
    }
}

fn sonars() -> Mounted {
    let cones = 16;
    let bearing = |cone: usize| std::f64::consts::TAU * ((cone as f64 + 0.5) / cones as f64 - 0.5);
    Mounted {
        name: "ring".to_owned(),
        device: Device::Sonar(Sonar { max_range_m: 4.0, ..Sonar::default() }),
        mount: Pose::default(),
        bearings_rad: (0..cones).map(bearing).collect(),
        every: 1,
        grazing_rad: 0.0,
    }
}

/// What a robot with all three sensors, of this camera, can see of a scene that is equipped.
///
/// # Errors
/// A route that is blocked.
pub(super) fn sensed(scene: &Scene, furnished: &Furnished, camera: Camera, prior: f64) -> Result<Sensed, Failure> {
    let mut scene = scene.clone();
    (scene.camera, scene.sensors) = (camera, vec![laser(), sonars()]);
    let covered = |numbers: &[usize]| {
        let mut only = scene.clone();
        only.obstacles = numbers.iter().map(|number| scene.obstacles[*number].clone()).collect();
        scene::truth(&only).map(|occupied| *occupied == Some(true))
    };
    let [glass, legs] = [&furnished.glass, &furnished.legs].map(|numbers| covered(numbers));
    let ground = Ground::new(scene, prior)?;
    // What could be seen is without noise: any seed.
    let simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, 0);
    let mut witness = Witness::new(&ground);
    simulation.scans.iter().enumerate().try_for_each(|(k, scan)| witness.look(&ground, k, scan))?;
    let regions = [witness.seen.mask(Region::Observable), glass, legs];
    Ok(Sensed { surface: witness.seen.surface().clone(), regions })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worlds::condition::SUITES;
    use crate::worlds::site::{Assumptions, Site, WorldId};

    fn site(condition: &str) -> Site {
        let text = include_str!("../../../scenes/clutter.toml");
        let family = scene::Family::parse(text, std::path::Path::new("clutter.toml")).expect("a family");
        let world = WorldId { family: "clutter".into(), condition: condition.into(), cell_um: None, seed: 1 };
        Site::of_family(&family, &world, &Assumptions::default()).expect("a site")
    }

    /// The suites of one world differ in the sensors alone: the same things, the same way, the same cells to be judged by.
    #[test]
    fn suites_share_world_and_regions() {
        let sites = SUITES.map(|suite| site(suite.name));
        let all = sites[6].ground.sensed.as_ref().expect("a suite");
        for (site, suite) in sites.iter().zip(&SUITES) {
            let sensed = site.ground.sensed.as_ref().expect("a suite");
            assert_eq!((&sensed.surface, &sensed.regions), (&all.surface, &all.regions), "{}", suite.name);
            assert_eq!(site.ground.truth, sites[0].ground.truth);
            let carried = suite.suite.expect("a suite");
            assert_eq!(site.ground.scene.camera.columns > 0, carried.contains(&Carried::Camera));
            assert_eq!(site.ground.scene.sensors.len(), carried.iter().filter(|one| **one != Carried::Camera).count());
            assert_eq!(site.setup.sensors.iter().len(), 1 + site.ground.scene.sensors.len());
        }
        for (name, mask) in all.by_name() {
            assert!(mask.values().iter().any(|inside| *inside), "{name}");
        }
        let seen_of_glass = all.regions[1].values().iter().zip(all.surface.values()).filter(|(g, s)| **g && **s);
        assert!(seen_of_glass.count() > 10, "glass stands in sight");
    }
}
