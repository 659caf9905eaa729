//! What is mapped, and how the maps are judged.

pub mod claims;
pub mod mappers;
pub mod run;
pub mod scenes;
