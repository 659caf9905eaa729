//! `list`: what there is to run.

use std::path::Path;

use clap::CommandFactory as _;
use mapper::catalogue::MAPPERS;
use serde_json::{Value, json};

use crate::cli::{Cli, Format, ListOptions};
use crate::failure::Failure;
use crate::table::{self, Table};

/// Folder in which scenes are looked for.
const SCENES: &str = "scenes";

/// Prints experiments, mappers and scenes.
///
/// # Errors
/// A stdout that cannot be written.
pub fn run(options: &ListOptions) -> Result<(), Failure> {
    let mut table = Table::new(&["kind", "name", "summary", "source"]);
    for command in Cli::command().get_subcommands() {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        table.push(vec![json!("experiment"), json!(command.get_name()), json!(about), Value::Null]);
    }
    for entry in MAPPERS {
        table.push(vec![json!("mapper"), json!(entry.name), json!(entry.summary), json!(entry.source)]);
    }
    for (path, description) in scenes(Path::new(SCENES)) {
        table.push(vec![json!("scene"), json!(path), json!(description), Value::Null]);
    }
    match options.format {
        Format::Csv => table.print(false),
        Format::Json => table.print(true),
        Format::Text => table::print(&text(&table)),
    }
}

fn text(table: &Table) -> String {
    let mut text = String::new();
    let mut kind = "";
    for row in table.rows() {
        let [now, name, summary] = [&row[0], &row[1], &row[2]].map(|value| value.as_str().unwrap_or_default());
        if now != kind {
            text += &format!("{}{now}s\n", if kind.is_empty() { "" } else { "\n" });
            kind = now;
        }
        text += &format!("  {name:20} {summary}\n");
    }
    text
}

/// Scene files in `folder` with their descriptions, sorted; a file that is no scene says so.
fn scenes(folder: &Path) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    paths.sort();
    let describe = |path: &Path| match scene::Scene::load(path, None) {
        Ok(scene) => scene.description,
        Err(error) => format!("not a valid scene: {error}"),
    };
    paths.iter().map(|path| (path.display().to_string(), describe(path))).collect()
}
