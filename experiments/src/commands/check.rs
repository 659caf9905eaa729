//! `check FILE`: is a scene, a family, a sweep or a file of gates valid, and what does it hold?

mod drawing;
mod picture;

use std::path::{Path, PathBuf};

use clap::Args;
use mapper::Prior;
use scene::enclosure;
use score::MovingRegion;
use serde_json::{Value, json};

use self::drawing::drawing;
use self::picture::Form;
use crate::failure::Failure;
use crate::output::args::{FormatOption, positive};
use crate::output::single::{self, Existing};
use crate::output::table::{Table, aligned, rounded};
use crate::output::{note, warn};
use crate::worlds::ground::Ground;
use crate::worlds::scenes::described;
use crate::worlds::witness::Witness;

/// Options of `check`.
#[derive(Debug, Args)]
pub struct CheckOptions {
    /// Scene, family of scenes, sweep or gates: a name of `list`, or a file
    #[arg(value_name = "FILE", value_parser = described())]
    pub file: PathBuf,
    /// Which scene of a family [default: 1]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub layout: Option<u64>,
    /// Side of a cell in metres, instead of the scene's
    #[arg(long, value_name = "M", allow_negative_numbers = true, value_parser = positive)]
    pub grid: Option<f64>,
    /// Draw the scene in characters, above what it holds
    #[arg(long)]
    pub show: bool,
    /// Draw the scene into a file: .png, .svg, or .txt for characters
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Replace the file of --out if it is there already
    #[arg(long, requires = "out")]
    pub force: bool,
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
}

/// Something that a file holds: what, how much, and its unit.
pub type Fact = (String, Value, &'static str);

/// What single commands make of their files.
pub struct Readers {
    /// Of sweeps.
    pub sweep: fn(&Path) -> Result<Vec<Fact>, Failure>,
    /// Of gates.
    pub gate: fn(&Path) -> Result<Vec<Fact>, Failure>,
}

/// Columns of a drawing.
const WIDTH: usize = 78;

/// Reads the file, drives the route of a scene, and prints what there is.
///
/// # Errors
/// All that is wrong with the file, a line each, in the order of the file; else the first problem with a route.
pub fn run(options: &CheckOptions, readers: &Readers) -> Result<(), Failure> {
    let (what, reader) = match kind(&options.file) {
        Kind::Scene => return scene(options),
        Kind::Sweep => ("a sweep", readers.sweep),
        Kind::Gates => ("a file of gates", readers.gate),
    };
    let given = [
        ("--show", options.show),
        ("--out", options.out.is_some()),
        ("--layout", options.layout.is_some()),
        ("--grid", options.grid.is_some()),
    ];
    if let Some((option, _)) = given.into_iter().find(|(_, given)| *given) {
        let place = options.file.display();
        return Err(Failure::BadInput(format!("{option}: is about scenes, and {place} is {what}; leave it out")));
    }
    let facts = reader(&options.file)?;
    print(options, &facts, "", "")
}

/// What a file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// A scene or a family, or nothing that can be told.
    Scene,
    Sweep,
    Gates,
}

/// By the keys of the file that no other kind has.
fn kind(path: &Path) -> Kind {
    let Ok(text) = strict::read(path) else { return Kind::Scene };
    let Ok((source, document)) = strict::open(&text, "") else { return Kind::Scene };
    let root = strict::Table::new(&source, "", 0, document.get_ref());
    let has = |keys: &[&str]| keys.iter().any(|key| root.get(key).is_some());
    match () {
        () if has(&["gate"]) => Kind::Gates,
        () if has(&["mappers", "vary", "paired", "scenes", "families"]) => Kind::Sweep,
        () => Kind::Scene,
    }
}

/// Checks a scene, or one of a family.
fn scene(options: &CheckOptions) -> Result<(), Failure> {
    let file = &options.file;
    let form = options.out.as_deref().map(Form::of).transpose()?;
    if let Some(out) = &options.out {
        single::refuse_taken(out, &[file], Existing::forced(options.force))?;
    }
    let scene = scene::examine(file, options.grid, options.layout)?;
    let ground = Ground::new(scene, Prior::default().occupancy)?;
    warn(&ground.scene.warnings);
    warn(enclosure(&ground.scene, &ground.world, &ground.drive).warning(file).as_slice());
    let layout = ground.scene.layout.map(|layout| format!(", layout {layout}")).unwrap_or_default();
    let shown = if options.show { drawing(&ground, WIDTH) + "\n" } else { String::new() };
    if let Some((out, form)) = options.out.as_ref().zip(form) {
        let picture = single::Whole { path: out.clone(), bytes: form.picture(&ground, WIDTH)? };
        single::put(&[picture], &[file], Existing::forced(options.force))?;
    }
    print(options, &facts(&ground)?, &layout, &shown)?;
    options.out.iter().for_each(|out| note(out.display()));
    Ok(())
}

