//! Sweep files: TOML, read as strictly as a scene.

mod values;

use std::path::{Path, PathBuf};

use mapper::catalogue::MAPPERS;
use scene::Set;
use score::Region;
use serde::Serialize;
use strict::{Error, Findings, Limit, Table, first, open, read};

use self::values::{keys, list, paired, settings, values};
use super::parameters::{PARAMETERS, Settings, Value};
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

type Found = Findings<Error>;

/// Reads a sweep file.
///
/// # Errors
/// All that is wrong with it, with line and column.
pub fn load(path: &Path) -> Result<Sweep, Vec<Error>> {
    examine(&read(path).map_err(|error| vec![error])?, &path.display().to_string())
}

/// Checks the text of a sweep file; `file` is what messages call it.
///
/// # Errors
/// The first problem, with line and column.
pub fn parse(text: &str, file: &str) -> Result<Sweep, Error> {
    examine(text, file).map_err(first)
}

/// As [`parse`].
///
/// # Errors
/// Every problem, with line and column, but those that follow from another.
pub fn examine(text: &str, file: &str) -> Result<Sweep, Vec<Error>> {
    let (source, document) = open(text, file).map_err(|error| vec![error])?;
    let root = Table::new(&source, "the sweep", 0, document.get_ref());
    let mut found = Found::default();
    let sweep = checked(&root, &mut found);
    found.or(sweep)
}

fn checked(root: &Table, found: &mut Found) -> Option<Sweep> {
    found.only(root, &KEYS);
    let known: Vec<&str> = MAPPERS.iter().map(|entry| entry.name).collect();
    if root.get("mappers").is_none() {
        found.add(root.missing("mappers", "`mappers = [\"visibility\"]`"));
    }
    let mappers = words(root, "mappers", &known, found);
    let regions = words(root, "regions", &regions::known(), found)
        .unwrap_or_else(|| DEFAULT_REGIONS.map(|region| region.name().to_owned()).to_vec());
    let (first_seed, seeds) = seeds(root, found);
    let set = section(root, "set", found).map(|table| settings(&table, found)).unwrap_or_default();
    let mut axes = Vec::new();
    if let Some(table) = section(root, "paired", found) {
        axes.extend(paired(&table, found));
    }
    if let Some(table) = section(root, "vary", found) {
        found.only(&table, &keys());
        for parameter in &PARAMETERS {
            if let Some(node) = table.get(parameter.key) {
                let steps = values(&table, parameter, node, found).into_iter().map(|value| vec![value]).collect();
                axes.push(Axis { keys: vec![parameter.key], steps });
            }
        }
    }
    let of_families = root.get("families").is_some();
    let sites = sites(root, found);
    once(root, of_families, found);
    let programs = Vec::new();
    let sweep = Sweep { sites, of_families, mappers: mappers?, programs, first_seed, seeds, regions, set, axes };
    if sweep.jobs().is_none_or(|jobs| jobs > MOST_JOBS) {
        let bound = format!("at most {MOST_JOBS} jobs in all");
        let remedy = "shorten the lists, or take fewer seeds";
        let key = ["vary", "paired", "seeds"].into_iter().find(|key| root.get(key).is_some());
        found.add(match key.and_then(|key| Some((key, root.get(key)?))) {
            Some((key, node)) => root.refuse(key, node, &bound, remedy),
            None => root.missing("vary", &bound),
        });
    }
    Some(sweep)
}

/// A table of the file, if there is one.
fn section<'a>(root: &Table<'a>, key: &str, found: &mut Found) -> Option<Table<'a>> {
    found.take(root.section(key)).flatten()
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
fn sites(root: &Table, found: &mut Found) -> Vec<PathBuf> {
    let given: Vec<&str> = ["scene", "scenes", "families"].into_iter().filter(|key| root.get(key).is_some()).collect();
    if given.is_empty() {
        found.add(root.missing("scene", "`scene = \"scenes/room.toml\"`, `scenes = [..]` or `families = [..]`"));
    }
    let mut paths = Vec::new();
    for (k, key) in given.iter().enumerate() {
        let Some(node) = root.get(key) else { continue };
        if k > 0 {
            found.add(root.refuse(key, node, "the only one of scene, scenes and families", "keep one of them"));
            continue;
        }
        let items = match *key {
            "scene" => Some(std::slice::from_ref(node)),
            _ => found.take(list(root, key, node)),
        };
        for item in items.into_iter().flatten() {
            let refused = |bound, remedy| root.refuse(key, item, bound, remedy);
            match item.get_ref().as_str().filter(|text| !text.is_empty()).map(path_of) {
                None => found.add(refused("the name of a file", "write it in quotes")),
                Some(path) if paths.contains(&path) => {
                    found.add(refused("a file that is not named before", "name each once"));
                }
                Some(path) => paths.push(path),
            }
        }
    }
    paths
}

/// A list of different words out of those known; none where there is no list.
fn words(table: &Table, key: &str, known: &[&str], found: &mut Found) -> Option<Vec<String>> {
    let node = table.get(key)?;
    let mut words: Vec<String> = Vec::new();
    for item in found.take(list(table, key, node))? {
        let Some(word) = found.take(table.word(key, item, known)) else { continue };
        if words.iter().any(|other| other == word) {
            found.add(table.refuse(key, item, "a name that is not named before", "name each once"));
        }
        words.push(word.to_owned());
    }
    Some(words)
}

/// First seed and number of seeds.
fn seeds(root: &Table, found: &mut Found) -> (u64, u64) {
    let usual = (Set::FIRST_TEST, 1);
    let Some(table) = section(root, "seeds", found) else { return usual };
    found.only(&table, &["first", "count"]);
    let first = found.take(table.optional_whole("first", &SEED)).flatten();
    let count = found.take(table.optional_whole("count", &COUNT)).flatten();
    (first.unwrap_or(usual.0), count.unwrap_or(usual.1))
}

/// Refuses a parameter that is given in two places, and two that say the same thing.
fn once(root: &Table, of_families: bool, found: &mut Found) {
    let tables = ["vary", "paired", "set"].into_iter().filter_map(|name| root.section(name).ok().flatten());
    let tables: Vec<Table> = tables.collect();
    let places = |key: &str| tables.iter().filter(|table| table.get(key).is_some()).count();
    let mut refuse = |key: &str, bound: &str, remedy: &str| {
        let first = tables.iter().find_map(|table| Some((table, table.get(key)?)));
        if let Some((table, node)) = first {
            found.add(table.refuse(key, node, bound, remedy));
        }
    };
    for parameter in &PARAMETERS {
        if places(parameter.key) > 1 {
            refuse(parameter.key, "given in one of [set], [vary] and [paired] only", "remove the others");
        }
    }
    if places("correlation") > 0 {
        refuse("assumed_length", "left out beside correlation, which says the same", "keep one of them");
    }
    for parameter in PARAMETERS.iter().filter(|parameter| parameter.of_family() && !of_families) {
        refuse(parameter.key, "left out without families, whose layouts it is about", "use `families = [..]`");
    }
}

#[cfg(test)]
mod tests;
