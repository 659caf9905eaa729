//! What `tune` leaves behind and prints.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use mapper::Prior;
use serde_json::{Value, json};

use super::candidates::Candidate;
use super::fit::Fit;
use super::{BATCH_SEEDS, TuneOptions, figure};
use crate::failure::Failure;
use crate::output::folder::{RECORD, Staging};
use crate::output::record::versions;
use crate::output::table::{Table, aligned, rounded};

/// So many candidates of each mapper are printed for reading.
const SHOWN: usize = 5;

/// Every candidate in the order of the grids.
pub fn table(fits: &[Fit]) -> Table {
    let heads = ["mapper", "reconciliation"].into_iter().chain(Candidate::PARAMETERS);
    let heads: Vec<&str> = heads.chain(["worlds", "log_loss", "brier", "best"]).collect();
    let mut table = Table::new(&heads);
    for fit in fits {
        let best = fit.best();
        for (candidate, errors) in &fit.candidates {
            let mut row = vec![json!(fit.tuned.name()), json!(candidate.reconciliation())];
            row.extend(candidate.parameters().map(Value::from));
            row.extend([json!(fit.worlds), rounded(errors.log_loss), rounded(errors.brier), json!(*candidate == best)]);
            table.push(row);
        }
    }
    table
}

/// The best candidates of each mapper, and what is to be made of the first.
pub fn text(fits: &[Fit], options: &TuneOptions) -> String {
    let mut rows = Vec::new();
    for fit in fits {
        for (place, (candidate, errors)) in fit.ranking().iter().take(SHOWN).enumerate() {
            let name = if place == 0 { fit.tuned.name() } else { "" };
            rows.push(vec![
                name.to_owned(),
                candidate.to_string(),
                fit.worlds.to_string(),
                format!("{:.4}", errors.log_loss),
                format!("{:.4}", errors.brier),
            ]);
        }
    }
    let (families, seeds) = (options.families.len(), options.seeds);
    let mut text = format!("tune: tuning set, {families} families x {seeds} seeds\n\n");
    let _ = writeln!(text, "The best {SHOWN} of each mapper, means over all that could be seen");
    text += &aligned(&["mapper", "parameters", "worlds", "log loss", "Brier"], &rows);
    text += "\n";
    for fit in fits {
        let _ = writeln!(text, "{}: {}{}", fit.tuned, fit.best(), remark(fit));
    }
    text
}

/// Whether the best candidate is what the catalogue has, and whether the grid holds it.
fn remark(fit: &Fit) -> String {
    let (best, built_in) = (fit.best(), fit.tuned.built_in());
    let mut remark = if best == built_in { ", as built in".to_owned() } else { format!("\n  built in is {built_in}") };
    let candidates: Vec<Candidate> = fit.candidates.iter().map(|(candidate, _)| *candidate).collect();
    let border = best.at_border(&candidates);
    if !border.is_empty() {
        let _ = write!(remark, "\n  at the end of the grid: {}", border.join(", "));
    }
    remark
}

/// Writes everything.
///
/// # Errors
/// A drawing that fails; a file that cannot be written.
pub fn write(staging: &mut Staging, fits: &[Fit], options: &TuneOptions) -> Result<(), Failure> {
    staging.write("tuning.csv", |out| table(fits).write_csv(out).map_err(io::Error::other))?;
    if let Some(picture) = figure::draw(fits)? {
        staging.write("tuning.png", |out| out.write_all(&picture))?;
    }
    let files = staging.files_and(&[RECORD]);
    let chosen = fits.iter().map(|fit| (fit.tuned.name().to_owned(), json!(fit.best().to_string())));
    let record = json!({
        "schema_version": 1,
        "command": "tune",
        "configuration": {
            "set": "tuning",
            "families": options.families.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
            "seeds": options.seeds,
            "batch_seeds": options.seeds.min(BATCH_SEEDS),
            "mappers": fits.iter().map(|fit| fit.tuned.name()).collect::<Vec<_>>(),
            "prior": Prior::default(),
            "criterion": "mean log loss over the observable region at the end of the drive",
        },
        "chosen": chosen.collect::<serde_json::Map<_, _>>(),
        "versions": versions(),
        "files": files,
    });
    staging.record(&record)
}
