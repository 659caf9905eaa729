//! Sweep files: TOML, read as strictly as a scene.

mod values;

use std::path::{Path, PathBuf};

use mapper::catalogue::MAPPERS;
use scene::Set;
use score::Region;
use serde::Serialize;
use strict::{Error, Limit, Table, Value as Node, open, read};

use self::values::{keys, list, paired, settings, values};
use super::parameters::{PARAMETERS, Parameter, Settings, Value};
use super::regions;
use crate::failure::Failure;
use crate::programs::options::{ProgramOptions, ProgramRecord};
use crate::worlds::mappers::own;
use crate::worlds::scenes::path_of;

/// A sweep: what is varied over which worlds, and by which mappers they are mapped.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// Scene and family files, in the order of the file.
    pub sites: Vec<PathBuf>,
    /// Whether they are families.
    pub of_families: bool,
    /// Names of the mappers.
    pub mappers: Vec<String>,
    /// The programs among them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub programs: Vec<ProgramRecord>,
    /// First seed; of a family also the first layout ...
    pub first_seed: u64,
    /// ... and how many follow each other.
    pub seeds: u64,
    /// Names of the regions that maps are scored in.
    pub regions: Vec<String>,
    /// What is the same in every job.
    pub set: Settings,
    /// Axes of the product; an axis holds the values of one parameter, or of several that go together.
    pub axes: Vec<Axis>,
}

/// Parameters that change together.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// One or more keys ...
    pub keys: Vec<&'static str>,
    /// ... and their values, a row per step.
    pub steps: Vec<Vec<Value>>,
}

const KEYS: [&str; 9] = ["scene", "scenes", "families", "mappers", "seeds", "regions", "set", "vary", "paired"];

pub(super) const SEED: Limit = Limit {
    min: 0.0,
    max: 9e15,
    bound: "a whole number from 0 to 9e15",
    remedy: "give the first seed, such as 1; of a family it is also the first layout",
};
pub(super) const COUNT: Limit = Limit {
    min: 1.0,
    max: 1e6,
    bound: "a whole number from 1 to 1000000",
    remedy: "give the number of seeds, such as 4",
};
/// More jobs than this are a mistake in a list.
pub const MOST_JOBS: u64 = 10_000_000;

/// Reads a sweep file.
///
/// # Errors
/// The first problem, with line and column.
pub fn load(path: &Path) -> Result<Sweep, Error> {
    parse(&read(path)?, &path.display().to_string())
}

/// Checks the text of a sweep file; `file` is what messages call it.
///
/// # Errors
/// The first problem, with line and column.
pub fn parse(text: &str, file: &str) -> Result<Sweep, Error> {
    let (source, document) = open(text, file)?;
    let root = Table::new(&source, "the sweep", 0, document.get_ref());
    root.only(&KEYS)?;
    let known: Vec<&str> = MAPPERS.iter().map(|entry| entry.name).collect();
    let mappers =
        words(&root, "mappers", &known)?.ok_or_else(|| root.missing("mappers", "`mappers = [\"visibility\"]`"))?;
    let regions = words(&root, "regions", &regions::known())?
        .unwrap_or_else(|| DEFAULT_REGIONS.map(|region| region.name().to_owned()).to_vec());
    let (first_seed, seeds) = seeds(&root)?;
    let set = match root.section("set")? {
        Some(table) => settings(&table)?,
        None => Settings::new(),
    };
    let mut axes = Vec::new();
    if let Some(table) = root.section("paired")? {
        axes.extend(paired(&table)?);
    }
    if let Some(table) = root.section("vary")? {
        table.only(&keys())?;
        for parameter in &PARAMETERS {
            if let Some(node) = table.get(parameter.key) {
                let steps = values(&table, parameter, node)?.into_iter().map(|value| vec![value]).collect();
                axes.push(Axis { keys: vec![parameter.key], steps });
            }
        }
    }
    let of_families = root.get("families").is_some();
    let programs = Vec::new();
    let sweep = Sweep { sites: sites(&root)?, of_families, mappers, programs, first_seed, seeds, regions, set, axes };
    once(&root, &sweep)?;
    let jobs = sweep.jobs();
    if jobs.is_none_or(|jobs| jobs > MOST_JOBS) {
        let node = root.get("vary").or_else(|| root.get("paired")).or_else(|| root.get("seeds"));
        let bound = format!("at most {MOST_JOBS} jobs in all");
        return Err(node.map_or_else(
            || root.missing("vary", &bound),
            |node| root.refuse("vary", node, &bound, "shorten the lists, or take fewer seeds"),
        ));
    }
    Ok(sweep)
}

const DEFAULT_REGIONS: [Region; 3] = [Region::Observable, Region::Visible, Region::Surface];

impl Sweep {
    /// Adds programs as mappers.
    ///
    /// # Errors
    /// Two of one name.
    pub fn with(mut self, programs: &ProgramOptions) -> Result<Self, Failure> {
        self.mappers.extend(own(programs)?.into_iter().map(|entry| entry.name.to_owned()));
        self.programs = programs.record();
        Ok(self)
    }

