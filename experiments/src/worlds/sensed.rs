//! What suites of sensors are judged over: the same cells for all of them.

use grid::Raster;

/// What any of the three sensors can see: the same cells for every suite.
pub const IN_REACH: &str = "in-reach";

/// Panes of glass, of which one beam in ten and one column in twenty find the frame.
pub const GLASS: &str = "glass";

/// Legs of 6 cm, on which every second beam ends.
pub const LEGS: &str = "legs";

/// The regions of worlds of the set, beside those that follow from the rays of a suite.
pub const REGIONS: [&str; 3] = [IN_REACH, GLASS, LEGS];

/// What the sensors of all suites have in common to be judged by.
#[derive(Debug, Clone)]
pub struct Sensed {
    /// The surfaces that any of them can see.
    pub surface: Raster<bool>,
    /// The cells of each of [`REGIONS`].
    pub regions: [Raster<bool>; 3],
}

impl Sensed {
    /// The regions by name.
    pub fn by_name(&self) -> impl Iterator<Item = (&'static str, &Raster<bool>)> {
        REGIONS.into_iter().zip(&self.regions)
    }
}
