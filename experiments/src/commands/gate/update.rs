//! New baselines for old, and what changes with them.

use serde_json::json;

use super::file::{Demand, Gate};
use super::measure::{ValueKey, Values};
use crate::output::table::{Table, aligned, optional};

/// How the baseline of a gate changes.
struct Change<'a> {
    gate: &'a Gate,
    /// Means over the worlds, old and new.
    means: [Option<f64>; 2],
    /// Worlds whose value is another.
    changed: usize,
    /// Worlds that had none.
    added: usize,
}

impl Change<'_> {
    fn word(&self) -> &'static str {
        match (self.added, self.changed) {
            (0, 0) => "same",
            (added, _) if added == self.gate.worlds.len() => "new",
            _ => "changed",
        }
    }

    /// New minus old, where both are of the same worlds.
    fn difference(&self) -> Option<f64> {
        let [old, new] = self.means;
        old.zip(new).filter(|_| self.added == 0).map(|(old, new)| new - old)
    }
}

/// The new baselines: of the gates that were measured what was measured, of other gates what there was.
pub fn merged(all: &[Gate], old: &Values, new: Values) -> Values {
    let mut merged = new;
    for gate in all.iter().filter(|gate| matches!(gate.demand, Demand::NotWorseThanBaselineBy(_))) {
        for key in gate.keys(&gate.mapper) {
            if let Some(value) = old.get(&key).filter(|_| !merged.contains_key(&key)) {
                merged.insert(key, *value);
            }
        }
    }
    merged
}

fn changes<'a>(gates: &'a [Gate], old: &Values, new: &Values) -> Vec<Change<'a>> {
    let gates = gates.iter().filter(|gate| matches!(gate.demand, Demand::NotWorseThanBaselineBy(_)));
    let change = |gate: &'a Gate| {
        let keys: Vec<ValueKey> = gate.keys(&gate.mapper).collect();
        let mean = |values: &Values| {
            let values: Vec<f64> = keys.iter().filter_map(|key| values.get(key).copied().flatten()).collect();
            (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
        };
        let bits = |value: Option<f64>| value.map(f64::to_bits);
        let another =
            |key: &&ValueKey| old.get(key).zip(new.get(key)).is_some_and(|(old, new)| bits(*old) != bits(*new));
        Change {
            gate,
            means: [mean(old), mean(new)],
            changed: keys.iter().filter(another).count(),
            added: keys.iter().filter(|key| !old.contains_key(key)).count(),
        }
    };
    gates.map(change).collect()
}

/// What changes, a row per gate with a baseline.
pub fn table(gates: &[Gate], old: &Values, new: &Values) -> Table {
    Table::of(
        &changes(gates, old, new),
        &[
            ("gate", &|c| json!(c.gate.name)),
            ("mapper", &|c| json!(c.gate.mapper)),
            ("metric", &|c| json!(c.gate.criterion.metric)),
            ("unit", &|c| json!(c.gate.criterion.unit)),
            ("region", &|c| json!(c.gate.region)),
            ("old", &|c| optional(c.means[0])),
            ("new", &|c| optional(c.means[1])),
            ("change", &|c| optional(c.difference())),
            ("changed", &|c| json!(c.changed)),
            ("added", &|c| json!(c.added)),
            ("worlds", &|c| json!(c.gate.worlds.len())),
            ("word", &|c| json!(c.word())),
        ],
    )
}

/// The same for reading.
pub fn text(gates: &[Gate], old: &Values, new: &Values) -> String {
    let row = |change: &Change| {
        let decimals = change.gate.criterion.decimals + 1;
        let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"));
        let signed = |value: f64| if change.word() == "same" { "0".to_owned() } else { format!("{value:+.decimals$}") };
        vec![
            change.gate.name.clone(),
            number(change.means[0]),
            number(change.means[1]),
            change.difference().map_or_else(|| "-".to_owned(), signed),
            format!("{} of {}", change.changed + change.added, change.gate.worlds.len()),
            change.word().to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = changes(gates, old, new).iter().map(row).collect();
    aligned(&["gate", "old", "new", "change", "worlds", ""], &rows)
}
