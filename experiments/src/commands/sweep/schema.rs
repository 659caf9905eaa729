//! The schema of sweep files.

use mapper::catalogue::MAPPERS;
use serde_json::{Value, json};
use strict::Limit;

use super::file::{COUNT, SEED};
use super::parameters::{PARAMETERS, Parameter, ParameterKind};
use super::regions;
use crate::worlds::schema::{between, file, flag, list, number, table, text, whole, word};

/// The schema of sweep files.
pub fn schema() -> Value {
    let names = |known: &[&str]| {
        let mut names = list("Names, each once", word("A name", known.iter().copied()), 1);
        names["uniqueItems"] = json!(true);
        names
    };
    let mut files = list("Files, or names of those that come with the program", text("A file or a name"), 1);
    files["uniqueItems"] = json!(true);
    let seeds = [("first", whole("The first seed", &SEED)), ("count", whole("How many seeds", &COUNT))];
    let of = |values: fn(&Parameter) -> Value| PARAMETERS.iter().map(|p| (p.key, values(p))).collect::<Vec<_>>();
    let keys = [
        ("scene", text("A scene")),
        ("scenes", files.clone()),
        ("families", files),
        ("mappers", names(&MAPPERS.iter().map(|entry| entry.name).collect::<Vec<_>>())),
        ("seeds", table("Seeds of the readings; of a family also the layouts", &seeds, &[])),
        ("regions", names(&regions::known())),
        ("set", table("The same in every job", &of(value), &[])),
        ("vary", table("Every combination of these", &of(values), &[])),
        ("paired", table("Lists of one length that go together", &of(values), &[])),
    ];
    let mut schema = file("A sweep: many settings over many worlds", &keys, &["mappers"]);
    schema["oneOf"] = ["scene", "scenes", "families"].map(|key| json!({ "required": [key] })).into();
    schema
}

/// One value of a parameter.
fn value(parameter: &Parameter) -> Value {
    match &parameter.kind {
        ParameterKind::Number(limit) | ParameterKind::Both(limit) => number(parameter.about, limit),
        ParameterKind::Whole(limit) => whole(parameter.about, limit),
        ParameterKind::Word(words) => word(parameter.about, words.iter().copied()),
    }
}

/// A list of values, or a range of numbers.
fn values(parameter: &Parameter) -> Value {
    let mut all = list("Values, each once", value(parameter), 1);
    all["uniqueItems"] = json!(true);
    let (ParameterKind::Number(limit) | ParameterKind::Both(limit)) = &parameter.kind else { return all };
    json!({ "description": parameter.about, "anyOf": [all, range(limit)] })
}

fn range(limit: &Limit) -> Value {
    let mut steps = between("How many values, both ends among them", 2.0, 10_000.0);
    steps["multipleOf"] = json!(1);
    let keys = [
        ("from", number("The first value", limit)),
        ("to", number("The last value", limit)),
        ("steps", steps),
        ("log", flag("In equal ratios, in place of equal steps")),
    ];
    table("Values in equal steps", &keys, &["from", "to", "steps"])
}
