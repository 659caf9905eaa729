//! Sweep files: TOML, read as strictly as a scene.

use std::path::{Path, PathBuf};

use mapper::catalogue::MAPPERS;
use scene::reader::{Limit, Table, Value as Node, number, open, read};
use scene::{SceneError, Set};
use score::Region;
use serde::Serialize;

use super::parameters::{Kind, PARAMETERS, Parameter, Settings, Value};
use super::regions;

/// A sweep: what is varied over which worlds, and by which mappers they are mapped.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sweep {
    /// Scene and family files, in the order of the file.
    pub sites: Vec<PathBuf>,
    /// Whether they are families.
    pub of_families: bool,
    /// Names of the mappers.
    pub mappers: Vec<String>,
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

const SEED: Limit = Limit {
    min: 0.0,
    max: 9e15,
    bound: "a whole number from 0 to 9e15",
    remedy: "give the first seed, such as 1; of a family it is also the first layout",
};
const COUNT: Limit = Limit {
    min: 1.0,
    max: 1e6,
    bound: "a whole number from 1 to 1000000",
    remedy: "give the number of seeds, such as 4",
};
const STEPS: Limit = Limit {
    min: 2.0,
    max: 10_000.0,
    bound: "a whole number from 2 to 10000",
    remedy: "give how many values there are, both ends included",
};

/// More jobs than this are a mistake in a list.
pub const MOST_JOBS: u64 = 10_000_000;

/// Reads a sweep file.
///
/// # Errors
/// The first problem, with line and column.
pub fn load(path: &Path) -> Result<Sweep, SceneError> {
    parse(&read(path)?, &path.display().to_string())
}

/// Checks the text of a sweep file; `file` is what messages call it.
///
/// # Errors
/// The first problem, with line and column.
pub fn parse(text: &str, file: &str) -> Result<Sweep, SceneError> {
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
    let sweep = Sweep { sites: sites(&root)?, of_families, mappers, first_seed, seeds, regions, set, axes };
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

fn keys() -> Vec<&'static str> {
    PARAMETERS.iter().map(|parameter| parameter.key).collect()
}

/// The files that are named: `scene`, `scenes`, or `families`.
fn sites(root: &Table) -> Result<Vec<PathBuf>, SceneError> {
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
        Some(text) if !text.contains(['/', '.']) => Ok(PathBuf::from(format!("scenes/{text}.toml"))),
        Some(text) => Ok(PathBuf::from(text)),
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

/// A list of at least one item.
fn list<'a>(table: &Table, key: &str, node: &'a Node<'a>) -> Result<&'a [Node<'a>], SceneError> {
    let items = node.get_ref().as_array().filter(|items| !items.is_empty());
    let items: Option<&[Node]> = items.map(|items| &**items);
    items.ok_or_else(|| table.refuse(key, node, "a list of at least one value", "write it like [a, b]"))
}

/// A list of different words out of those known.
fn words(table: &Table, key: &str, known: &[&str]) -> Result<Option<Vec<String>>, SceneError> {
    let Some(node) = table.get(key) else { return Ok(None) };
    let mut words: Vec<String> = Vec::new();
    for item in list(table, key, node)? {
        let word = word(table, key, item, known)?;
        if words.contains(&word) {
            return Err(table.refuse(key, item, "a name that is not named before", "name each once"));
        }
        words.push(word);
    }
    Ok(Some(words))
}

fn word(table: &Table, key: &str, node: &Node, known: &[&str]) -> Result<String, SceneError> {
    let text = node.get_ref().as_str().unwrap_or_default();
    if known.contains(&text) {
        return Ok(text.to_owned());
    }
    let likeness = |known: &&&str| strsim::normalized_damerau_levenshtein(known, text);
    let nearest = known.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b))).copied().unwrap_or_default();
    let bound = format!("one of {}", known.join(", "));
    Err(table.refuse(key, node, &bound, &format!("the nearest is \"{nearest}\"")))
}

fn whole(table: &Table, key: &str, limit: &Limit) -> Result<Option<u64>, SceneError> {
    let number = table.optional_number(key, limit)?;
    match (number, table.get(key)) {
        (Some(number), Some(node)) if number.fract() > 0.0 => Err(table.refuse(key, node, limit.bound, limit.remedy)),
        _ => Ok(number.map(|number| number as u64)),
    }
}

/// First seed and number of seeds.
fn seeds(root: &Table) -> Result<(u64, u64), SceneError> {
    let Some(table) = root.section("seeds")? else { return Ok((Set::FIRST_TEST, 1)) };
    table.only(&["first", "count"])?;
    Ok((whole(&table, "first", &SEED)?.unwrap_or(Set::FIRST_TEST), whole(&table, "count", &COUNT)?.unwrap_or(1)))
}

