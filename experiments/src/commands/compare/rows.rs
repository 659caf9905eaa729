//! Rows of the tables of a comparison, as its files hold them: what is shown is what is written.

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::repeats::Readings;
use crate::failure::Failure;
use crate::output::table::Table;

/// A row of `summary.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the names are those of the columns")]
pub struct Mean {
    pub scope: String,
    pub region: String,
    pub mapper: String,
    pub metric: String,
    pub worlds: usize,
    pub mean: Option<f64>,
}

/// A row of `differences.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the names are those of the columns")]
pub struct Difference {
    pub scope: String,
    pub region: String,
    pub metric: String,
    pub mapper: String,
    pub pairs: Option<usize>,
    pub difference: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub p_holm: Option<f64>,
    pub rank_biserial: Option<f64>,
    pub cohen_dz: Option<f64>,
    pub verdict: Option<String>,
}

/// A row of `repeats.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the names are those of the columns")]
pub struct Repeat {
    pub family: String,
    pub seed: u64,
    pub readings: Readings,
    pub mapper: String,
    pub repeats: usize,
    pub log_loss: Option<f64>,
    pub free_known: Option<f64>,
    pub phantom_area: Option<f64>,
    pub missed_area: Option<f64>,
    #[serde(default)] // tables of before this column are shown too
    pub retention: Option<f64>,
}

/// A row of `at-rest.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the names are those of the columns")]
pub struct Rested {
    pub mapper: String,
    pub worlds: usize,
    pub static_accuracy: f64,
    pub at_rest: f64,
    pub points_less: f64,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// A row of `sensors.csv`.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the names are those of the columns")]
pub struct Sensed {
    pub scope: String,
    pub region: String,
    pub metric: String,
    pub mapper: String,
    pub suite: String,
    pub worlds: usize,
    pub mean: Option<f64>,
    pub better_alone: Option<String>,
    pub difference: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
    pub margin: Option<f64>,
    pub not_worse: Option<bool>,
}

/// A row of `efficiency.csv`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[expect(missing_docs, reason = "the names are those of the columns")]
pub struct Efficient {
    pub scope: String,
    pub mapper: String,
    pub worlds: usize,
    pub log_loss: f64,
    pub prior: f64,
    pub gibbs: f64,
    pub efficiency: Option<f64>,
    pub low: Option<f64>,
    pub high: Option<f64>,
}

/// The tables that are shown.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows {
    /// `summary.csv`.
    pub means: Vec<Mean>,
    /// `differences.csv`.
    pub differences: Vec<Difference>,
    /// `repeats.csv`; empty where nothing was repeated.
    pub repeats: Vec<Repeat>,
    /// `at-rest.csv`; empty where nobody walks.
    pub at_rest: Vec<Rested>,
    /// `sensors.csv`; empty but of suites of sensors.
    pub sensors: Vec<Sensed>,
    /// `efficiency.csv`; empty where `gibbs` or `prior` is not among the mappers.
    pub efficiency: Vec<Efficient>,
}

impl Difference {
    /// Whether the interval excludes zero.
    pub fn is_sure(&self) -> bool {
        self.low.is_some_and(|low| low > 0.0) || self.high.is_some_and(|high| high < 0.0)
    }
}

impl Rows {
    /// The mean of a metric over the worlds of a scope.
    pub fn mean(&self, scope: &str, region: &str, mapper: &str, metric: &str) -> Option<f64> {
        let mut rows = self.means.iter();
        rows.find(|r| r.scope == scope && r.region == region && r.mapper == mapper && r.metric == metric)?.mean
    }

    /// The difference of a mapper from the reference.
    pub fn difference(&self, scope: &str, region: &str, mapper: &str, metric: &str) -> Option<&Difference> {
        let mut rows = self.differences.iter();
        rows.find(|r| r.scope == scope && r.region == region && r.mapper == mapper && r.metric == metric)
    }
}

/// The rows of a CSV text.
///
/// # Errors
/// A text that is no such table.
pub fn parse<T: DeserializeOwned>(csv: &[u8]) -> Result<Vec<T>, csv::Error> {
    csv::Reader::from_reader(csv).into_deserialize().collect()
}

/// The rows of a table.
///
/// # Errors
/// A table of another kind: a defect of ours.
pub fn of<T: DeserializeOwned>(table: &Table) -> Result<Vec<T>, Failure> {
    parse(&table.csv()?).map_err(Failure::internal)
}
