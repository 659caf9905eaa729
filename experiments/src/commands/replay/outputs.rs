//! The files that `replay` leaves behind, and what it prints.

use std::fmt::Write as _;
use std::io::Write as _;

use grid::Raster;
use logs::{Report, Sensor};
use mapper::catalogue::Entry;
use mapper::{Belief, Model, Repeats};
use score::{Better, SeriesMean};
use serde_json::{Value, json};

use super::along_time;
use super::extent::{Known, Survey};
use super::figure;
use super::mapping::Maps;
use super::options::{Body, REPEAT_DEG, ReplayOptions};
use super::predictions::{OfSensor, Prediction, Predictions};
use super::recording::Recording;
use super::viewed;
use crate::failure::Failure;
use crate::figures::Paper;
use crate::output;
use crate::output::folder::Staging;
use crate::output::ledger::RECORD;
use crate::output::record::Record;
use crate::output::table::{Table, aligned};
use crate::page::{self, Page, Part, Picture, Section, Sheet, Viewer};
use crate::worlds::kernels;
use crate::worlds::ranked::{Head, SortOption, legend};
use crate::worlds::reading;
use crate::worlds::suspects::{self, Suspect};

/// All that there is to tell.
pub(super) struct Told<'a> {
    pub(super) options: &'a ReplayOptions,
    pub(super) survey: &'a Survey,
    pub(super) setup: &'a Model,
    pub(super) maps: &'a Maps,
    pub(super) predictions: &'a Predictions,
    pub(super) suspects: &'a [Suspect],
}

/// The scores of every sensor by itself, of a log of several.
const BY_SENSOR: &str = "by-sensor.csv";

/// Every sensor against its own map and those of the others, of a log of several.
const SUSPECTS: &str = "suspects.csv";

/// Every file that may come of it, beside the record.
pub(super) fn names(entries: &[&Entry], paper: &Paper) -> Vec<String> {
    let tables = ["predictions.csv", BY_SENSOR, SUSPECTS, "differences.csv", "along-time.csv", "report.html"];
    let fixed = tables.into_iter().map(str::to_owned).chain(paper.files(&["along-time.png", "maps.png"]));
    let maps = entries.iter().flat_map(|entry| output::map::names(entry.name));
    let costmaps = entries.iter().flat_map(|entry| output::map::footprint_names(entry.name));
    fixed.chain(maps).chain(costmaps).collect()
}

