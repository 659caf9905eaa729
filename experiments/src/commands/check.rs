//! `check SCENE`: is the scene valid, and what does it hold?

mod drawing;

use clap::Args;

use mapper::Prior;
use scene::{SceneError, enclosure};
use score::MovingRegion;
use serde_json::{Value, json};

use self::drawing::drawing;
use crate::failure::Failure;
use crate::output::table::{Table, aligned, rounded};
use crate::output::warn;
use crate::worlds::run::Ground;
use crate::worlds::scenes::SceneOptions;
use crate::worlds::witness::Witness;

/// Options of `check`.
#[derive(Debug, Args)]
pub struct CheckOptions {
    /// What to check
    #[command(flatten)]
    pub scene: SceneOptions,
    /// Draw the scene in characters, above what it holds
    #[arg(long)]
    pub show: bool,
}

/// Columns of a drawing.
const WIDTH: usize = 78;

/// Loads the scene, drives its route, and prints what there is.
///
/// # Errors
/// All that is wrong with the scene's file, a line each, in the order of the file; else the first problem with its route.
pub fn run(options: &CheckOptions) -> Result<(), Failure> {
    let CheckOptions { scene: options, show } = options;
    let scene = scene::examine(&options.scene, options.grid, options.layout).map_err(all)?;
    let ground = Ground::new(scene, Prior::default().occupancy)?;
    warn(&ground.scene.warnings);
    warn(enclosure(&ground.scene, &ground.world, &ground.drive).warning(&options.scene).as_slice());
    let facts = facts(&ground)?;
    let table = Table::of(
        &facts,
        &[("item", &|row| json!(row.0)), ("value", &|row| row.1.clone()), ("unit", &|row| json!(row.2))],
    );
    table.print(options.print.format, || {
        // A number of things has no unit to show.
        let unit = |unit: &str| if unit == "1" { String::new() } else { unit.to_owned() };
        let rows: Vec<_> = facts.iter().map(|row| vec![row.0.clone(), row.1.to_string(), unit(row.2)]).collect();
        let layout = ground.scene.layout.map(|layout| format!(", layout {layout}")).unwrap_or_default();
        let table = aligned(&["item", "value", "unit"], &rows);
        let drawing = if *show { drawing(&ground, WIDTH) + "\n" } else { String::new() };
        format!("{}{layout}: valid\n\n{drawing}{table}", options.scene.display())
    })
}

/// One failure of all errors.
fn all(mut errors: Vec<SceneError>) -> Failure {
    errors.sort_by_key(|error| error.place().map(|place| (place.line, place.column)));
    let all: Vec<Failure> = errors.into_iter().map(Failure::from).collect();
    let lines = all.iter().map(ToString::to_string).collect::<Vec<_>>().join("\nerror: ");
    match all.iter().any(|failure| matches!(failure, Failure::Internal(_))) {
        true => Failure::Internal(lines),
        false => Failure::BadInput(lines),
    }
}

fn facts(ground: &Ground) -> Result<Vec<(String, Value, &'static str)>, Failure> {
    let scene = &ground.scene;
    let spec = &scene.grid;
    let mut witness = Witness::new(ground);
    let (mut rays, mut hits) = (0usize, 0usize);
    // What rays meet does not depend on the seed.
    for (number, scan) in scene::simulate(scene, &ground.world, &ground.drive, 0).scans.iter().enumerate() {
        witness.look(ground, number, scan)?;
        rays += scan.true_ranges_m.len();
        hits += scan.true_ranges_m.iter().flatten().count();
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
