//! What a comparison consists of, worked out before any world is made.

use std::path::PathBuf;

use mapper::Reconciliation;
use mapper::catalogue::{Entry, Kind, MAPPERS};
use scene::{Family, Set};

use super::options::{CompareOptions, Worlds};
use super::world::WorldJob;
use crate::failure::Failure;
use crate::programs::options::ProgramRecord;
use crate::worlds::condition::{AS_BELIEVED, Condition, DEPARTURES, DRIFT, PEOPLE, POSES, SUITES, departures};
use crate::worlds::drives::DriveOptions;
use crate::worlds::ground::Driven;
use crate::worlds::mappers::{entries, own};
use crate::worlds::scenes::families;
use crate::worlds::site::{Assumptions, Site, WorldId};

/// The mapper that all are compared with.
pub const REFERENCE: &str = "visibility";

/// A comparison in full.
#[derive(Clone)]
pub struct Plan {
    /// Which worlds.
    pub set: Worlds,
    /// The families, of different names ...
    pub families: Vec<Family>,
    /// ... and their files.
    pub paths: Vec<PathBuf>,
    /// Names of the conditions.
    pub conditions: Vec<&'static str>,
    /// Worlds of each family under each condition ...
    pub seeds: u64,
    /// ... and those of them that batch mappers run on.
    pub batch_seeds: u64,
    /// The mappers, the reference among them.
    pub mappers: Vec<&'static Entry>,
    /// The programs among them.
    pub programs: Vec<ProgramRecord>,
    /// What they assume.
    pub assumed: Assumptions,
    /// The drives that are planned on their maps.
    pub drives: DriveOptions,
    /// How often a scan is repeated, rising; nothing is where nothing is to be repeated.
    pub repeats: Vec<usize>,
    /// Scans of each repeated world.
    pub repeated_scans: usize,
}

impl Plan {
    /// Settles every option.
    ///
    /// # Errors
    /// A mapper that does not exist, or no reference among them; a family that cannot be read, or two of a
    /// name, or one whose robot does not fit the set.
    pub fn new(options: &CompareOptions) -> Result<Self, Failure> {
        let mappers = match options.mappers.is_empty() {
            true => {
                let of_sensors = options.set == Worlds::Sensors;
                let usual = |entry: &&Entry| match of_sensors {
                    true => OF_SENSORS.contains(&entry.name),
                    false => !maps_the_same(entry, options) && !on_request(entry),
                };
                let default = MAPPERS.iter().filter(usual);
                default.chain(own(&options.programs)?).collect()
            }
            false => entries(&options.mappers, &options.programs)?,
        };
        if !mappers.iter().any(|entry| entry.name == REFERENCE) {
            let message = format!("--mappers: all are compared with {REFERENCE}, which is not among them; add it");
            return Err(Failure::BadInput(message));
        }
        if mappers.len() == 1 {
            let message = format!("--mappers: nothing is compared with {REFERENCE}; add another mapper (see `list`)");
            return Err(Failure::BadInput(message));
        }
        let set = options.set;
        let conditions = conditions(options)?;
        let seeds = u64::from(options.seeds.unwrap_or(match (options.quick, set) {
            (true, Worlds::Robustness | Worlds::Sensors) => 1,
            (true, _) => 4,
            (false, Worlds::Test) => 30,
            (false, Worlds::Robustness | Worlds::Sensors) => 8,
            (false, Worlds::Tuning) => 10,
        }));
        let third = if options.quick { 1 } else { seeds.div_ceil(3) };
        let batch_seeds = options.batch_seeds.map_or(third, u64::from).min(seeds);
        let (repeats, repeated_scans) = match (set, options.quick) {
            (Worlds::Robustness | Worlds::Sensors, _) => (vec![], 0),
            (_, true) => (vec![1, 10, 100], 1),
            (_, false) => (vec![1, 10, 100, 1000], 2),
        };
        let families = families(&options.families)?;
        fit(&families, &options.families, set, &conditions)?;
        Ok(Self {
            set,
            families,
            paths: options.families.clone(),
            conditions,
            seeds,
            batch_seeds,
            mappers,
            programs: options.programs.record(),
            assumed: Assumptions { max_range_m: options.cut.max_range_m, ..Assumptions::of(&options.prior) },
            drives: options.drives,
            repeats,
            repeated_scans,
        })
    }

