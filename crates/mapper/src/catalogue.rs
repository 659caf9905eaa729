//! Every mapper by name.

use std::sync::Arc;

use grid::GridSpec;
use sensor::SensorModel;

use crate::{
    ConstantIncrements, Conventional, ConventionalRule, Field, ForwardEm, Lateral, Lockstep, LogOdds, Mapper, Mrf,
    NoOcclusion, Prior, Reconciliation, Tuning, Unseen, Visibility,
};

/// What a mapper is made from.
#[derive(Clone)]
pub struct Setup {
    /// The cells to map.
    pub grid: GridSpec,
    /// The sensor that the mapper believes it has.
    pub sensor: Arc<dyn SensorModel>,
    /// What is believed before the first reading.
    pub prior: Prior,
    /// What becomes of edges that no ray runs along.
    pub reconciliation: Reconciliation,
    /// Parameters of the rules that are not as published or fitted.
    pub tuning: Tuning,
}

impl Setup {
    /// The paper's prior, and every rule as it is.
    pub fn new(grid: GridSpec, sensor: Arc<dyn SensorModel>) -> Self {
        Self {
            grid,
            sensor,
            prior: Prior::default(),
            reconciliation: Reconciliation::default(),
            tuning: Tuning::default(),
        }
    }

    /// A conventional rule with the bin of the sensor, and what is given in the place of its values.
    pub(crate) fn conventional(&self, rule: ConventionalRule) -> ConventionalRule {
        self.tuning.conventional(rule.for_sensor(&*self.sensor, self.grid.cell_m))
    }
}

/// How a mapper takes its scans.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// One after the other; the map is up to date after each.
    Online,
    /// All at once: the map is solved for from every scan so far, see [`Mapper::settle`].
    Batch,
    /// Online, but fed noise-free readings: it shows what the noise costs, and is no rival.
    NoiseFree,
}

/// A mapper that can be asked for by name.
#[derive(Clone, Copy)]
pub struct Entry {
    /// The name on the command line and in every table.
    pub name: &'static str,
    /// One line for a list.
    pub summary: &'static str,
    /// Where it is defined.
    pub source: &'static str,
    /// How it takes its scans.
    pub kind: Kind,
    /// Makes one.
    pub build: fn(&Setup) -> Box<dyn Mapper>,
}

