//! The file of the gates: TOML, read as strictly as a scene.

use std::collections::BTreeMap;
use std::path::Path;

use mapper::catalogue::Entry;
use scene::{SceneError, Set};
use score::{FEWEST_PAIRS, Region};
use strict::{Error, Limit, Table, Value, open, read};

use super::source::GateSource;
use crate::worlds::condition::{AS_BELIEVED, Condition, DEPARTURES};
use crate::worlds::criteria::{CRITERIA, Criterion, criteria, criterion};
use crate::worlds::scenes::FAMILIES;
use crate::worlds::scenes::path_of;
use crate::worlds::site::{MICROMETRES, WorldId};

/// What must hold of a mapper's maps.
#[derive(Debug, Clone, PartialEq)]
pub struct Gate {
    /// Its name.
    pub name: String,
    /// Name of the mapper that is judged.
    pub mapper: String,
    /// The metric, with the way that is better.
    pub criterion: &'static Criterion,
    /// Name of the region that maps are judged in.
    pub region: String,
    /// The worlds that are mapped.
    pub worlds: Vec<WorldId>,
    /// What is demanded.
    pub demand: Demand,
}

/// What a gate demands; bounds are in the unit of its metric.
#[derive(Debug, Clone, PartialEq)]
pub enum Demand {
    /// The mean over the worlds is at most this.
    AtMost(f64),
    /// The mean over the worlds is at least this.
    AtLeast(f64),
    /// The mean of the paired differences from the baseline is not surely worse by more than this.
    NotWorseThanBaselineBy(f64),
    /// The mapper is surely better than another on the same readings, by more than `by`.
    BetterThan {
        /// Name of the other mapper.
        mapper: String,
        /// The least difference, 0 or more.
        by: f64,
    },
}

impl Demand {
    /// Its key in the file.
    pub fn key(&self) -> &'static str {
        match self {
            Self::AtMost(_) => "at_most",
            Self::AtLeast(_) => "at_least",
            Self::NotWorseThanBaselineBy(_) => "not_worse_than_baseline_by",
            Self::BetterThan { .. } => "better_than",
        }
    }

    /// The number that it bounds by.
    pub fn bound(&self) -> f64 {
        match self {
            Self::AtMost(bound) | Self::AtLeast(bound) => *bound,
            Self::NotWorseThanBaselineBy(by) | Self::BetterThan { by, .. } => *by,
        }
    }
}

impl Gate {
    /// Whether it compares with values of former maps.
    pub fn needs_baseline(&self) -> bool {
        matches!(self.demand, Demand::NotWorseThanBaselineBy(_))
    }
}

/// All gates of a file, and where their worlds come from.
#[derive(Debug, Clone)]
pub struct Gates {
    /// The file, as the caller named it.
    pub file: String,
    /// The gates in their order.
    pub gates: Vec<Gate>,
    /// The families and scenes by name.
    pub sites: BTreeMap<String, GateSource>,
}

const KEYS: [&str; 14] = [
    "name",
    "mapper",
    "metric",
    "region",
    "families",
    "scene",
    "set",
    "grid",
    "seeds",
    "at_most",
    "at_least",
    "not_worse_than_baseline_by",
    "better_than",
    "by",
];

pub(super) const DEMANDS: [&str; 4] = ["at_most", "at_least", "not_worse_than_baseline_by", "better_than"];

/// Worlds of each family, or readings of a scene, where the file does not say.
const SEEDS: u64 = 10;

pub(super) const MOST_SEEDS: Limit = Limit {
    min: 1.0,
    max: 1000.0,
    bound: "a whole number from 1 to 1000",
    remedy: "give the number of worlds of each family, such as 10",
};
pub(super) const BOUND: Limit = Limit {
    min: -1e6,
    max: 1e6,
    bound: "a number in the unit of the metric, at most 1000000 in size",
    remedy: "give a bound such as 0.2",
};
pub(super) const MARGIN: Limit = Limit {
    min: 0.0,
    max: 1e6,
    bound: "a difference in the unit of the metric, 0 to 1000000",
    remedy: "give the largest difference that does not matter, such as 0.002; the sign follows from the metric",
};
pub(super) const GRID: Limit = Limit {
    min: 0.01,
    max: 10.0,
    bound: "a cell size in m, 0.01 to 10",
    remedy: "give the side of a cell such as 0.1, or leave it out for the scene's own",
};

/// Reads the file of the gates. `known` are the mappers there are.
///
/// # Errors
/// The first problem, with file, line and column; a family or scene that cannot be read.
pub fn load(path: &Path, known: &[Entry]) -> Result<Gates, SceneError> {
    parse(&read(path)?, &path.display().to_string(), known)
}

