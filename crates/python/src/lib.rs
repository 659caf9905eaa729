//! The package `sightgrid` for Python.
//!
//! Thin: what is computed here is computed by the crates that the command line uses, so that results are equal to the bit. Arrays of a map
//! have a row of cells per row, the lowest first (`origin="lower"` of matplotlib), and NaN where nothing is known.

mod arrays;
mod errors;
mod grid;
mod log;
mod map;
mod mapper;
mod prior;
mod scan;
mod score;
mod sensor;
mod simulate;

use pyo3::prelude::*;

/// The native half of the package.
#[pymodule]
fn _sightgrid(module: &Bound<'_, PyModule>) -> PyResult<()> {
    strict::bring(experiments::worlds::shipped::FILES);
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<grid::Grid>()?;
    module.add_class::<sensor::Sensor>()?;
    module.add_class::<sensor::Stereo>()?;
    module.add_class::<sensor::Laser>()?;
    module.add_class::<sensor::Sonar>()?;
    module.add_class::<prior::Prior>()?;
    module.add_class::<scan::Scan>()?;
    module.add_class::<mapper::Mapper>()?;
    module.add_class::<simulate::Simulation>()?;
    module.add_class::<log::Log>()?;
    module.add_class::<log::Event>()?;
    module.add_function(wrap_pyfunction!(mapper::mappers, module)?)?;
    module.add_function(wrap_pyfunction!(simulate::simulate, module)?)?;
    module.add_function(wrap_pyfunction!(score::score, module)?)?;
    module.add_function(wrap_pyfunction!(score::paired, module)?)?;
    module.add_function(wrap_pyfunction!(map::load_map, module)?)?;
    module.add_function(wrap_pyfunction!(map::save_map, module)?)?;
    module.add_function(wrap_pyfunction!(log::read_log, module)?)?;
    Ok(())
}
