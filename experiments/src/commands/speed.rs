//! `speed`: what every mapper costs on the user's own machine, side by side, on one thread.

mod carrier;
pub mod file;
pub mod growth;
pub mod hall;
pub mod measure;
mod options;
mod outputs;
mod processor;
pub mod scans;
mod simulated;
pub mod tables;
pub mod world;

pub use options::SpeedOptions;

use std::path::{Path, PathBuf};

use mapper::Model;
use sensor::Scan;

use self::growth::Sizes;
use self::hall::Hall;
use self::scans::{ScanSet, Visited};
use self::tables::{Alone, Conditions};
use crate::failure::Failure;
use crate::jobs::interruption;
use crate::jobs::progress::Count;
use crate::jobs::threads;
use crate::output::args::Format;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;
use crate::output::table;
use crate::worlds::faults;
use crate::worlds::mappers::entries;
use crate::worlds::scenes;

/// Maps the same scans by every mapper with a clock, and prints the time of each.
///
/// # Errors
/// Bad input before any measurement, I/O, and a mapper that did not do its work.
pub fn run(options: &SpeedOptions) -> Result<(), Failure> {
    interruption::watch();
    let entries = entries(&options.mappers, &options.programs)?;
    options.order.check(options.print.format, &tables::HEADS, &tables::COLUMNS)?;
    if options.growth {
        if let Some(program) = options.programs.programs.first() {
            return Err(Failure::BadInput(format!(
                "--growth: '{}' works in a process of its own, whose scans have no times of their own; leave out --mapper",
                program.name
            )));
        }
        growth::online(&entries)?;
        if options.print.format == Format::Csv && options.out.is_none() {
            let message =
                "--growth --format csv: gives two tables, and stdout takes one; name a folder for both with --out";
            return Err(Failure::BadInput(message.to_owned()));
        }
    }
    let programs: Vec<String> = options.programs.programs.iter().map(|program| program.name.to_string()).collect();
    options.world.check(&entries, &programs)?;
    // Before a scene is driven through, which takes threads.
    threads::limit(Some(1))?;
    let set = match options.scans.as_ref().map(|path| scenes::or_file(path)) {
        Some((scene, true)) => {
            let place = scene.display().to_string();
            options.given.warn(&["sensor", "reach"], &place, "a scene, which has sensors and a map of its own");
            simulated::load(&scene)?
        }
        Some((path, false)) => file::load(&path, options.sensor, options.reach)?,
        None => Hall::new()?.scans(),
    };
    let (setup, conditions) = conditions(options, &set)?;
    let reads: Vec<&Path> = options.scans.iter().map(PathBuf::as_path).collect();
    let purpose = Purpose::new("speed", &reads, options.paper.files(&outputs::FILES));
    let staging = options.out.as_deref().map(|folder| Staging::open(folder, &purpose)).transpose()?;
    if cfg!(debug_assertions) {
        note(format_args!(
            "warning: this build checks every map after every scan, and is slower for it; run with cargo run --release"
        ));
    }

    let (repeats, sizes) = (options.repeats as usize, Sizes::default());
    let steps = if options.growth { growth::steps(&sizes, entries.len(), repeats) } else { 0 };
    let parts = apart(&set, &setup);
    let progress = Count::measurements(entries.len() * repeats * (1 + parts.len()) + steps);
    let step = || progress.step();
    let speeds = measure::measure(&entries, &setup, (&set, options.world), &conditions.visited, repeats, step)?;
    let alone = parts.into_iter().map(|(sensor, set, visited)| {
        let speeds = measure::measure(&entries, &setup, (&set, options.world), &visited, repeats, step)?;
        Ok(Alone { sensor, scans: set.scans.len(), visited, speeds })
    });
    let alone = alone.collect::<Result<Vec<Alone>, Failure>>()?;
    let curves = options.growth.then(|| growth::measure(&entries, &sizes, repeats, step)).transpose()?;
    progress.finish();

    if let (Some(staging), Some(folder)) = (staging, &options.out) {
        outputs::write(staging, (&speeds, &alone), &conditions, curves.as_deref(), &options.paper)?;
        note(folder.join("speed.csv").display());
    }
    for speed in &speeds {
        if let Some(outside) = speed.outside.as_ref().filter(|outside| outside.fault.is_none()) {
            note(format_args!("{}: {:.3} s of its last map in its process", speed.mapper, outside.seconds));
        }
    }
    let table = options.order.of(tables::table(&speeds, &conditions), &tables::HEADS);
    let printed = match (options.print.format, &curves) {
        (Format::Json, curves) if curves.is_some() || !alone.is_empty() => {
            let mut json = table.to_json();
            if !alone.is_empty() {
                json["by_sensor"] = tables::by_sensor(&alone).to_json()["rows"].take();
            }
            if let Some(curves) = curves {
                json["growth"] = growth::table(curves).to_json()["rows"].take();
            }
            table::print(&format!("{json:#}\n"))
        }
        (format, curves) => table.print(format, || {
            let growth = curves.as_ref().map(|curves| format!("\n{}", growth::text(curves))).unwrap_or_default();
            let sensors = if alone.is_empty() { String::new() } else { tables::sensors_text(&alone) };
            tables::text(&speeds, &conditions, &options.order) + &sensors + &growth
        }),
    };
    printed?;
    let faults = speeds.iter().filter_map(|speed| Some(format!("{}: {}", speed.mapper, speed.fault()?)));
    faults::none(&faults.collect::<Vec<_>>())
}

/// The scans of each of several sensors alone, with what they ask of every mapper; of those that have a reading that is a range.
fn apart(set: &ScanSet, setup: &Model) -> Vec<(String, ScanSet, Visited)> {
    let called: Vec<&str> = set.called().collect();
    if called.len() < 2 {
        return Vec::new();
    }
    let of = |(number, called): (usize, &&str)| {
        let alone = set.of_sensor(number);
        let visited = alone.visited(&setup.grid);
        (visited.rays > 0).then(|| ((*called).to_owned(), alone, visited))
    };
    called.iter().enumerate().filter_map(of).collect()
}

/// The map, the belief, and what the scans ask of every mapper.
fn conditions(options: &SpeedOptions, set: &ScanSet) -> Result<(Model, Conditions), Failure> {
    let source = match &options.scans {
        Some(path) => path.display().to_string(),
        None => "a drive round a hall of 40 m by 40 m with boxes".to_owned(),
    };
    let grid = set.grid(options.grid).map_err(|what| Failure::BadInput(format!("{source}: {what}")))?;
    let visited = set.visited(&grid);
    if visited.rays == 0 {
        return Err(Failure::BadInput(format!(
            "{source}: column range_m: none of {} rays has a range that the sensor can see; one must, of a camera at a depth of \
             0.25 m or more in front of it; check the unit of the ranges (m) and of the bearings (rad)",
            set.rays()
        )));
    }
    let sensors = set.sensors();
    let setup = Model { sensors: sensors.clone(), ..Model::new(grid, sensors.of(&Scan::default()).clone()) };
    let processor = processor::name();
    let (scans, repeats, world) = (set.scans.len(), options.repeats, options.world);
    let conditions = Conditions { source, scans, visited, grid, repeats, world, processor };
    Ok((setup, conditions))
}
