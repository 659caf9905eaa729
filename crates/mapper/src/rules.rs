//! The rules that are compared, each with its mapper; the fast `visibility` is in `crate::fast`.

pub(crate) mod ageing;
pub(crate) mod climb;
pub(crate) mod continuous_ray;
pub(crate) mod conventional;
pub(crate) mod decay;
pub(crate) mod dynamic;
pub(crate) mod dynamic_grid;
pub(crate) mod forward_em;
pub(crate) mod fusion;
pub mod gibbs;
pub(crate) mod hit_count;
pub(crate) mod log_odds;
pub mod mrf;
pub mod no_occlusion;
pub(crate) mod odds_map;
pub(crate) mod range_cut;
pub(crate) mod readings;
pub(crate) mod repeats;
pub(crate) mod shown;
pub(crate) mod signed_distance;
pub(crate) mod sonar_profile;
pub(crate) mod sweep;
pub(crate) mod unseen;
pub(crate) mod visibility;
pub(crate) mod wedge;
pub(crate) mod widening_beams;
