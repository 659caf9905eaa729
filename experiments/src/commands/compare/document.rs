//! A comparison as a document: the sections of the page, and the same in Markdown.

use std::fmt::Write as _;

use score::{MovingRegion, Region};
use serde_json::Value;

use super::answer::answer;
use super::at_rest;
use super::efficiency;
use super::figures::CAPTIONS;
use super::plan::Plan;
use super::repeats::Readings;
use super::rows::{Repeat, Rows};
use super::sensors;
use super::sheets::{self, ALL, OBSERVABLE, Width};
use super::worlds::{self, WorldScore};
use crate::failure::Failure;
use crate::page::{Cell, Page, Part, Picture, Section, Sheet, Viewer, command_line};
use crate::worlds::claims::{self, Claim};
use crate::worlds::sensed;

/// The sections, with those of the pictures that there are.
pub fn sections(plan: &Plan, rows: &Rows, pictures: &[Picture]) -> Vec<Section> {
    let (mappers, parts) = (plan.names(), plan.parts());
    let picture = |name: &str| pictures.iter().find(|p| p.name == name).cloned().map(Part::Picture);
    let mut better = vec![Part::Sheet(sheets::means(rows, &mappers, ALL, OBSERVABLE))];
    better.extend(picture("differences.png"));
    for metric in ["log_loss", "brier"] {
        better.push(Part::Sheet(sheets::differences(rows, &mappers, ALL, OBSERVABLE, metric, Width::Page)));
    }
    let mut places = Vec::new();
    if parts.len() > 1 {
        places.extend(
            ["log_loss", "brier"].map(|metric| Part::Sheet(sheets::parts(rows, &mappers, &parts, metric, Width::Page))),
        );
    }
    places.extend(efficiency::sheet(&rows.efficiency, &parts, Width::Page).map(Part::Sheet));
    let shown = |region: &&str| rows.means.iter().any(|mean| mean.region == **region);
    let regions = Region::ALL.iter().map(|region| region.name());
    let others = MovingRegion::ALL.iter().map(|region| region.name()).chain(sensed::REGIONS);
    let regions = regions.chain(others.filter(shown));
    places.extend(regions.map(|region| region_fold(rows, &mappers, region)));
    let mut trust = Vec::new();
    trust.extend(["reliability.png", "profiles.png"].into_iter().filter_map(picture));
    let mut sections = vec![
        section("Which mapper is better", BETTER, better),
        section(
            "Which map may I drive on",
            DRIVES,
            sheets::drives(rows, &mappers, Width::Page).map(Part::Sheet).into(),
        ),
        section("Where, and under which conditions", PLACES, places),
        section("How far a map can be taken at its word", TRUST, trust),
        section("What each idea is worth", ABLATIONS, vec![Part::Sheet(sheets::ablations(rows, &mappers))]),
    ];
    if let Some(moved) = sheets::moved(rows, &mappers, Width::Page) {
        let mut parts = vec![Part::Sheet(moved)];
        for metric in ["harmonic_accuracy", "trail_area"] {
            let region = MovingRegion::Swept.name();
            parts.push(Part::Sheet(sheets::differences(rows, &mappers, ALL, region, metric, Width::Page)));
        }
        parts.extend(at_rest::sheet(&rows.at_rest, Width::Page).map(Part::Sheet));
        sections.insert(1, section("What becomes of what moves", MOVED, parts));
    }
    if plan.has_suites() {
        let parts = sensors::sheets(plan, rows).into_iter().map(Part::Sheet).collect();
        sections.insert(1, section("What a second sensor is worth", SENSORS, parts));
    }
    if !rows.repeats.is_empty() {
        let mut again: Vec<Part> = picture("repeats.png").into_iter().collect();
        let mut sheet = |readings, title, decimals, of: fn(&Repeat) -> Option<f64>| {
            again.push(Part::Sheet(sheets::repeats(rows, readings, &mappers, title, decimals, of)));
        };
        sheet(Readings::Same, "Log loss, nats/cell,", 3, |r| r.log_loss);
        sheet(Readings::Same, "Share of free space held free", 3, |r| r.free_known);
        sheet(Readings::Same, "Phantom area, m²,", 2, |r| r.phantom_area);
        sheet(Readings::Standing, "Log loss, nats/cell,", 3, |r| r.log_loss);
        sheet(Readings::Standing, "Share of free space held free", 3, |r| r.free_known);
        if rows.repeats.iter().any(|r| r.readings == Readings::Driven) {
            sheet(Readings::Standing, "Free-space retention", 3, |r| r.retention);
            sheet(Readings::Driven, "Log loss, nats/cell,", 3, |r| r.log_loss);
        }
        sheet(Readings::Fresh, "Log loss, nats/cell,", 3, |r| r.log_loss);
        sections.push(section("The same scan again and again", AGAIN, again));
    }
    sections
}

const BETTER: &str = "Every mapper has the same readings, and every world is a pair. Differences are mapper minus visibility: \
    above zero means more loss than visibility. Intervals are 95 % bootstrap intervals (BCa, 10,000 resamples), p is of Wilcoxon's \
    signed-rank test with Holm's correction over all mappers and metrics of one scope and region, d_z is the mean over the standard \
    deviation of the differences. A mapper is equivalent where the interval lies inside the margin, which was set beforehand; \
    better or worse where the interval excludes zero and the adjusted p is at most 0.05; else undecided, which is not the same as no difference.";
const MOVED: &str = "Static: the share of the cells that nothing has covered which a map holds right. Dynamic: the share of the cells where something has been, and is \
    no more, that it holds free again; harmonic: the harmonic mean of both, never to be read alone. Trail: the area of those held occupied; ghost: the largest patch of \
    changed cells that are free now and held occupied. Lag: the mean number of looks from at most 4 m until a change is in the map, 10 at most; cleared: the share of changes \
    to free that are within 3.";
