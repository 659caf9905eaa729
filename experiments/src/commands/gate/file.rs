//! The file of the gates: TOML, read as strictly as a scene.

use std::collections::BTreeMap;
use std::path::Path;

use mapper::catalogue::Entry;
use scene::{SceneError, Set};
use score::{FEWEST_PAIRS, MovingRegion, Region};
use strict::{Error, Findings, Limit, Table, Value, first, open, read};

use super::source::GateSource;
use crate::worlds::condition::{AS_BELIEVED, Condition, DEPARTURES, condition, departures};
use crate::worlds::criteria::{Criterion, criteria, criterion};
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

const KEYS: [&str; 15] = [
    "name",
    "mapper",
    "metric",
    "region",
    "families",
    "scene",
    "set",
    "condition",
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

type Found = Findings<SceneError>;

/// Reads the file of the gates. `known` are the mappers there are.
///
/// # Errors
/// All that is wrong with it, with file, line and column; families or scenes that cannot be read.
pub fn load(path: &Path, known: &[Entry]) -> Result<Gates, Vec<SceneError>> {
    examine(&read(path).map_err(|error| vec![error.into()])?, &path.display().to_string(), known)
}

/// Checks the text of a file of gates; `file` is what messages call it.
///
/// # Errors
/// The first problem; as [`load`].
pub fn parse(text: &str, file: &str, known: &[Entry]) -> Result<Gates, SceneError> {
    examine(text, file, known).map_err(first)
}

/// As [`parse`].
///
/// # Errors
/// Every problem but those that follow from another; as [`load`].
pub fn examine(text: &str, file: &str, known: &[Entry]) -> Result<Gates, Vec<SceneError>> {
    let (source, document) = open(text, file).map_err(|error| vec![error.into()])?;
    let root = Table::new(&source, "the gates", 0, document.get_ref());
    let mut found = Found::default();
    let gates = checked(&root, file, known, &mut found);
    found.or(gates)
}

fn checked(root: &Table, file: &str, known: &[Entry], found: &mut Found) -> Option<Gates> {
    found.only(root, &["gate"]);
    let tables = found.take(root.list("gate"))?;
    if tables.is_empty() {
        found.add(root.missing("[[gate]]", "[[gate]] with name, mapper, metric and a bound"));
    }
    let mut gates = Gates { file: file.to_owned(), gates: Vec::new(), sites: BTreeMap::new() };
    let mut names: Vec<String> = Vec::new();
    for table in &tables {
        found.only(table, &KEYS);
        let name = found.take(table.name("name"));
        if name.as_ref().is_some_and(|name| names.contains(name)) {
            found.add(refuse(table, "name", "a name that no gate above has", "choose another"));
        }
        names.extend(name.clone());
        gates.gates.extend(gate(table, name, known, &mut gates.sites, found));
    }
    Some(gates)
}

fn gate(
    table: &Table,
    name: Option<String>,
    known: &[Entry],
    sites: &mut BTreeMap<String, GateSource>,
    found: &mut Found,
) -> Option<Gate> {
    let mappers: Vec<&str> = known.iter().map(|entry| entry.name).collect();
    let mapper = found.take(one_of(table, "mapper", &mappers, None));
    let metrics: Vec<&str> = criteria().map(|criterion| criterion.metric).collect();
    let criterion = found.take(one_of(table, "metric", &metrics, None)).and_then(criterion);
    let placed = worlds(table, sites, found);
    let region = criterion.zip(placed.as_ref()).and_then(|(criterion, (_, regions))| {
        let regions: Vec<&str> = regions.iter().map(String::as_str).collect();
        let usual = criterion.region.unwrap_or(Region::Observable.name());
        if !regions.contains(&usual) {
            let bound = "a metric of worlds at rest, since nothing moves here but the robot";
            let remedy = "name a scene or families with things that move, such as corridor-people";
            found.add(refuse(table, "metric", bound, remedy));
            return None;
        }
        let region = found.take(one_of(table, "region", &regions, Some(usual)))?;
        if !criterion.is_of(region) {
            let of = if usual == Region::All.name() { "of the whole world" } else { "of that region alone" };
            let bound = format!("left out or {usual:?} with {}, which is {of}", criterion.metric);
            found.add(refuse(table, "region", &bound, "leave it out"));
        }
        Some(region.to_owned())
    });
    let demand = demand(table, &mappers, mapper, criterion, found);
    let paired = matches!(demand, Some(Demand::NotWorseThanBaselineBy(_) | Demand::BetterThan { .. }));
    if let Some((worlds, _)) = placed.as_ref().filter(|(worlds, _)| paired && worlds.len() < FEWEST_PAIRS) {
        let bound = format!("at least {FEWEST_PAIRS} worlds to pair, not {}", worlds.len());
        found.add(refuse(table, "seeds", &bound, "raise seeds, or bound the mean with at_most or at_least"));
    }
    Some(Gate {
        name: name?,
        mapper: mapper?.to_owned(),
        criterion: criterion?,
        region: region?,
        worlds: placed?.0,
        demand: demand?,
    })
}

/// The worlds of a gate, and the regions that all of them have.
fn worlds(
    table: &Table,
    sites: &mut BTreeMap<String, GateSource>,
    found: &mut Found,
) -> Option<(Vec<WorldId>, Vec<String>)> {
    let count = found.take(table.optional_whole("seeds", &MOST_SEEDS));
    let cell_m = found.take(table.optional_number("grid", &GRID));
    let sets = ["test", "robustness", "tuning"];
    let set = found.take(one_of(table, "set", &sets, Some("test")));
    let names = places(table, sites, found);
    let asked = match table.get("condition") {
        Some(_) => Some(found.take(condition_of(table))?),
        None => None,
    };
    let (set, usual): (Set, Vec<&Condition>) = match set? {
        "robustness" => (Set::Robustness, DEPARTURES.iter().collect()),
        "tuning" => (Set::Tuning, vec![&AS_BELIEVED]),
        _ => (Set::Test, vec![&AS_BELIEVED]),
    };
    let conditions = asked.map_or(usual, |asked| vec![asked]);
    let (names, count) = (names?, count?.unwrap_or(SEEDS));
    let cell_um = cell_m?.map(|cell_m| (cell_m * MICROMETRES).round() as u32);
    let mut worlds = Vec::new();
    for family in &names {
        for condition in &conditions {
            let world = |seed| WorldId { family: family.clone(), condition: condition.name.to_owned(), cell_um, seed };
            worlds.extend(set.seeds(count).map(world));
        }
    }
    // All of them have the regions by rays; those of worlds that move only if all move.
    let of_all = |region: &&str| names.iter().all(|name| sites[name].regions().contains(region));
    let mut regions: Vec<String> =
        names.first().map(|name| sites[name].regions().into_iter().filter(of_all).map(str::to_owned).collect())?;
    if conditions.iter().all(|condition| condition.people_per_100_m2.is_some()) {
        let moving = MovingRegion::ALL.iter().map(|region| region.name().to_owned());
        regions.extend(moving.filter(|region| !regions.contains(region)).collect::<Vec<_>>());
    }
    Some((worlds, regions))
}

/// How the world differs from what mappers assume. A scene has its own obstacles and people.
fn condition_of(table: &Table) -> Result<&'static Condition, Error> {
    let known: Vec<&str> = [&AS_BELIEVED].into_iter().chain(departures()).map(|condition| condition.name).collect();
    let name = one_of(table, "condition", &known, None)?;
    let condition = condition(name).unwrap_or(&AS_BELIEVED); // a name that is known
    if table.get("scene").is_some() && condition.of_layouts() {
        let remedy = "name families, or change the scene";
        return Err(refuse(
            table,
            "condition",
            "one that does not change obstacles or people, which a scene has of its own",
            remedy,
        ));
    }
    Ok(condition)
}

