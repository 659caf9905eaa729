//! What `tune` leaves behind and prints.

use std::fmt::Write as _;

use mapper::{Candidate, Prior, Setting};
use serde_json::{Value, json};

use super::candidates::{at_border, parameters};
use super::fit::{Errors, TunedFit};
use super::{BATCH_SEEDS, TuneOptions, figure};
use crate::failure::Failure;
use crate::output::folder::Staging;
use crate::output::record::Record;
use crate::output::table::{Table, aligned, rounded};

/// So many candidates of each mapper are printed for reading.
const SHOWN: usize = 5;

/// Every candidate in the order of the grids.
pub fn table(fits: &[TunedFit]) -> Table {
    let mut rows: Vec<(&TunedFit, Candidate, Errors)> = Vec::new();
    for fit in fits {
        rows.extend(fit.candidates.iter().map(|(candidate, errors)| (fit, candidate.clone(), *errors)));
    }
    let names = parameters();
    let value = |candidate: &Candidate, number: usize| match candidate.get(names[number]) {
        Some(Setting::Number(number)) if number == f64::INFINITY => json!("inf"),
        Some(Setting::Number(number)) => json!(number),
        Some(Setting::Word(word)) => json!(word),
        None => Value::Null,
    };
    Table::of(&rows, &[("mapper", &|row| json!(row.0.tuned.name()))])
        .with(&rows, &names, |row, number| value(&row.1, number))
        .and(
            &rows,
            &[
                ("worlds", &|row| json!(row.0.worlds)),
                ("log_loss", &|row| rounded(row.2.log_loss)),
                ("brier", &|row| rounded(row.2.brier)),
                ("best", &|row| json!(row.1 == row.0.best())),
            ],
        )
}

/// The best candidates of each mapper, and what is to be made of the first.
pub fn text(fits: &[TunedFit], options: &TuneOptions) -> String {
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
fn remark(fit: &TunedFit) -> String {
    let (best, built_in) = (fit.best(), fit.tuned.built_in());
    let mut remark = if best == built_in { ", as built in".to_owned() } else { format!("\n  built in is {built_in}") };
    let candidates: Vec<Candidate> = fit.candidates.iter().map(|(candidate, _)| candidate.clone()).collect();
    let border = at_border(&best, &candidates);
    for names in border.chunks(3) {
        let _ = write!(remark, "\n  at the end of the grid: {}", names.join(", "));
    }
    remark
}

/// The files, beside the record.
pub(super) const FILES: [&str; 2] = ["tuning.csv", "tuning.png"];

/// Writes everything.
///
/// # Errors
/// A drawing that fails; a file that cannot be written.
pub fn write(staging: &mut Staging, fits: &[TunedFit], options: &TuneOptions) -> Result<(), Failure> {
    table(fits).save(staging, "tuning.csv")?;
    if let Some(picture) = figure::draw(fits, &options.paper) {
        options.paper.save(staging, "tuning.png", &picture)?;
    }
    let chosen = fits.iter().map(|fit| (fit.tuned.name().to_owned(), json!(fit.best().to_string())));
    let configuration = json!({
        "set": "tuning",
        "families": options.families.iter().map(|path| path.display().to_string()).collect::<Vec<_>>(),
        "seeds": options.seeds,
        "batch_seeds": options.seeds.min(BATCH_SEEDS),
        "mappers": fits.iter().map(|fit| fit.tuned.name()).collect::<Vec<_>>(),
        "prior": Prior::default(),
        "criterion": "mean log loss over the observable region at the end of the drive",
    });
    let chosen = chosen.collect::<serde_json::Map<_, _>>();
    staging.record(&Record::new("tune", json!({ "configuration": configuration, "chosen": chosen })))
}
