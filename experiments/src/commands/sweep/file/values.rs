//! Values of parameters: one, a list, a range, or lists that go together.

use strict::{Error, Limit, Table, Value as Node, number};

use super::{Axis, Found};
use crate::commands::sweep::parameters::{PARAMETERS, Parameter, ParameterKind, Settings, Value};

const STEPS: Limit = Limit {
    min: 2.0,
    max: 10_000.0,
    bound: "a whole number from 2 to 10000",
    remedy: "give how many values there are, both ends included",
};

/// Keys of all parameters.
pub(super) fn keys() -> Vec<&'static str> {
    PARAMETERS.iter().map(|parameter| parameter.key).collect()
}

/// A list of at least one item.
pub(super) fn list<'a>(table: &Table, key: &str, node: &'a Node<'a>) -> Result<&'a [Node<'a>], Error> {
    let items = node.get_ref().as_array().filter(|items| !items.is_empty());
    let items: Option<&[Node]> = items.map(|items| &**items);
    items.ok_or_else(|| table.refuse(key, node, "a list of at least one value", "write it like [a, b]"))
}

/// One value of each of some parameters.
pub(super) fn settings(table: &Table, found: &mut Found) -> Settings {
    found.only(table, &keys());
    let given = PARAMETERS.iter().filter_map(|parameter| Some((parameter, table.get(parameter.key)?)));
    let value = |(parameter, node): (&'static Parameter, _)| {
        Some((parameter.key.to_owned(), found.take(value(table, parameter, node))?))
    };
    given.filter_map(value).collect()
}

/// Lists of one length that go together.
pub(super) fn paired(table: &Table, found: &mut Found) -> Option<Axis> {
    found.only(table, &keys());
    let mut axis = Axis { keys: Vec::new(), steps: Vec::new() };
    for parameter in &PARAMETERS {
        let Some(node) = table.get(parameter.key) else { continue };
        let before = found.count();
        let values = values(table, parameter, node, found);
        if found.count() > before {
            continue; // how many it would have is not known
        }
        if let Some(first) = axis.keys.first().filter(|_| axis.steps.len() != values.len()) {
            let bound = format!("{} values, as many as {first} has", axis.steps.len());
            found.add(table.refuse(parameter.key, node, &bound, "give lists of one length, or use [vary]"));
            continue;
        }
        axis.steps.resize(values.len(), Vec::new());
        axis.keys.push(parameter.key);
        axis.steps.iter_mut().zip(values).for_each(|(step, value)| step.push(value));
    }
    Some(axis).filter(|axis| !axis.keys.is_empty())
}

/// A list, a range, or one value of a parameter.
pub(super) fn values(table: &Table, parameter: &'static Parameter, node: &Node, found: &mut Found) -> Vec<Value> {
    let key = parameter.key;
    if node.get_ref().as_table().is_some() {
        return range(table, parameter, node, found).unwrap_or_default();
    }
    let mut values = Vec::new();
    for item in found.take(list(table, key, node)).into_iter().flatten() {
        let Some(value) = found.take(value(table, parameter, item)) else { continue };
        if values.contains(&value) {
            found.add(table.refuse(key, item, "a value that is not given before", "give each once"));
        }
        values.push(value);
    }
    values
}

/// `{ from, to, steps }`, both ends included; with `log = true` in equal ratios.
fn range(table: &Table, parameter: &'static Parameter, node: &Node, found: &mut Found) -> Option<Vec<Value>> {
    let key = parameter.key;
    let (ParameterKind::Number(limit) | ParameterKind::Both(limit), Some(range)) =
        (&parameter.kind, found.take(table.section(key))?)
    else {
        found.add(table.refuse(key, node, "a list", "a range is for numbers; write the values like [a, b]"));
        return None;
    };
    found.only(&range, &["from", "to", "steps", "log"]);
    let ends = [found.take(range.number("from", limit)), found.take(range.number("to", limit))];
    let steps = found.take(range.optional_whole("steps", &STEPS));
    if steps == Some(None) {
        found.add(range.missing("steps", "`steps = 5`"));
    }
    let log = match range.get("log").map(|node| (node, node.get_ref().as_bool())) {
        Some((node, None)) => {
            found.add(range.refuse("log", node, "true or false", "leave it out for equal steps"));
            return None;
        }
        Some((_, Some(log))) => log,
        None => false,
    };
    let [from, to] = [ends[0]?, ends[1]?];
    if to <= from || log && from <= 0.0 {
        let bound = if log { "from above 0, and to above from" } else { "to above from" };
        found.add(table.refuse(key, node, bound, "exchange the ends, or give a list"));
        return None;
    }
    let steps = steps??;
    let last = (steps - 1) as f64;
    let at = |k: u64| {
        let share = k as f64 / last;
        let value = if log { from * libm::pow(to / from, share) } else { from + (to - from) * share };
        // Twelve digits: the ends and 0.1 + 0.2 are what was meant.
        format!("{value:.11e}").parse().unwrap_or(value)
    };
    Some((0..steps).map(|k| Value::Number(at(k))).collect())
}

fn value(table: &Table, parameter: &'static Parameter, node: &Node) -> Result<Value, Error> {
    let key = parameter.key;
    let numeric = |limit: &Limit, whole: bool| {
        let fits = |v: &f64| limit.allows(*v) && (!whole || v.fract().abs() <= 0.0);
        let number = number(node).filter(fits);
        number.map(Value::Number).ok_or_else(|| table.refuse(key, node, limit.bound, limit.remedy))
    };
    match &parameter.kind {
        ParameterKind::Number(limit) | ParameterKind::Both(limit) => numeric(limit, false),
        ParameterKind::Whole(limit) => numeric(limit, true),
        ParameterKind::Word(known) => table.word(key, node, known).map(|word| Value::Word(word.to_owned())),
    }
}