/// Writes everything.
pub(super) fn write(staging: &mut Staging, recording: &Recording, told: &Told) -> Result<(), Failure> {
    let (scores, differences) = (told.predictions.table(), told.predictions.differences());
    scores.save(staging, "predictions.csv")?;
    let by_sensor = told.predictions.by_sensor();
    if told.predictions.sensors.len() > 1 {
        by_sensor.save(staging, BY_SENSOR)?;
        suspects::table(told.suspects).save(staging, SUSPECTS)?;
    }
    differences.save(staging, "differences.csv")?;
    let (along, baseline) = (&told.predictions.along, &told.predictions.rows[told.predictions.baseline].name);
    along_time::table(along, baseline).save(staging, "along-time.csv")?;
    for map in &told.maps.maps {
        output::map::write(staging, map.mapper, &map.occupancy, &told.maps.seen)?;
        if let Some(radius_m) = told.options.footprint {
            let belief = map.pairs.as_ref().map_or(Belief::Cells(&map.occupancy), Belief::Chain);
            output::map::write_footprint(staging, map.mapper, belief, radius_m, &told.maps.seen)?;
        }
    }
    let drawn: Vec<(&str, &Raster<f64>)> =
        told.maps.maps.iter().map(|map| (map.mapper, &map.occupancy)).filter(|(name, _)| *name != "prior").collect();
    let (prior, paper) = (told.setup.prior.marginal(), &told.options.paper);
    let drawing = figure::draw(&drawn, &told.maps.seen, prior, &told.survey.path, paper);
    let bytes = paper.save(staging, "maps.png", &drawing)?;
    let picture = Picture { name: "maps.png".to_owned(), caption: figure::CAPTION.to_owned(), bytes };
    let drawing = along_time::draw(along, baseline, paper);
    let bytes = paper.save(staging, "along-time.png", &drawing)?;
    let in_time = Picture { name: "along-time.png".to_owned(), caption: along_time::CAPTION.to_owned(), bytes };
    let mut configuration = configuration(told);
    let programs = told.options.programs.record();
    if !programs.is_empty() {
        configuration["programs"] = json!(programs);
    }
    let mut predicts = vec![
        Part::Sheet(Sheet::of("Loss of every map, nats per reading; lower is better", &scores)),
        Part::Sheet(Sheet::of(
            "Differences from the baseline; above 0 is worse, recalibrated ones first",
            &differences,
        )),
        Part::Picture(in_time),
    ];
    if told.predictions.sensors.len() > 1 {
        predicts.insert(1, Part::Sheet(Sheet::of("The same of every sensor by itself, plain", &by_sensor)));
        let caption = "Every sensor against its own map, and against the map of the others";
        predicts.insert(2, Part::Sheet(Sheet::of(caption, &suspects::table(told.suspects))));
    }
    let files = staging.files_and(&["report.html", RECORD]);
    let page = Page {
        title: format!("Replay of {}", name(told.options)),
        lead: LEAD.to_owned(),
        facts: facts(told),
        claims: Vec::new(),
        viewer: Some(Viewer {
            worlds: vec![viewed::world(&name(told.options), recording, told)?],
            budget: page::WORLD_BYTES,
        }),
        sections: vec![
            section("The maps", MAPS, vec![Part::Picture(picture)]),
            section("Which map predicts best", PREDICTS, predicts),
            section("What is in the log", "", vec![Part::Sheet(Sheet::of("Counts", &counts(told)))]),
        ],
        configuration: serde_json::to_string_pretty(&configuration).map_err(Failure::internal)?,
        command: page::command_line(&json!({
            "command": "replay", "configuration": configuration, "grid": told.setup.grid,
            "pictures": told.options.paper.asked(),
        })),
        files,
        ..Page::default()
    };
    let html = page::page(&page)?;
    staging.write("report.html", |out| out.write_all(html.as_bytes()))?;
    let findings = findings(told);
    let mut parts = json!({ "configuration": configuration, "grid": told.setup.grid, "findings": findings });
    if let Some(pictures) = told.options.paper.asked() {
        parts["pictures"] = json!(pictures);
    }
    staging.record(&Record::new("replay", parts))
}

fn section(heading: &str, lead: &str, parts: Vec<Part>) -> Section {
    Section { heading: heading.to_owned(), lead: lead.to_owned(), parts }
}

const LEAD: &str = "What a robot recorded, mapped by several rules from the same scans, and scored without any ground truth by how well each map \
     predicts readings that it has not seen.";
const MAPS: &str = "NAME.yaml and NAME.pgm are for map_server and Nav2, NAME.npy has the probabilities.";
const PREDICTS: &str = "The score is the mean of -ln P(reading | map). One model predicts for all maps: the likelihood of the reading over \
    the first occupied cell on its ray, under the map's own probabilities. Columns and rows that are called recalibrated are of maps whose seen \
    cells had their log odds multiplied by a slope and moved by a shift (Cox 1958), fitted to scans that are neither mapped nor scored: the scans \
    kept back are parted in two, and each part is scored with what the other was fitted to. Clamps and overconfidence then do not decide, \
    and the order of cells does. Plain scores are of the maps as they are; a row NAME-chain is plain, with the joint probabilities of \
    neighbours. Intervals are 95 % by a bootstrap of blocks of scans that follow each other.";

