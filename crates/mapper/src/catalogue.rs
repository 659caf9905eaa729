//! Every mapper by name.

use crate::belief::lateral::Lateral;
use crate::belief::renewal::Renewal;
use crate::fast::visibility::FastVisibility;
use crate::fit::{Candidate, Fit, Fitted, Setting};
use crate::mapper::Mapper;
use crate::model::Model;
use crate::pairs::reconcile::Reconciliation;
use crate::rules::continuous_ray::{ContinuousRay, ContinuousRays};
use crate::rules::conventional::{Conventional, ConventionalRule};
use crate::rules::decay::Decay;
use crate::rules::dynamic_grid::DynamicGrid;
use crate::rules::forward_em::ForwardEm;
use crate::rules::fusion::{Fusion, PerSensor};
use crate::rules::gibbs::{Gibbs, Sampling};
use crate::rules::hit_count::{HitCount, HitCounter};
use crate::rules::log_odds::{ConstantIncrements, LogOdds};
use crate::rules::mrf::{Field, Mrf};
use crate::rules::no_occlusion::NoOcclusion;
use crate::rules::range_cut::{ConventionalCut, RangeCut};
use crate::rules::repeats::OnlyNews;
use crate::rules::signed_distance::{SignedDistance, SignedDistances};
use crate::rules::sonar_profile::SonarProfiles;
use crate::rules::unseen::Unseen;
use crate::rules::visibility::Visibility;
use crate::rules::widening_beams::{WideningBeams, WideningBeamsMapper};
use crate::rules::window::{FixedLag, VisibilityWindow};

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

