//! Mapping and scoring what the gates ask for.

use std::collections::{BTreeMap, BTreeSet};
use std::panic::{AssertUnwindSafe, catch_unwind};

use mapper::Model;
use mapper::catalogue::Entry;

use super::file::{Demand, Gate, Gates};
use crate::failure::{Failure, panic_text};
use crate::jobs::engine;
use crate::jobs::progress::Count;
use crate::output::table::rounded;
use crate::worlds::aligned::{self, ALIGNED, aligned};
use crate::worlds::criteria::criterion;
use crate::worlds::drives;
use crate::worlds::ground::Ground;
use crate::worlds::run::{Keep, Trial};
use crate::worlds::site::{Site, WorldId};

/// What a value is of. Its order is that of the baselines.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct ValueKey {
    /// Name of the mapper.
    pub mapper: String,
    /// Name of the metric.
    pub metric: String,
    /// Name of the region.
    pub region: String,
    /// The world.
    pub world: WorldId,
}

/// Values of metrics, rounded as in every file; none where a metric is not defined.
pub type Values = BTreeMap<ValueKey, Option<f64>>;

/// What was measured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Measured {
    /// The values ...
    pub values: Values,
    /// ... and of mappers that failed on a world, why.
    pub failures: BTreeMap<(String, WorldId), String>,
}

/// A metric's name and a region's.
type Wanted = BTreeSet<(String, String)>;

impl Gate {
    /// The values of a mapper that the gate looks at, world by world.
    pub fn keys<'a>(&'a self, mapper: &'a str) -> impl Iterator<Item = ValueKey> + 'a {
        self.worlds.iter().map(move |world| ValueKey {
            mapper: mapper.to_owned(),
            metric: self.criterion.metric.to_owned(),
            region: self.region.clone(),
            world: world.clone(),
        })
    }

    /// The mappers that the gate needs.
    pub fn mappers(&self) -> Vec<&str> {
        match &self.demand {
            Demand::BetterThan { mapper, .. } => vec![&self.mapper, mapper],
            _ => vec![&self.mapper],
        }
    }
}

/// The worlds that gates need, and what of them: values by mapper.
pub fn plan(gates: &[Gate]) -> BTreeMap<WorldId, BTreeMap<String, Wanted>> {
    let mut plan: BTreeMap<WorldId, BTreeMap<String, Wanted>> = BTreeMap::new();
    for gate in gates {
        for mapper in gate.mappers() {
            for ValueKey { mapper, metric, region, world } in gate.keys(mapper) {
                plan.entry(world).or_default().entry(mapper).or_default().insert((metric, region));
            }
        }
    }
    plan
}

/// Maps every world that the gates need by the mappers that they judge, a world to a thread at a time. The result
/// does not depend on the number of threads. `stream` 0 gives the readings that baselines are made from, any
/// other number other readings of the same worlds.
///
/// A mapper that fails, by a panic too, is a finding and ends nothing.
///
/// # Errors
/// A world that cannot be made; a mapper that is not among the known ones.
pub fn measure(gates: &Gates, known: &[Entry], stream: u32, threads: usize) -> Result<Measured, Failure> {
    let jobs: Vec<(WorldId, BTreeMap<String, Wanted>)> = plan(&gates.gates).into_iter().collect();
    let progress = Count::worlds(jobs.len());
    let parts = engine::each(&jobs, threads, |(world, wanted)| {
        let source = gates.sites.get(&world.family);
        let source = source.ok_or_else(|| Failure::Internal(format!("there is no family {:?}", world.family)))?;
        let Site { ground, setup } = source.site(world)?;
        let drives = wanted
            .values()
            .flatten()
            .any(|(metric, _)| criterion(metric).is_some_and(|c| c.region == Some(drives::REGION.name())));
        let ground = if drives { ground } else { ground.without_drives() };
        let mut part = Measured::default();
        for (mapper, wanted) in wanted {
            let entry = known.iter().find(|entry| entry.name == mapper);
            let entry = entry.ok_or_else(|| Failure::Internal(format!("there is no mapper {mapper:?}")))?;
            match values(&ground, &setup, entry, world, stream, wanted) {
                Ok(values) => part.values.extend(values),
                Err(cause) => drop(part.failures.insert((mapper.clone(), world.clone()), cause)),
            }
        }
        progress.step();
        Ok(part)
    });
    progress.finish();
    let mut measured = Measured::default();
    for part in parts? {
        measured.values.extend(part.values);
        measured.failures.extend(part.failures);
    }
    Ok(measured)
}

/// The values of one mapper on one world, or why there are none.
fn values(
    ground: &Ground,
    setup: &Model,
    entry: &Entry,
    world: &WorldId,
    stream: u32,
    wanted: &Wanted,
) -> Result<Values, String> {
    let seed = world.seed + (u64::from(stream) << 32);
    let run = || -> Result<(Trial, Option<Trial>), Failure> {
        let trial = ground.trial(seed, &[entry], setup, &Keep::default(), &|_, _| {})?;
        let asked = trial.fault(0).is_none() && wanted.iter().any(|(_, region)| region == ALIGNED);
        let moved = if asked { Some(aligned(ground, (&trial, 0), entry, setup)?.0) } else { None };
        Ok((trial, moved))
    };
    let (trial, moved) = match catch_unwind(AssertUnwindSafe(run)) {
        Ok(result) => result.map_err(|failure| failure.to_string())?,
        Err(panic) => {
            return Err(format!("it panicked: {}", panic_text(&*panic).unwrap_or("no message")));
        }
    };
    if let Some(fault) = trial.fault(0) {
        return Err(fault.to_owned());
    }
    let last = trial.runs.first().map_or(0, |run| run.stages.len().saturating_sub(1));
    let value = |(metric, region): &(String, String)| {
        let scored = match region.as_str() {
            ALIGNED => moved.as_ref().and_then(|moved| moved.metric(entry.name, last, aligned::REGION.name(), metric)),
            region => trial.metric(entry.name, last, region, metric),
        };
        let value = scored.and_then(|metric| metric.value);
        let key = ValueKey {
            mapper: entry.name.to_owned(),
            metric: metric.clone(),
            region: region.clone(),
            world: world.clone(),
        };
        (key, value.and_then(|value| rounded(value).as_f64()))
    };
    Ok(wanted.iter().map(value).collect())
}