fn name(options: &ReplayOptions) -> String {
    options.log.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

fn facts(told: &Told) -> String {
    let Told { survey, setup, predictions, .. } = told;
    let called = |(known, count): (&Known, usize)| match known.kind {
        Sensor::Laser { beams, max_range_m } => format!("a laser of {beams} beams up to {max_range_m} m"),
        Sensor::Sonar { .. } if count > 1 => format!("{count} sonars"),
        Sensor::Stereo | Sensor::Sonar { .. } => kernels::called(known.kind).to_owned(),
    };
    let arrays = survey.arrays.iter().filter_map(|(first, all)| Some((survey.sensors.get(first)?, all.len())));
    let mut all: Vec<String> = arrays.map(called).collect();
    all.dedup();
    let sensor = all.join(" and ");
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
    let mut rows = vec![
        ("lines".to_owned(), report.lines),
        ("scans".to_owned(), report.scans),
        ("scans in use".to_owned(), told.survey.kept),
        ("beams".to_owned(), report.beams),
        ("beams without echo".to_owned(), report.no_returns),
        ("beams that say nothing".to_owned(), report.unusable),
        ("damaged lines".to_owned(), report.damaged),
    ];
    rows.extend(report.skipped.iter().map(|(name, number)| (format!("messages {name}, skipped"), *number)));
    rows.extend(left_out(report).into_iter().map(|(what, number)| (format!("scans {what}"), number)));
    rows.extend((report.steps_back > 0).then(|| ("steps back in time".to_owned(), report.steps_back)));
    Table::of(&rows, &[("what", &|row| json!(row.0)), ("number", &|row| json!(row.1))])
}

/// Why scans are not in use, and how many.
pub(super) fn left_out(report: &Report) -> Vec<(&'static str, u64)> {
    let all = [
        ("outside the time window", report.outside_window),
        ("outside the trajectory", report.outside_trajectory),
        ("in gaps without poses", report.in_gaps),
        (if report.poses.is_some() { "without a pose" } else { "without odometry" }, report.unplaced),
        ("far from all others", report.strays),
        ("left out by --every, --least-move, --least-turn", report.thinned),
    ];
    all.into_iter().filter(|(_, number)| *number > 0).collect()
}

/// What the maps were made from.
fn configuration(told: &Told) -> Value {
    let Told { options, survey, setup, .. } = told;
    let described = |kind: Sensor| options.kernels().record(kind);
    let mut configuration = json!({
        "log": options.log.display().to_string(),
        "trajectory": options.trajectory.as_ref().and_then(|path| path.file_name()).map(|name| name.to_string_lossy()),
        "mappers": told.maps.maps.iter().map(|map| map.mapper).collect::<Vec<_>>(),
        "hold_out": options.hold_out,
        "reach_m": survey.reach_m,
        "footprint_m": options.footprint,
        "min_range_m": options.min_range,
        "max_gap_s": options.max_gap,
        "fan": {"fov_deg": options.fan.fov, "first_bearing_deg": options.fan.first_bearing, "increment_deg": options.fan.increment},
        "every": options.every,
        "window_s": options.window,
        "least_move_m": options.least_move,
        "least_turn_deg": options.least_turn,
        "map_range_m": options.map_range,
        "prior": setup.prior,
        "reconciliation": setup.reconciliation,
        "sensor": described(survey.sensor),
    });
    if survey.arrays.len() > 1 {
        let first = survey.sensors.iter().filter(|(number, _)| survey.arrays.contains_key(number));
        let all = first.map(|(number, known)| (number.to_string(), described(known.kind)));
        configuration["sensors"] = Value::Object(all.collect());
    }
    let cameras =
        told.options.depth.depth.iter().map(|number| (number.to_string(), json!(told.options.depth.camera())));
    let cameras: serde_json::Map<String, Value> = cameras.collect();
    // What is seldom asked for stands there where it was.
    let rare = [
        ("body", (options.body == Body::Robot).then(|| json!("robot"))),
        ("bag", options.bag.record()),
        ("depth", (!cameras.is_empty()).then_some(Value::Object(cameras))),
        ("given_max_range_m", options.max_range.map(|max_range_m| json!(max_range_m))),
        (
            "repeat_distance_m",
            (options.repeat_distance.total_cmp(&Repeats::CHOSEN.distance_m).is_ne())
                .then(|| json!(options.repeat_distance)),
        ),
        (
            "repeat_angle_deg",
            (options.repeat_angle.total_cmp(&REPEAT_DEG).is_ne()).then(|| json!(options.repeat_angle)),
        ),
        ("given_reach_m", options.reach.map(|reach_m| json!(reach_m))),
        (
            "damaged_share",
            (options.damaged_share.total_cmp(&reading::DAMAGED_SHARE).is_ne()).then(|| json!(options.damaged_share)),
        ),
    ];
    for (key, value) in rare {
        if let Some(value) = value {
            configuration[key] = value;
        }
    }
    configuration
}

/// What is to be known of the log, and the largest steps in it.
fn findings(told: &Told) -> Value {
    let report = &told.survey.report;
    let fails = fails(told.predictions, told.setup);
    let step = |step: Option<logs::Step>| {
        step.map(
            |step| json!({"line": step.line, "move_m": step.move_m, "turn_rad": step.turn_rad, "time_s": step.time_s}),
        )
    };
    let said = |finding: logs::Finding| json!({"warning": finding.is_warning() || (fails && reading::waits(&finding)), "text": finding.text(report.unit)});
    json!({
        "said": report.findings().into_iter().map(said).collect::<Vec<_>>(),
        "longest_move": step(report.motion.longest),
        "sharpest_turn": step(report.motion.sharpest),
        "agreement": told.predictions.agreement.as_ref().map(|judged| judged.agreement.record(judged.mapper, correct(told.setup))),
    })
}

/// Whether the readings kept back end away from the surfaces of the map.
fn fails(predictions: &Predictions, setup: &Model) -> bool {
    predictions.agreement.as_ref().is_some_and(|judged| judged.agreement.fails(correct(setup)))
}

/// The probability that a reading comes from what a map holds.
fn correct(setup: &Model) -> f64 {
    setup.sensors.iter().next().map_or(1.0, |sensor| sensor.correct_match())
}

/// Prints what the map shows to be wrong with a log.
pub(super) fn tell_agreement(
    place: &str,
    survey: &Survey,
    predictions: &Predictions,
    suspects: &[Suspect],
    setup: &Model,
) {
    let judged = predictions.agreement.as_ref();
    if let Some(said) = judged.and_then(|judged| judged.agreement.warning(judged.mapper, correct(setup))) {
        output::note(format_args!("warning: {place}: {said}"));
    }
    let named = suspects::lines(suspects);
    // Where no sensor is to be told from the others, what is left is that their map does not explain them.
    let doubts = if named.is_empty() { predictions.doubtful() } else { named };
    for doubt in doubts {
        output::note(format_args!("warning: {place}: {doubt}"));
    }
    reading::tell_after_mapping(place, &survey.report, fails(predictions, setup));
}

/// What the terminal shows.
pub(super) fn text(told: &Told) -> String {
    let Told { survey, predictions, .. } = told;
    let mut text = format!("replay of {}\n{}\n", name(told.options), facts(told).replace("; ", "\n"));
    let report = &survey.report;
    for (what, step) in [("move", report.motion.longest), ("turn", report.motion.sharpest)] {
        if let Some(step) = step {
            let size = match what {
                "move" => format!("{:.2} m", step.move_m),
                _ => format!("{:.0} degrees", step.turn_rad.to_degrees()),
            };
            let _ =
                writeln!(text, "largest {what} between scans: {size} within {:.2} s (line {})", step.time_s, step.line);
        }
    }
    if let Some(judged) = predictions.agreement.as_ref().filter(|judged| judged.agreement.share().is_some()) {
        text += &judged.agreement.text(judged.mapper, correct(told.setup)).replace(" of the map", "\nof the map");
        text.push('\n');
    }
    let _ = writeln!(
        text,
        "{} beams, {} without echo, {} that say nothing",
        report.beams, report.no_returns, report.unusable
    );
    if report.left_out() > 0 {
        let _ = writeln!(text, "{} of {} scans are not in use:", report.left_out(), report.scans);
        left_out(report).into_iter().for_each(|(what, number)| {
            let _ = writeln!(text, "  {number} {what}");
        });
    }
    if report.damaged > 0 {
        let _ = writeln!(text, "{} damaged {}s were skipped; the first:", report.damaged, report.unit);
        report.problems.iter().take(3).for_each(|problem| {
            let _ = writeln!(text, "  {} {}: {}", report.unit, problem.line, problem.reason);
        });
    }
    if let Some(longest_m) = report.suspected_max_range_m() {
        let _ = writeln!(
            text,
            "many echoes have exactly {longest_m} m: if that is the scanner's code for none, give --max-range {longest_m}"
        );
    }
    text.push('\n');
    text += &scores(predictions, &told.options.order);
    if predictions.sensors.len() > 1 {
        text += &by_sensor(predictions);
    }
    text
}

/// The heads of the scores, where maps are recalibrated or not. What a map predicts as it is has one name in both.
pub(super) fn heads(is_fair: bool) -> Vec<Head<'static>> {
    let loss = |title, name| [Head::of(title, name, Better::Lower), Head::plain("95 % interval")];
    let scores = match is_fair {
        true => [loss("recalibrated", "recalibrated_log_loss"), loss("plain", "predictive_log_loss")].concat(),
        false => loss("nats/reading", "predictive_log_loss").to_vec(),
    };
    std::iter::once(Head::plain("mapper")).chain(scores).collect()
}

