//! Tables of things that compete, for reading: rows in the order of a column, and the best of every column marked.

use std::cmp::Ordering;

use clap::Args;
use mapper::catalogue::{self, Kind};
use score::Better;

use super::criteria::{CRITERIA, Criterion, criterion};
use crate::failure::Failure;
use crate::output::args::Format;
use crate::output::marks::{BEST, EVEN, is_marked, value};
use crate::output::table::{Table, aligned, marked};

/// What the marks of a text mean, where it has any; a line.
pub fn legend(text: &str) -> &'static str {
    let has = |mark: char| text.split_whitespace().any(|word| is_marked(word, mark));
    match (has(BEST), has(EVEN)) {
        (_, true) => "* best of its column; = behind it by no more than does not matter\n",
        (true, false) => "* best of its column\n",
        (false, false) => "",
    }
}

/// A column of numbers or words.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Head<'a> {
    /// What stands above it.
    pub title: &'a str,
    /// The name of what it holds in files; may be empty.
    pub name: &'a str,
    /// Which way is better, and the largest difference that does not matter; none where neither way is, or nobody knows.
    pub judged: Option<(Better, f64)>,
}

impl<'a> Head<'a> {
    /// A column that judges nothing.
    pub const fn plain(title: &'a str) -> Self {
        Self { title, name: "", judged: None }
    }

    /// A column in which every difference matters.
    pub const fn of(title: &'a str, name: &'a str, better: Better) -> Self {
        Self { title, name, judged: Some((better, 0.0)) }
    }

    /// A column of a metric, by its name.
    pub fn metric(title: &'a str, metric: &'a str) -> Self {
        Self { title, name: metric, judged: criterion(metric).and_then(|criterion| criterion.judged) }
    }

    /// A column of a metric, by what tables for reading call it, with its unit or without.
    pub fn titled(title: &'a str) -> Self {
        let plain = title.replace('\n', " ");
        let is = |c: &&Criterion| plain == c.title || plain.strip_prefix(c.title) == Some(&format!(" {}", c.unit));
        let found = CRITERIA.iter().find(is);
        Self { title, name: found.map_or("", |c| c.metric), judged: found.and_then(|c| c.judged) }
    }

    /// Whether somebody means this column by `name`: signs between words do not count.
    fn is(&self, name: &str) -> bool {
        [self.title, self.name].iter().any(|own| !own.is_empty() && plain(own) == plain(name))
    }
}

fn plain(name: &str) -> String {
    let word = |c: char| if "-_\n".contains(c) { ' ' } else { c.to_ascii_lowercase() };
    name.trim().chars().map(word).collect()
}

/// `--sort`.
#[derive(Debug, Clone, Default, Args)]
pub struct SortOption {
    /// Order the rows of tables on stdout by this column, the best first where it is known which way is better
    #[arg(long, value_name = "COLUMN")]
    pub sort: Option<String>,
}

impl SortOption {
    /// Refuses a column that no table has: of text the `heads`, of csv and json the columns of `table`.
    ///
    /// # Errors
    /// Such a column, with those that there are and the nearest.
    pub fn check(&self, format: Format, heads: &[Head], table: &[&str]) -> Result<(), Failure> {
        let Some(name) = &self.sort else { return Ok(()) };
        let mut known: Vec<String> = match format {
            Format::Text => heads.iter().map(|head| head.title.replace('\n', " ")).collect(),
            Format::Csv | Format::Json => table.iter().map(|column| (*column).to_owned()).collect(),
        };
        let found = match format {
            Format::Text => heads.iter().any(|head| head.is(name)),
            Format::Csv | Format::Json => table.iter().any(|column| plain(column) == plain(name)),
        };
        if found {
            return Ok(());
        }
        let mut seen = std::collections::BTreeSet::new();
        known.retain(|column| !column.is_empty() && seen.insert(column.clone()));
        let nearest = strict::nearest(name, known.iter().map(String::as_str));
        Err(Failure::BadInput(format!(
            "--sort {name}: must be a column of the tables printed: {}; the nearest is '{nearest}'",
            known.join(", ")
        )))
    }

    /// The same, where columns of some names are not there and another is their place.
    #[must_use]
    pub fn renamed(&self, absent: &[&str], name: &str) -> Self {
        let is_absent = |sort: &&String| absent.iter().any(|absent| plain(absent) == plain(sort));
        if self.sort.as_ref().filter(is_absent).is_none() { self.clone() } else { Self { sort: Some(name.to_owned()) } }
    }

