//! Scans of a scene, as its robot takes them.

use std::path::Path;

use super::scans::{Carrier, ScanSet};
use crate::failure::Failure;
use crate::worlds::condition::AS_BELIEVED;
use crate::worlds::site::{Assumptions, Site};

/// The seed of the readings.
const SEED: u64 = 1;

/// The scans of all sensors of a scene, or of the first layout of a family, and how mappers know them.
///
/// # Errors
/// A scene that cannot be read or driven through; a robot that reads nothing.
pub(super) fn load(path: &Path) -> Result<ScanSet, Failure> {
    let scene = scene::load(path, None, None)?;
    let Site { ground, setup } = Site::of(scene, &AS_BELIEVED, &Assumptions::default())?;
    let names = ["camera"].into_iter().chain(ground.scene.sensors.iter().map(|sensor| sensor.name.as_str()));
    let all: Vec<Carrier> =
        names.zip(setup.sensors.iter()).map(|(name, model)| Carrier::new(name, model.clone())).collect();
    let simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, SEED);
    let mut scans: Vec<_> = simulation.scans.iter().flat_map(|simulated| simulated.together()).collect();
    // A robot without a camera has other sensors from number 1 on.
    let first = scans.iter().map(|scan| scan.sensor).min().unwrap_or(0);
    scans.iter_mut().for_each(|scan| scan.sensor -= first);
    let mut set = ScanSet::of(all.into_iter().skip(first).collect());
    scans.iter().for_each(|scan| set.add(scan));
    set.on_map(ground.truth.spec());
    Ok(set)
}
