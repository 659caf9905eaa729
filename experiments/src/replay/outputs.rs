//! The files that `replay` leaves behind, and what it says in the terminal.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use grid::ros_map::{self, Coding, Shades};
use grid::{Raster, npy};
use logs::Sensor;
use mapper::Model;
use score::SeriesMean;
use serde_json::{Value, json};

use super::extent::Survey;
use super::options::{LaserOptions, ReplayOptions, StereoOptions};
use super::predictions::{Predictions, Row};
use super::{Map, Maps};
use crate::failure::Failure;
use crate::figures;
use crate::record::versions;
use crate::report::{self, Page, Part, Picture, Section, Sheet};
use crate::staging::{RECORD, Staging};
use crate::table::{self, Table};

/// All that there is to tell.
pub(super) struct Told<'a> {
    pub(super) options: &'a ReplayOptions,
    pub(super) survey: &'a Survey,
    pub(super) setup: &'a Model,
    pub(super) maps: &'a Maps,
    pub(super) predictions: &'a Predictions,
}

/// Writes everything.
pub(super) fn write(staging: &mut Staging, told: &Told) -> Result<(), Failure> {
    let (scores, differences) = (told.predictions.table(), told.predictions.differences());
    csv(staging, "predictions.csv", &scores)?;
    csv(staging, "differences.csv", &differences)?;
    for map in &told.maps.maps {
        save(staging, map, &told.maps.seen)?;
    }
    let drawn: Vec<(&str, &Raster<f64>)> =
        told.maps.maps.iter().map(|map| (map.mapper, &map.occupancy)).filter(|(name, _)| *name != "prior").collect();
    let bytes = figures::replay::draw(&drawn, told.setup.prior.marginal(), &told.survey.path)?;
    staging.write("maps.png", |out| out.write_all(&bytes))?;
    let picture = Picture { name: "maps.png".to_owned(), caption: figures::replay::CAPTION.to_owned(), bytes };
    let configuration = configuration(told);
    let files = staging.files_and(&["report.html", RECORD]);
    let page = Page {
        title: format!("Replay of {}", name(told.options)),
        lead: LEAD.to_owned(),
        facts: facts(told),
        claims: Vec::new(),
        viewer: None,
        sections: vec![
            section("The maps", MAPS, vec![Part::Picture(picture)]),
            section(
                "Which map predicts best",
                PREDICTS,
                vec![
                    Part::Sheet(Sheet::of("Loss of every map, nats per reading; lower is better", &scores)),
                    Part::Sheet(Sheet::of("Differences from the baseline; above 0 is worse", &differences)),
                ],
            ),
            section("What is in the log", "", vec![Part::Sheet(Sheet::of("Counts", &counts(told)))]),
        ],
        configuration: serde_json::to_string_pretty(&configuration).map_err(Failure::internal)?,
        files: files.clone(),
    };
    let html = report::page(&page)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    let record = json!({
        "schema_version": 1,
        "command": "replay",
        "configuration": configuration,
        "grid": told.setup.grid,
        "versions": versions(),
        "files": files,
    });
    staging.record(&record)
}

/// The map as numpy reads it, and as a robot does; cells in which no beam was are unknown to the latter.
fn save(staging: &mut Staging, map: &Map, seen: &Raster<bool>) -> Result<(), Failure> {
    let mapper = map.mapper;
    staging.write(&format!("{mapper}.npy"), |out| npy::write(&map.occupancy.map(|p| *p as f32), out))?;
    let spec = *map.occupancy.spec();
    let known = |cell: usize| seen[cell].then(|| map.occupancy[cell] as f32);
    let known = Raster::new(spec, (0..spec.cells()).map(known).collect());
    let coding = Coding::default();
    let shades = Shades::of(&known, &coding).map_err(Failure::internal)?;
    let image = format!("{mapper}.pgm");
    staging.write(&image, |out| shades.pgm(out))?;
    let yaml = ros_map::describe(&spec, 0.0, &coding, &image);
    staging.write(&format!("{mapper}.yaml"), |out| out.write_all(yaml.as_bytes()))
}

fn csv(staging: &mut Staging, name: &str, table: &Table) -> Result<(), Failure> {
    staging.write(name, |out| table.write_csv(out).map_err(io::Error::other))
}

fn section(heading: &str, lead: &str, parts: Vec<Part>) -> Section {
    Section { heading: heading.to_owned(), lead: lead.to_owned(), parts }
}

const LEAD: &str = "What a robot recorded, mapped by several rules from the same scans, and scored without any ground truth by how well each map \
     predicts readings that it has not seen.";
const MAPS: &str = "NAME.yaml and NAME.pgm are for map_server and Nav2, NAME.npy has the probabilities.";
const PREDICTS: &str = "The score is the mean of -ln P(reading | map). One model predicts for all maps: the likelihood of the reading over \
    the first occupied cell on its ray, under the map's own probabilities; a row NAME-chain is the same with the joint probabilities of \
    neighbours. Intervals are 95 % by a bootstrap of blocks of scans that follow each other.";

