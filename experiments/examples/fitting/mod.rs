//! What the programs share that try numbers of mappers on tuning worlds.

use std::error::Error;
use std::path::PathBuf;

use experiments::commands::tune::fit::errors;
use experiments::worlds::scenes::{FAMILIES, SCENES, families};
use experiments::worlds::site::WorldId;
use mapper::Candidate;
use scene::{Family, Set};

/// The layouts that the tuning worlds are of.
pub(crate) struct Worlds {
    families: Vec<Family>,
    layouts: u64,
}

impl Worlds {
    /// So many tuning worlds of each family as the first argument says; one without it.
    pub(crate) fn asked_for() -> Result<Self, Box<dyn Error>> {
        let layouts: u64 = std::env::args().nth(1).map_or(Ok(1), |number| number.parse())?;
        let paths: Vec<PathBuf> =
            FAMILIES.split(',').map(|name| PathBuf::from(SCENES).join(format!("{name}.toml"))).collect();
        Ok(Self { families: families(&paths)?, layouts })
    }

    /// The heads of the columns of [`losses`](Self::losses).
    pub(crate) fn heads(&self) -> String {
        let names: Vec<&str> = self.families.iter().map(|family| family.name.as_str()).collect();
        format!("{},mean", names.join(","))
    }

    /// The log loss of a candidate over what could be seen: the mean of each family, and that of all.
    pub(crate) fn losses(&self, candidate: &Candidate) -> Result<String, Box<dyn Error>> {
        let mut means = Vec::new();
        for family in &self.families {
            let mut sum = 0.0;
            for seed in Set::Tuning.seeds(self.layouts) {
                let condition = "as-believed".to_owned();
                let world = WorldId { family: family.name.clone(), condition, cell_um: None, seed };
                sum += errors(&world, family, std::slice::from_ref(candidate))?[0].log_loss;
            }
            means.push(sum / self.layouts as f64);
        }
        means.push(means.iter().sum::<f64>() / means.len() as f64);
        let means: Vec<String> = means.iter().map(|mean| format!("{mean:.4}")).collect();
        Ok(means.join(","))
    }
}