/// The names of the scene or families; none where one of them cannot be read.
fn places(table: &Table, sites: &mut BTreeMap<String, GateSource>, found: &mut Found) -> Option<Vec<String>> {
    if table.get("scene").is_some() {
        for key in ["families", "set"].into_iter().filter(|key| table.get(key).is_some()) {
            found.add(refuse(table, key, "left out beside `scene`", "a scene has neither layouts nor sets"));
        }
        let (text, value) = found.take(one_text(table, "scene"))?;
        return Some(vec![found.take(site(table, "scene", (text, Some(value)), sites, GateSource::scene))?]);
    }
    let (mut names, mut all) = (Vec::new(), true);
    for (family, value) in found.take(families(table))? {
        match found.take(site(table, "families", (&family, value), sites, GateSource::family)) {
            Some(name) if names.contains(&name) => {
                found.add(refuse(table, "families", "different families", "name each once"));
            }
            Some(name) => names.push(name),
            None => all = false,
        }
    }
    all.then_some(names)
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

fn demand(
    table: &Table,
    mappers: &[&str],
    mapper: Option<&str>,
    criterion: Option<&Criterion>,
    found: &mut Found,
) -> Option<Demand> {
    let given: Vec<&str> = DEMANDS.into_iter().filter(|key| table.get(key).is_some()).collect();
    let all = DEMANDS.join(", ");
    let &[key] = given.as_slice() else {
        found.add(match given.last() {
            Some(key) => refuse(table, key, &format!("the only one of {all}"), "make a gate of each"),
            None => table.missing("at_most", &format!("one of {all}")),
        });
        return None;
    };
    let unjudged = criterion.filter(|criterion| criterion.judged.is_none());
    if let Some(criterion) = unjudged.filter(|_| matches!(key, "not_worse_than_baseline_by" | "better_than")) {
        let bound = format!("left out with {}, of which neither more nor less is better", criterion.metric);
        found.add(refuse(table, key, &bound, "bound it with at_most or at_least"));
    }
    if key != "better_than" && table.get("by").is_some() {
        let remedy = "it says by how much better the mapper must be";
        found.add(refuse(table, "by", "left out without better_than", remedy));
    }
    Some(match key {
        "at_most" => Demand::AtMost(found.take(table.number(key, &BOUND))?),
        "at_least" => Demand::AtLeast(found.take(table.number(key, &BOUND))?),
        "better_than" => {
            let others: Vec<&str> = mappers.iter().copied().filter(|other| Some(*other) != mapper).collect();
            let other = found.take(one_of(table, key, &others, None));
            let by = found.take(table.optional_number("by", &MARGIN))?.unwrap_or(0.0);
            Demand::BetterThan { mapper: other?.to_owned(), by }
        }
        _ => Demand::NotWorseThanBaselineBy(found.take(table.number(key, &MARGIN))?),
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