/// One value of each of some parameters.
fn settings(table: &Table) -> Result<Settings, SceneError> {
    table.only(&keys())?;
    let mut settings = Settings::new();
    for parameter in &PARAMETERS {
        if let Some(node) = table.get(parameter.key) {
            settings.insert(parameter.key.to_owned(), value(table, parameter, node)?);
        }
    }
    Ok(settings)
}

/// Lists of one length that go together.
fn paired(table: &Table) -> Result<Option<Axis>, SceneError> {
    table.only(&keys())?;
    let mut axis = Axis { keys: Vec::new(), steps: Vec::new() };
    for parameter in &PARAMETERS {
        let Some(node) = table.get(parameter.key) else { continue };
        let values = values(table, parameter, node)?;
        if let Some(first) = axis.keys.first().filter(|_| axis.steps.len() != values.len()) {
            let bound = format!("{} values, as many as {first} has", axis.steps.len());
            return Err(table.refuse(parameter.key, node, &bound, "give lists of one length, or use [vary]"));
        }
        axis.steps.resize(values.len(), Vec::new());
        axis.keys.push(parameter.key);
        axis.steps.iter_mut().zip(values).for_each(|(step, value)| step.push(value));
    }
    Ok(Some(axis).filter(|axis| !axis.keys.is_empty()))
}

/// A list, a range, or one value of a parameter.
fn values(table: &Table, parameter: &'static Parameter, node: &Node) -> Result<Vec<Value>, SceneError> {
    let key = parameter.key;
    if node.get_ref().as_table().is_some() {
        return range(table, parameter, node);
    }
    let mut values = Vec::new();
    for item in list(table, key, node)? {
        let value = value(table, parameter, item)?;
        if values.contains(&value) {
            return Err(table.refuse(key, item, "a value that is not given before", "give each once"));
        }
        values.push(value);
    }
    Ok(values)
}

/// `{ from, to, steps }`, both ends included; with `log = true` in equal ratios.
fn range(table: &Table, parameter: &'static Parameter, node: &Node) -> Result<Vec<Value>, SceneError> {
    let key = parameter.key;
    let (Kind::Number(limit), Some(range)) = (&parameter.kind, table.section(key)?) else {
        return Err(table.refuse(key, node, "a list", "a range is for numbers; write the values like [a, b]"));
    };
    range.only(&["from", "to", "steps", "log"])?;
    let (from, to) = (range.number("from", limit)?, range.number("to", limit)?);
    let steps = whole(&range, "steps", &STEPS)?.ok_or_else(|| range.missing("steps", "`steps = 5`"))?;
    let log = match range.get("log").map(|node| (node, node.get_ref().as_bool())) {
        Some((node, None)) => return Err(range.refuse("log", node, "true or false", "leave it out for equal steps")),
        Some((_, Some(log))) => log,
        None => false,
    };
    if to <= from || log && from <= 0.0 {
        let bound = if log { "from above 0, and to above from" } else { "to above from" };
        return Err(table.refuse(key, node, bound, "exchange the ends, or give a list"));
    }
    let last = (steps - 1) as f64;
    let at = |k: u64| {
        let share = k as f64 / last;
        let value = if log { from * libm::pow(to / from, share) } else { from + (to - from) * share };
        // Twelve digits: the ends and 0.1 + 0.2 are what was meant.
        format!("{value:.11e}").parse().unwrap_or(value)
    };
    Ok((0..steps).map(|k| Value::Number(at(k))).collect())
}

fn value(table: &Table, parameter: &'static Parameter, node: &Node) -> Result<Value, SceneError> {
    let key = parameter.key;
    let numeric = |limit: &Limit, whole: bool| {
        let fits = |v: &f64| limit.allows(*v) && (!whole || v.fract().abs() <= 0.0);
        let number = number(node).filter(fits);
        number.map(Value::Number).ok_or_else(|| table.refuse(key, node, limit.bound, limit.remedy))
    };
    match &parameter.kind {
        Kind::Number(limit) => numeric(limit, false),
        Kind::Whole(limit) => numeric(limit, true),
        Kind::Word(known) => word(table, key, node, known).map(Value::Word),
    }
}

