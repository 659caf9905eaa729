//! `list`: what there is to run.

use std::path::Path;

use clap::{Args, Command};
use mapper::catalogue::MAPPERS;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::output::args::FormatOption;
use crate::output::table::Table;

/// Options of `list`.
#[derive(Debug, Args)]
pub struct ListOptions {
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
}

/// Folder in which scenes are looked for.
const SCENES: &str = "scenes";

/// Prints `experiments`, mappers, scenes and families.
///
/// # Errors
/// A stdout that cannot be written.
pub fn run<'a>(options: &ListOptions, experiments: impl Iterator<Item = &'a Command>) -> Result<(), Failure> {
    let mut table = Table::new(&["kind", "name", "summary", "source"]);
    for command in experiments {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        table.push(vec![json!("experiment"), json!(command.get_name()), json!(about), Value::Null]);
    }
    for entry in MAPPERS {
        table.push(vec![json!("mapper"), json!(entry.name), json!(entry.summary), json!(entry.source)]);
    }
    for (kind, path, description) in scenes(Path::new(SCENES)) {
        table.push(vec![json!(kind), json!(path), json!(description), Value::Null]);
    }
    table.print(options.print.format, || text(&table))
}

fn text(table: &Table) -> String {
    let mut text = String::new();
    let mut kind = "";
    for row in table.rows() {
        let [now, name, summary] = [&row[0], &row[1], &row[2]].map(|value| value.as_str().unwrap_or_default());
        if now != kind {
            let heading = if now == "family" { "families, one scene per layout".to_owned() } else { format!("{now}s") };
            text += &format!("{}{heading}\n", if kind.is_empty() { "" } else { "\n" });
            kind = now;
        }
        text += &format!("  {name:22} {summary}\n");
    }
    text
}

/// Files in `folder` with their kind and description: scenes first, then families, each sorted; a file that is
/// neither says so.
fn scenes(folder: &Path) -> Vec<(&'static str, String, String)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    paths.sort();
    let describe = |path: &Path| match (scene::Family::load(path), scene::load(path, None, None)) {
        (Ok(family), _) => ("family", family.description),
        (_, Ok(scene)) => ("scene", scene.description),
        (_, Err(error)) => ("scene", format!("not a valid scene: {error}")),
    };
    let mut found: Vec<_> = paths.iter().map(|path| (describe(path), path.display().to_string())).collect();
    found.sort_by_key(|((kind, _), _)| *kind == "family");
    found.into_iter().map(|((kind, description), path)| (kind, path, description)).collect()
}
