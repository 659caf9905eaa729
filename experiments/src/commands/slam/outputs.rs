//! The files that `slam` leaves behind, and what it prints.

use std::io::Write as _;

use grid::{GridSpec, Raster};
use logs::Sensor;
use mapper::Model;
use mapper::catalogue::Entry;
use sensor::{FeatureCamera, Pose};
use serde_json::{Value, json};
use slam::{Outcome, Update};

use super::along;
use super::document::{self, Pictures};
use super::figure::{self, Ways};
use super::options::SlamOptions;
use super::scores::{References, Scores};
use super::sensors;
use super::source::{Carrier, Taken};
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output;
use crate::output::folder::Staging;
use crate::output::ledger::RECORD;
use crate::output::note;
use crate::output::record::Record;
use crate::output::table::{Table, optional, rounded};
use crate::page::cloud::Moment;
use crate::worlds::landmarks;
use crate::worlds::seen::{Reach, Seen};

/// Round what was seen, cells.
const MARGIN: usize = 10;

/// All that there is to tell.
pub(super) struct Told<'a> {
    pub(super) options: &'a SlamOptions,
    pub(super) entry: &'a Entry,
    pub(super) place: &'a str,
    pub(super) scans: &'a [Taken],
    pub(super) model: &'a Model,
    pub(super) sensors: &'a [Carrier],
    /// What found features, where they were asked for.
    pub(super) camera: Option<FeatureCamera>,
    /// That of a log.
    pub(super) sensor: Option<Sensor>,
    pub(super) outcome: &'a Outcome,
    /// The map round what was seen of it, and which cells were.
    pub(super) map: &'a Raster<f64>,
    pub(super) seen: &'a Raster<bool>,
    pub(super) scores: &'a Scores,
    pub(super) away: &'a [Update],
    /// The particles after every update.
    pub(super) moments: &'a [Moment],
    /// Numbers of the updates at which the robot came back to where it had been.
    pub(super) returns: &'a [usize],
    pub(super) references: &'a References,
}

/// Every file that may come of it, beside the record.
pub(super) fn names(paper: &Paper) -> Vec<String> {
    let fixed = ["trajectory.txt", landmarks::FILE, "metrics.csv", "updates.csv", "report.html"].map(str::to_owned);
    fixed.into_iter().chain(output::map::names("map")).chain(paper.files(&["along.png", "trajectory.png"])).collect()
}

/// Writes everything.
pub(super) fn write(staging: &mut Staging, told: &Told) -> Result<(), Failure> {
    staging.write("trajectory.txt", |out| trajectory(told, out))?;
    told.scores.table().save(staging, "metrics.csv")?;
    updates(&told.outcome.updates).save(staging, "updates.csv")?;
    if let Some(camera) = &told.camera {
        landmarks::table(&told.outcome.landmarks, camera).save(staging, landmarks::FILE)?;
    }
    let (map, seen) = (told.map, told.seen);
    output::map::write(staging, "map", map, seen)?;
    let places = |poses: &mut dyn Iterator<Item = Pose>| poses.map(|pose| pose.position_m()).collect::<Vec<_>>();
    let found = places(&mut told.outcome.trajectory.iter().map(|(_, pose)| *pose));
    let odometry = places(&mut told.scans.iter().map(|taken| taken.odometry));
    let truth = told.references.truth.as_deref().unwrap_or_default();
    let truth: Vec<[f64; 2]> = truth.iter().map(|stamped| [stamped.pose.x_m, stamped.pose.y_m]).collect();
    let drawn = Ways { found: &found, odometry: &odometry, truth: &truth };
    let drawing = figure::draw(map, seen, told.model.prior.marginal(), &drawn, &told.options.paper);
    let paper = &told.options.paper;
    let picture = paper.save(staging, "trajectory.png", &drawing)?;
    let (updates, particles) = (&told.outcome.updates, told.options.particles as usize);
    let (way, reference) = (&told.outcome.trajectory, told.references.truth.as_deref());
    let along = along::draw(updates, particles, told.scans, way, reference, paper);
    let pictures = Pictures { trajectory: picture, along: paper.save(staging, "along.png", &along)? };
    let ways = vec![("odometry", odometry), ("truth", truth), ("slam", found)];
    let cloud = document::cloud(told, ways)?;
    let configuration = configuration(told);
    let files = staging.files_and(&["report.html", RECORD]);
    let html = document::page(told, cloud, pictures, &configuration, files)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    let away: Vec<f64> = told.away.iter().map(|update| update.time_s).collect();
    let returned: Vec<f64> = told.returns.iter().map(|k| told.outcome.updates[*k].time_s).collect();
    let findings = json!({ "carried_away_s": away, "returned_s": returned, "passed_over_s": told.outcome.passed_over, "relations_left_out": told.scores.left_out });
    let mut parts = json!({ "configuration": configuration, "grid": told.model.grid, "findings": findings });
    if let Some(pictures) = told.options.paper.asked() {
        parts["pictures"] = json!(pictures);
    }
    staging.record(&Record::new("slam", parts))
}

