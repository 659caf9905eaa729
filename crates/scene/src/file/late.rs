//! What would only come when the drive is over.

use strict::Table;

use crate::drive::least_time_s;
use crate::{Behaviour, Due, Opening, Scene, Warning};

/// A warning for every time that lies behind the end of the drive, as long as nothing holds the robot up.
pub(super) fn warnings(root: &Table, scene: &Scene) -> Vec<Warning> {
    let drive_s = least_time_s(scene);
    let tables = |kind| root.list(kind).unwrap_or_default();
    let late = |table: &Table, key: &'static str, at_s: f64| {
        let place = table.place_of(key);
        (at_s > drive_s).then(|| Warning::Late { place, element: table.element(), key, at_s, drive_s })
    };
    let mut warnings = Vec::new();
    for (mover, table) in scene.movers.iter().zip(tables("mover")) {
        let walks = !matches!(mover.behaviour, Behaviour::Route { ref points_m, .. } if points_m.len() == 1);
        warnings.extend(late(&table, "start_s", mover.start_s).filter(|_| walks));
    }
    for (door, table) in scene.doors.iter().zip(tables("door")) {
        let Opening::Times(times) = &door.opening else { continue };
        warnings.extend(times.iter().find_map(|[from, _]| late(&table, "open_s", *from)));
    }
    for (chair, table) in scene.chairs.iter().zip(tables("chair")) {
        let times = chair.moves.iter().filter_map(|m| if let Due::At(at_s) = m.due { Some(at_s) } else { None });
        warnings.extend(times.into_iter().find_map(|at_s| late(&table, "moves", at_s)));
    }
    warnings
}