const SENSORS: &str = "Every layout is mapped seven times, by robots that differ in what they carry. Every third box of it is a pane of glass, on which one beam of \
    the laser in ten ends and one column of the camera in twenty; every second disc is a leg of 6 cm, on which every second beam ends. All are judged over the same cells, what \
    any of the three sensors could see: the regions of the other tables follow from the rays of each suite. Several sensors are held against the better one of them alone, \
    in the same worlds: they are not worse where the 95 % interval of the difference ends below the margin.";
const DRIVES: &str = "Drives between pairs of places that follow from the truth alone, 200 a world unless asked otherwise and the same for every mapper: \
    planned on the map of the whole drive, on which a cell above the threshold (0.5) is an obstacle, as is what no ray reached (--plan-unknown), and driven as the \
    robot's disc in the exact world. Reached: the share planned and driven without a collision. Colliding: the share planned and driven into something. \
    The rest was not planned. Detour: the mean length of those reached over a shortest way in the truth; maps reach different pairs. Recall: the share of surface \
    cells above 0.5, and above 0.65, what a saved ROS map keeps. By footprint: planned by the probability that an obstacle stands under the robot's disc, from \
    the joint probabilities of neighbours where a map holds them; above the threshold is an obstacle, below it a way costs the more the more probable one is.";
const PLACES: &str =
    "Regions follow from noise-free rays, never from a map. differences.csv has every metric in every region.";
const TRUST: &str = "Cells of all worlds together.";
const ABLATIONS: &str =
    "Differences from visibility with their intervals; retention is better when higher, the others when lower.";
const AGAIN: &str = "One scan, alone in a map, again and again: the noise is the same every time, so that nothing new is learned after the \
    first. Every rule here counts it as new all the same.";

fn section(heading: &str, lead: &str, parts: Vec<Part>) -> Section {
    Section { heading: heading.to_owned(), lead: lead.to_owned(), parts }
}

fn region_fold(rows: &Rows, mappers: &[&str], region: &str) -> Part {
    let differences = |metric| sheets::differences(rows, mappers, ALL, region, metric, Width::Page);
    Part::Fold {
        summary: format!("{region}: {}", sheets::region_in_words(region)),
        open: false,
        parts: vec![sheets::means(rows, mappers, ALL, region), differences("log_loss"), differences("brier")],
    }
}

/// The page. `record` is `run.json`.
///
/// # Errors
/// A record that is no JSON object.
pub fn page(
    plan: &Plan,
    rows: &Rows,
    scores: &[WorldScore],
    record: &Value,
    pictures: &[Picture],
    viewer: Viewer,
) -> Result<Page, Failure> {
    let worlds = worlds::section(plan, scores, &viewer);
    Ok(Page {
        answer: answer(plan, rows),
        title: format!("Mappers compared, {} set", plan.set.name()),
        lead: plan.about(),
        facts: facts(plan),
        claims: claims::of_record(record),
        viewer: Some(viewer),
        sections: sections(plan, rows, pictures).into_iter().chain([worlds]).collect(),
        configuration: serde_json::to_string_pretty(&record["configuration"]).map_err(Failure::internal)?,
        files: record["files"].as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned).collect(),
        command: command_line(record),
        ..Page::default()
    })
}

fn facts(plan: &Plan) -> String {
    [Some(plan.heading()), plan.batch_note()].into_iter().flatten().collect::<Vec<_>>().join(". ")
}

/// The same as Markdown: claims, tables, and the pictures by name.
pub fn markdown(plan: &Plan, claims: &[Claim], sections: &[Section]) -> String {
    let mut text = format!("# Mappers compared, {} set\n\n{}\n\n{}\n", plan.set.name(), plan.about(), facts(plan));
    if !claims.is_empty() {
        text += "\n| claim | measured | |\n|---|---|---|\n";
    }
    for Claim { claim, measured, holds } in claims {
        let _ = writeln!(text, "| {claim} | {measured} | {} |", if *holds { "holds" } else { "**fails**" });
    }
    for Section { heading, lead, parts } in sections {
        let _ = write!(text, "\n## {heading}\n\n{lead}\n");
        for part in parts {
            match part {
                Part::Sheet(sheet) => text += &table(sheet),
                Part::Picture(Picture { name, caption, .. }) => {
                    let _ = write!(text, "\n![{caption}]({name})\n");
                }
                Part::Fold { summary, parts, .. } => {
                    let _ = write!(text, "\n### {summary}\n");
                    parts.iter().for_each(|sheet| text += &table(sheet));
                }
            }
        }
    }
    text
}

fn table(Sheet { caption, note, heads, rows }: &Sheet) -> String {
    let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | ").replace('\n', " "));
    let mut text = format!("\n{caption}{}\n\n", if note.is_empty() { String::new() } else { format!(" ({note})") });
    text += &line(heads.clone());
    text += &line((0..heads.len()).map(|column| if column == 0 { "---" } else { "---:" }.to_owned()).collect());
    rows.iter().for_each(|row| text += &line(row.iter().map(|Cell { text, .. }| text.clone()).collect()));
    text
}

/// Those of the known pictures that `read` has.
///
/// # Errors
/// Whatever `read` reports.
pub fn pictures(mut read: impl FnMut(&str) -> Result<Option<Vec<u8>>, Failure>) -> Result<Vec<Picture>, Failure> {
    let mut found = Vec::new();
    for (name, caption) in CAPTIONS {
        found.extend(read(name)?.map(|bytes| Picture { name: name.to_owned(), caption: caption.to_owned(), bytes }));
    }
    Ok(found)
}
