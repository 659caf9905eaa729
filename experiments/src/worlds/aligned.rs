//! A map where it agrees best with the truth.
//!
//! Poses that drift lay a map beside the world. How good it is apart from that is asked of the map that the mapper makes
//! of the same readings from the same poses, all of which have been moved as one rigid body by the alignment of its map:
//! no cell is interpolated, and whatever has a history, as retention has, is defined.

use grid::{Frame, Raster};
use mapper::Model;
use mapper::catalogue::Entry;
use score::{AlignBound, Alignment, Region, align};

use super::ground::Ground;
use super::run::{Keep, Trial};
use crate::failure::Failure;

/// What stands for the region of the aligned map: all that could be seen.
pub const ALIGNED: &str = "aligned";

/// The region that an aligned map is scored in.
pub const REGION: Region = Region::Observable;

/// How far a map may be moved.
pub const BOUND: AlignBound = AlignBound { shift_m: 1.0, turn_rad: 15.0 * std::f64::consts::PI / 180.0 };

/// The trial of one mapper of `trial`, by its place among the runs, from poses that are moved by the alignment of its last
/// map; and the alignment.
///
/// # Errors
/// A mapper that gives something else than probabilities; memory that the system does not give.
pub fn aligned(
    ground: &Ground,
    (trial, run): (&Trial, usize),
    entry: &Entry,
    setup: &Model,
) -> Result<(Trial, Alignment), Failure> {
    let end = trial.runs.get(run).and_then(|run| run.stages.last());
    let (Some(end), Some(reached)) = (end, trial.reached.last()) else {
        return Err(Failure::Internal(format!("{} was never scored", entry.name)));
    };
    // What no ray reached is not known, whatever the prior says of it.
    let known = |(p, reached): (&f64, &bool)| reached.then_some(*p as f32);
    let spec = *end.occupancy.spec();
    let map = Raster::new(spec, end.occupancy.values().iter().zip(reached.values()).map(known).collect());
    let frame = Frame::straight(spec);
    let by = align((&map, &frame), (&ground.truth, &frame), &BOUND).map_err(Failure::internal)?;
    let again = ground.trial_moved(trial.seed, &[entry], setup, &Keep::default(), Some(&by), &|_, _| {})?;
    Ok((again, by))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    use mapper::catalogue::find;
    use scene::Scene;

    use crate::worlds::condition::AS_BELIEVED;
    use crate::worlds::site::{Assumptions, Site};

    /// A map that is made from poses moved as one rigid body finds its way back.
    #[test]
    fn poses_that_are_moved_as_one_are_moved_back() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
        let scene = Scene::load(&path, Some(0.1)).expect("a scene");
        let Site { ground, setup } = Site::of(scene, &AS_BELIEVED, &Assumptions::default()).expect("a site");
        let ground = ground.without_drives();
        let entry = find("visibility").expect("there");
        let middle = Frame::straight(*ground.truth.spec()).middle();
        let away = Alignment { pivot_m: middle, shift_m: [0.25, -0.3], turn_rad: 0.08, at_bound: false };
        let moved = ground.trial_moved(1, &[entry], &setup, &Keep::default(), Some(&away), &|_, _| {}).expect("mapped");
        let (_, by) = aligned(&ground, (&moved, 0), entry, &setup).expect("aligned");
        // Back is the inverse: turned by as much, and the shift as the turn leaves it.
        let (sin, cos) = libm::sincos(by.turn_rad);
        let [x, y] = away.shift_m;
        let left_m = [cos * x - sin * y + by.shift_m[0], sin * x + cos * y + by.shift_m[1]];
        assert!((by.turn_rad + away.turn_rad).abs() < 0.01, "{by:?}");
        assert!(left_m.iter().all(|left| left.abs() < 0.06), "{by:?} {left_m:?}");
        assert!(!by.at_bound);
    }

    #[test]
    fn a_map_from_true_poses_stays_about_where_it_is() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/room.toml");
        let scene = Scene::load(&path, Some(0.1)).expect("a scene");
        let Site { ground, setup } = Site::of(scene, &AS_BELIEVED, &Assumptions::default()).expect("a site");
        let ground = ground.without_drives();
        let entry = find("visibility").expect("there");
        let trial = ground.trial(1, &[entry], &setup, &Keep::default(), &|_, _| {}).expect("mapped");
        let (again, by) = aligned(&ground, (&trial, 0), entry, &setup).expect("aligned");
        assert!(by.shift_m.iter().all(|shift| shift.abs() < 0.05) && by.turn_rad.abs() < 0.01, "{by:?}");
        let loss =
            |trial: &Trial| trial.metric("visibility", trial.runs[0].stages.len() - 1, REGION.name(), "log_loss");
        let [before, after] = [&trial, &again].map(|trial| loss(trial).and_then(|m| m.value).expect("scored"));
        assert!((before - after).abs() < 0.02, "{before} {after}");
    }
}
