//! One viewing ray in double precision: Eqs. (1)-(17).

pub(crate) mod bearing_chain;
pub(crate) mod chain;
pub mod cone;
pub mod exact;
pub(crate) mod likelihood;
pub mod past_the_map;
pub(crate) mod predictive;
pub mod printed;
pub(crate) mod recalibration;
mod surface;
pub(crate) mod update;
pub(crate) mod worth;