    /// The worlds, a seed of every family and condition after the other.
    pub fn jobs(&self) -> Vec<WorldJob> {
        let set = match self.set {
            Worlds::Test | Worlds::Sensors => Set::Test,
            Worlds::Robustness => Set::Robustness,
            Worlds::Tuning => Set::Tuning,
        };
        let mut jobs = Vec::new();
        for (number, seed) in set.seeds(self.seeds).enumerate() {
            for family in &self.families {
                jobs.extend(self.conditions.iter().map(|condition| WorldJob {
                    world: WorldId {
                        family: family.name.clone(),
                        condition: (*condition).to_owned(),
                        cell_um: None,
                        seed,
                    },
                    batch: (number as u64) < self.batch_seeds,
                }));
            }
        }
        jobs
    }

    /// The family of a job of this plan.
    ///
    /// # Panics
    /// If the job is not of this plan.
    pub fn family(&self, job: &WorldJob) -> &Family {
        let family = self.families.iter().find(|family| family.name == job.world.family);
        family.unwrap_or_else(|| panic!("no family is called {}", job.world.family))
    }

    /// The world of a job of this plan, ready to be mapped.
    ///
    /// # Errors
    /// As [`Site::of_family`].
    pub fn site(&self, job: &WorldJob) -> Result<Site, Failure> {
        let Site { ground, setup } = Site::of_family(self.family(job), &job.world, &self.assumed)?;
        Ok(Site { ground: ground.with_drives(&self.drives, Driven::Last), setup })
    }

    /// Whether its worlds are of suites of sensors.
    pub fn has_suites(&self) -> bool {
        self.set == Worlds::Sensors
    }

    /// Names of the mappers.
    pub fn names(&self) -> Vec<&'static str> {
        self.mappers.iter().map(|entry| entry.name).collect()
    }

    /// The scopes to show part by part: conditions where there are several, else families.
    pub fn parts(&self) -> Vec<&str> {
        match self.conditions.len() {
            1 => self.families.iter().map(|family| family.name.as_str()).collect(),
            _ => self.conditions.clone(),
        }
    }

    /// What the worlds are for, in a sentence or two.
    pub fn about(&self) -> String {
        let notes = [
            (PEOPLE.name, " Under the condition people they are not at rest: people walk about."),
            (
                POSES.name,
                " Under the condition poses all mappers are told the same wrong poses, off afresh at every scan.",
            ),
            (DRIFT.name, " Under the condition drift all mappers are told the same poses, those of odometry."),
        ];
        let noted = notes.into_iter().filter(|(name, _)| self.conditions.contains(name));
        self.set.about().to_owned() + &noted.map(|(_, note)| note).collect::<String>()
    }

    /// One line on what is compared.
    pub fn heading(&self) -> String {
        let conditions = match self.conditions.len() {
            1 => String::new(),
            n => format!(" x {n} conditions"),
        };
        let (families, worlds) = (self.families.len(), self.jobs().len());
        let counted = |count: u64, one: &str, many: &str| format!("{count} {}", if count == 1 { one } else { many });
        format!(
            "{} set, {}{conditions} x {} = {}, {} mappers",
            self.set.name(),
            counted(families as u64, "family", "families"),
            counted(self.seeds, "seed", "seeds"),
            counted(worlds as u64, "world", "worlds"),
            self.mappers.len()
        )
    }

    /// What to know of the batch mappers, if any run on fewer worlds than the others.
    pub fn batch_note(&self) -> Option<String> {
        let fewer = self.batch_seeds < self.seeds && self.has_batch();
        let worlds = self.jobs().iter().filter(|job| job.batch).count();
        let note = format!("Batch mappers ran on {worlds} of them: compare their differences, not their means");
        fewer.then_some(note)
    }

    /// Whether any of the mappers takes all scans at once.
    pub fn has_batch(&self) -> bool {
        self.mappers.iter().any(|entry| entry.kind == Kind::Batch)
    }
}