/// Refuses a parameter that is given in two places, and two that say the same thing.
fn once(root: &Table, sweep: &Sweep) -> Result<(), SceneError> {
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
    if places("size_factor") > 0 && root.get("families").is_none() {
        refuse("size_factor", "left out without families, whose obstacles it is about", "use `families = [..]`")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn axes(text: &str) -> Result<Sweep, SceneError> {
        parse(&format!("scene = \"a.toml\"\nmappers = [\"prior\"]\n{text}"), "s.toml")
    }

    fn numbers(axis: &Axis) -> Vec<f64> {
        let number = |step: &Vec<Value>| match step.as_slice() {
            [Value::Number(number)] => *number,
            other => panic!("{other:?}"),
        };
        axis.steps.iter().map(number).collect()
    }

    #[test]
    fn ranges_hold_both_ends_and_the_numbers_that_were_meant() {
        let sweep = axes("[vary]\ngrid = { from = 0.1, to = 0.5, steps = 5 }").expect("valid");
        assert_eq!(format!("{:?}", numbers(&sweep.axes[0])), "[0.1, 0.2, 0.3, 0.4, 0.5]");
        let sweep = axes("[vary]\ngrid = { from = 0.01, to = 10.0, steps = 4, log = true }").expect("valid");
        assert_eq!(format!("{:?}", numbers(&sweep.axes[0])), "[0.01, 0.1, 1.0, 10.0]");
    }

    #[test]
    fn every_combination_once_and_pairs_together() {
        let text = "[set]\nprior = 0.2\n[vary]\ngrid = [0.1, 0.2, 0.5]\nmismatches = [\"independent\", \"clustered\"]\n\
                    [paired]\ndisparity_sigma = [0.5, 1.0]\nbelieved_sigma = [0.6, 0.7]";
        let sweep = axes(text).expect("valid");
        assert_eq!((sweep.settings_count(), sweep.jobs()), (Some(12), Some(12)));
        let all: Vec<Settings> = (0..12).map(|number| sweep.settings(number)).collect();
        for (k, settings) in all.iter().enumerate() {
            assert!(!all[..k].contains(settings), "{settings:?} twice");
            assert_eq!(settings.len(), 5);
            assert_eq!(settings["prior"], Value::Number(0.2));
            let first = settings["disparity_sigma"] == Value::Number(0.5);
            assert_eq!(settings["believed_sigma"], Value::Number(if first { 0.6 } else { 0.7 }));
        }
        assert_eq!(sweep.keys(), ["disparity_sigma", "mismatches", "grid", "prior", "believed_sigma"]);
    }

    #[test]
    fn every_parameter_is_refused_beyond_its_bounds_with_its_place() {
        for parameter in &PARAMETERS {
            let (wrong, bound) = match &parameter.kind {
                Kind::Number(limit) | Kind::Whole(limit) => (vec!["-1.0", "1e9", "nan", "\"x\"", "true"], limit.bound),
                Kind::Word(_) => (vec!["1", "\"x\"", "[]"], "one of "),
            };
            for value in wrong {
                for (section, given) in [("set", value.to_owned()), ("vary", format!("[{value}]"))] {
                    let key = parameter.key;
                    let text = format!("[{section}]\n{key} = {given}");
                    let error = axes(&text).expect_err(&text).to_string();
                    let column = key.len() + if section == "set" { 4 } else { 5 };
                    assert!(error.contains(&format!("s.toml:4:{column}: [{section}]: {key} = ")), "{text}: {error}");
                    assert!(error.contains(bound), "{text}: {error}");
                }
            }
        }
    }

    #[test]
    fn ranges_that_cannot_be() {
        for (range, expected) in [
            ("{ from = 0.1, to = 0.1, steps = 3 }", "to above from"),
            ("{ from = 0.1, to = 1.0, steps = 1 }", "steps = 1"),
            ("{ from = 0.1, to = 1.0, steps = 2.5 }", "steps = 2.5"),
            ("{ from = 0.1, to = 1.0, steps = 3, log = 1 }", "true or false"),
            ("{ from = 0.1, to = 1.0, step = 3 }", "unknown key `step`"),
            ("{ to = 1.0, steps = 3 }", "`from` is missing"),
            ("{ from = 0.1, to = 99.0, steps = 3 }", "to = 99"),
            ("[]", "a list of at least one value"),
        ] {
            let error = axes(&format!("[vary]\ngrid = {range}")).expect_err(range).to_string();
            assert!(error.contains(expected) && error.contains("s.toml:4:"), "{range}: {error}");
        }
        let words = axes("[vary]\nmismatches = { from = 0.0, to = 1.0, steps = 2 }").expect_err("words").to_string();
        assert!(words.contains("a range is for numbers"), "{words}");
        let zero =
            axes("[vary]\nprior = { from = 0.0, to = 1.0, steps = 3, log = true }").expect_err("zero").to_string();
        assert!(zero.contains("from above 0"), "{zero}");
    }
}
