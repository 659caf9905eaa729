//! Values of parameters: one, a list, a range, or lists that go together.

use strict::{Error, Limit, Table, Value as Node, number};

use super::Axis;
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
pub(super) fn settings(table: &Table) -> Result<Settings, Error> {
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
pub(super) fn paired(table: &Table) -> Result<Option<Axis>, Error> {
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
pub(super) fn values(table: &Table, parameter: &'static Parameter, node: &Node) -> Result<Vec<Value>, Error> {
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
fn range(table: &Table, parameter: &'static Parameter, node: &Node) -> Result<Vec<Value>, Error> {
    let key = parameter.key;
    let (ParameterKind::Number(limit) | ParameterKind::Both(limit), Some(range)) =
        (&parameter.kind, table.section(key)?)
    else {
        return Err(table.refuse(key, node, "a list", "a range is for numbers; write the values like [a, b]"));
    };
    range.only(&["from", "to", "steps", "log"])?;
    let (from, to) = (range.number("from", limit)?, range.number("to", limit)?);
    let steps = range.optional_whole("steps", &STEPS)?.ok_or_else(|| range.missing("steps", "`steps = 5`"))?;
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