fn name(options: &ReplayOptions) -> String {
    options.log.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn facts(told: &Told) -> String {
    let Told { survey, setup, predictions, .. } = told;
    let sensor = match survey.sensor {
        Sensor::Laser { beams, max_range_m } => format!("a laser of {beams} beams up to {max_range_m} m"),
        Sensor::Stereo => "a stereo camera".to_owned(),
    };
    let (scans, kept) = (survey.kept, predictions.scans);
    let time = match survey.duration_s() {
        duration if duration > 0.0 => format!(" in {duration:.0} s"),
        _ => String::new(),
    };
    format!(
        "{scans} scans of {sensor} along {:.0} m{time}; {kept} of them kept back; a map of {} x {} cells of {} m",
        survey.length_m, setup.grid.width, setup.grid.height, setup.grid.cell_m
    )
}

fn counts(told: &Told) -> Table {
    let report = &told.survey.report;
    let mut table = Table::new(&["what", "number"]);
    let mut row = |what: &str, number: u64| table.push(vec![json!(what), json!(number)]);
    row("lines", report.lines);
    row("scans", report.scans);
    row("scans in use", told.survey.kept);
    row("beams", report.beams);
    row("beams without echo", report.no_returns);
    row("beams that say nothing", report.unusable);
    row("damaged lines", report.damaged);
    for (name, number) in &report.skipped {
        row(&format!("messages {name}, skipped"), *number);
    }
    for (what, number) in [
        ("scans outside the time window", report.outside_window),
        ("scans outside the trajectory", report.outside_trajectory),
        ("scans left out by --every, --least-move, --least-turn", report.thinned),
        ("steps back in time", report.steps_back),
    ] {
        if number > 0 {
            row(what, number);
        }
    }
    table
}

/// What the maps were made from.
fn configuration(told: &Told) -> Value {
    let Told { options, survey, setup, .. } = told;
    let LaserOptions { range_sigma, hit, no_echo, early } = options.laser;
    let StereoOptions { focal_baseline, disparity_sigma, correct_match, max_disparity } = options.stereo;
    let sensor = match survey.sensor {
        Sensor::Laser { max_range_m, .. } => json!({
            "range_sigma_m": range_sigma, "max_range_m": max_range_m, "hit": hit, "no_echo": no_echo, "early_per_m": early,
        }),
        Sensor::Stereo => json!({
            "focal_baseline": focal_baseline, "disparity_sigma": disparity_sigma, "correct_match": correct_match,
            "max_disparity": max_disparity,
        }),
    };
    json!({
        "log": name(options),
        "trajectory": options.trajectory.as_ref().and_then(|path| path.file_name()).map(|name| name.to_string_lossy()),
        "mappers": told.maps.maps.iter().map(|map| map.mapper).collect::<Vec<_>>(),
        "hold_out": options.hold_out,
        "reach_m": survey.reach_m,
        "min_range_m": options.min_range,
        "every": options.every,
        "window_s": options.window,
        "least_move_m": options.least_move,
        "least_turn_deg": options.least_turn,
        "prior": setup.prior,
        "reconciliation": setup.reconciliation,
        "sensor": sensor,
    })
}

/// What the terminal shows.
pub(super) fn text(told: &Told) -> String {
    let Told { survey, predictions, .. } = told;
    let mut text = format!("replay of {}\n{}\n", name(told.options), facts(told).replace("; ", "\n"));
    let report = &survey.report;
    let _ = writeln!(
        text,
        "{} beams, {} without echo, {} that say nothing",
        report.beams, report.no_returns, report.unusable
    );
    if report.damaged > 0 {
        let _ = writeln!(text, "{} damaged lines were skipped; the first:", report.damaged);
        report.problems.iter().take(3).for_each(|problem| {
            let _ = writeln!(text, "  line {}: {}", problem.line, problem.reason);
        });
    }
    if let Some(longest_m) = report.suspected_max_range_m() {
        let _ = writeln!(
            text,
            "many echoes have exactly {longest_m} m: if that is the scanner's code for none, give --max-range {longest_m}"
        );
    }
    let baseline = &predictions.rows[predictions.baseline].name;
    let ends = |interval: score::Interval| format!("{:.3} .. {:.3}", interval.low, interval.high);
    let loss = |row: &Row| vec![row.name.clone(), format!("{:.3}", row.loss.mean), ends(row.loss.interval)];
    let difference = |row: &Row| {
        let SeriesMean { mean, interval } = row.difference;
        vec![row.name.clone(), format!("{mean:+.3}"), ends(interval), row.verdict().to_owned()]
    };
    text.push('\n');
    let heads = ["mapper", "nats/reading", "95 % interval"];
    text += &table::aligned(&heads, &predictions.rows.iter().map(loss).collect::<Vec<_>>());
    if predictions.rows.len() > 1 {
        text.push('\n');
        let heads = ["mapper", &format!("minus {baseline}"), "95 % interval", ""];
        text += &table::aligned(&heads, &predictions.others().map(difference).collect::<Vec<_>>());
    }
    let _ = write!(
        text,
        "\n{} readings of {} scans kept back. Nats per reading: the mean of\n-ln P(reading | map); lower is better. NAME-chain: with the joint probabilities\nof neighbours.\n",
        predictions.readings, predictions.scans
    );
    text
}