/// A row for every scan: time by the log's clock, s, place, m, and a quaternion.
fn trajectory(told: &Told, out: &mut impl std::io::Write) -> std::io::Result<()> {
    for (taken, (_, pose)) in told.scans.iter().zip(&told.outcome.trajectory) {
        let (sin, cos) = libm::sincos(0.5 * pose.theta_rad);
        writeln!(out, "{:.6} {:.6} {:.6} 0 0 0 {sin:.9} {cos:.9}", taken.clock_s, pose.x_m, pose.y_m)?;
    }
    Ok(())
}

fn updates(updates: &[Update]) -> Table {
    Table::of(
        updates,
        &[
            ("time_s", &|row| rounded(row.time_s)),
            ("effective", &|row| rounded(row.effective)),
            ("resampled", &|row| json!(row.resampled)),
            ("spread_m", &|row| rounded(row.spread_m)),
            ("matched", &|row| rounded(row.matched)),
            ("gain_nats_per_reading", &|row| optional(row.gain)),
            ("carried_away", &|row| json!(row.carried_away)),
        ],
    )
}

/// The map round what was seen of it, and which cells were.
pub(super) fn cropped(scans: &[Taken], outcome: &Outcome, model: &Model) -> (Raster<f64>, Raster<bool>) {
    let spec = model.grid;
    let mut seen = Seen::new(spec);
    let mut updates = outcome.updates.iter().map(|update| update.time_s).peekable();
    for (taken, (time_s, pose)) in scans.iter().zip(&outcome.trajectory) {
        if updates.next_if(|update| update.total_cmp(time_s).is_eq()).is_some() {
            for mounted in taken.mounted() {
                let scan = mounted.scan_from(*pose);
                seen.add(&scan, &**model.sensors.of(&scan), Reach::Median);
            }
        }
    }
    let seen = seen.cells;
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    for cell in (0..spec.cells()).filter(|cell| seen[*cell]) {
        let (column, row) = spec.column_row(cell);
        low = [low[0].min(column), low[1].min(row)];
        high = [high[0].max(column), high[1].max(row)];
    }
    if low[0] > high[0] {
        (low, high) = ([0; 2], [spec.width - 1, spec.height - 1]);
    }
    let from = low.map(|index| index.saturating_sub(MARGIN));
    let until = [(high[0] + MARGIN + 1).min(spec.width), (high[1] + MARGIN + 1).min(spec.height)];
    let window = GridSpec {
        origin_m: [0, 1].map(|k| spec.origin_m[k] + spec.cell_m * from[k] as f64),
        width: until[0] - from[0],
        height: until[1] - from[1],
        ..spec
    };
    let there = |cell: usize| {
        let (column, row) = window.column_row(cell);
        (row + from[1]) * spec.width + column + from[0]
    };
    let map = (0..window.cells()).map(|cell| outcome.map.occupied(there(cell))).collect();
    let known = (0..window.cells()).map(|cell| seen[there(cell)]).collect();
    (Raster::new(window, map), Raster::new(window, known))
}

