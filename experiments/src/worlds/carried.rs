//! Scans with the places of their sensors on the robot.

use scene::SimulatedScan;
use sensor::{Pose, Scan};
use slam::Mounted;

/// A scan, and where its sensor stands on the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Carried {
    pub scan: Scan,
    pub mount: Pose,
}

/// What all sensors of a simulated robot read at one time, by rising numbers.
pub fn carried(simulated: &SimulatedScan) -> Vec<Carried> {
    let mount = |number: usize| {
        let beside = simulated.beside.iter().find(|beside| beside.scan.sensor == number);
        beside.map_or_else(Pose::default, |beside| beside.mount)
    };
    simulated.together().into_iter().map(|scan| Carried { mount: mount(scan.sensor), scan }).collect()
}

/// The same as a filter takes them.
pub fn mounted(scans: &[Carried]) -> Vec<Mounted<'_>> {
    scans.iter().map(|carried| Mounted { scan: &carried.scan, mount: carried.mount }).collect()
}
