//! What `compare` prints: the numbers that a person looks at first, 80 columns wide.

use std::fmt::Write as _;

use mapper::catalogue::Kind;

use super::at_rest;
use super::efficiency;
use super::plan::Plan;
use super::rows::Rows;
use super::sensors;
use super::sheets::{self as sheet, ALL, OBSERVABLE, Width};
use crate::page::Sheet;
use crate::worlds::claims::{self, Claim};
use crate::worlds::ranked::{Head, SortOption, legend};

/// Means and differences over all worlds, differences part by part, claims.
pub fn summary(plan: &Plan, rows: &Rows, claims: &[Claim], order: &SortOption) -> String {
    let mut text = format!("{}\n", plan.heading());
    text += &plan.batch_note().map_or_else(|| "\n".to_owned(), |note| format!("{note}\n\n"));
    // They ran on fewer worlds than the others.
    let apart: Vec<&str> = match plan.batch_note() {
        Some(_) => plan.mappers.iter().filter(|entry| entry.kind == Kind::Batch).map(|entry| entry.name).collect(),
        None => Vec::new(),
    };
    for sheet in sheets(plan, rows) {
        let _ = writeln!(text, "{}\n{}", sheet.caption, printed(&sheet, order, &apart));
    }
    text += &match legend(&text) {
        "" => String::new(),
        marks => format!("{marks}\n"),
    };
    text + &claims::lines(claims)
}

/// The heads of all tables that are printed.
pub fn heads(plan: &Plan) -> Vec<String> {
    sheets(plan, &Rows::default()).into_iter().flat_map(|sheet| sheet.heads).collect()
}

fn sheets(plan: &Plan, rows: &Rows) -> Vec<Sheet> {
    let (mappers, parts) = (plan.names(), plan.parts());
    let mut shown = vec![sheet::means(rows, &mappers, ALL, OBSERVABLE)];
    for metric in ["log_loss", "brier"] {
        shown.push(sheet::differences(rows, &mappers, ALL, OBSERVABLE, metric, Width::Terminal));
    }
    shown.extend(efficiency::sheet(&rows.efficiency, &parts, Width::Terminal));
    shown.extend(sheet::moved(rows, &mappers, Width::Terminal));
    shown.extend(at_rest::sheet(&rows.at_rest, Width::Terminal));
    shown.extend(sheet::drives(rows, &mappers, Width::Terminal));
    if plan.has_suites() {
        shown.extend(sensors::sheets(plan, rows));
    } else if parts.len() > 1 {
        shown.push(sheet::parts(rows, &mappers, &parts, "log_loss", Width::Terminal));
    }
    shown
}

/// A sheet in columns; heads of two words take two lines.
fn printed(sheet: &Sheet, order: &SortOption, apart: &[&str]) -> String {
    let narrow = |head: &String| match head.chars().count() {
        0..=10 => head.replacen([' ', '-'], "\n", 1),
        _ => head.clone(),
    };
    let heads: Vec<String> = sheet.heads.iter().map(narrow).collect();
    let heads: Vec<Head> = heads.iter().map(|head| Head::titled(head)).collect();
    let rows: Vec<Vec<String>> =
        sheet.rows.iter().map(|row| row.iter().map(|cell| cell.text.clone()).collect()).collect();
    order.ranked_but(&heads, &rows, apart)
}