    /// The table for programs in this order; `heads` are those of which it is known which way is better, beside the metrics.
    #[must_use]
    pub fn of(&self, table: Table, heads: &[Head]) -> Table {
        let Some(name) = &self.sort else { return table };
        let Some(column) = table.columns().iter().position(|own| plain(own) == plain(name)) else { return table };
        let own = heads.iter().find(|head| head.is(table.columns()[column])).and_then(|head| head.judged);
        let judged = own.or_else(|| criterion(table.columns()[column]).and_then(|c| c.judged));
        let better = judged.map(|(better, _)| better);
        table.sorted_by(|a, b| compared(&a[column], &b[column], better))
    }

    /// A table for reading in this order, with its marks. A row that begins with nothing belongs to the one above it.
    pub fn ranked(&self, heads: &[Head], rows: &[Vec<String>]) -> String {
        self.ranked_but(heads, rows, &[])
    }

    /// The same, where some rows do not compete with the others.
    pub fn ranked_but(&self, heads: &[Head], rows: &[Vec<String>], apart: &[&str]) -> String {
        let mut blocks: Vec<Vec<Vec<String>>> = Vec::new();
        for row in rows {
            match blocks.last_mut() {
                Some(block) if row.first().is_some_and(String::is_empty) => block.push(row.clone()),
                _ => blocks.push(vec![row.clone()]),
            }
        }
        let column = self.sort.as_ref().and_then(|name| heads.iter().position(|head| head.is(name)));
        if let Some(column) = column {
            let better = heads[column].judged.map(|(better, _)| better);
            blocks.sort_by(|a, b| compared(&a[0][column], &b[0][column], better));
        }
        let mut titles: Vec<String> = heads.iter().map(|head| head.title.to_owned()).collect();
        let mut rows: Vec<Vec<String>> = blocks.concat();
        for (column, head) in heads.iter().enumerate() {
            let marks = head.judged.and_then(|judged| marks(&rows, column, judged, apart));
            if let Some(marks) = marks {
                titles[column] =
                    titles[column].split('\n').map(|line| format!("{line} ")).collect::<Vec<_>>().join("\n");
                for (row, mark) in rows.iter_mut().zip(marks) {
                    row[column].push(mark);
                }
            }
        }
        let titles: Vec<&str> = titles.iter().map(String::as_str).collect();
        if titles.iter().any(|title| title.ends_with(' ')) { marked(&titles, &rows) } else { aligned(&titles, &rows) }
    }
}

/// A mark for each row, a blank where it has none; none where nothing is best: fewer than two compete, or all read the same.
fn marks(rows: &[Vec<String>], column: usize, (better, margin): (Better, f64), apart: &[&str]) -> Option<Vec<char>> {
    let competes = |row: &Vec<String>| {
        let name = row.first().map_or("", String::as_str);
        !apart.contains(&name)
            && !name.is_empty()
            && catalogue::find(name).is_none_or(|entry| entry.kind != Kind::NoiseFree)
    };
    let values: Vec<Option<f64>> = rows.iter().map(|row| value(&row[column]).filter(|_| competes(row))).collect();
    let worse = |value: f64, best: f64| if better == Better::Lower { value - best } else { best - value };
    let best = values.iter().flatten().copied().reduce(|a, b| if worse(b, a) < 0.0 { b } else { a })?;
    let behind = |value: &Option<f64>| value.map(|value| worse(value, best));
    if !values.iter().filter_map(behind).any(|behind| behind > 0.0) {
        return None;
    }
    let mark = |value: &Option<f64>| match behind(value) {
        Some(behind) if behind <= 0.0 => BEST,
        Some(behind) if behind <= margin * (1.0 + 1e-9) => EVEN,
        _ => ' ',
    };
    Some(values.iter().map(mark).collect())
}