/// The scores as the terminal shows them.
fn scores(predictions: &Predictions, order: &SortOption) -> String {
    let baseline = &predictions.rows[predictions.baseline].name;
    let mean = |loss: SeriesMean| [format!("{:.3}", loss.mean), ends(loss.interval)];
    let is_fair = predictions.rows.iter().any(|row| row.fair.is_some());
    let loss = |row: &Prediction| {
        let fair = row.fair.as_ref().map_or_else(Default::default, |fair| mean(fair.loss.mean));
        let fair = fair.into_iter().filter(|_| is_fair);
        [row.name.clone()].into_iter().chain(fair).chain(mean(row.plain.mean)).collect::<Vec<_>>()
    };
    let heads = heads(is_fair);
    // What is asked for by the head that stands where maps are recalibrated, or where they are not.
    let absent: &[&str] = if is_fair { &["nats/reading"] } else { &["plain", "recalibrated", "recalibrated_log_loss"] };
    let order = &order.renamed(absent, "predictive_log_loss");
    let mut text = order.ranked(&heads, &predictions.rows.iter().map(loss).collect::<Vec<_>>());
    text += legend(&text);
    let difference = |row: &Prediction| {
        let loss = match &row.fair {
            Some(fair) => &fair.loss,
            None if is_fair => return None,
            None => &row.plain,
        };
        let SeriesMean { mean, interval } = loss.difference;
        Some(vec![row.name.clone(), format!("{mean:+.3}"), ends(interval), loss.verdict().to_owned()])
    };
    let differences: Vec<_> = predictions.others().filter_map(difference).collect();
    if !differences.is_empty() {
        // In the order of what is subtracted from.
        let minus = format!("minus {baseline}");
        let minus = Head { title: &minus, name: heads[1].name, judged: None };
        let heads = [Head::plain("mapper"), minus, Head::plain("95 % interval"), Head::plain("")];
        text += &format!("\n{}", order.ranked(&heads, &differences));
    }
    let _ = write!(
        text,
        "\n{} readings of {} scans kept back. Nats per reading: the mean of\n-ln P(reading | map); lower is better.{}\n",
        predictions.readings,
        predictions.scans,
        if is_fair { RECALIBRATED } else { FEW }
    );
    text
}

