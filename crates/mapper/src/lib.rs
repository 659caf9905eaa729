//! Occupancy mappers behind one trait.
//!
//! A [`Mapper`] takes scans one by one and holds, for every cell, the probability that it is
//! occupied. The paper's method keeps a [`PairwiseGrid`]: a marginal per cell and a joint
//! probability per pair of neighbours. One update reads like the paper:
//!
//! | step | equations | function |
//! |---|---|---|
//! | the ray as a Markov chain of cells | Section 2.1, (11)-(13) | [`Chain::gather`] |
//! | likelihood of the reading per first occupied cell | (21) | [`sensor::Kernel::likelihood`] |
//! | ... past the last cell | sum to infinity in (7) | [`past_the_map::likelihood`] |
//! | posterior of every pair | (1)-(7) | [`exact::posterior`], [`printed::posterior`] |
//! | agreement between rays | (18)-(20) | [`Moments`], [`PairwiseGrid::reconcile`] |
//!
//! [`Lateral`] adds continuity across rays, which is not in the paper.
//! [`FastVisibility`] does the same for several rays at a time, which is what `visibility` runs; [`Visibility`] is its reference.
//! [`catalogue`] lists every mapper by name. To add your own, implement [`Mapper`]: the example
//! `own_mapper` does it in twenty lines.
//!
//! Modules import from those before them alone: `memory`, `belief`, `pairs`, `ray`, `tuning`, `model`, `mapper`, `fit`, `fast`, `rules`, `catalogue`.

mod belief;
pub mod catalogue;
mod fast;
mod fit;
mod mapper;
mod memory;
mod model;
mod pairs;
mod ray;
mod rules;
mod tuning;

pub use belief::estimate::{self, Estimate};
pub use belief::lateral::Lateral;
pub use belief::prior::{CorrelationLaw, Prior};
pub use belief::probability::{EPSILON, bayes};
pub use belief::renewal::Renewal;
pub use belief::repeats::Repeats;
pub use fast::visibility::FastVisibility;
pub use fit::{Candidate, Fit, Fitted, Setting};
pub use mapper::{Mapper, Mixing, Outside, Work, moments};
pub use model::{Model, Sensors};
pub use pairs::footprint;
pub use pairs::grid::{Broken, PairwiseGrid};
pub use pairs::joint::Joint;
pub use pairs::moments::Moments;
pub use pairs::posterior::RayPosterior;
pub use pairs::reconcile::Reconciliation;
pub use ray::chain::Chain;
pub use ray::predictive::{Belief, Predictive};
pub use ray::recalibration::{FitRay, Recalibration};
pub use ray::update::RayRule;
pub use ray::{cone, exact, past_the_map, printed};
pub use rules::ageing::{Ageing, AgeingIncrements};
pub use rules::continuous_ray::{ContinuousRay, ContinuousRays};
pub use rules::conventional::{Conventional, ConventionalRule};
pub use rules::decay::{Decay, Fading};
pub use rules::dynamic::Dynamic;
pub use rules::dynamic_grid::{DynamicGrid, Transitions};
pub use rules::forward_em::ForwardEm;
pub use rules::fusion::{Fusion, PerSensor};
pub use rules::gibbs::{self, Gibbs, Sampling, Unmixed};
pub use rules::hit_count::{HitCount, HitCounter};
pub use rules::log_odds::{ConstantIncrements, LogOdds};
pub use rules::mrf::{self, Field, Mrf};
pub use rules::no_occlusion::{self, NoOcclusion};
pub use rules::range_cut::{ConventionalCut, RangeCut, UpTo};
pub use rules::repeats::{News, OnlyNews};
pub use rules::shown::{Choice, Shown};
pub use rules::signed_distance::{SignedDistance, SignedDistances};
pub use rules::sonar_profile::SonarProfiles;
pub use rules::unseen::Unseen;
pub use rules::visibility::Visibility;
pub use rules::widening_beams::{WideningBeams, WideningBeamsMapper};
pub use rules::window::{FixedLag, VisibilityWindow};
pub use tuning::Tuning;
