//! Tables: one value, three views.

use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::io::{self, Write};

use serde_json::{Map, Value, json};

use super::args::Format;
use super::folder::Staging;
use super::paint;
pub use super::screen::{fitted, width, wrapped};
use crate::failure::Failure;

/// A table with named columns. A value that does not exist is null: an empty field in CSV.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    columns: Vec<&'static str>,
    rows: Vec<Vec<Value>>,
}

/// A column of a table over rows of a type: its name, and what it holds of a row.
pub type Column<'a, R> = (&'static str, &'a dyn Fn(&R) -> Value);

impl Table {
    /// The table of some rows.
    pub fn of<R>(rows: &[R], columns: &[Column<R>]) -> Self {
        Self { columns: Vec::new(), rows: vec![Vec::new(); rows.len()] }.and(rows, columns)
    }

    /// Adds columns for the same rows.
    #[must_use]
    pub fn and<R>(mut self, rows: &[R], columns: &[Column<R>]) -> Self {
        self.columns.extend(columns.iter().map(|(name, _)| *name));
        for (own, row) in self.rows.iter_mut().zip(rows) {
            own.extend(columns.iter().map(|(_, value)| value(row)));
        }
        self
    }

    /// Adds a column for each name; `value` is given a row and the number of the name.
    #[must_use]
    pub fn with<R>(mut self, rows: &[R], names: &[&'static str], value: impl Fn(&R, usize) -> Value) -> Self {
        self.columns.extend(names);
        for (own, row) in self.rows.iter_mut().zip(rows) {
            own.extend((0..names.len()).map(|number| value(row, number)));
        }
        self
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[&'static str] {
        &self.columns
    }

    /// The rows, one value per column.
    pub fn rows(&self) -> &[Vec<Value>] {
        &self.rows
    }

    /// Writes the table as CSV.
    ///
    /// # Errors
    /// Whatever the writer reports.
    pub fn write_csv(&self, out: impl Write) -> Result<(), csv::Error> {
        let mut csv = csv::Writer::from_writer(out);
        csv.write_record(&self.columns)?;
        for row in &self.rows {
            csv.write_record(row.iter().map(field))?;
        }
        Ok(csv.flush()?)
    }

    /// Leaves the table as a CSV file of a folder.
    ///
    /// # Errors
    /// Whatever the system reports.
    pub fn save(&self, staging: &mut Staging, name: &str) -> Result<(), Failure> {
        staging.write(name, |out| self.write_csv(out).map_err(io::Error::other))
    }

    /// The cells as text, nothing where there is no value.
    pub fn fields(&self) -> Vec<Vec<String>> {
        self.rows.iter().map(|row| row.iter().map(field).collect()).collect()
    }

    /// The table as JSON: `{"schema_version": 1, "rows": [{column: value}]}`.
    pub fn to_json(&self) -> Value {
        let object = |row: &Vec<Value>| -> Value {
            self.columns.iter().map(|c| (*c).to_owned()).zip(row.iter().cloned()).collect::<Map<_, _>>().into()
        };
        json!({ "schema_version": 1, "rows": self.rows.iter().map(object).collect::<Vec<_>>() })
    }

    /// The same rows in another order, those alike as they were; `order` is given their cells as text.
    #[must_use]
    pub fn sorted_by(mut self, order: impl Fn(&[String], &[String]) -> Ordering) -> Self {
        let mut rows: Vec<(Vec<String>, Vec<Value>)> = self.fields().into_iter().zip(self.rows).collect();
        rows.sort_by(|a, b| order(&a.0, &b.0));
        self.rows = rows.into_iter().map(|(_, row)| row).collect();
        self
    }

    /// Writes the table to stdout, for reading as `text` gives it.
    ///
    /// # Errors
    /// A stdout that cannot be written.
    pub fn print(&self, format: Format, text: impl FnOnce() -> String) -> Result<(), Failure> {
        match format {
            Format::Text => print(&paint::meaning(&fitted(&text(), width()))),
            Format::Json => print(&format!("{:#}\n", self.to_json())),
            Format::Csv => print(&String::from_utf8_lossy(&self.csv()?)),
        }
    }

    /// The table as CSV.
    ///
    /// # Errors
    /// None but a defect.
    pub fn csv(&self) -> Result<Vec<u8>, Failure> {
        let mut bytes = Vec::new();
        self.write_csv(&mut bytes).map_err(Failure::internal)?;
        Ok(bytes)
    }
}

/// Writes to stdout. A reader that has gone away, as `head` does, is no error.
///
/// # Errors
/// A stdout that cannot be written.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Failure::Internal(format!("stdout: cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// A value as a field of a CSV file: nothing where there is none.
pub fn field(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// A number with six significant digits: enough to see every change that matters, few enough to be
/// the same on another machine. What is not finite does not exist.
pub fn rounded(value: f64) -> Value {
    if !value.is_finite() {
        return Value::Null;
    }
    let text = format!("{value:.5e}");
    let nearest: f64 = text.parse().unwrap_or(value);
    json!(if nearest == 0.0 { 0.0 } else { nearest }) // no minus zero
}

/// [`rounded`], or null.
pub fn optional(value: Option<f64>) -> Value {
    value.map_or(Value::Null, rounded)
}

/// A table for reading: columns are aligned, numbers to the right, and nothing is drawn but a line
/// under the heads. Where the screen is narrower, it comes in blocks, each with the columns that tell rows apart.
pub fn aligned(heads: &[&str], rows: &[Vec<String>]) -> String {
    in_blocks(heads, rows, Gap::Two)
}

/// The same of columns that may hold marks: where a head ends with a blank, the last letter of a column stands in the gap behind it.
pub fn marked(heads: &[&str], rows: &[Vec<String>]) -> String {
    in_blocks(heads, rows, Gap::Marks)
}

/// What stands between columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Gap {
    Two,
    /// One blank behind a column whose head ends with one.
    Marks,
}

fn in_blocks(heads: &[&str], rows: &[Vec<String>], gap: Gap) -> String {
    let blocks = width().map_or_else(|| vec![(0..heads.len()).collect()], |width| blocks(heads, rows, width));
    let part = |block: Vec<usize>| {
        let heads: Vec<&str> = block.iter().map(|&column| heads[column]).collect();
        let cell = |row: &Vec<String>, column: usize| row.get(column).cloned().unwrap_or_default();
        let rows: Vec<Vec<String>> =
            rows.iter().map(|row| block.iter().map(|&column| cell(row, column)).collect()).collect();
        unbroken(&heads, &rows, gap)
    };
    blocks.into_iter().map(part).collect::<Vec<_>>().join("\n")
}

/// The columns that tell rows apart, the first or the first two.
fn keys(heads: &[&str], rows: &[Vec<String>]) -> usize {
    let first: BTreeSet<Option<&String>> = rows.iter().map(|row| row.first()).collect();
    if first.len() == rows.len() { 1 } else { heads.len().min(2) }
}

/// The columns of each block of a table, those that tell rows apart before all others, such that a block fits into so many columns of text
/// as far as a block with one more column can. A last column without a head belongs to the one before it.
fn blocks(heads: &[&str], rows: &[Vec<String>], width: usize) -> Vec<Vec<usize>> {
    let letters = |text: &str| text.chars().count();
    let wide = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| letters(cell));
        cells.chain([letters(heads[column])]).max().unwrap_or(0)
    };
    let gap = 2;
    let keys: Vec<usize> = (0..keys(heads, rows)).collect();
    let begin = keys.iter().map(|&column| gap + wide(column)).sum::<usize>().saturating_sub(gap);
    let (mut all, mut block, mut used) = (Vec::new(), keys.clone(), begin);
    for column in keys.len()..heads.len() {
        let tail = if heads.get(column + 1).is_some_and(|head| head.is_empty()) { gap + wide(column + 1) } else { 0 };
        if block.len() > keys.len() && !heads[column].is_empty() && used + gap + wide(column) + tail > width {
            all.push(std::mem::replace(&mut block, keys.clone()));
            used = begin;
        }
        block.push(column);
        used += gap + wide(column);
    }
    all.push(block);
    all
}

