//! All that a comparison finds.

use super::judgement::{Judgement, Scope};
use super::repeats::Repeated;
use super::world::WorldScores;
use crate::worlds::claims::Claim;

/// What a comparison has found.
pub struct Findings {
    /// The scores of every world, in the order of the jobs.
    pub worlds: Vec<WorldScores>,
    /// What is judged together.
    pub scopes: Vec<Scope>,
    /// Every mapper against the reference.
    pub judgements: Vec<Judgement>,
    /// The same scan, again and again.
    pub repeated: Vec<Repeated>,
    /// What was promised of the reference.
    pub claims: Vec<Claim>,
}
