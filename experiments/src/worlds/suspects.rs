//! Which of several sensors is not to be believed: every sensor against its own map, and against the map of the others.
//!
//! A map of all sensors explains a wrong one too, and smears the right one. So each sensor has a map by itself. What is wrong in a sensor alone
//! shows in its own map: readings that are false come from nothing that the others of the same sensor have seen. A sensor that is turned against the
//! way it is mounted, as far as the log or scene has it, is found in two steps: its readings fit the map of the others better when they are turned back, and, since
//! that is as true of its neighbours, its own map becomes sharper when they are. One that always reads the same is known by that, where the
//! others' map does not say so.

mod evidence;
mod naming;
mod panel;

use mapper::Model;
use scene::{Scene, SimulatedScan, Simulation};
use score::SeriesMean;
use serde_json::json;

pub use self::evidence::{Named, Suspect, Turn, Visit};
pub use self::naming::Wrong;
use self::panel::Panel;
pub(crate) use self::panel::false_density;
use crate::failure::Failure;
use crate::output::table::{Table, optional, rounded};

/// Judges the sensors of a robot by its scans, every `hold_out`-th of each sensor by maps that have not seen it; nothing of a single sensor.
///
/// # Errors
/// What `visit` reports.
pub fn suspects(
    setup: &Model,
    sensors: &[Named],
    hold_out: u64,
    visit: &mut Visit<'_>,
) -> Result<Vec<Suspect>, Failure> {
    if sensors.len() < 2 {
        return Ok(Vec::new());
    }
    let panel = Panel::of(setup, sensors, hold_out, &vec![0.0; sensors.len()], visit)?;
    let mut suspects = panel.suspects();
    let back_rad: Vec<f64> = suspects.iter().map(|suspect| suspect.turn.map_or(0.0, |turn| turn.back_rad)).collect();
    if suspects.iter().any(|suspect| suspect.turn.is_some()) {
        let turned = Panel::of(setup, sensors, hold_out, &back_rad, visit)?;
        for (number, suspect) in suspects.iter_mut().enumerate() {
            if let Some(turn) = &mut suspect.turn {
                turn.by_itself = panel.sharper(&turned, number);
            }
        }
    }
    Ok(suspects)
}

/// The same of the readings that a scene's sensors gave on a drive.
///
/// # Errors
/// None of its own.
pub fn of_drive(setup: &Model, scene: &Scene, simulation: &Simulation) -> Result<Vec<Suspect>, Failure> {
    let camera = (scene.camera.columns > 0).then(|| Named { numbers: vec![0], called: "camera".to_owned() });
    let beside = scene
        .sensors
        .iter()
        .zip(1..)
        .map(|(sensor, number)| Named { numbers: vec![number], called: sensor.name.clone() });
    let sensors: Vec<Named> = camera.into_iter().chain(beside).collect();
    suspects(setup, &sensors, OF_DRIVE, &mut |each| {
        simulation.scans.iter().flat_map(SimulatedScan::together).for_each(|scan| each(&scan));
        Ok(())
    })
}

/// Of a drive, every so-manyth scan of a sensor judges it.
const OF_DRIVE: u64 = 5;

/// Those that are named, and why.
pub fn named(suspects: &[Suspect]) -> Vec<(&Named, Wrong)> {
    naming::named(suspects)
}

/// A line for each sensor that is named, for a warning.
pub fn lines(suspects: &[Suspect]) -> Vec<String> {
    let line = |(sensor, wrong): (&Named, Wrong)| format!("sensor {} ({}) {wrong}", sensor.number(), sensor.called);
    named(suspects).into_iter().map(line).collect()
}

/// Everything as a table.
pub fn table(suspects: &[Suspect]) -> Table {
    let named = named(suspects);
    let verdict = |sensor: &Named| named.iter().find(|(named, _)| *named == sensor).map(|(_, wrong)| wrong.word());
    let mean = |mean: Option<SeriesMean>| optional(mean.map(|mean| mean.mean));
    let low = |mean: Option<SeriesMean>| optional(mean.map(|mean| mean.interval.low));
    let high = |mean: Option<SeriesMean>| optional(mean.map(|mean| mean.interval.high));
    let by_others = |row: &Suspect| row.turn.map(|turn| turn.by_others);
    let by_itself = |row: &Suspect| row.turn.and_then(|turn| turn.by_itself);
    Table::of(
        suspects,
        &[
            ("sensor", &|row| json!(row.sensor.number())),
            ("kind", &|row| json!(row.sensor.called)),
            ("readings", &|row| json!(row.readings)),
            ("correct_match", &|row| rounded(row.correct)),
            ("explained_by_itself", &|row| mean(row.by_itself)),
            ("explained_by_itself_high", &|row| high(row.by_itself)),
            ("explained_by_others", &|row| mean(row.by_others)),
            ("explained_by_others_high", &|row| high(row.by_others)),
            ("gain_over_unseen", &|row| mean(row.over_unseen)),
            ("gain_over_unseen_high", &|row| high(row.over_unseen)),
            ("usual_reading", &|row| optional(row.same.map(|(reading, _)| reading))),
            ("share_of_it", &|row| optional(row.same.map(|(_, share)| share))),
            ("turned_back_deg", &|row| optional(row.turn.map(|turn| turn.back_rad.to_degrees()))),
            ("gain_by_others", &|row| mean(by_others(row))),
            ("gain_by_others_low", &|row| low(by_others(row))),
            ("gain_by_itself", &|row| mean(by_itself(row))),
            ("gain_by_itself_low", &|row| low(by_itself(row))),
            ("named", &|row| json!(verdict(&row.sensor))),
        ],
    )
}

#[cfg(test)]
mod tests;
