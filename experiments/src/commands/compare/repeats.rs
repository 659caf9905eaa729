//! The same scan, again and again: how often may evidence be counted that is not new?

use mapper::catalogue::{Entry, Kind};
use scene::Family;
use score::{Region, Scorer};

use super::world::WorldJob;
use crate::failure::Failure;
use crate::worlds::site::{Assumptions, Site};
use crate::worlds::witness::Witness;

/// A map after so many repeats of one scan, over what that scan could see.
#[derive(Debug, Clone, PartialEq)]
pub struct Repeated {
    /// Family of the world.
    pub family: String,
    /// Its seed.
    pub seed: u64,
    /// Number of the scan, from 0.
    pub scan: usize,
    /// Name of the mapper.
    pub mapper: &'static str,
    /// How often the scan is in the map.
    pub repeats: usize,
    /// Log loss over the observable region of the scan, nats per cell.
    pub log_loss: Option<f64>,
    /// Share of its free cells held free.
    pub free_known: Option<f64>,
    /// Area of its free cells held occupied, m².
    pub phantom_area: Option<f64>,
    /// Area of its surface cells held free, m².
    pub missed_area: Option<f64>,
}

/// Maps `scans` scans of a world, evenly spread over the drive, each alone and `counts` times, by every
/// mapper that takes scans one by one. A robot that stands still and a camera whose noise does not change
/// do just this.
///
/// # Errors
/// As [`Site::of_family`]; a mapper that gives something else than probabilities.
pub fn repeat(
    job: &WorldJob,
    family: &Family,
    assumed: &Assumptions,
    mappers: &[&'static Entry],
    scans: usize,
    counts: &[usize],
) -> Result<Vec<Repeated>, Failure> {
    let Site { ground, setup } = Site::of_family(family, &job.world, assumed)?;
    let simulation = scene::simulate(&ground.scene, &ground.world, &ground.drive, job.world.seed);
    let mut repeated = Vec::new();
    for number in (0..scans).map(|k| k * simulation.scans.len() / scans) {
        let simulated = &simulation.scans[number];
        let mut witness = Witness::new(&ground);
        witness.look(&ground, number, simulated)?;
        let mask = witness.seen.mask(Region::Observable);
        let scorer = Scorer::new(witness.truth(&ground), witness.seen.surface())?;
        for entry in mappers.iter().filter(|entry| entry.kind == Kind::Online) {
            let mut mapper = entry.mapper(&setup);
            let mut done = 0;
            for &repeats in counts {
                (done..repeats).for_each(|_| mapper.integrate(&simulated.scan));
                done = repeats;
                mapper.settle();
                // A program that gives no map has no values.
                let has_map = mapper.outside().is_none_or(|outside| outside.fault.is_none());
                let scores = has_map.then(|| scorer.scores(mapper.occupancy(), &mask)).transpose()?;
                repeated.push(Repeated {
                    family: job.world.family.clone(),
                    seed: job.world.seed,
                    scan: number,
                    mapper: entry.name,
                    repeats,
                    log_loss: scores.as_ref().and_then(|scores| scores.log_loss.value),
                    free_known: scores.as_ref().and_then(|scores| scores.free_known.value),
                    phantom_area: scores.as_ref().and_then(|scores| scores.phantom_area.value),
                    missed_area: scores.as_ref().and_then(|scores| scores.missed_area.value),
                });
            }
        }
    }
    Ok(repeated)
}