/// Checks the text of a file of gates; `file` is what messages call it.
///
/// # Errors
/// As [`load`].
pub fn parse(text: &str, file: &str, known: &[Entry]) -> Result<Gates, SceneError> {
    let (source, document) = open(text, file)?;
    let root = Table::new(&source, "the gates", 0, document.get_ref());
    root.only(&["gate"])?;
    let mut gates = Gates { file: file.to_owned(), gates: Vec::new(), sites: BTreeMap::new() };
    for table in root.list("gate")? {
        let gate = gate(&table, known, &mut gates.sites)?;
        if gates.gates.iter().any(|other| other.name == gate.name) {
            return Err(refuse(&table, "name", "a name that no gate above has", "choose another").into());
        }
        gates.gates.push(gate);
    }
    if gates.gates.is_empty() {
        return Err(root.missing("[[gate]]", "[[gate]] with name, mapper, metric and a bound").into());
    }
    Ok(gates)
}

fn gate(table: &Table, known: &[Entry], sites: &mut BTreeMap<String, GateSource>) -> Result<Gate, SceneError> {
    table.only(&KEYS)?;
    let name = table.name("name")?;
    let mappers: Vec<&str> = known.iter().map(|entry| entry.name).collect();
    let mapper = one_of(table, "mapper", &mappers, None)?;
    let metrics: Vec<&str> = criteria().map(|criterion| criterion.metric).collect();
    let metric = one_of(table, "metric", &metrics, None)?;
    let criterion = criterion(metric).unwrap_or(&CRITERIA[0]); // found: it is one of them
    let (worlds, regions) = worlds(table, sites)?;
    let regions: Vec<&str> = regions.iter().map(String::as_str).collect();
    if !regions.contains(&criterion.region.unwrap_or(Region::Observable.name())) {
        let bound = "a metric of worlds at rest, since nothing moves here but the robot";
        let remedy = "name a scene or families with things that move, such as corridor-people";
        return Err(refuse(table, "metric", bound, remedy).into());
    }
    let usual = criterion.region.unwrap_or(Region::Observable.name());
    let region = one_of(table, "region", &regions, Some(usual))?;
    if !criterion.is_of(region) {
        let of = if usual == Region::All.name() { "of the whole world" } else { "of that region alone" };
        let bound = format!("left out or {usual:?} with {metric}, which is {of}");
        return Err(refuse(table, "region", &bound, "leave it out").into());
    }
    let demand = demand(table, &mappers, mapper, criterion)?;
    let paired = matches!(demand, Demand::NotWorseThanBaselineBy(_) | Demand::BetterThan { .. });
    if paired && worlds.len() < FEWEST_PAIRS {
        let bound = format!("at least {FEWEST_PAIRS} worlds to pair, not {}", worlds.len());
        return Err(refuse(table, "seeds", &bound, "raise seeds, or bound the mean with at_most or at_least").into());
    }
    Ok(Gate { name, mapper: mapper.to_owned(), criterion, region: region.to_owned(), worlds, demand })
}

/// The worlds of a gate, and the regions that all of them have.
fn worlds(table: &Table, sites: &mut BTreeMap<String, GateSource>) -> Result<(Vec<WorldId>, Vec<String>), SceneError> {
    let count = table.optional_whole("seeds", &MOST_SEEDS)?.unwrap_or(SEEDS);
    let cell_um = table.optional_number("grid", &GRID)?.map(|cell_m| (cell_m * MICROMETRES).round() as u32);
    let sets = ["test", "robustness", "tuning"];
    let set = one_of(table, "set", &sets, Some("test"))?;
    let (set, conditions): (Set, &[Condition]) = match set {
        "robustness" => (Set::Robustness, &DEPARTURES),
        "tuning" => (Set::Tuning, &[AS_BELIEVED]),
        _ => (Set::Test, &[AS_BELIEVED]),
    };
    let mut names = Vec::new();
    if table.get("scene").is_some() {
        if let Some(key) = ["families", "set"].into_iter().find(|key| table.get(key).is_some()) {
            return Err(refuse(table, key, "left out beside `scene`", "a scene has neither layouts nor sets").into());
        }
        let (text, value) = one_text(table, "scene")?;
        names.push(site(table, "scene", (text, Some(value)), sites, GateSource::scene)?);
    } else {
        for (family, value) in families(table)? {
            let name = site(table, "families", (&family, value), sites, GateSource::family)?;
            if names.contains(&name) {
                return Err(refuse(table, "families", "different families", "name each once").into());
            }
            names.push(name);
        }
    }
    let mut worlds = Vec::new();
    for family in &names {
        for condition in conditions {
            let world = |seed| WorldId { family: family.clone(), condition: condition.name.to_owned(), cell_um, seed };
            worlds.extend(set.seeds(count).map(world));
        }
    }
    // All of them have the regions by rays; those of worlds that move only if all move.
    let of_all = |region: &&str| names.iter().all(|name| sites[name].regions().contains(region));
    let regions =
        names.first().map(|name| sites[name].regions().into_iter().filter(of_all).map(str::to_owned).collect());
    Ok((worlds, regions.unwrap_or_default()))
}

