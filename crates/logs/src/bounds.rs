//! How far numbers of a log reach before they are taken for a mistake.

/// Coordinates reach so far, m: those of the world's usual grids do.
pub(crate) const FAR_M: f64 = 1e8;

/// Headings that are not wrapped reach so far, rad.
pub(crate) const WOUND_RAD: f64 = 1e6;

/// Times reach so far, s: 3,000 years.
pub(crate) const LATE_S: f64 = 1e11;
