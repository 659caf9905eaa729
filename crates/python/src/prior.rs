//! What mappers assume before the first reading.

use mapper::CorrelationLaw;
use pyo3::prelude::*;

use crate::errors::bad;

/// Occupancy and continuity of an unseen world (Section 3.2 of the paper).
///
/// :param occupancy: probability that an unseen cell is occupied, above 0 and below 1
/// :param correlation: correlation of two cells 5 cm apart, 0 to 1
/// :param scaled: whether it falls with the distance, ``exp(-d / l)``; otherwise it is the same at every cell size
#[pyclass(frozen, module = "sightgrid")]
#[derive(Clone, Copy)]
pub(crate) struct Prior {
    pub(crate) prior: mapper::Prior,
}

#[pymethods]
impl Prior {
    #[new]
    #[pyo3(signature = (occupancy = mapper::Prior::default().occupancy, correlation = mapper::Prior::default().correlation, scaled = true))]
    fn new(occupancy: f64, correlation: f64, scaled: bool) -> PyResult<Self> {
        if !(occupancy > 0.0 && occupancy < 1.0) {
            return Err(bad(format!("occupancy is {occupancy}; it must be a probability above 0 and below 1")));
        }
        if !(0.0..=1.0).contains(&correlation) {
            return Err(bad(format!("correlation is {correlation}; it must be from 0 to 1")));
        }
        let correlation_law = if scaled { CorrelationLaw::Scaled } else { CorrelationLaw::Fixed };
        Ok(Self { prior: mapper::Prior { occupancy, correlation, correlation_law } })
    }

    /// Probability that an unseen cell is occupied.
    #[getter]
    fn occupancy(&self) -> f64 {
        self.prior.occupancy
    }

    /// Correlation of two cells 5 cm apart.
    #[getter]
    fn correlation(&self) -> f64 {
        self.prior.correlation
    }

    /// Correlation of neighbouring cells of side ``cell_m``, m.
    fn neighbour_correlation(&self, cell_m: f64) -> f64 {
        self.prior.neighbour_correlation(cell_m)
    }

    fn __repr__(&self) -> String {
        let scaled = if self.prior.correlation_law == CorrelationLaw::Scaled { "True" } else { "False" };
        format!("Prior(occupancy={}, correlation={}, scaled={scaled})", self.prior.occupancy, self.prior.correlation)
    }
}
