//! How good a map is.

use std::collections::BTreeMap;

use ::grid::Raster;
use ::score::{Comparison, Scorer};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;

use crate::arrays::{to_cells, truth};
use crate::errors::bad;
use crate::grid::Grid;
use crate::simulate::Simulation;

/// What maps are scored against.
#[derive(FromPyObject)]
pub(crate) enum Truth<'py> {
    World(PyRef<'py, Simulation>),
    Cells(PyReadonlyArray2<'py, f64>),
    States(PyReadonlyArray2<'py, bool>),
}

/// Every metric of a map over a region, by name: log loss and Brier score, IoU, areas of phantoms and of what is missed, calibration and more
/// (``sightgrid guide metrics`` has the formulas). ``None`` where a metric is not defined.
///
/// :param p: probability that each cell is occupied, ``(height, width)``, 0 to 1
/// :param truth: a ``Simulation``, or an array of 1 or True (occupied), 0 or False (free), NaN (not known)
/// :param region: name of a region of a simulation; default ``"observable"``
/// :param grid: the cells, where the truth is an array
/// :param mask: which cells are scored, where the truth is an array; default all that are known
/// :param surface: occupied cells that could be seen, and so missed, where the truth is an array; default all that are occupied
/// :param unknown: what stands for NaN in ``p``; default the prior, 0.1
#[pyfunction]
#[pyo3(signature = (p, truth, *, region = None, grid = None, mask = None, surface = None, unknown = None))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn score(
    py: Python<'_>,
    p: PyReadonlyArray2<'_, f64>,
    truth: Truth<'_>,
    region: Option<&str>,
    grid: Option<PyRef<'_, Grid>>,
    mask: Option<PyReadonlyArray2<'_, bool>>,
    surface: Option<PyReadonlyArray2<'_, bool>>,
    unknown: Option<f64>,
) -> PyResult<BTreeMap<&'static str, Option<f64>>> {
    let judged = Judged::of(truth, region, grid, mask, surface)?;
    let spec = *judged.truth.spec();
    let unknown = unknown.unwrap_or(judged.prior);
    let known = |value: f64| if value.is_nan() { unknown } else { value };
    let map = Raster::new(spec, to_cells("p", &p, &spec)?.into_iter().map(known).collect());
    let scores =
        py.detach(|| Scorer::new(&judged.truth, &judged.surface).and_then(|scorer| scorer.scores(&map, &judged.mask)));
    Ok(scores.map_err(bad)?.metrics().into_iter().map(|metric| (metric.name, metric.value)).collect())
}

struct Judged {
    truth: Raster<Option<bool>>,
    surface: Raster<bool>,
    mask: Raster<bool>,
    prior: f64,
}

impl Judged {
    fn of(
        of: Truth<'_>,
        region: Option<&str>,
        grid: Option<PyRef<'_, Grid>>,
        mask: Option<PyReadonlyArray2<'_, bool>>,
        surface: Option<PyReadonlyArray2<'_, bool>>,
    ) -> PyResult<Self> {
        let array = |array: &dyn Fn(&::grid::GridSpec) -> PyResult<Vec<f64>>| -> PyResult<Raster<Option<bool>>> {
            let Some(grid) = &grid else {
                return Err(bad("the truth is an array: give the grid that it is on, which says how large cells are"));
            };
            truth(array(&grid.spec)?, grid.spec)
        };
        let states = match &of {
            Truth::World(world) => {
                if grid.is_some() || mask.is_some() || surface.is_some() {
                    return Err(bad(
                        "a simulation has its own grid, regions and surfaces: leave out grid, mask and surface",
                    ));
                }
                let mask = world.mask(region.unwrap_or("observable"))?.clone();
                return Ok(Self {
                    truth: world.truth.clone(),
                    surface: world.surface.clone(),
                    mask,
                    prior: world.prior,
                });
            }
            Truth::Cells(cells) => array(&|spec| to_cells("truth", cells, spec))?,
            Truth::States(states) => array(&|spec| {
                Ok(to_cells("truth", states, spec)?.into_iter().map(|state| f64::from(u8::from(state))).collect())
            })?,
        };
        if let Some(region) = region {
            return Err(bad(format!("region {region:?}: an array has no regions by name; give a mask")));
        }
        let spec = *states.spec();
        let mask = match mask {
            Some(mask) => Raster::new(spec, to_cells("mask", &mask, &spec)?),
            None => states.map(Option::is_some),
        };
        let surface = match surface {
            Some(surface) => Raster::new(spec, to_cells("surface", &surface, &spec)?),
            None => states.map(|state| *state == Some(true)),
        };
        Ok(Self { truth: states, surface, mask, prior: mapper::Prior::default().occupancy })
    }
}

/// Mean of paired differences with its 95 % interval (BCa bootstrap of a fixed seed), as ``compare`` has it.
///
/// :param ours: a value for every world; ``None`` where there is none
/// :param theirs: of the same worlds in the same order
/// :returns: ``{"pairs", "mean", "low", "high", "p"}``; ``p`` is that of the signed-rank test, not adjusted
#[pyfunction]
pub(crate) fn paired(
    py: Python<'_>,
    ours: Vec<Option<f64>>,
    theirs: Vec<Option<f64>>,
) -> PyResult<BTreeMap<&'static str, f64>> {
    let compared = py.detach(|| Comparison::of_defined(&ours, &theirs)).map_err(bad)?;
    let Comparison { pairs, mean_difference, interval, signed_rank, .. } = compared;
    Ok(BTreeMap::from([
        ("pairs", pairs as f64),
        ("mean", mean_difference),
        ("low", interval.low),
        ("high", interval.high),
        ("p", signed_rank.p),
    ]))
}