fn unbroken(heads: &[&str], rows: &[Vec<String>], gap: Gap) -> String {
    use comfy_table::{CellAlignment, LineStyle, Table as Text, TableStyle};
    let rule = LineStyle::none().fill('─').junction('─');
    let mut text = Text::new();
    text.load_style(TableStyle::new().header_separator(rule)).set_header(heads).add_rows(rows);
    for (i, column) in text.column_iter_mut().enumerate() {
        let in_gap = gap == Gap::Marks && heads[i].ends_with(' ');
        column.set_padding((0, u16::from(i + 1 < heads.len() && !in_gap)));
        if i > 0 {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let lines: Vec<String> = text.to_string().lines().map(|line| line.trim_end().to_owned()).collect();
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits_and_no_minus_zero() {
        assert_eq!(rounded(0.123_456_789), json!(0.123457));
        assert_eq!(rounded(-123_456_789.0), json!(-123_457_000.0));
        assert_eq!(rounded(-0.0).to_string(), "0.0");
        assert_eq!(rounded(f64::NAN), Value::Null);
    }

    #[test]
    fn a_table_wider_than_the_screen_comes_in_blocks() {
        let heads = ["mapper", "log loss", "Brier", "against", ""];
        let rows = vec![["visibility", "0.1", "0.02", "0.003", "better"].map(str::to_owned).to_vec()];
        assert_eq!(blocks(&heads, &rows, 80), [vec![0, 1, 2, 3, 4]]);
        assert_eq!(blocks(&heads, &rows, 30), [vec![0, 1, 2], vec![0, 3, 4]], "a verdict stays beside its number");
        assert_eq!(blocks(&heads, &rows, 5), [vec![0, 1], vec![0, 2], vec![0, 3, 4]]);
        assert_eq!(blocks(&heads[..1], &rows, 5), [vec![0]]);
        let twice = [rows.clone(), rows].concat();
        assert_eq!(blocks(&heads, &twice, 30), [vec![0, 1, 2], vec![0, 1, 3, 4]], "two columns tell rows apart");
    }

    #[test]
    fn prose_ends_between_words_and_drawings_stay() {
        let text = "one two three four\n  five six seven eight\na  b  c  d  e  f\n────────────────────────\n";
        let fitted = fitted(text, Some(14));
        assert_eq!(
            fitted,
            "one two three\nfour\n  five six\n  seven eight\na  b  c  d  e  f\n────────────────────────\n"
        );
        assert_eq!(super::fitted(text, None), text);
    }

    #[test]
    fn an_absent_value_is_an_empty_field_and_a_null() {
        let table = Table::of(&["x,y"], &[("a", &|text| json!(text)), ("b", &|_| Value::Null)]);
        assert_eq!(String::from_utf8(table.csv().expect("memory")).expect("text"), "a,b\n\"x,y\",\n");
        assert_eq!(table.to_json(), json!({"schema_version": 1, "rows": [{"a": "x,y", "b": null}]}));
    }
}
