//! Whether the scans of a log fit together: what the readings kept back say of the map that is fitted.

use std::sync::Arc;

use grid::{DigitalLine, GridSpec, Raster};
use mapper::catalogue::find;
use mapper::{FastVisibility, Mapper as _, Model, Prior};
use sensor::{Laser, Scan, SensorModel};

use crate::failure::Failure;
use crate::jobs::memory;
use crate::output::note;
use crate::worlds::agreement::{Agreement, Spread};

/// One scan in so many is kept back, as by `replay`: a map of half of the scans lacks surfaces that a camera saw from afar.
const KEPT_BACK: usize = 10;

/// Says on stderr which share of the readings of scans kept back end near the surfaces of the map of the others, as a warning where
/// it is too small.
pub(super) fn tell(
    place: &str,
    scans: &[Scan],
    grid: GridSpec,
    sensor: Arc<dyn SensorModel>,
    prior: Prior,
    spread: Spread,
) {
    let mut map = FastVisibility::visibility(&Model { prior, ..Model::new(grid, Arc::clone(&sensor)) });
    let (mut seen, mut line) = (Raster::filled(grid, false), DigitalLine::default());
    let is_kept_back = |number: usize| (number + 1).is_multiple_of(KEPT_BACK);
    for (_, scan) in scans.iter().enumerate().filter(|(number, _)| !is_kept_back(*number)) {
        map.integrate(scan);
        for ray in scan.rays() {
            let Some(range_m) = ray.reading.and_then(|reading| sensor.range_of(reading, ray.bearing_rad)) else {
                continue;
            };
            line.trace(&grid, ray.origin_m, ray.direction, range_m);
            line.cells().iter().for_each(|cell| seen[*cell] = true);
        }
    }
    let of = |scan: &Scan| Agreement::of(scan, map.occupancy(), &seen, &*sensor, spread);
    let kept_back = scans.iter().skip(KEPT_BACK - 1).step_by(KEPT_BACK);
    let agreement = kept_back.map(of).fold(Agreement::default(), Agreement::and);
    match agreement.warning("visibility", sensor.correct_match()) {
        Some(warning) => note(format_args!("warning: {place}: {warning}")),
        None if agreement.share().is_some() => {
            note(format_args!("note: {place}: {}", agreement.text("visibility", sensor.correct_match())));
        }
        None => {}
    }
}

/// Refuses more cells than memory holds with a map for every fit that runs at once.
///
/// # Errors
/// Both numbers and the remedy.
pub(super) fn refuse_too_large(place: &str, grid: GridSpec) -> Result<(), Failure> {
    let setup = Model::new(grid, Arc::new(Laser::default()));
    let mapper: Vec<_> = find("visibility").into_iter().collect();
    let bytes = memory::of_mapping(&grid, &mapper, &setup, 1) * rayon::current_num_threads() as f64;
    memory::refuse(place, &grid, bytes, "use larger cells (--grid) or fewer --threads")
}
