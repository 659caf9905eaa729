//! `list`: what there is to run.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::{Args, Command};
use mapper::catalogue::{Entry, MAPPERS};
use serde_json::json;

use crate::failure::Failure;
use crate::output::args::{Format, FormatOption};
use crate::output::table::{Table, width, wrapped};
use crate::worlds::ranked::SortOption;
use crate::worlds::scenes::{SCENES, SWEEPS};

/// Options of `list`.
#[derive(Debug, Args)]
pub struct ListOptions {
    /// How the table is printed
    #[command(flatten)]
    pub print: FormatOption,
    /// How rows are ordered
    #[command(flatten)]
    pub order: SortOption,
}

/// Prints `experiments`, mappers, scenes, families and sweeps.
///
/// # Errors
/// A stdout that cannot be written.
pub fn run<'a>(options: &ListOptions, experiments: impl Iterator<Item = &'a Command>) -> Result<(), Failure> {
    options.order.check(Format::Csv, &[], &["kind", "name", "summary", "source"])?;
    let about = |command: &Command| command.get_about().map(ToString::to_string).unwrap_or_default();
    let experiment = |command: &Command| Listed::new("experiment", command.get_name(), &about(command));
    let mut all: Vec<Listed> = experiments.map(experiment).collect();
    let mapper = |e: &Entry| Listed { source: Some(e.source.to_owned()), ..Listed::new("mapper", e.name, e.summary) };
    all.extend(MAPPERS.iter().map(mapper));
    all.extend(scenes());
    all.extend(sweeps());
    let key = |listed: &Listed| match options.order.sort.as_deref().map(str::trim) {
        Some(column) if column.eq_ignore_ascii_case("name") => listed.name.clone(),
        Some(column) if column.eq_ignore_ascii_case("summary") => listed.summary.clone(),
        Some(column) if column.eq_ignore_ascii_case("source") => listed.source.clone().unwrap_or_default(),
        _ => String::new(), // within a kind, all are alike
    };
    all.chunk_by_mut(|a, b| a.kind == b.kind).for_each(|kind| kind.sort_by_cached_key(key));
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
    source: Option<String>,
}

impl Listed {
    fn new(kind: &'static str, name: &str, summary: &str) -> Self {
        Self { kind, name: name.to_owned(), summary: summary.to_owned(), source: None }
    }
}

fn text(all: &[Listed]) -> String {
    let (mut text, room) = (String::new(), width().map_or(usize::MAX, |width| width.saturating_sub(25)));
    for (number, group) in all.chunk_by(|a, b| a.kind == b.kind).enumerate() {
        text += if number == 0 { "" } else { "\n" };
        text += &match group[0].kind {
            "family" => "families, one scene per layout\n".to_owned(),
            kind => format!("{kind}s\n"),
        };
        for Listed { name, summary, .. } in group {
            let lines = wrapped(summary, room);
            text += &format!("  {name:22} {}\n", lines.join(&format!("\n{:25}", "")));
        }
    }
    text
}

/// The TOML files of `folder`, here or brought with the program, each path once, sorted.
fn files(folder: &str) -> BTreeSet<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let brought = strict::brought().iter().map(|(path, _)| PathBuf::from(path));
    let here = brought.filter(|path| path.parent() == Some(Path::new(folder)));
    entries.chain(here).filter(|path| path.extension().is_some_and(|e| e == "toml")).collect()
}

/// A file by the name that commands take.
fn file(kind: &'static str, path: &Path, summary: &str) -> Listed {
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    Listed { source: Some(path.display().to_string()), ..Listed::new(kind, &name, summary) }
}

/// Scenes first, then families; a file that is neither is listed with the reason.
fn scenes() -> Vec<Listed> {
    let describe = |path: &PathBuf| {
        let (kind, summary) = match (scene::Family::load(path), scene::load(path, None, None)) {
            (Ok(family), _) => ("family", family.description),
            (_, Ok(scene)) => ("scene", scene.description),
            (_, Err(error)) => ("scene", format!("not a valid scene: {error}")),
        };
        file(kind, path, &summary)
    };
    let mut found: Vec<Listed> = files(SCENES).iter().map(describe).collect();
    found.sort_by_key(|listed| listed.kind == "family");
    found
}

/// Sweeps, each with the question that it begins with.
fn sweeps() -> impl Iterator<Item = Listed> {
    files(SWEEPS).into_iter().map(|path| {
        let summary = match strict::read(&path) {
            Ok(text) => question(&text),
            Err(error) => format!("not a valid sweep: {error}"),
        };
        file("sweep", &path, &summary)
    })
}

/// The first sentence of the comment that a text begins with.
fn question(text: &str) -> String {
    let comment: Vec<&str> = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim).collect();
    let comment = comment.join(" ");
    let end = ["? ", ". "].iter().filter_map(|end| comment.find(end)).min();
    comment[..end.map_or(comment.len(), |at| at + 1)].to_owned()
}