type Text<'a, 'b> = (&'b str, Option<&'a Value<'a>>);

/// The families asked for with their places, or those that come with the program.
fn families<'a>(table: &Table<'a>) -> Result<Vec<(String, Option<&'a Value<'a>>)>, Error> {
    let Some(value) = table.get("families") else {
        return Ok(FAMILIES.split(',').map(|path| (path.to_owned(), None)).collect());
    };
    let refused = |value| {
        table.refuse(
            "families",
            value,
            "a list of at least one family",
            "write it like [\"clutter\", \"my/attic.toml\"]",
        )
    };
    let items = value.get_ref().as_array().filter(|items| !items.is_empty()).ok_or_else(|| refused(value))?;
    let text = |item: &'a Value<'a>| {
        item.get_ref().as_str().map(|text| (text.to_owned(), Some(item))).ok_or_else(|| refused(item))
    };
    items.iter().map(text).collect()
}

/// Reads the family or scene that is named here, unless it is read already, and gives its name.
fn site(
    table: &Table,
    key: &str,
    (text, value): Text,
    sites: &mut BTreeMap<String, GateSource>,
    load: fn(std::path::PathBuf) -> Result<GateSource, SceneError>,
) -> Result<String, SceneError> {
    let path = path_of(text);
    if let Some(site) = sites.values().find(|site| site.path == path) {
        return Ok(site.name.clone());
    }
    let site = load(path).map_err(|error| match value {
        Some(value) => table
            .refuse(
                key,
                value,
                &format!("a file of its kind that can be read ({error})"),
                "correct the name or the file",
            )
            .into(),
        None => error,
    })?;
    let name = site.name.clone();
    if let Some((other, value)) = sites.get(&name).zip(value) {
        let bound = format!("of another name than {}: both are called {name:?}", other.path.display());
        return Err(table.refuse(key, value, &bound, "rename one, since baselines go by names").into());
    }
    sites.insert(name.clone(), site);
    Ok(name)
}

fn demand(table: &Table, mappers: &[&str], mapper: &str, criterion: &Criterion) -> Result<Demand, Error> {
    let given: Vec<&str> = DEMANDS.into_iter().filter(|key| table.get(key).is_some()).collect();
    let all = DEMANDS.join(", ");
    let &[key] = given.as_slice() else {
        return Err(match given.last() {
            Some(key) => refuse(table, key, &format!("the only one of {all}"), "make a gate of each"),
            None => table.missing("at_most", &format!("one of {all}")),
        });
    };
    if matches!(key, "not_worse_than_baseline_by" | "better_than") && criterion.judged.is_none() {
        let bound = format!("left out with {}, of which neither more nor less is better", criterion.metric);
        return Err(refuse(table, key, &bound, "bound it with at_most or at_least"));
    }
    if key != "better_than" && table.get("by").is_some() {
        return Err(refuse(
            table,
            "by",
            "left out without better_than",
            "it says by how much better the mapper must be",
        ));
    }
    Ok(match key {
        "at_most" => Demand::AtMost(table.number(key, &BOUND)?),
        "at_least" => Demand::AtLeast(table.number(key, &BOUND)?),
        "better_than" => {
            let others: Vec<&str> = mappers.iter().copied().filter(|other| *other != mapper).collect();
            let other = one_of(table, key, &others, None)?.to_owned();
            Demand::BetterThan { mapper: other, by: table.optional_number("by", &MARGIN)?.unwrap_or(0.0) }
        }
        _ => Demand::NotWorseThanBaselineBy(table.number(key, &MARGIN)?),
    })
}

fn one_text<'a>(table: &Table<'a>, key: &str) -> Result<(&'a str, &'a Value<'a>), Error> {
    let Some(value) = table.get(key) else { return Err(table.missing(key, &format!("`{key} = \"...\"`"))) };
    let refused = || table.refuse(key, value, "a text", "write it in quotes");
    value.get_ref().as_str().map(|text| (text, value)).ok_or_else(refused)
}

/// A text that is one of the known ones; the default if there is one and the key is not there.
fn one_of<'t>(table: &Table, key: &str, known: &[&'t str], default: Option<&'t str>) -> Result<&'t str, Error> {
    if let (None, Some(default)) = (table.get(key), default) {
        return Ok(default);
    }
    let (_, value) = one_text(table, key)?;
    table.word(key, value, known)
}

/// A refusal of a key's value; of a key that is not there, it is missing.
fn refuse(table: &Table, key: &str, bound: &str, remedy: &str) -> Error {
    match table.get(key) {
        Some(value) => table.refuse(key, value, bound, remedy),
        None => table.missing(key, &format!("`{key} = ...`: must be {bound}; {remedy}")),
    }
}
