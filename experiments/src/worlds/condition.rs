//! Worlds that differ from what the mappers assume.

use sensor::{Matcher, Mismatches};

use super::poses::WrongPoses;

/// How the simulated world differs from the one that the mappers assume.
#[derive(Clone, Copy)]
pub struct Condition {
    /// Its name in every file.
    pub name: &'static str,
    /// One line for people.
    pub summary: &'static str,
    /// Factor on the mean size of obstacles; the mappers keep their correlation.
    pub size_factor: f64,
    /// What becomes of the simulated camera; the mappers keep the camera of the scene's file.
    pub camera: fn(&mut Matcher),
    /// People per 100 m², between two numbers, where those of the family are not meant.
    pub people_per_100_m2: Option<[f64; 2]>,
    /// How wrong the poses are that all mappers are told.
    pub poses: WrongPoses,
    /// What the robot carries in the place of its own sensors, in a world with panes and legs; none where it carries its own.
    pub suite: Option<&'static [Carried]>,
}

/// A sensor of the robots of the set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carried {
    /// The stereo camera of the family.
    Camera,
    /// A laser of 90 beams over 180 degrees, 0.1 m ahead of the robot's middle.
    Laser,
    /// A ring of 16 sonars.
    Sonar,
}

impl Condition {
    /// Whether it changes what stands or walks in a world, which only the layouts of families let it.
    pub fn of_layouts(&self) -> bool {
        (self.size_factor - 1.0).abs() > 0.0 || self.people_per_100_m2.is_some()
    }
}

/// The world as the mappers assume it.
pub const AS_BELIEVED: Condition = Condition {
    name: "as-believed",
    summary: "the mappers know the camera, and obstacles have the size they expect",
    size_factor: 1.0,
    camera: |_| {},
    people_per_100_m2: None,
    poses: WrongPoses::NONE,
    suite: None,
};

/// The robustness set, unless others are asked for: one thing differs at a time.
pub const DEPARTURES: [Condition; 7] = [
    Condition {
        name: "match-0.6",
        summary: "correct matches 0.6",
        camera: |m| m.stereo.correct_match = 0.6,
        ..AS_BELIEVED
    },
    Condition {
        name: "match-0.95",
        summary: "correct matches 0.95",
        camera: |m| m.stereo.correct_match = 0.95,
        ..AS_BELIEVED
    },
    Condition {
        name: "sigma-0.5",
        summary: "sigma of the disparity halved",
        camera: |m| m.stereo.disparity_sigma *= 0.5,
        ..AS_BELIEVED
    },
    Condition {
        name: "sigma-2",
        summary: "sigma of the disparity doubled",
        camera: |m| m.stereo.disparity_sigma *= 2.0,
        ..AS_BELIEVED
    },
    Condition { name: "size-0.5", summary: "obstacles half as large", size_factor: 0.5, ..AS_BELIEVED },
    Condition { name: "size-2", summary: "obstacles twice as large", size_factor: 2.0, ..AS_BELIEVED },
    Condition {
        name: "clusters",
        summary: "mismatches in runs that copy neighbouring surfaces",
        camera: |m| m.mismatches = Mismatches::Clustered(Default::default()),
        ..AS_BELIEVED
    },
];

/// A world that is not at rest, as the mappers assume it: a departure that is compared where it is asked for.
pub const PEOPLE: Condition =
    Condition { name: "people", summary: "people walk about", people_per_100_m2: Some([4.0, 8.0]), ..AS_BELIEVED };

/// Poses that are not exact, as the mappers assume them: what is left of an error where scans are matched. A departure that is compared
/// where it is asked for.
pub const POSES: Condition = Condition {
    name: "poses",
    summary: "poses 2 cm and half a degree off, afresh at every scan",
    poses: WrongPoses { sigma_m: 0.02, sigma_rad: 0.5 * std::f64::consts::PI / 180.0, drift: 0.0 },
    ..AS_BELIEVED
};

/// Poses that nobody corrects. A departure that is compared where it is asked for.
pub const DRIFT: Condition = Condition {
    name: "drift",
    summary: "poses by odometry alone, of the standard noise",
    poses: WrongPoses { drift: 1.0, ..WrongPoses::NONE },
    ..AS_BELIEVED
};

/// Every sensor alone, every pair, and all three.
pub const SUITES: [Condition; 7] = [
    suite("camera", "the stereo camera alone", &[Carried::Camera]),
    suite("laser", "a laser alone", &[Carried::Laser]),
    suite("sonar", "a ring of sonars alone", &[Carried::Sonar]),
    suite("camera-laser", "the stereo camera and a laser", &[Carried::Camera, Carried::Laser]),
    suite("camera-sonar", "the stereo camera and a ring of sonars", &[Carried::Camera, Carried::Sonar]),
    suite("laser-sonar", "a laser and a ring of sonars", &[Carried::Laser, Carried::Sonar]),
    suite(
        "all-three",
        "the stereo camera, a laser and a ring of sonars",
        &[Carried::Camera, Carried::Laser, Carried::Sonar],
    ),
];

const fn suite(name: &'static str, summary: &'static str, suite: &'static [Carried]) -> Condition {
    Condition { name, summary, suite: Some(suite), ..AS_BELIEVED }
}

/// The departures that are compared where they are asked for.
pub const ON_REQUEST: [&Condition; 3] = [&PEOPLE, &POSES, &DRIFT];

/// Every departure that can be asked for.
pub fn departures() -> impl Iterator<Item = &'static Condition> {
    DEPARTURES.iter().chain(ON_REQUEST)
}

/// The condition of the given name, suites of sensors among them.
pub fn condition(name: &str) -> Option<&'static Condition> {
    [&AS_BELIEVED].into_iter().chain(departures()).chain(&SUITES).find(|condition| condition.name == name)
}