/// The plain scores of every sensor by itself.
fn by_sensor(predictions: &Predictions) -> String {
    let mean = |score: Option<SeriesMean>| {
        score.map_or_else(
            || ["-".to_owned(), String::new()],
            |score| [format!("{:.3}", score.mean), ends(score.interval)],
        )
    };
    let cell = |row: &OfSensor| {
        let ([loss, interval], [gain, _], [explained, _]) = (mean(row.loss), mean(row.gain), mean(row.explained));
        let sensor = format!("{} ({})", row.sensor, row.called);
        vec![row.mapper.clone(), sensor, row.readings.to_string(), loss, interval, gain, explained]
    };
    let rows: Vec<Vec<String>> = predictions.sensors_by_mapper().map(cell).collect();
    format!("\n{}", aligned(&["mapper", "sensor", "readings", "plain", "95 % interval", "gain", "explained"], &rows))
        + GAIN
}

const GAIN: &str = "\nGain: how much better the map predicts the sensor than an unseen world does. Explained: the share of the\n\
    readings that come from what the map holds, by its probabilities.\n";

const RECALIBRATED: &str = "\nRecalibrated: log odds times a slope plus a shift, fitted to scans that are\n\
    neither mapped nor scored, so that clamps do not decide; the differences are of\n\
    this. Plain: the map as it is. NAME-chain: with the joint probabilities of\nneighbours.";
const FEW: &str = "\nScans are too few to recalibrate maps: that takes two with readings, kept back.";

fn ends(interval: score::Interval) -> String {
    format!("{:.3} .. {:.3}", interval.low, interval.high)
}