/// The mappers of this crate, the paper's method first.
pub const MAPPERS: &[Entry] = &[
    Entry {
        name: "visibility",
        summary: "the paper's method: occlusion and continuity, summed exactly",
        source: "Eqs. (1)-(7), (18)-(20)",
        kind: Kind::Online,
        build: |setup| Box::new(Lockstep::visibility(setup)),
    },
    Entry {
        name: "visibility-lateral",
        summary: "the paper's method with continuity across rays too",
        source: "Eqs. (1)-(7), (18)-(20); Rabiner 1989; Jeffrey 1965",
        kind: Kind::Online,
        build: |setup| Box::new(Lockstep::lateral(setup, Lateral::default())),
    },
    Entry {
        name: "visibility-reference",
        summary: "the same in double precision, ray by ray: what the fast one is held to",
        source: "Eqs. (1)-(7), (18)-(20)",
        kind: Kind::Online,
        build: |setup| Box::new(Visibility::exact(setup)),
    },
    Entry {
        name: "visibility-printed",
        summary: "the same with Eqs. (4)-(17) as the paper prints them",
        source: "Eqs. (4)-(17), (18)-(20)",
        kind: Kind::Online,
        build: |setup| Box::new(Visibility::as_printed(setup)),
    },
    Entry {
        name: "conventional",
        summary: "every cell for itself: no occlusion, no continuity",
        source: "Eqs. (22)-(26)",
        kind: Kind::Online,
        build: |setup| Box::new(Conventional::with(setup, setup.conventional(ConventionalRule::default()))),
    },
    Entry {
        name: "conventional-tuned",
        summary: "the same with bin and clamps fitted on the tuning scenes",
        source: "Eqs. (22)-(26), fitted",
        kind: Kind::Online,
        build: |setup| Box::new(Conventional::with(setup, setup.conventional(ConventionalRule::TUNED))),
    },
    Entry {
        name: "log-odds-octomap",
        summary: "constant increments with the defaults of OctoMap",
        source: "Hornung et al. 2013",
        kind: Kind::Online,
        build: |setup| Box::new(ConstantIncrements::new(setup, setup.tuning.log_odds(LogOdds::OCTOMAP))),
    },
    Entry {
        name: "log-odds-cartographer",
        summary: "constant increments with the defaults of Cartographer",
        source: "Hess et al. 2016",
        kind: Kind::Online,
        build: |setup| Box::new(ConstantIncrements::new(setup, setup.tuning.log_odds(LogOdds::CARTOGRAPHER))),
    },
    Entry {
        name: "independent",
        summary: "occlusion without continuity: the exact inverse sensor model",
        source: "Kaufman et al. 2016",
        kind: Kind::Online,
        build: |setup| Box::new(Lockstep::independent(setup)),
    },
    Entry {
        name: "no-occlusion",
        summary: "continuity without occlusion: the conventional likelihoods on the paper's chain",
        source: "ablation: Eqs. (18)-(20), (23)-(26)",
        kind: Kind::Online,
        build: |setup| Box::new(NoOcclusion::new(setup)),
    },
    Entry {
        name: "forward-em",
        summary: "the most likely map under the forward model, by EM over what caused each reading",
        source: "Thrun 2003",
        kind: Kind::Batch,
        build: |setup| Box::new(ForwardEm::new(setup)),
    },
    Entry {
        name: "mrf",
        summary: "the generic solution: a field over the map with exact rays, loopy sum-product",
        source: "Rachlin et al. 2005",
        kind: Kind::Batch,
        build: |setup| Box::new(Mrf::new(setup, setup.tuning.field(Field::TUNED))),
    },
    Entry {
        name: "visibility-touched",
        summary: "visibility with edges on no ray left out of the least squares",
        source: "ablation: Eq. (20)",
        kind: Kind::Online,
        build: |setup| Box::new(Lockstep::visibility(&with(setup, Reconciliation::Touched))),
    },
    Entry {
        name: "visibility-all-edges",
        summary: "visibility with edges on no ray in the least squares",
        source: "ablation: Eq. (20)",
        kind: Kind::Online,
        build: |setup| Box::new(Lockstep::visibility(&with(setup, Reconciliation::AllEdges))),
    },
    Entry {
        name: "lateral-rays",
        summary: "half of visibility-lateral: rays of a scan tell each other where they end",
        source: "ablation: Rabiner 1989",
        kind: Kind::Online,
        build: |setup| Box::new(Lockstep::lateral(setup, Lateral::RAYS)),
    },
    Entry {
        name: "lateral-edges",
        summary: "the other half: edges on no ray take over what their ends have learnt",
        source: "ablation: Jeffrey 1965",
        kind: Kind::Online,
        build: |setup| Box::new(Lockstep::lateral(setup, Lateral::EDGES)),
    },
    Entry {
        name: "prior",
        summary: "lower bound: no reading at all",
        source: "Section 3.2",
        kind: Kind::Online,
        build: |setup| Box::new(Unseen::new(setup)),
    },
    Entry {
        name: "perfect",
        summary: "upper bound: visibility fed noise-free readings, and told so",
        source: "Eqs. (1)-(7), (18)-(20)",
        kind: Kind::NoiseFree,
        build: |setup| Box::new(Lockstep::visibility(setup)),
    },
];

fn with(setup: &Setup, reconciliation: Reconciliation) -> Setup {
    Setup { reconciliation, ..setup.clone() }
}

/// The mapper of the given name.
pub fn find(name: &str) -> Option<&'static Entry> {
    MAPPERS.iter().find(|entry| entry.name == name)
}
