//! What moves in a scene, as its file describes it: people, doors and chairs.

use rand::RngExt as _;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng as _;

use crate::{Origin, Shape};

/// Stream of the motion seed from which the first door's chances are drawn; the others follow below it. Far from the streams
/// of readings and layouts, should a motion seed be theirs too.
const DOORS: u64 = u64::MAX - (1 << 32);

/// A chance takes two words of the stream.
const WORDS_PER_PERIOD: u128 = 4;

/// Something that walks: a person, a cart. It keeps its orientation.
#[derive(Debug, Clone, PartialEq)]
pub struct Mover {
    /// What it covers about its own place, which is `[0, 0]`.
    pub shape: Shape,
    /// Factor on the detection rate of readings on it, 0 to 1.
    pub texture: f64,
    /// Where it goes.
    pub behaviour: Behaviour,
    /// Where it stands at the start, m.
    pub start_m: [f64; 2],
    /// Walking, m/s.
    pub speed_m_s: f64,
    /// It stands until then, s.
    pub start_s: f64,
    /// Where it comes from, for messages.
    pub origin: Origin,
}

/// Where a mover goes.
#[derive(Debug, Clone, PartialEq)]
pub enum Behaviour {
    /// From point to point.
    Route {
        /// The points, m; the first is where it starts.
        points_m: Vec<[f64; 2]>,
        /// How long it stands at each of them, s.
        pauses_s: Vec<f64>,
        /// What comes after the last.
        repeat: Repeat,
    },
    /// Behind the robot, along the robot's own way.
    Follower {
        /// How far behind, m.
        distance_m: f64,
    },
    /// To and fro about its start.
    Loiterer {
        /// It stays this near, m.
        within_m: f64,
        /// It stands up to so long at every place, s.
        pause_s: f64,
    },
}

/// What a mover does at the end of its route.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Repeat {
    /// It goes to the first point and begins again.
    Loop,
    /// It stays.
    Once,
    /// It goes back the way it came, and so on.
    BackAndForth,
}

/// A leaf that turns about its hinge.
#[derive(Debug, Clone, PartialEq)]
pub struct Door {
    /// What it turns about, m.
    pub hinge_m: [f64; 2],
    /// From the hinge to its free edge, m.
    pub length_m: f64,
    /// Its thickness, m.
    pub thickness_m: f64,
    /// Direction from the hinge to the free edge while it is shut, rad.
    pub closed_rad: f64,
    /// The same while it is open; the difference has the sign of the swing.
    pub open_rad: f64,
    /// From shut to open, s.
    pub swing_s: f64,
    /// When it is open.
    pub opening: Opening,
    /// Factor on the detection rate of readings on it, 0 to 1.
    pub texture: f64,
    /// Where it comes from, for messages.
    pub origin: Origin,
}

/// When a door is open, or on its way there.
#[derive(Debug, Clone, PartialEq)]
pub enum Opening {
    /// From the first until the second of each of these times, s.
    Times(Vec<[f64; 2]>),
    /// While the robot drives these stages: indices into [`Scene::stages`](crate::Scene::stages).
    Stages(Vec<usize>),
    /// In every period with this chance.
    Chance {
        /// Length of a period, s.
        period_s: f64,
        /// 0 to 1.
        chance: f64,
    },
}

/// Something that stands, and stands elsewhere later.
#[derive(Debug, Clone, PartialEq)]
pub struct Chair {
    /// What it covers at first.
    pub shape: Shape,
    /// Its moves, in order.
    pub moves: Vec<ChairMove>,
    /// Factor on the detection rate of readings on it, 0 to 1.
    pub texture: f64,
    /// Where it comes from, for messages.
    pub origin: Origin,
}

/// One move of a chair, which takes no time and waits until the place is free.
#[derive(Debug, Clone, PartialEq)]
pub struct ChairMove {
    /// When it is due.
    pub due: Due,
    /// What the chair covers from then on.
    pub shape: Shape,
}

/// When something is due.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Due {
    /// At this time, s.
    At(f64),
    /// When this stage has ended: an index into [`Scene::stages`](crate::Scene::stages).
    AfterStage(usize),
}

impl Door {
    /// Its angle at the start, rad.
    pub(crate) fn angle_at_start(&self, seed: u64) -> f64 {
        let door = self.origin.number as u64 - 1;
        if self.opening.wants_open(0.0, 0, seed, door) { self.open_rad } else { self.closed_rad }
    }

    /// The leaf at an angle (rad).
    pub fn leaf(&self, angle_rad: f64) -> Shape {
        let (sin, cos) = libm::sincos(angle_rad);
        let half = 0.5 * self.length_m;
        Shape::Box {
            center_m: [self.hinge_m[0] + half * cos, self.hinge_m[1] + half * sin],
            half_m: [half, 0.5 * self.thickness_m],
            axis: [cos, sin],
        }
    }
}

impl Opening {
    /// Whether the door is to be open at a time of the drive (s), while the robot drives a stage. `seed` and `door`, its
    /// number from 0, fix the chances.
    pub(crate) fn wants_open(&self, time_s: f64, stage: usize, seed: u64, door: u64) -> bool {
        match self {
            Self::Times(times) => times.iter().any(|[from, to]| (*from..*to).contains(&time_s)),
            Self::Stages(stages) => stages.contains(&stage),
            Self::Chance { period_s, chance } => {
                let period = (time_s / period_s).floor().max(0.0) as u128;
                let mut rng = ChaCha8Rng::seed_from_u64(seed);
                rng.set_stream(DOORS - door);
                rng.set_word_pos(period * WORDS_PER_PERIOD);
                rng.random::<f64>() < *chance
            }
        }
    }
}

impl Mover {
    /// What it covers while its place is `at_m`.
    pub fn shape_at(&self, at_m: [f64; 2]) -> Shape {
        self.shape.moved(at_m)
    }

    /// How far it reaches from its own place, m.
    pub fn reach_m(&self) -> f64 {
        match &self.shape {
            Shape::Disc { center_m, radius_m } => libm::hypot(center_m[0], center_m[1]) + radius_m,
            other => other.corners_m().iter().map(|c| libm::hypot(c[0], c[1])).fold(0.0, f64::max),
        }
    }
}
