//! The page of a folder that `slam` leaves.

use serde_json::{Value, json};

use super::along;
use super::outputs::Told;
use super::sensors;
use crate::failure::Failure;
use crate::figures::cells;
use crate::output::table::{Table, rounded};
use crate::page::{self, Cloud, Page, Part, Picture, Section, Sheet};

const LEAD: &str =
    "Where a robot went and what lies there, found together from scans and odometry by a particle filter.";

/// What the pictures of a page are.
pub(super) struct Pictures {
    /// The map with the ways.
    pub(super) trajectory: Vec<u8>,
    /// The updates along time.
    pub(super) along: Vec<u8>,
}

/// The page, of what was found.
///
/// # Errors
/// A picture or a template that fails.
pub(super) fn page(
    told: &Told,
    cloud: Cloud,
    pictures: Pictures,
    configuration: &Value,
    files: Vec<String>,
) -> Result<String, Failure> {
    let picture = |name: &str, caption: &str, bytes| {
        Part::Picture(Picture { name: name.to_owned(), caption: caption.to_owned(), bytes })
    };
    let section =
        |heading: &str, lead: &str, parts| Section { heading: heading.to_owned(), lead: lead.to_owned(), parts };
    let mut sections =
        vec![section("The way", "", vec![picture("trajectory.png", super::figure::CAPTION, pictures.trajectory)])];
    let scores = told.scores.table();
    if !scores.rows().is_empty() {
        sections.push(section(
            "Errors",
            ERRORS,
            vec![Part::Sheet(Sheet::of("Errors of the way that was found, and of the odometry", &scores))],
        ));
    }
    if told.sensors.len() > 1 {
        let sheet = Sheet::of(
            "Sensors of the robot",
            &sensors::table(sensors::Robot { sensors: told.sensors, scans: told.scans, model: told.model }),
        );
        sections.push(section("Sensors", sensors::SENSORS, vec![Part::Sheet(sheet)]));
    }
    sections.push(section("Along the way", "", vec![picture("along.png", along::CAPTION, pictures.along)]));
    let returns = returns(told);
    if !returns.rows().is_empty() {
        sections.push(section("Where the robot came back", RETURNS, vec![Part::Sheet(Sheet::of("Returns", &returns))]));
    }
    page::page(&Page {
        title: format!("Way and map of {}", name(told.place)),
        lead: LEAD.to_owned(),
        facts: facts(told),
        cloud: Some(cloud),
        sections,
        configuration: serde_json::to_string_pretty(configuration).map_err(Failure::internal)?,
        command: page::command_line(&json!({
            "command": "slam", "configuration": configuration, "grid": told.model.grid, "pictures": told.options.paper.asked(),
        })),
        files,
        ..Page::default()
    })
}

const ERRORS: &str = "ate is the distance between poses of the same time once the ways are aligned, rpe_1m the error of the motion over a metre \
    (Sturm et al. 2012), relations the errors of motions between two times that are believed (Kümmerle et al. 2009), loops those of more than \
    30 s. Metres, and degrees of those that end in rotation.";

const RETURNS: &str = "The robot came back to where it had been more than 30 s before: what it sees there tells particles with the right way from others.";

fn name(place: &str) -> String {
    std::path::Path::new(place).file_name().map_or_else(|| place.to_owned(), |name| name.to_string_lossy().into_owned())
}

fn facts(told: &Told) -> String {
    let filter = told.options.filter();
    let updates = told.outcome.updates.len();
    let particles =
        if filter.particles == 1 { "1 particle".to_owned() } else { format!("{} particles", filter.particles) };
    format!(
        "{} scans, {updates} of them matched and mapped by {particles} of {}; seed {}; cells of {} m",
        told.scans.len(),
        told.entry.name,
        filter.seed,
        told.model.grid.cell_m
    )
}

/// A row for every return.
fn returns(told: &Told) -> Table {
    let rows: Vec<&slam::Update> = told.returns.iter().map(|k| &told.outcome.updates[*k]).collect();
    Table::of(
        &rows,
        &[
            ("time_s", &|row| rounded(row.time_s)),
            ("x_m", &|row| rounded(row.pose.x_m)),
            ("y_m", &|row| rounded(row.pose.y_m)),
            ("effective", &|row| rounded(row.effective)),
            ("resampled", &|row| json!(row.resampled)),
            ("spread_m", &|row| rounded(row.spread_m)),
        ],
    )
}

/// What of the particles the page shows; the map is the one that is written.
///
/// # Errors
/// A picture that cannot be encoded.
pub(super) fn cloud(told: &Told, ways: Vec<(&'static str, Vec<[f64; 2]>)>) -> Result<Cloud, Failure> {
    let spec = told.map.spec();
    let upper = [spec.width, spec.height].map(|side| side as f64 * spec.cell_m);
    let mut moments = told.moments.to_vec();
    told.returns.iter().for_each(|k| moments[*k].returned = true);
    Ok(Cloud {
        map: cells::png(told.map, told.seen, told.model.prior.marginal())?,
        corners_m: [spec.origin_m, [0, 1].map(|k| spec.origin_m[k] + upper[k])],
        ways,
        moments,
    })
}
