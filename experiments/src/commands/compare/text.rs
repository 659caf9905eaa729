//! What `compare` prints: the numbers that a person looks at first, 80 columns wide.

use std::fmt::Write as _;

use super::plan::Plan;
use super::rows::Rows;
use super::sheets::{self, ALL, OBSERVABLE, Width};
use crate::output::table::aligned;
use crate::page::Sheet;
use crate::worlds::claims::{self, Claim};

/// Means and differences over all worlds, differences part by part, claims.
pub fn summary(plan: &Plan, rows: &Rows, claims: &[Claim]) -> String {
    let (mappers, parts) = (plan.names(), plan.parts());
    let mut text = format!("{}\n", plan.heading());
    text += &plan.batch_note().map_or_else(|| "\n".to_owned(), |note| format!("{note}\n\n"));
    let mut shown = vec![sheets::means(rows, &mappers, ALL, OBSERVABLE)];
    for metric in ["log_loss", "brier"] {
        shown.push(sheets::differences(rows, &mappers, ALL, OBSERVABLE, metric, Width::Terminal));
    }
    shown.extend(sheets::moved(rows, &mappers, Width::Terminal));
    shown.extend(sheets::drives(rows, &mappers, Width::Terminal));
    if parts.len() > 1 {
        shown.push(sheets::parts(rows, &mappers, &parts, "log_loss", Width::Terminal));
    }
    for sheet in shown {
        let _ = writeln!(text, "{}\n{}", sheet.caption, printed(&sheet));
    }
    text + &claims::lines(claims)
}

/// A sheet in columns; heads of two words take two lines.
fn printed(sheet: &Sheet) -> String {
    let narrow = |head: &String| match head.chars().count() {
        0..=10 => head.replacen([' ', '-'], "\n", 1),
        _ => head.clone(),
    };
    let heads: Vec<String> = sheet.heads.iter().map(narrow).collect();
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let rows: Vec<Vec<String>> =
        sheet.rows.iter().map(|row| row.iter().map(|cell| cell.text.clone()).collect()).collect();
    aligned(&heads, &rows)
}