/// Which of two cells comes first: the better number, else the lesser; numbers before words, and what has no value last.
fn compared(a: &str, b: &str, better: Option<Better>) -> Ordering {
    // Of a number with its interval or its verdict behind it, the number counts.
    let number = |cell: &str| cell.split_whitespace().next().and_then(|first| value(first.trim_end_matches('?')));
    let absent = |cell: &str| cell.is_empty() || cell == "-";
    match (number(a), number(b)) {
        (Some(a), Some(b)) if better == Some(Better::Higher) => b.total_cmp(&a),
        (Some(a), Some(b)) => a.total_cmp(&b),
        (a_number, b_number) => {
            (a_number.is_none(), absent(a)).cmp(&(b_number.is_none(), absent(b))).then_with(|| a.cmp(b))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HEADS: [Head; 3] = [
        Head::plain("mapper"),
        Head { title: "log\nloss", name: "log_loss", judged: Some((Better::Lower, 0.005)) },
        Head::of("AUC", "auc", Better::Higher),
    ];

    fn rows(rows: &[[&str; 3]]) -> Vec<Vec<String>> {
        rows.iter().map(|row| row.map(str::to_owned).to_vec()).collect()
    }

    fn sorted(column: &str) -> SortOption {
        SortOption { sort: Some(column.to_owned()) }
    }

    #[test]
    fn the_best_those_that_read_the_same_and_those_that_hardly_differ_have_marks() {
        let rows = rows(&[["a", "0.103", "0.9"], ["b", "0.100", "0.9"], ["c", "0.100", "-"], ["d", "0.106", "0.8"]]);
        let text = SortOption::default().ranked(&HEADS, &rows);
        assert_eq!(
            text,
            "mapper    log  AUC\n         loss\n───────────────────\na       0.103= 0.9*\nb       0.100* 0.9*\n\
             c       0.100*   -\nd       0.106  0.8\n"
        );
        assert_eq!(legend(&text), "* best of its column; = behind it by no more than does not matter\n");
    }

    #[test]
    fn nothing_is_best_where_all_are_alike_alone_or_no_rival() {
        let of = |given: &[[&str; 3]]| SortOption::default().ranked(&HEADS, &rows(given));
        for given in [
            &[["a", "0.1", "1.0"], ["b", "0.1", "1.0"]][..],
            &[["a", "0.1", "1.0"]],
            &[["a", "-", "-"], ["b", "0.1", "-"]],
        ] {
            assert!(!of(given).contains([BEST, EVEN]), "{given:?}");
            assert_eq!(legend(&of(given)), "");
        }
        let text = of(&[["perfect", "0.01", "1.0"], ["a", "0.2", "0.9"], ["b", "0.3", "0.8"]]);
        assert!(text.contains("0.2*") && text.contains("0.9*") && !text.contains("0.01*"), "{text}");
    }

    #[test]
    fn rows_are_ordered_best_first_with_what_belongs_to_them() {
        let given = rows(&[["a", "0.2", "0.8"], ["", "±0.1", "±0.2"], ["b", "-", "0.9"], ["c", "0.1", "0.7"]]);
        let order = |column: &str| -> Vec<String> {
            let text = sorted(column).ranked(&HEADS, &given);
            text.lines().skip(3).map(|line| line.chars().next().unwrap_or(' ').to_string()).collect()
        };
        assert_eq!(order("log_loss"), ["c", "a", " ", "b"]);
        assert_eq!(order("Log loss"), order("log-loss"));
        assert_eq!(order("auc"), ["b", "a", " ", "c"]);
        assert_eq!(order("mapper"), ["a", " ", "b", "c"]);
    }

    #[test]
    fn a_column_that_is_not_there_is_refused_with_those_that_are() {
        let refused = sorted("log los").check(Format::Text, &HEADS, &["value"]).expect_err("no such head").to_string();
        assert_eq!(
            refused,
            "--sort log los: must be a column of the tables printed: mapper, log loss, AUC; the nearest is 'log loss'"
        );
        assert!(sorted("value").check(Format::Csv, &HEADS, &["value"]).is_ok());
        assert!(sorted("log_loss").check(Format::Json, &HEADS, &["value"]).is_err());
    }

    proptest! {
        /// Against the definition: no other is better by more than the mark says.
        #[test]
        fn marks_are_those_of_the_definition(values in prop::collection::vec(0u32..30, 2..9)) {
            let given: Vec<Vec<String>> =
                values.iter().enumerate().map(|(k, v)| vec![k.to_string(), format!("{:.3}", f64::from(*v) / 1000.0)]).collect();
            let found = marks(&given, 1, (Better::Lower, 0.005), &[]);
            let least = values.iter().min().expect("two or more");
            prop_assert_eq!(found.is_none(), values.iter().all(|v| v == least));
            for (mark, value) in found.into_iter().flatten().zip(&values) {
                let expected = match value - least { 0 => BEST, 1..=5 => EVEN, _ => ' ' };
                prop_assert_eq!(mark, expected);
            }
        }
    }
}
