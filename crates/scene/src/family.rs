//! Families: generated scenes, one per layout number.

use std::fmt::Write as _;
use std::path::PathBuf;

use strict::Place;

use crate::file::edit::quoted;
use crate::generate::people::{self, Person};
use crate::generate::{self, Layout, Plan};
use crate::{Problem, Scene, SceneError};

/// A kind of place, of which every layout number gives another: a TOML file with a `[generate]`
/// table, and the `[grid]`, `[camera]`, `[sensor]`, `[robot]` and `[odometry]` of its scenes.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Family {
    /// Short name; the scenes are called `NAME-LAYOUT`.
    pub name: String,
    /// One line about it, possibly empty.
    pub description: String,
    pub(crate) plan: Plan,
    /// Radius of the robot, m.
    pub(crate) robot_radius_m: f64,
    /// The tables that every scene takes over, with the text of their values.
    pub(crate) carried: Vec<(String, Vec<(String, String)>)>,
    pub(crate) path: PathBuf,
    /// Where `[generate]` stands.
    pub(crate) place: Place,
}

/// More obstacles than this take seconds to place, each beside all others, and minutes where one finds no place
/// in any attempt.
const MOST_PIECES: f64 = 4000.0;

/// Bits of a layout number that a scene file's motion seed holds.
const MOTION_SEEDS: u64 = (1 << 52) - 1;

/// What is done to a family on purpose, to see what a mapper makes of a world it does not expect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Variation {
    /// Factor on the mean obstacle size, 0.1 to 10. The covered share of the floor stays: obstacles of twice
    /// the size are a quarter as many.
    pub size_factor: f64,
}

impl Default for Variation {
    fn default() -> Self {
        Self { size_factor: 1.0 }
    }
}

/// Sets of layouts that are kept apart: what is fitted on one is reported on another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Set {
    /// Layouts on which parameters are chosen.
    Tuning,
    /// Layouts on which results are reported.
    Test,
    /// Layouts for worlds and sensors other than the mappers believe in.
    Robustness,
}

impl Set {
    /// Layouts in each set.
    pub const SIZE: u64 = 10_000;

    /// First layout of the test set.
    pub const FIRST_TEST: u64 = 1;

    /// First layout of the tuning set.
    pub const FIRST_TUNING: u64 = 10_001;

    /// First layout of the robustness set.
    pub const FIRST_ROBUSTNESS: u64 = 20_001;

    /// The first `count` layout numbers of the set.
    ///
    /// # Panics
    /// If `count` is more than [`SIZE`](Self::SIZE): the next set begins there.
    pub fn seeds(self, count: u64) -> std::ops::Range<u64> {
        assert!(count <= Self::SIZE, "a set has {} layouts, not {count}", Self::SIZE);
        let first = match self {
            Self::Test => Self::FIRST_TEST,
            Self::Tuning => Self::FIRST_TUNING,
            Self::Robustness => Self::FIRST_ROBUSTNESS,
        };
        first..first + count
    }
}

impl Family {
    /// The scene file of a layout, as text. The same seed gives the same text.
    ///
    /// # Errors
    /// A size factor out of range, obstacles too many or too large for the share they are to cover, and a family
    /// whose obstacles leave no room for a route.
    pub fn generate(&self, seed: u64, variation: &Variation) -> Result<String, SceneError> {
        let layout = self.layout(seed, variation)?;
        let people = self.people(seed, &layout)?;
        Ok(self.text(seed, variation, &layout, people.as_deref()))
    }

    /// The scene of a layout, read from its text as any other. `cell_m` replaces the file's cell size (m).
    ///
    /// # Errors
    /// As [`generate`](Self::generate), and what [`Scene::parse`] refuses.
    pub fn scene(&self, seed: u64, cell_m: Option<f64>, variation: &Variation) -> Result<Scene, SceneError> {
        let path = PathBuf::from(format!("{} (layout {seed})", self.path.display()));
        let scene = Scene::parse(&self.generate(seed, variation)?, &path, cell_m)?;
        Ok(Scene { layout: Some(seed), ..scene })
    }

