//! How the maps were doing from scan to scan.

use super::chart::{Axis, Chart, Series, sheet};
use super::drawing::Drawing;
use super::paper::Paper;
use super::style;
use crate::worlds::run::{Moment, Stage, Trial};

/// What the picture shows.
pub const CAPTION: &str = "Log loss over what could be seen so far (lower is better) and free-space retention (higher is better) after \
    every scan; dashed lines are the ends of the stages.";

/// Size of a chart.
const SIZE: (f64, f64) = (700.0, 560.0);

/// Draws both curves of every mapper.
pub fn draw(trial: &Trial, stages: &[Stage], paper: &Paper) -> Drawing {
    let values = |of: fn(&Moment) -> Option<f64>| trial.runs.iter().flat_map(|run| &run.timeline).filter_map(of);
    let top = values(|m| m.log_loss).fold(0.1, f64::max) * 1.05;
    let bottom = (values(|m| m.retention).fold(0.95, f64::min) * 20.0 - 0.5).floor() / 20.0;
    let losses = curves(trial, stages, Axis::linear("log loss, nats/cell", 0.0..top), |m| m.log_loss);
    let kept =
        curves(trial, stages, Axis::linear("retention, share of cells", bottom.max(0.0)..1.005), |m| m.retention);
    let titled = |chart: Chart, title: &str| Chart { title: title.to_owned(), ..chart };
    sheet(&[titled(losses, "Log loss"), titled(kept, "Free space kept free")], 2, SIZE, paper)
}

fn curves(trial: &Trial, stages: &[Stage], y: Axis, value: impl Fn(&Moment) -> Option<f64>) -> Chart {
    let end = trial.runs.iter().filter_map(|run| run.timeline.last()).map(|m| m.time_s).fold(1.0, f64::max);
    let names: Vec<&str> = trial.runs.iter().map(|run| run.mapper).collect();
    let series = trial.runs.iter().zip(style::of_mappers(&names)).map(|(run, style)| {
        Series::new(run.mapper, style, run.timeline.iter().map(|moment| (moment.time_s, value(moment))))
    });
    let ends = stages.iter().filter_map(|stage| Some((time_of(trial, stage)?, format!("({})", stage.name))));
    Chart { ends: ends.collect(), ..Chart::new("", Axis::linear("time, s", 0.0..end), y, series.collect()) }
}

fn time_of(trial: &Trial, stage: &Stage) -> Option<f64> {
    Some(trial.simulation.scans.get(stage.scans.checked_sub(1)?)?.scan.time_s)
}
