//! `list`: what there is to run.

use std::path::{Path, PathBuf};

use clap::{Args, Command};
use mapper::catalogue::{Entry, MAPPERS};
use serde_json::json;

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
    let about = |command: &Command| command.get_about().map(ToString::to_string).unwrap_or_default();
    let experiment = |command: &Command| Listed::new("experiment", command.get_name(), &about(command));
    let mut all: Vec<Listed> = experiments.map(experiment).collect();
    let mapper = |e: &Entry| Listed { source: Some(e.source), ..Listed::new("mapper", e.name, e.summary) };
    all.extend(MAPPERS.iter().map(mapper));
    all.extend(scenes(Path::new(SCENES)));
    let table = Table::of(
        &all,
        &[
            ("kind", &|row| json!(row.kind)),
            ("name", &|row| json!(row.name)),
            ("summary", &|row| json!(row.summary)),
            ("source", &|row| json!(row.source)),
        ],
    );
    table.print(options.print.format, || text(&all))
}

/// Something to run, or to run it on.
struct Listed {
    kind: &'static str,
    name: String,
    summary: String,
    source: Option<&'static str>,
}

impl Listed {
    fn new(kind: &'static str, name: &str, summary: &str) -> Self {
        Self { kind, name: name.to_owned(), summary: summary.to_owned(), source: None }
    }
}

fn text(all: &[Listed]) -> String {
    let mut text = String::new();
    for (number, group) in all.chunk_by(|a, b| a.kind == b.kind).enumerate() {
        text += if number == 0 { "" } else { "\n" };
        text += &match group[0].kind {
            "family" => "families, one scene per layout\n".to_owned(),
            kind => format!("{kind}s\n"),
        };
        group.iter().for_each(|Listed { name, summary, .. }| text += &format!("  {name:22} {summary}\n"));
    }
    text
}

/// Files in `folder` with their kind and description: scenes first, then families, each sorted; a file that is
/// neither is listed with the reason.
fn scenes(folder: &Path) -> Vec<Listed> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|e| e == "toml")).collect();
    paths.sort();
    let describe = |path: &PathBuf| {
        let (kind, summary) = match (scene::Family::load(path), scene::load(path, None, None)) {
            (Ok(family), _) => ("family", family.description),
            (_, Ok(scene)) => ("scene", scene.description),
            (_, Err(error)) => ("scene", format!("not a valid scene: {error}")),
        };
        Listed::new(kind, &path.display().to_string(), &summary)
    };
    let mut found: Vec<Listed> = paths.iter().map(describe).collect();
    found.sort_by_key(|listed| listed.kind == "family");
    found
}