    fn layout(&self, seed: u64, variation: &Variation) -> Result<Layout, SceneError> {
        let invalid = |problem| SceneError::at(self.place.clone(), problem);
        let size_factor = variation.size_factor;
        if !(0.1..=10.0).contains(&size_factor) {
            return Err(invalid(Problem::File(strict::Problem::Value {
                element: "the variation asked for".to_owned(),
                key: "size_factor".to_owned(),
                value: size_factor.to_string(),
                bound: "a factor on the obstacle size, 0.1 to 10".to_owned(),
                remedy: "give a factor such as 2, or 1 for the family as it is".to_owned(),
            })));
        }
        let plan = Plan { obstacle_m: self.plan.obstacle_m * size_factor, ..self.plan.clone() };
        let [width, height] = plan.size_m.map(|range| range[1]);
        let pieces = plan.covered * width * height / (plan.obstacle_m * plan.obstacle_m);
        if pieces > MOST_PIECES {
            let least = 1e-3 * (1e3 * (plan.covered * width * height / MOST_PIECES).sqrt()).ceil();
            return Err(invalid(Problem::File(strict::Problem::Value {
                element: "[generate]".to_owned(),
                key: "obstacle_size".to_owned(),
                value: plan.obstacle_m.to_string(),
                bound: format!(
                    "at least {least:.3} m, or about {pieces:.0} obstacles, more than {MOST_PIECES}, cover {} of a place of {width} x {height} m",
                    plan.covered
                ),
                remedy: "give a larger obstacle_size or a lower covered".to_owned(),
            })));
        }
        let clear_m = self.robot_radius_m + plan.clearance_m;
        generate::layout(&plan, clear_m, seed).ok_or_else(|| {
            invalid(Problem::NoLayout {
                layout: seed,
                attempts: generate::ATTEMPTS,
                obstacle_m: plan.obstacle_m,
                covered: plan.covered,
                needed_m: clear_m,
            })
        })
    }

    /// Whether its robot carries sensors of `[[sensor]]`.
    pub fn lists_sensors(&self) -> bool {
        self.carried.iter().any(|(heading, _)| heading == "[[sensor]]")
    }

    /// Whether its robot has a camera.
    pub fn has_camera(&self) -> bool {
        !self.lists_sensors() || self.carried.iter().any(|(heading, _)| heading == "[camera]")
    }

    /// Whether people walk in its scenes.
    pub fn moves(&self) -> bool {
        self.plan.people_per_100_m2.is_some()
    }

    /// The same family with so many people per 100 m² of every place, between two numbers from 0 to 20. Layouts stay as they are.
    pub fn with_people(mut self, per_100_m2: [f64; 2]) -> Self {
        self.plan.people_per_100_m2 = Some(per_100_m2);
        self
    }

    /// The people of a layout, in a family that has some.
    fn people(&self, seed: u64, layout: &Layout) -> Result<Option<Vec<Person>>, SceneError> {
        let Some(per_100_m2) = self.plan.people_per_100_m2 else { return Ok(None) };
        let people = people::draw(layout, per_100_m2, self.plan.people_m_s, self.robot_radius_m, seed);
        let crowded = || SceneError::at(self.place.clone(), Problem::Crowded { layout: seed, most: per_100_m2[1] });
        people.map(Some).ok_or_else(crowded)
    }

    /// A layout as a scene file.
    fn text(&self, seed: u64, variation: &Variation, layout: &Layout, people: Option<&[Person]>) -> String {
        let Self { name, description, .. } = self;
        let [width, height] = layout.size_m;
        let mut text =
            format!("# Layout {seed} of the family {name}, obstacle size times {}.\n\n", variation.size_factor);
        let _ = write!(text, "name = \"{name}-{seed}\"\ndescription = {}\n\n", quoted(description));
        if people.is_some() {
            let _ = write!(text, "motion_seed = {}\n\n", seed & MOTION_SEEDS);
        }
        let _ = write!(text, "[bounds]\nmin = [0.0, 0.0]\nmax = [{width:?}, {height:?}]\n\n");
        for piece in &layout.pieces {
            let _ = write!(text, "{piece}\n\n");
        }
        for person in people.unwrap_or_default() {
            let _ = write!(text, "{person}\n\n");
        }
        text += "[waypoints]\n";
        for (name, [x, y]) in &layout.waypoints {
            let _ = writeln!(text, "{name} = [{x:?}, {y:?}]");
        }
        let _ = write!(text, "\n[route]\nstops = {:?}\n", layout.stops);
        for (name, stops) in &layout.stages {
            let _ = write!(text, "\n[[stage]]\nname = \"{name}\"\nafter = {:?}\n", &layout.stops[..*stops]);
        }
        for (heading, entries) in &self.carried {
            let _ = write!(text, "\n{heading}\n");
            for (key, value) in entries {
                let _ = writeln!(text, "{key} = {value}");
            }
        }
        text
    }
}

#[cfg(test)]
mod tests;