/// Prints that the file is valid, a drawing, and what it holds.
fn print(options: &CheckOptions, facts: &[Fact], layout: &str, drawing: &str) -> Result<(), Failure> {
    let table = Table::of(
        facts,
        &[("item", &|row| json!(row.0)), ("value", &|row| row.1.clone()), ("unit", &|row| json!(row.2))],
    );
    table.print(options.print.format, || {
        // A number of things has no unit to show.
        let unit = |unit: &str| if unit == "1" { String::new() } else { unit.to_owned() };
        let value = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        let rows: Vec<_> = facts.iter().map(|row| vec![row.0.clone(), value(&row.1), unit(row.2)]).collect();
        let table = aligned(&["item", "value", "unit"], &rows);
        format!("{}{layout}: valid\n\n{drawing}{table}", options.file.display())
    })
}

fn facts(ground: &Ground) -> Result<Vec<Fact>, Failure> {
    let scene = &ground.scene;
    let spec = &scene.grid;
    let mut witness = Witness::new(ground);
    let (mut rays, mut hits) = (0usize, 0usize);
    // What rays meet does not depend on the seed.
    for (number, scan) in scene::simulate(scene, &ground.world, &ground.drive, 0).scans.iter().enumerate() {
        witness.look(ground, number, scan)?;
        let beside = scan.beside.iter().map(|beside| &beside.true_ranges_m);
        for ranges in [&scan.true_ranges_m].into_iter().chain(beside) {
            rays += ranges.len();
            hits += ranges.iter().flatten().count();
        }
    }
    let (seen, truths) = (&witness.seen, ground.still().values());
    let known = truths.iter().flatten().count();
    let occupied = truths.iter().filter(|t| **t == Some(true)).count();
    let area = |cells: usize| rounded(cells as f64 * spec.cell_area_m2());
    let positions: Vec<[f64; 2]> = ground.drive.poses.iter().map(|p| p.pose.position_m()).collect();
    let length: f64 = positions.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
    let count = |mask: grid::Raster<bool>| mask.values().iter().filter(|&&v| v).count();
    let mut facts = vec![
        ("cells".to_owned(), json!(spec.cells()), "1"),
        ("cell size".to_owned(), rounded(spec.cell_m), "m"),
        ("known area".to_owned(), area(known), "m²"),
        ("occupied area".to_owned(), area(occupied), "m²"),
        ("observable area".to_owned(), area(count(seen.mask(score::Region::Observable))), "m²"),
        ("obstacles".to_owned(), json!(scene.obstacles.len()), "1"),
        ("route".to_owned(), rounded(length), "m"),
        ("scans".to_owned(), json!(ground.scans()), "1"),
        ("rays".to_owned(), json!(rays), "1"),
        ("rays that end on an obstacle".to_owned(), json!(hits), "1"),
        ("... but in no occupied cell".to_owned(), json!(seen.hits_without_surface()), "1"),
    ];
    let sensors = scene.sensors.iter().map(|sensor| {
        let what = format!("rays of {}, a sensor of kind {}", sensor.name, sensor.device.kind().name());
        (what, json!(sensor.bearings_rad.len()), "1")
    });
    facts.extend(sensors);
    let moving = [("people", scene.movers.len()), ("doors", scene.doors.len()), ("chairs", scene.chairs.len())];
    facts.extend(moving.iter().filter(|(_, n)| *n > 0).map(|(what, n)| ((*what).to_owned(), json!(n), "1")));
    for (name, scans) in &ground.drive.stage_ends {
        facts.push((format!("stage {name} ends after scan"), json!(scans), "1"));
    }
    for region in &scene.regions {
        facts.push((format!("region {}", region.name), area(count(region.mask(spec))), "m²"));
    }
    if ground.moves() {
        facts.push(("things that move".to_owned(), json!(ground.drive.motion.len()), "1"));
        let moving = witness
            .movement
            .iter()
            .flat_map(|movement| MovingRegion::ALL.map(|region| (region.name(), movement.moving.mask(region))));
        facts.extend(moving.map(|(name, mask)| (format!("{name} area in the end"), area(count(mask)), "m²")));
    }
    Ok(facts)
}