/// Names of the conditions of a set, in the order of the robustness set.
fn conditions(options: &CompareOptions) -> Result<Vec<&'static str>, Failure> {
    let asked = &options.conditions;
    if options.set != Worlds::Robustness {
        return match asked.first() {
            None if options.set == Worlds::Sensors => Ok(SUITES.iter().map(|suite| suite.name).collect()),
            None => Ok(vec![AS_BELIEVED.name]),
            Some(name) => Err(Failure::BadInput(format!(
                "--conditions {name}: worlds of the {} set are as the mappers believe; add --set robustness",
                options.set.name()
            ))),
        };
    }
    let chosen = |condition: &&Condition| match asked.is_empty() {
        true => DEPARTURES.iter().any(|usual| usual.name == condition.name),
        false => asked.iter().any(|name| name == condition.name),
    };
    Ok(departures().filter(chosen).map(|condition| condition.name).collect())
}

/// Refuses families whose robots do not fit the worlds of a set: those that list sensors where the set has its own, and those without a camera
/// where a condition is the camera's.
fn fit(families: &[Family], paths: &[PathBuf], set: Worlds, conditions: &[&str]) -> Result<(), Failure> {
    for (family, path) in families.iter().zip(paths) {
        let place = path.display();
        if set == Worlds::Sensors && family.lists_sensors() {
            return Err(Failure::BadInput(format!(
                "--families: {place}: its robot carries sensors of [[sensor]], and the set sensors has its own; take them out, or compare with --set test"
            )));
        }
        let of_camera = DEPARTURES.iter().find(|one| !one.of_layouts() && conditions.contains(&one.name));
        if let Some(condition) = of_camera.filter(|_| !family.has_camera()) {
            return Err(Failure::BadInput(format!(
                "--families: {place}: its robot has no [camera], whose noise the condition {} changes; name other --conditions, or compare with --set test",
                condition.name
            )));
        }
    }
    Ok(())
}

/// The mappers of the set of sensors.
const OF_SENSORS: [&str; 9] = [
    REFERENCE,
    "conventional",
    "log-odds-octomap",
    "sonar-moravec",
    "visibility-pool",
    "visibility-maximum",
    "octomap-maximum",
    "miura-2002",
    "independent",
];

/// Mappers that stand in no table unless they are named: rules as published of which the table has the fitted ones, rules for a
/// world that moves, which the worlds of this comparison do not, rules for several sensors, which most robots here have not, and
/// sampling, which takes as long as all others together.
pub const ON_REQUEST: [&str; 15] = [
    "visibility-window",
    "hit-count-gmapping",
    "hit-count-karto",
    "tsdf",
    "mrpt-widening",
    "wavemap",
    "log-odds-decay",
    "dynamic-grid",
    "sonar-moravec",
    "visibility-pool",
    "visibility-maximum",
    "octomap-maximum",
    "miura-2002",
    "gibbs",
    "gibbs-unchecked",
];

fn on_request(entry: &Entry) -> bool {
    ON_REQUEST.contains(&entry.name)
}

/// Whether a mapper makes the map of `visibility` anyway: its own reference, and the variant that the options make it.
fn maps_the_same(entry: &Entry, options: &CompareOptions) -> bool {
    let variant = match options.prior.reconciliation() {
        Reconciliation::AllEdges => "visibility-all-edges",
        Reconciliation::Touched => "visibility-touched",
    };
    ["visibility-reference", variant].contains(&entry.name)
}
