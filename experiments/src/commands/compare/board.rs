//! The running leader board, while worlds are mapped.

use std::collections::BTreeMap;
use std::sync::Mutex;

use score::Region;

use super::world::WorldScores;
use crate::worlds::criteria::CRITERIA;

/// So many mappers are shown.
const SHOWN: usize = 5;

/// Sums of the log losses of each mapper so far, and over how many worlds.
#[derive(Debug, Default)]
pub(super) struct Board(Mutex<BTreeMap<String, (f64, u32)>>);

impl Board {
    /// Takes in a world; the best mappers so far, by the mean over the worlds that each has.
    pub(super) fn with(&self, world: &WorldScores) -> String {
        let Ok(mut sums) = self.0.lock() else { return String::new() };
        let metric = CRITERIA.iter().position(|criterion| criterion.metric == "log_loss").unwrap_or_default();
        for map in &world.maps {
            if let Some(loss) = world.value(&map.mapper, Region::Observable.name(), metric) {
                let (sum, worlds) = sums.entry(map.mapper.clone()).or_default();
                *sum += loss;
                *worlds += 1;
            }
        }
        // The bound by noise-free readings is no competitor.
        let mappers = sums.iter().filter(|(name, _)| *name != "perfect");
        let mut means: Vec<(f64, &str)> = mappers.map(|(name, (sum, n))| (sum / f64::from(*n), &**name)).collect();
        means.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = means.iter().take(SHOWN).map(|(loss, name)| format!("{name} {loss:.3}"));
        format!("lowest log loss so far: {}", best.collect::<Vec<_>>().join(", "))
    }
}
