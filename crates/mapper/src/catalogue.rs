//! Every mapper by name.

use crate::belief::lateral::Lateral;
use crate::fast::visibility::FastVisibility;
use crate::mapper::Mapper;
use crate::model::Model;
use crate::pairs::reconcile::Reconciliation;
use crate::rules::conventional::{Conventional, ConventionalRule};
use crate::rules::forward_em::ForwardEm;
use crate::rules::log_odds::{ConstantIncrements, LogOdds};
use crate::rules::mrf::{Field, Mrf};
use crate::rules::no_occlusion::NoOcclusion;
use crate::rules::unseen::Unseen;
use crate::rules::visibility::Visibility;

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

/// Makes a mapper from a model: a function, or a closure that knows more, such as which program to start.
pub type Build = dyn Fn(&Model) -> Box<dyn Mapper> + Send + Sync;

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
    pub build: &'static Build,
}

/// The mappers of this crate, the paper's method first.
pub const MAPPERS: &[Entry] = &[
    Entry {
        name: "visibility",
        summary: "the paper's method: occlusion and continuity, summed exactly",
        source: "Eqs. (1)-(7), (18)-(20)",
        kind: Kind::Online,
        build: &|model| Box::new(FastVisibility::visibility(model)),
    },
    Entry {
        name: "visibility-lateral",
        summary: "the paper's method with continuity across rays too",
        source: "Eqs. (1)-(7), (18)-(20); Rabiner 1989; Jeffrey 1965",
        kind: Kind::Online,
        build: &|model| Box::new(FastVisibility::lateral(model, Lateral::default())),
    },
    Entry {
        name: "visibility-reference",
        summary: "the same in double precision, ray by ray: what the fast one is held to",
        source: "Eqs. (1)-(7), (18)-(20)",
        kind: Kind::Online,
        build: &|model| Box::new(Visibility::exact(model)),
    },
    Entry {
        name: "visibility-printed",
        summary: "the same with Eqs. (4)-(17) as the paper prints them",
        source: "Eqs. (4)-(17), (18)-(20)",
        kind: Kind::Online,
        build: &|model| Box::new(Visibility::as_printed(model)),
    },
    Entry {
        name: "conventional",
        summary: "every cell for itself: no occlusion, no continuity",
        source: "Eqs. (22)-(26)",
        kind: Kind::Online,
        build: &|model| Box::new(Conventional::new(model)),
    },
    Entry {
        name: "conventional-tuned",
        summary: "the same with bin and clamps fitted on the tuning scenes",
        source: "Eqs. (22)-(26), fitted",
        kind: Kind::Online,
        build: &|model| Box::new(Conventional::for_sensors(model, ConventionalRule::TUNED)),
    },
    Entry {
        name: "log-odds-octomap",
        summary: "constant increments with the defaults of OctoMap",
        source: "Hornung et al. 2013",
        kind: Kind::Online,
        build: &|model| Box::new(ConstantIncrements::new(model, LogOdds::OCTOMAP.tuned(&model.tuning))),
    },
    Entry {
        name: "log-odds-cartographer",
        summary: "constant increments with the defaults of Cartographer",
        source: "Hess et al. 2016",
        kind: Kind::Online,
        build: &|model| Box::new(ConstantIncrements::new(model, LogOdds::CARTOGRAPHER.tuned(&model.tuning))),
    },
    Entry {
        name: "independent",
        summary: "occlusion without continuity: the exact inverse sensor model",
        source: "Kaufman et al. 2016",
        kind: Kind::Online,
        build: &|model| Box::new(FastVisibility::independent(model)),
    },
    Entry {
        name: "no-occlusion",
        summary: "continuity without occlusion: the conventional likelihoods on the paper's chain",
        source: "ablation: Eqs. (18)-(20), (23)-(26)",
        kind: Kind::Online,
        build: &|model| Box::new(NoOcclusion::new(model)),
    },
    Entry {
        name: "forward-em",
        summary: "the most likely map under the forward model, by EM over what caused each reading",
        source: "Thrun 2003",
        kind: Kind::Batch,
        build: &|model| Box::new(ForwardEm::new(model)),
    },
    Entry {
        name: "mrf",
        summary: "the generic solution: a field over the map with exact rays, loopy sum-product",
        source: "Rachlin et al. 2005",
        kind: Kind::Batch,
        build: &|model| Box::new(Mrf::new(model, Field::TUNED.tuned(&model.tuning))),
    },
    Entry {
        name: "visibility-touched",
        summary: "visibility with edges on no ray left out of the least squares",
        source: "ablation: Eq. (20)",
        kind: Kind::Online,
        build: &|model| Box::new(FastVisibility::visibility(&with(model, Reconciliation::Touched))),
    },
    Entry {
        name: "visibility-all-edges",
        summary: "visibility with edges on no ray in the least squares",
        source: "ablation: Eq. (20)",
        kind: Kind::Online,
        build: &|model| Box::new(FastVisibility::visibility(&with(model, Reconciliation::AllEdges))),
    },
    Entry {
        name: "lateral-rays",
        summary: "half of visibility-lateral: rays of a scan tell each other where they end",
        source: "ablation: Rabiner 1989",
        kind: Kind::Online,
        build: &|model| Box::new(FastVisibility::lateral(model, Lateral::RAYS)),
    },
    Entry {
        name: "lateral-edges",
        summary: "the other half: edges on no ray take over what their ends have learnt",
        source: "ablation: Jeffrey 1965",
        kind: Kind::Online,
        build: &|model| Box::new(FastVisibility::lateral(model, Lateral::EDGES)),
    },
    Entry {
        name: "prior",
        summary: "lower bound: no reading at all",
        source: "Section 3.2",
        kind: Kind::Online,
        build: &|model| Box::new(Unseen::new(model)),
    },
    Entry {
        name: "perfect",
        summary: "upper bound: visibility fed noise-free readings, and told so",
        source: "Eqs. (1)-(7), (18)-(20)",
        kind: Kind::NoiseFree,
        build: &|model| Box::new(FastVisibility::visibility(model)),
    },
];

fn with(model: &Model, reconciliation: Reconciliation) -> Model {
    Model { reconciliation, ..model.clone() }
}

/// The mapper of the given name.
pub fn find(name: &str) -> Option<&'static Entry> {
    MAPPERS.iter().find(|entry| entry.name == name)
}
