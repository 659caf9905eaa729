//! One viewing ray and one reading by every rule: the paper's Section 3.2, Figures 8 to 10.

mod answer;
mod cases;
pub mod certainty;
mod figures;
pub mod file;
mod no_hit;
mod options;
mod viewing_ray;
mod views;

pub use answer::{Answer, Answers};
pub use cases::{Case, NAMES, find};
pub use options::RayOptions;
pub use viewing_ray::{MOST_CELLS, ViewingRay, both};

use std::io::Write as _;
use std::path::Path;

use serde_json::json;
use strict::nearest;

use self::views::Digits;
use crate::failure::Failure;
use crate::figures::Paper;
use crate::jobs::interruption;
use crate::output::args::Format;
use crate::output::folder::{Purpose, Staging};
use crate::output::note;
use crate::output::record::Record;
use crate::output::table;
use crate::worlds::claims::{self, Claim};

/// Solves the ray, shows what every rule makes of it, and judges what the paper claims of it.
///
/// # Errors
/// Bad input before any work, I/O, and claims that do not hold.
pub fn run(options: &RayOptions) -> Result<(), Failure> {
    interruption::watch();
    let name = options.ray.display().to_string();
    let case = find(&name);
    let ray = match &case {
        Some(case) => case.ray.clone(),
        None => load(&options.ray, &name)?,
    };
    let folder =
        options.out.clone().or_else(|| Some(Path::new("results").join(format!("ray-{}", case.as_ref()?.name))));
    let purpose = Purpose::new("ray", &[&options.ray], options.paper.files(&FILES));
    let staging = folder.as_deref().map(|folder| Staging::open(folder, &purpose)).transpose()?;
    let answers = Answers::of(&ray);
    let curve = case.as_ref().filter(|case| case.name == "occluded").map(|_| certainty::curve()).unwrap_or_default();
    let mut claims: Vec<Claim> = case.iter().flat_map(|case| case.claims(&answers)).collect();
    if !curve.is_empty() {
        claims.extend(certainty::claims(&curve));
    }
    if let (Some(staging), Some(folder)) = (staging, &folder) {
        Outputs {
            name: &name,
            case: case.as_ref(),
            ray: &ray,
            answers: &answers,
            curve: &curve,
            claims: &claims,
            paper: &options.paper,
        }
        .write(staging)?;
        note(folder.join("ray.png").display());
    }
    match options.format {
        Format::Json => table::print(&views::json(&answers)?)?,
        Format::Csv => table::print(&String::from_utf8_lossy(&views::csv(&ray, &answers, Digits::All)?))?,
        Format::Text => table::print(&text(&name, case.as_ref(), &ray, &answers, &claims))?,
    }
    claims::all_hold(&claims)
}

/// Reads a ray file; a name that is neither a file nor a case is refused with the cases that there are.
fn load(path: &Path, name: &str) -> Result<ViewingRay, Failure> {
    if !path.exists() && path.extension().is_none() {
        return Err(Failure::BadInput(format!(
            "{name}: is neither a case nor a file; the nearest case is '{}', all are: {}; or give a ray file, see ray --help",
            nearest(name, NAMES),
            NAMES.join(", ")
        )));
    }
    Ok(file::load(path)?)
}

fn text(name: &str, case: Option<&Case>, ray: &ViewingRay, answers: &Answers, claims: &[Claim]) -> String {
    let mut text = String::new();
    if let Some(case) = case {
        text += &format!("{}: {}\n\n", case.figure, case.about);
    }
    text += &views::text(name, ray, answers);
    text += &claims::below(claims);
    if claims.is_empty() { text } else { text + "\n" }
}

/// The files, beside the record.
const FILES: [&str; 5] = ["ray.toml", "ray.csv", "ray.png", "certainty.csv", "certainty.png"];

/// What a run leaves in its folder.
struct Outputs<'a> {
    name: &'a str,
    case: Option<&'a Case>,
    ray: &'a ViewingRay,
    answers: &'a Answers,
    curve: &'a [certainty::Point],
    claims: &'a [Claim],
    paper: &'a Paper,
}

impl Outputs<'_> {
    fn write(&self, mut staging: Staging) -> Result<(), Failure> {
        let Self { name, case, ray, answers, paper, .. } = self;
        let about = case.map_or_else(|| (*name).to_owned(), |case| format!("{}: {}", case.figure, case.about));
        let toml = file::text(ray, &about);
        staging.write("ray.toml", |out| out.write_all(toml.as_bytes()))?;
        let csv = views::csv(ray, answers, Digits::Six)?;
        staging.write("ray.csv", |out| out.write_all(&csv))?;
        let picture = figures::answers(ray, answers, case.map_or(&[], Case::bands), paper);
        paper.save(&mut staging, "ray.png", &picture)?;
        if !self.curve.is_empty() {
            let table = certainty::table(self.curve);
            table.save(&mut staging, "certainty.csv")?;
            let picture = figures::certainty(self.curve, cases::UNCHANGED, paper);
            paper.save(&mut staging, "certainty.png", &picture)?;
        }
        let configuration = json!({
            "ray": name,
            "about": case.map(|case| format!("{}: {}", case.figure, case.about.replace('\n', " "))),
            "cells": ray.cells(),
            "cell_size": ray.cell_size_m,
            "observation": ray.observation_px,
            "no_hit_likelihood": ray.no_hit_likelihood,
            "sensor": ray.stereo,
        });
        staging.record(&Record::new("ray", json!({ "configuration": configuration, "claims": self.claims })))?;
        staging.publish()
    }
}
