//! What particles are weighed by, by the names that a user gives.

use clap::ValueEnum;
use slam::Weight;

/// What particles are weighed by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub enum Weighing {
    /// what the particle's map says of the readings
    Evidence,
    /// the likelihood field of the surfaces, as GMapping has it
    #[default]
    Field,
}

impl Weighing {
    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Evidence => "evidence",
            Self::Field => "field",
        }
    }

    /// The weight, with the power that was fitted unless another is given.
    pub fn weight(self, power: Option<f64>) -> Weight {
        match self {
            Self::Field => Weight::Field { power: power.unwrap_or(Weight::FIELD.power()) },
            Self::Evidence => {
                Weight::Evidence { beams: Weight::BEAMS, power: power.unwrap_or(Weight::EVIDENCE.power()) }
            }
        }
    }
}