    /// Number of settings of the product.
    pub fn settings_count(&self) -> Option<u64> {
        self.axes.iter().try_fold(1u64, |product, axis| product.checked_mul(axis.steps.len() as u64))
    }

    /// Number of jobs; none where it is beyond all bounds.
    pub fn jobs(&self) -> Option<u64> {
        self.settings_count()?.checked_mul(self.seeds)?.checked_mul(self.sites.len() as u64)
    }

    /// The settings with the given number, the last axis changing fastest.
    pub fn settings(&self, mut number: u64) -> Settings {
        let mut settings = self.set.clone();
        for axis in self.axes.iter().rev() {
            let steps = axis.steps.len() as u64;
            let step = &axis.steps[(number % steps) as usize];
            number /= steps;
            settings.extend(axis.keys.iter().map(|key| (*key).to_owned()).zip(step.iter().cloned()));
        }
        settings
    }

    /// Keys of all parameters that are set or varied, in the order of [`PARAMETERS`].
    pub fn keys(&self) -> Vec<&'static str> {
        let used = |key: &str| self.set.contains_key(key) || self.axes.iter().any(|axis| axis.keys.contains(&key));
        PARAMETERS.iter().map(|parameter| parameter.key).filter(|key| used(key)).collect()
    }
}

/// The files that are named: `scene`, `scenes`, or `families`.
fn sites(root: &Table) -> Result<Vec<PathBuf>, Error> {
    let given: Vec<&str> = ["scene", "scenes", "families"].into_iter().filter(|key| root.get(key).is_some()).collect();
    let &[key] = given.as_slice() else {
        return Err(match given.get(1).and_then(|key| Some((key, root.get(key)?))) {
            Some((key, node)) => {
                root.refuse(key, node, "the only one of scene, scenes and families", "keep one of them")
            }
            None => root.missing("scene", "`scene = \"scenes/room.toml\"`, `scenes = [..]` or `families = [..]`"),
        });
    };
    let Some(node) = root.get(key) else { return Ok(Vec::new()) };
    let text = |node: &Node| match node.get_ref().as_str() {
        Some("") | None => Err(root.refuse(key, node, "the name of a file", "write it in quotes")),
        Some(text) => Ok(path_of(text)),
    };
    if key == "scene" {
        return Ok(vec![text(node)?]);
    }
    let mut paths = Vec::new();
    for item in list(root, key, node)? {
        let path = text(item)?;
        if paths.contains(&path) {
            return Err(root.refuse(key, item, "a file that is not named before", "name each once"));
        }
        paths.push(path);
    }
    Ok(paths)
}

/// A list of different words out of those known.
fn words(table: &Table, key: &str, known: &[&str]) -> Result<Option<Vec<String>>, Error> {
    let Some(node) = table.get(key) else { return Ok(None) };
    let mut words: Vec<String> = Vec::new();
    for item in list(table, key, node)? {
        let word = table.word(key, item, known)?.to_owned();
        if words.contains(&word) {
            return Err(table.refuse(key, item, "a name that is not named before", "name each once"));
        }
        words.push(word);
    }
    Ok(Some(words))
}

/// First seed and number of seeds.
fn seeds(root: &Table) -> Result<(u64, u64), Error> {
    let Some(table) = root.section("seeds")? else { return Ok((Set::FIRST_TEST, 1)) };
    table.only(&["first", "count"])?;
    Ok((
        table.optional_whole("first", &SEED)?.unwrap_or(Set::FIRST_TEST),
        table.optional_whole("count", &COUNT)?.unwrap_or(1),
    ))
}

/// Refuses a parameter that is given in two places, and two that say the same thing.
fn once(root: &Table, sweep: &Sweep) -> Result<(), Error> {
    let places = |key: &str| {
        let varied = sweep.axes.iter().filter(|axis| axis.keys.contains(&key)).count();
        varied + usize::from(sweep.set.contains_key(key))
    };
    let refuse = |key: &str, bound: &str, remedy: &str| {
        for name in ["vary", "paired", "set"] {
            if let Some(table) = root.section(name)?
                && let Some(node) = table.get(key)
            {
                return Err(table.refuse(key, node, bound, remedy));
            }
        }
        Ok(())
    };
    for parameter in &PARAMETERS {
        if places(parameter.key) > 1 {
            refuse(parameter.key, "given in one of [set], [vary] and [paired] only", "remove the others")?;
        }
    }
    if places("correlation") > 0 && places("assumed_length") > 0 {
        refuse("assumed_length", "left out beside correlation, which says the same", "keep one of them")?;
    }
    let of_family = |parameter: &&Parameter| parameter.of_family() && places(parameter.key) > 0;
    if let Some(parameter) = PARAMETERS.iter().find(of_family).filter(|_| !sweep.of_families) {
        refuse(parameter.key, "left out without families, whose layouts it is about", "use `families = [..]`")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
