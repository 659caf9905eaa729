//! The rules that are compared, each with its mapper; the fast `visibility` is in `crate::fast`.

pub(crate) mod climb;
pub(crate) mod conventional;
pub(crate) mod forward_em;
pub(crate) mod log_odds;
pub mod mrf;
pub mod no_occlusion;
pub(crate) mod readings;
pub(crate) mod unseen;
pub(crate) mod visibility;
