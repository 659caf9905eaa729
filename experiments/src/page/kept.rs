//! What a page shows of a program's maps, in a file beside it: so that the page can be laid anew without starting the
//! program.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::Folder;
use super::encoding::{frames, frames_text, region_names};
use super::viewer::{Mapped, ViewedWorld, Viewer};
use crate::failure::Failure;
use crate::output::folder::Staging;
use crate::output::table::optional;
use crate::worlds::film::{EXACT, Frame};

/// The form of the file.
const SCHEMA_VERSION: u32 = 2;

/// The file.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Kept {
    schema_version: u32,
    mapper: String,
    /// One for each world of the viewer.
    worlds: Vec<World>,
}

/// The maps and scores of one world.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct World {
    name: String,
    seed: Option<u64>,
    /// Numbers of scans after which there are maps ...
    scans: Vec<usize>,
    /// ... and whether they are there in fine steps too.
    fine: Vec<bool>,
    /// The maps.
    occupancy: [String; 2],
    /// As [`Frame::exact`].
    exact: Vec<Vec<[Option<f64>; EXACT.len()]>>,
    /// As [`ViewedWorld::metrics`].
    metrics: Vec<(String, String)>,
    /// As [`Mapped::scores`].
    scores: Vec<Vec<(String, Vec<Value>)>>,
}

/// The file for what the page shows of a program.
pub fn name(mapper: &str) -> String {
    format!("{mapper}-page.json")
}

/// Writes the file of a program that has a part in the viewer.
///
/// # Errors
/// Whatever the system reports.
pub fn save(staging: &mut Staging, viewer: &Viewer, mapper: &str) -> Result<(), Failure> {
    let world = |world: &ViewedWorld| {
        let mapped = world.mappers.iter().find(|mapped| mapped.name == mapper)?;
        let row = |(region, values): &(String, Vec<Option<f64>>)| {
            (region.clone(), values.iter().map(|value| optional(*value)).collect())
        };
        Some(World {
            name: world.name.clone(),
            seed: world.seed,
            scans: mapped.frames.iter().map(|frame| frame.scans).collect(),
            fine: mapped.frames.iter().map(|frame| frame.fine.is_some()).collect(),
            occupancy: frames_text(&mapped.frames),
            exact: mapped.frames.iter().map(|frame| frame.exact.clone()).collect(),
            metrics: world.metrics.clone(),
            scores: mapped.scores.iter().map(|stage| stage.iter().map(row).collect()).collect(),
        })
    };
    let worlds = viewer.worlds.iter().filter_map(world).collect();
    let kept = Kept { schema_version: SCHEMA_VERSION, mapper: mapper.to_owned(), worlds };
    staging.write(&name(mapper), |out| serde_json::to_writer(out, &kept))
}

/// Puts programs among the mappers of a viewer that was made without them, from the files of a folder; `order` names all
/// mappers.
///
/// # Errors
/// A folder that does not keep what its page shows of a program, or not as the run left it.
pub fn add(folder: &Folder, viewer: &mut Viewer, programs: &[&str], order: &[&str]) -> Result<(), Failure> {
    for program in programs {
        let file = name(program);
        let wrong = |why: &str| folder.refuse(&file, &format!("{why}; run the command again"));
        let kept: Kept = serde_json::from_slice(&folder.proved(&file)?)
            .map_err(|error| wrong(&format!("is not what a page shows of a program: {error}")))?;
        if kept.schema_version != SCHEMA_VERSION {
            return Err(wrong(&format!("has schema_version {}: must be {SCHEMA_VERSION}", kept.schema_version)));
        }
        for world in &mut viewer.worlds {
            let found = kept.worlds.iter().find(|kept| kept.name == world.name && kept.seed == world.seed);
            // A batch program runs in some of the worlds.
            let Some(found) = found else { continue };
            let mapped = found.mapped(program, world).ok_or_else(|| wrong("holds maps of another grid"))?;
            world.mappers.push(mapped);
            if world.metrics.is_empty() {
                world.metrics.clone_from(&found.metrics);
            }
        }
    }
    let place = |mapped: &Mapped| order.iter().position(|name| *name == mapped.name);
    viewer.worlds.iter_mut().for_each(|world| world.mappers.sort_by_key(place));
    Ok(())
}

impl World {
    /// What stood in the viewer; nothing of maps of another size.
    fn mapped(&self, name: &str, world: &ViewedWorld) -> Option<Mapped> {
        let lengths = [self.fine.len(), self.exact.len()];
        (lengths == [self.scans.len(); 2]).then_some(())?;
        let regions = region_names(world).len();
        self.exact.iter().all(|rows| rows.len() == regions).then_some(())?;
        let films = frames(&self.occupancy, world.grid, &self.fine)?;
        let frame = |((scans, (levels, fine)), exact): ((&usize, _), &Vec<_>)| Frame {
            scans: *scans,
            levels,
            fine,
            exact: exact.clone(),
        };
        let row =
            |(region, values): &(String, Vec<Value>)| (region.clone(), values.iter().map(Value::as_f64).collect());
        Some(Mapped {
            name: name.to_owned(),
            frames: self.scans.iter().zip(films).zip(&self.exact).map(frame).collect(),
            scores: self.scores.iter().map(|stage| stage.iter().map(row).collect()).collect(),
            known: None,
        })
    }
}
