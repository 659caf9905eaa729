//! One viewing ray and one reading by every rule: the paper's Section 3.2, Figures 8 to 10.

mod answer;
mod cases;
pub mod certainty;
pub mod file;
mod no_hit;
mod options;
mod viewing_ray;
mod views;

pub use answer::{Answer, Answers};
pub use cases::{Case, NAMES, find};
pub use options::RayOptions;
pub use viewing_ray::{MOST_CELLS, ViewingRay, both};

use std::io::{self, Write as _};
use std::path::Path;

use serde_json::json;
use strict::nearest;

use crate::claims::{self, Claim};
use crate::cli::Format;
use crate::failure::Failure;
use crate::record::versions;
use crate::staging::{RECORD, Staging};
use crate::{figures, interruption, table};

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
    let staging = folder.as_deref().map(Staging::open).transpose()?;
    let answers = Answers::of(&ray);
    let curve = case.as_ref().filter(|case| case.name == "occluded").map(|_| certainty::curve()).unwrap_or_default();
    let mut claims: Vec<Claim> = case.iter().flat_map(|case| case.claims(&answers)).collect();
    if !curve.is_empty() {
        claims.extend(certainty::claims(&curve));
    }
    if let (Some(staging), Some(folder)) = (staging, &folder) {
        Outputs { name: &name, case: case.as_ref(), ray: &ray, answers: &answers, curve: &curve, claims: &claims }
            .write(staging)?;
        let _ = writeln!(io::stderr(), "{}", folder.join("ray.png").display());
    }
    match options.format {
        Format::Json => table::print(&views::json(&answers)?)?,
        Format::Csv => table::print(&String::from_utf8_lossy(&views::csv(&ray, &answers, true)?))?,
        Format::Text => table::print(&text(&name, case.as_ref(), &ray, &answers, &claims))?,
    }
    claims::all_hold(&claims)
}

/// Reads a ray file; a name that is neither a file nor a case says what there is.
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
    for claim in claims {
        let verdict = if claim.holds { "holds" } else { "FAILS" };
        text += &format!("\n{verdict}  {}:\n       {}", claim.claim, claim.measured);
    }
    if claims.is_empty() { text } else { text + "\n" }
}

/// What a run leaves in its folder.
struct Outputs<'a> {
    name: &'a str,
    case: Option<&'a Case>,
    ray: &'a ViewingRay,
    answers: &'a Answers,
    curve: &'a [certainty::Point],
    claims: &'a [Claim],
}

impl Outputs<'_> {
    fn write(&self, mut staging: Staging) -> Result<(), Failure> {
        let Self { name, case, ray, answers, .. } = self;
        let about = case.map_or_else(|| (*name).to_owned(), |case| format!("{}: {}", case.figure, case.about));
        let toml = file::text(ray, &about);
        staging.write("ray.toml", |out| out.write_all(toml.as_bytes()))?;
        let csv = views::csv(ray, answers, false)?;
        staging.write("ray.csv", |out| out.write_all(&csv))?;
        let picture = figures::ray::draw(ray, answers, case.map_or(&[], Case::bands))?;
        staging.write("ray.png", |out| out.write_all(&picture))?;
        if !self.curve.is_empty() {
            let table = certainty::table(self.curve);
            staging.write("certainty.csv", |out| table.write_csv(out).map_err(io::Error::other))?;
            let picture = figures::certainty::draw(self.curve, cases::UNCHANGED)?;
            staging.write("certainty.png", |out| out.write_all(&picture))?;
        }
        let files = staging.files_and(&[RECORD]);
        let record = json!({
            "schema_version": 1,
            "command": "ray",
            "configuration": {
                "ray": name,
                "about": case.map(|case| format!("{}: {}", case.figure, case.about.replace('\n', " "))),
                "cells": ray.cells(),
                "cell_size": ray.cell_size_m,
                "observation": ray.observation_px,
                "no_hit_likelihood": ray.no_hit_likelihood,
                "sensor": ray.stereo,
            },
            "claims": self.claims,
            "versions": versions(),
            "files": files,
        });
        staging.record(&record)?;
        staging.publish()
    }
}