impl Entry {
    /// Makes one for a model, which sees readings up to [`Model::max_range_m`] alone.
    pub fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        let mapper = (self.build)(model);
        if model.max_range_m == f64::INFINITY {
            return mapper;
        }
        Box::new(RangeCut::new(mapper, model, model.max_range_m))
    }
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
        name: "visibility-window",
        summary: "the last 12 scans solved together by sampling, and the pairs of visibility-lateral of all of them",
        source: "Merali and Barfoot 2013; Stone 1961",
        kind: Kind::Online,
        build: &|model| Box::new(VisibilityWindow::new(model, FixedLag::TUNED)),
    },
    Entry {
        name: "visibility-dynamic",
        summary: "the paper's method where people, doors and chairs move, and the robot may stand",
        source: "Eqs. (1)-(7), (18)-(20); Meyer-Delius et al. 2012; Kish 1965",
        kind: Kind::Online,
        build: &|model| {
            let mapper = FastVisibility::dynamic(model, Renewal::CHOSEN);
            Box::new(OnlyNews::new(Box::new(mapper), model, model.repeats))
        },
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
        name: "conventional-cut",
        summary: "the paper's conventional rule with readings up to a fitted range alone",
        source: "Eqs. (22)-(26); habit",
        kind: Kind::Online,
        build: &|model| ConventionalCut::TUNED.mapper(model),
    },
    Entry {
        name: "log-odds-octomap",
        summary: "constant increments with the defaults of OctoMap",
        source: "Hornung et al. 2013",
        kind: Kind::Online,
        build: &|model| Box::new(ConstantIncrements::new(model, LogOdds::OCTOMAP.tuned(&model.tuning))),
    },
    Entry {
        name: "octomap-cut",
        summary: "OctoMap with a fitted maxrange: a point beyond it clears up to it",
        source: "Hornung et al. 2013; octomap 1.9.7",
        kind: Kind::Online,
        build: &|model| Box::new(ConstantIncrements::new(model, LogOdds::OCTOMAP_CUT.tuned(&model.tuning))),
    },
    Entry {
        name: "log-odds-cartographer",
        summary: "constant increments with the defaults of Cartographer",
        source: "Hess et al. 2016",
        kind: Kind::Online,
        build: &|model| Box::new(ConstantIncrements::new(model, LogOdds::CARTOGRAPHER.tuned(&model.tuning))),
    },
    Entry {
        name: "log-odds-decay",
        summary: "OctoMap's increments, forgotten exponentially: a world that moves",
        source: "Hornung et al. 2013; Macenski et al. 2020",
        kind: Kind::Online,
        build: &|model| Box::new(Decay::STVL.mapper(model)),
    },
    Entry {
        name: "dynamic-grid",
        summary: "a hidden Markov chain in time in every cell, with fixed chances of change",
        source: "Meyer-Delius et al. 2012, not learnt",
        kind: Kind::Online,
        build: &|model| Box::new(DynamicGrid::MINUTE.mapper(model)),
    },
    Entry {
        name: "hit-count-gmapping",
        summary: "hits over visits with the threshold of GMapping, as occupied, free and unknown",
        source: "Grisetti et al. 2007; slam_gmapping 1.4.2",
        kind: Kind::Online,
        build: &|model| Box::new(HitCounter::new(model, HitCount::GMAPPING.tuned(&model.tuning))),
    },
    Entry {
        name: "hit-count-karto",
        summary: "the same with the counts and thresholds of Karto and slam_toolbox",
        source: "Konolige et al. 2010; slam_toolbox 2.8",
        kind: Kind::Online,
        build: &|model| Box::new(HitCounter::new(model, HitCount::KARTO.tuned(&model.tuning))),
    },
    Entry {
        name: "hit-count-tuned",
        summary: "the same with thresholds fitted on the tuning scenes",
        source: "Hähnel et al. 2003, fitted",
        kind: Kind::Online,
        build: &|model| Box::new(HitCounter::new(model, HitCount::TUNED.tuned(&model.tuning))),
    },
    Entry {
        name: "tsdf",
        summary: "truncated signed distance with the values of Voxblox, read out as occupancy",
        source: "Curless and Levoy 1996; Oleynikova et al. 2017",
        kind: Kind::Online,
        build: &|model| Box::new(SignedDistances::new(model, SignedDistance::VOXBLOX.tuned(&model.tuning))),
    },
    Entry {
        name: "tsdf-tuned",
        summary: "the same with truncation and weights fitted on the tuning scenes",
        source: "Curless and Levoy 1996, fitted",
        kind: Kind::Online,
        build: &|model| Box::new(SignedDistances::new(model, SignedDistance::TUNED.tuned(&model.tuning))),
    },
    Entry {
        name: "mrpt-widening",
        summary: "constant increments over beams that widen, with the defaults of MRPT",
        source: "MRPT 2.5.8, wideningBeamsWithDistance",
        kind: Kind::Online,
        build: &|model| Box::new(WideningBeamsMapper::new(model, WideningBeams::MRPT.tuned(&model.tuning))),
    },
    Entry {
        name: "mrpt-widening-tuned",
        summary: "the same with increments and clamps fitted on the tuning scenes",
        source: "MRPT 2.5.8, fitted",
        kind: Kind::Online,
        build: &|model| Box::new(WideningBeamsMapper::new(model, WideningBeams::TUNED.tuned(&model.tuning))),
    },
    Entry {
        name: "wavemap",
        summary: "noise along the ray: wavemap's continuous ray, with its values for depth cameras",
        source: "Reijgwart et al. 2023; wavemap 2.2",
        kind: Kind::Online,
        build: &|model| Box::new(ContinuousRays::new(model, ContinuousRay::WAVEMAP.tuned(&model.tuning))),
    },
    Entry {
        name: "wavemap-tuned",
        summary: "the same with noise, scaling and clamps fitted on the tuning scenes",
        source: "Reijgwart et al. 2023, fitted",
        kind: Kind::Online,
        build: &|model| Box::new(ContinuousRays::new(model, ContinuousRay::TUNED.tuned(&model.tuning))),
    },
    Entry {
        name: "sonar-moravec",
        summary: "an empty sector and an arc that is occupied somewhere: the first profile of sonars",
        source: "Moravec and Elfes 1985; Moravec 1988",
        kind: Kind::Online,
        build: &|model| Box::new(SonarProfiles::new(model)),
    },
    Entry {
        name: "visibility-pool",
        summary: "a map of every sensor by visibility, log odds added",
        source: "independent opinion pool: Berger 1985",
        kind: Kind::Online,
        build: &|model| Box::new(PerSensor::new(model, Fusion::Pool, &visibility)),
    },
    Entry {
        name: "visibility-maximum",
        summary: "a map of every sensor by visibility, of which the greatest counts",
        source: "costmap_2d 1.17",
        kind: Kind::Online,
        build: &|model| Box::new(PerSensor::new(model, Fusion::Maximum, &visibility)),
    },
    Entry {
        name: "octomap-maximum",
        summary: "a map of every sensor by OctoMap's increments, of which the greatest counts",
        source: "Hornung et al. 2013; costmap_2d 1.17",
        kind: Kind::Online,
        build: &|model| {
            let octomap =
                |model: &Model| Box::new(ConstantIncrements::new(model, LogOdds::OCTOMAP.tuned(&model.tuning))) as _;
            Box::new(PerSensor::new(model, Fusion::Maximum, &octomap))
        },
    },
    Entry {
        name: "miura-2002",
        summary: "a conventional map of every sensor; free where the laser says so, unless one has an obstacle",
        source: "Miura et al. 2002, as far as it is public",
        kind: Kind::Online,
        build: &|model| {
            Box::new(PerSensor::new(model, Fusion::Miura, &|model| Box::new(Conventional::new(model)) as _))
        },
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
        name: "gibbs",
        summary: "the posterior over whole maps, by sampling; none where chains do not agree",
        source: "Merali and Barfoot 2013",
        kind: Kind::Batch,
        build: &|model| Box::new(Gibbs::new(model, Sampling::TUNED)),
    },
    Entry {
        name: "gibbs-unchecked",
        summary: "the same in a sixteenth of the sweeps, also where its chains do not agree",
        source: "Merali and Barfoot 2013",
        kind: Kind::Batch,
        build: &|model| Box::new(Gibbs::new(model, Sampling::UNCHECKED)),
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

/// Mappers with parameters that the `tune` command fits, in the order of its tables.
pub const FITS: &[Fit] = &[
    Reconciliation::FIT,
    ConventionalRule::FIT,
    Field::FIT,
    ConventionalCut::FIT,
    LogOdds::CUT_FIT,
    HitCount::GMAPPING_FIT,
    HitCount::KARTO_FIT,
    HitCount::FIT,
    SignedDistance::VOXBLOX_FIT,
    SignedDistance::FIT,
    WideningBeams::FIT,
    ContinuousRay::FIT,
];

impl Reconciliation {
    /// With or without edges on no ray.
    const FIT: Fit = Fit {
        mapper: "visibility",
        built_in: || Candidate::of(Self::default()),
        tried: || Candidate::all([Self::AllEdges, Self::Touched]),
    };
}

impl Fitted for Reconciliation {
    fn parameters(&self) -> Vec<(&'static str, Setting)> {
        let word = match self {
            Self::AllEdges => "all-edges",
            Self::Touched => "touched",
        };
        vec![("reconciliation", Setting::Word(word))]
    }

    fn label(&self) -> String {
        if *self == Self::AllEdges { "all-edges" } else { "touched" }.to_owned()
    }

    fn mapper(&self, model: &Model) -> Box<dyn Mapper> {
        Box::new(FastVisibility::visibility(&with(model, *self)))
    }
}

fn visibility(model: &Model) -> Box<dyn Mapper> {
    Box::new(FastVisibility::visibility(model))
}

fn with(model: &Model, reconciliation: Reconciliation) -> Model {
    Model { reconciliation, ..model.clone() }
}

/// The mapper of the given name.
pub fn find(name: &str) -> Option<&'static Entry> {
    MAPPERS.iter().find(|entry| entry.name == name)
}
