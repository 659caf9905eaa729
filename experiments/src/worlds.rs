//! What is mapped, and how the maps are judged.

pub(crate) mod agreement;
pub mod aligned;
pub mod bins;
pub mod claims;
pub mod condition;
pub mod criteria;
pub mod drives;
pub mod estimate;
pub mod faults;
pub mod film;
pub mod ground;
pub mod kernels;
pub mod levels;
pub mod map_file;
pub mod mappers;
pub mod poses;
pub mod ranked;
pub mod reading;
pub mod run;
pub mod scenes;
pub mod schema;
pub mod seen;
pub mod shipped;
pub mod site;
pub mod witness;
pub mod yard;