/// What the results were made from.
fn configuration(told: &Told) -> Value {
    let options = told.options;
    let filter = options.filter();
    let name = |path: &Option<std::path::PathBuf>| path.as_ref().map(|path| path.display().to_string());
    let weight = options.weight.name();
    let noise = options.noise();
    let mut configuration = json!({
        "source": told.place,
        "mapper": told.entry.name,
        "particles": filter.particles,
        "seed": filter.seed,
        "weight": weight,
        "power": filter.weight.power(),
        "given_power": options.power,
        "landmarks": options.landmarks,
        "least_sigmas": options.filter_of(told.sensor.is_some()).least_sigmas,
        "update_move_m": filter.update_move_m,
        "update_turn_deg": options.update_turn,
        "noise": noise,
        "given_noise": options.noise.map(|noise| [noise.rad_per_rad, noise.rad_per_m, noise.m_per_m, noise.m_per_rad]),
        "truth": name(&options.truth),
        "relations": name(&options.relations),
        "layout": options.layout,
        "given_grid_m": options.grid,
        "sensor": told.sensor.map(|kind| options.kernels().record(kind)),
        "reach_m": options.reach,
        "min_range_m": options.min_range,
        "given_max_range_m": options.max_range,
        "every": options.every,
        "window_s": options.window,
        "damaged_share": options.damaged_share,
        "fan": {"fov_deg": options.fan.fov, "first_bearing_deg": options.fan.first_bearing, "increment_deg": options.fan.increment},
        "prior": told.model.prior,
        "reconciliation": told.model.reconciliation,
    });
    if told.sensors.len() > 1 {
        let known = told.sensors.iter().filter_map(|sensor| Some((sensor.number.to_string(), sensor.kind?)));
        let kernels: serde_json::Map<String, Value> =
            known.map(|(number, kind)| (number, options.kernels().record(kind))).collect();
        if !kernels.is_empty() {
            configuration["sensors"] = Value::Object(kernels);
        }
        configuration["mounts"] = sensors::mounts(told.sensors);
    }
    configuration
}

/// Says where the robot was carried away.
pub(super) fn tell_carried_away(place: &str, away: &[Update]) {
    for update in away {
        note(format_args!(
            "warning: {place}: at {:.1} s the robot is not where its map says: the map predicts the scans worse than no map would; was it \
             carried away, or did its wheels slip?",
            update.time_s
        ));
    }
}

/// Says which scans were passed over.
pub(super) fn tell_passed_over(place: &str, times_s: &[f64]) {
    if let Some(first) = times_s.first() {
        let scans = if times_s.len() == 1 { "1 scan is".to_owned() } else { format!("{} scans are", times_s.len()) };
        note(format_args!(
            "note: {place}: {scans} passed over, the first at {first:.1} s: the map contradicts them, and fits what comes soon after; is the \
             odometry late there?"
        ));
    }
}

/// Refuses a way that leaves the map: what lies there was neither matched nor mapped.
pub(super) fn tell_outside(place: &str, outcome: &Outcome, grid: &GridSpec) -> Result<(), Failure> {
    match outcome.trajectory.iter().find(|(_, pose)| grid.locate(pose.position_m()).is_none()) {
        None => Ok(()),
        Some((time_s, pose)) => Err(Failure::BadInput(format!(
            "{place}: at {time_s:.1} s the way leaves the map, at ({:.1}, {:.1}) m; make the map larger with --reach",
            pose.x_m, pose.y_m
        ))),
    }
}

/// What the terminal shows.
pub(super) fn text(told: &Told) -> String {
    let updates = &told.outcome.updates;
    let resampled = updates.iter().filter(|update| update.resampled).count();
    let effective = updates.iter().map(|update| update.effective).sum::<f64>() / updates.len() as f64;
    let returned = match told.returns.len() {
        0 => String::new(),
        1 => "\nthe robot came back once to where it had been".to_owned(),
        times => format!("\nthe robot came back {times} times to where it had been"),
    };
    let mut text = format!(
        "slam of {}\n{} scans, {} of them matched and mapped by {} particles of {}\n{}N_eff {effective:.1} on average, drawn anew {resampled} times{returned}\n",
        told.place,
        told.scans.len(),
        updates.len(),
        told.options.particles,
        told.entry.name,
        sensors::text(sensors::Robot { sensors: told.sensors, scans: told.scans, model: told.model }),
    );
    if !told.scores.table().rows().is_empty() {
        text.push('\n');
        text.push_str(&told.scores.text());
    }
    if told.scores.left_out > 0 {
        text.push_str(&format!("{} relations have no scan at their times\n", told.scores.left_out));
    }
    text
}
