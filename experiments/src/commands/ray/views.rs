//! The answers as JSON, CSV and text.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use serde::Serialize;

use super::answer::{Answer, Answers};
use super::viewing_ray::ViewingRay;
use crate::failure::Failure;
use crate::output::table::{aligned, rounded};

/// At most so many rows in the table for reading.
const ROWS: usize = 24;

/// One cell by one rule: a row of the CSV. The joint is that with the next cell.
#[derive(Debug, Serialize)]
struct CellRow {
    mapper: &'static str,
    cell: usize,
    enter_m: f64,
    exit_m: f64,
    prior: f64,
    posterior: f64,
    likelihood_ratio: Option<f64>,
    joint_ee: Option<f64>,
    joint_ef: Option<f64>,
    joint_fe: Option<f64>,
    joint_ff: Option<f64>,
    evidence: Option<f64>,
}

/// The answers as JSON in full precision, on one line: the form of README.md, "One viewing ray".
///
/// # Errors
/// None that a caller could cause.
pub(super) fn json(answers: &Answers) -> Result<String, Failure> {
    #[derive(Serialize)]
    struct Document<'a> {
        schema_version: u32,
        mappers: &'a Answers,
    }
    let text = serde_json::to_string(&Document { schema_version: 1, mappers: answers });
    text.map(|text| text + "\n").map_err(Failure::internal)
}

/// How exactly numbers are written.
#[derive(Clone, Copy)]
pub(super) enum Digits {
    All,
    Six,
}

/// The answers as CSV, one row per cell and rule: in full precision, or with the six digits that committed results keep.
///
/// # Errors
/// None that a caller could cause.
pub(super) fn csv(ray: &ViewingRay, answers: &Answers, digits: Digits) -> Result<Vec<u8>, Failure> {
    let kept = |v: f64| match digits {
        Digits::All => v,
        Digits::Six => rounded(v).as_f64().unwrap_or(v),
    };
    let mut csv = csv::Writer::from_writer(Vec::new());
    for (mapper, answer) in answers.named() {
        for k in 0..ray.cells() {
            let joint = answer.joint.as_ref().and_then(|pairs| pairs.get(k));
            let entry = |i: usize| joint.map(|pair| kept(pair[i]));
            let row = CellRow {
                mapper,
                cell: k,
                enter_m: kept(ray.enters_m(k)),
                exit_m: kept(ray.enters_m(k + 1)),
                prior: kept(ray.prior[k]),
                posterior: kept(answer.posterior[k]),
                likelihood_ratio: answer.likelihood_ratio[k].map(kept),
                joint_ee: entry(0),
                joint_ef: entry(1),
                joint_fe: entry(2),
                joint_ff: entry(3),
                evidence: answer.evidence.map(kept),
            };
            csv.serialize(row).map_err(Failure::internal)?;
        }
    }
    csv.into_inner().map_err(Failure::internal)
}

/// The answers for reading: what every rule makes of the ray as a whole, and the cells, thinned where they are many.
pub(super) fn text(name: &str, ray: &ViewingRay, answers: &Answers) -> String {
    let cells = if ray.cells() == 1 { "1 cell".to_owned() } else { format!("{} cells", ray.cells()) };
    let mut text = format!("{name}: {cells} of {} m, reading {} px", ray.cell_size_m, ray.observation_px);
    let range = ray.stereo.range(ray.observation_px, 0.0);
    let at = (range / ray.cell_size_m).floor();
    let _ = match range.is_finite() {
        true if at < ray.cells() as f64 => writeln!(text, " = {} m, in cell {at}\n", short(range)),
        true => writeln!(text, " = {} m, beyond the last cell\n", short(range)),
        false => writeln!(text, ", infinitely far\n"),
    };
    let summary = answers.named().map(|(mapper, answer)| {
        let (changed, by) = largest_change(ray, answer);
        let evidence = answer.evidence.map_or_else(|| "-".to_owned(), |z| format!("{z:.4e}"));
        vec![mapper.to_owned(), evidence, format!("{by:+.4}"), changed.to_string()]
    });
    text += &aligned(&["mapper", "evidence, 1/px", "largest change of a posterior", "in cell"], &summary);
    if answers.visibility.evidence == Some(0.0) {
        text += "\nno state of the ray explains the reading: the posterior is the prior\n";
    }
    let cells = shown(ray, answers);
    if cells.len() < ray.cells() {
        let _ = writeln!(text, "\n{} of {} cells (--format csv gives all)", cells.len(), ray.cells());
    } else {
        text += "\n";
    }
    let rows: Vec<Vec<String>> = cells
        .iter()
        .map(|&k| {
            let posteriors = answers.named().map(|(_, answer)| format!("{:.4}", answer.posterior[k]));
            [k.to_string(), short(ray.enters_m(k)), format!("{:.4}", ray.prior[k])]
                .into_iter()
                .chain(posteriors)
                .collect()
        })
        .collect();
    text + &aligned(&["cell", "from m", "prior", "visibility", "printed", "conventional", "independent"], &rows)
}

/// Where, and by how much, the posterior differs most from the prior.
fn largest_change(ray: &ViewingRay, answer: &Answer) -> (usize, f64) {
    let changes = answer.posterior.iter().zip(&ray.prior).map(|(after, before)| after - before);
    changes.enumerate().fold((0, 0.0), |most: (usize, f64), next| if next.1.abs() > most.1.abs() { next } else { most })
}

/// All cells, or some evenly spaced, those around the reading and those that change most.
fn shown(ray: &ViewingRay, answers: &Answers) -> BTreeSet<usize> {
    let last = ray.cells() - 1;
    if ray.cells() <= ROWS {
        return (0..=last).collect();
    }
    let even = ROWS - 8;
    let mut cells: BTreeSet<usize> = (0..even).map(|i| i * last / (even - 1)).collect();
    cells.extend(answers.named().map(|(_, answer)| largest_change(ray, answer).0));
    let o = ray.observation_px;
    let sigma = ray.stereo.disparity_sigma;
    for disparity in [o + sigma, o, o - sigma] {
        let at = ray.stereo.range(disparity, 0.0) / ray.cell_size_m;
        if disparity > 0.0 && at <= last as f64 {
            cells.insert(at as usize);
        }
    }
    cells
}

fn short(value: f64) -> String {
    rounded(value).to_string()
}
