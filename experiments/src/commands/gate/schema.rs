//! The schema of files of gates.

use serde_json::{Value, json};

use super::file::{BOUND, DEMANDS, GRID, MARGIN, MOST_SEEDS};
use crate::worlds::condition::{AS_BELIEVED, departures};
use crate::worlds::criteria::criteria;
use crate::worlds::schema::{file, list, name, number, table, text, whole, word};

/// The schema of files of gates. Mappers may be programs of one's own, so that any name will do.
pub fn schema() -> Value {
    let conditions = || [&AS_BELIEVED].into_iter().chain(departures()).map(|condition| condition.name);
    let families = list("Families of generated scenes", text("A file, or a name"), 1);
    let keys = [
        ("name", name("Name of the gate", 32)),
        ("mapper", text("Name of the mapper that is judged")),
        ("metric", word("What it is judged by", criteria().map(|criterion| criterion.metric))),
        ("region", text("Where maps are judged; the metric's usual region if left out")),
        ("families", families),
        ("scene", text("A scene, in place of families")),
        ("set", word("Which layouts", ["test", "robustness", "tuning"])),
        ("condition", word("How the world differs from what mappers assume", conditions())),
        ("grid", number("Side of a cell", &GRID)),
        ("seeds", whole("Worlds of each family, or readings of a scene", &MOST_SEEDS)),
        ("at_most", number("The mean is at most this", &BOUND)),
        ("at_least", number("The mean is at least this", &BOUND)),
        ("not_worse_than_baseline_by", number("The mean is not surely worse than before by more", &MARGIN)),
        ("better_than", text("Name of a mapper that this one is surely better than ...")),
        ("by", number("... by more than this", &MARGIN)),
    ];
    let mut gate = table("What must hold of a mapper's maps", &keys, &["name", "mapper", "metric"]);
    gate["oneOf"] = DEMANDS.map(|key| json!({ "required": [key] })).into();
    gate["dependencies"] = json!({ "by": ["better_than"], "scene": { "not": { "anyOf": [
        { "required": ["families"] }, { "required": ["set"] },
    ] } } });
    file("Gates: what must hold of maps, or the build fails", &[("gate", list("Gates", gate, 1))], &["gate"])
}
