//! How the maps were doing from scan to scan.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::ink::{self, FAINT, INK, LINES};
use super::{Area, png};
use crate::failure::Failure;
use crate::worlds::run::Stage;
use crate::worlds::run::{Moment, Trial};

/// What the picture shows.
pub const CAPTION: &str = "Log loss over what could be seen so far (lower is better) and free-space retention (higher is better) after \
    every scan; dashed lines are the ends of the stages.";

const SIZE: (u32, u32) = (1400, 620);

/// Draws both curves of every mapper.
///
/// # Errors
/// A drawing that fails.
pub fn draw(trial: &Trial, stages: &[Stage]) -> Result<Vec<u8>, Failure> {
    png(SIZE, |area| {
        let (left, right) = area.split_horizontally(SIZE.0 / 2);
        let losses = trial.runs.iter().flat_map(|run| &run.timeline).filter_map(|m| m.log_loss);
        let top = losses.fold(0.1, f64::max) * 1.05;
        curves(&left, trial, stages, ("log loss, nats per cell", 0.0..top), |m| m.log_loss)?;
        let kept = trial.runs.iter().flat_map(|run| &run.timeline).filter_map(|m| m.retention);
        let bottom = (kept.fold(0.95, f64::min) * 20.0 - 0.5).floor() / 20.0;
        curves(&right, trial, stages, ("free-space retention", bottom.max(0.0)..1.005), |m| m.retention)
    })
}

fn curves(
    area: &Area,
    trial: &Trial,
    stages: &[Stage],
    (label, range): (&str, std::ops::Range<f64>),
    value: impl Fn(&Moment) -> Option<f64>,
) -> Result<(), Failure> {
    let end = trial.runs.iter().filter_map(|run| run.timeline.last()).map(|m| m.time_s).fold(1.0, f64::max);
    let mut chart = ChartBuilder::on(area)
        .margin(16)
        .x_label_area_size(48)
        .y_label_area_size(72)
        .build_cartesian_2d(0.0..end, range.clone())
        .map_err(Failure::internal)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(228, 228, 228))
        .axis_style(FAINT)
        .label_style(ink::letters(ink::LABEL, &INK))
        .x_desc("time, s")
        .y_desc(label)
        .draw()
        .map_err(Failure::internal)?;
    for (stage, moment) in stages.iter().filter_map(|s| Some((s, time_of(trial, s)?))) {
        let line = [(moment, range.start), (moment, range.end)];
        chart.draw_series(DashedLineSeries::new(line, 6, 6, FAINT.into())).map_err(Failure::internal)?;
        let style = ink::letters(ink::LABEL, &FAINT).pos(Pos::new(HPos::Right, VPos::Top));
        let text = Text::new(format!("{} ", stage.name), (moment, range.end), style);
        chart.draw_series([text]).map_err(Failure::internal)?;
    }
    for (run, colour) in trial.runs.iter().zip(LINES.into_iter().cycle()) {
        let points = run.timeline.iter().filter_map(|m| Some((m.time_s, value(m)?)));
        chart
            .draw_series(LineSeries::new(points, colour.stroke_width(3)))
            .map_err(Failure::internal)?
            .label(run.mapper)
            .legend(move |(x, y)| PathElement::new(vec![(x, y), (x + 22, y)], colour.stroke_width(3)));
    }
    chart
        .configure_series_labels()
        .position(if range.start > 0.0 { SeriesLabelPosition::LowerLeft } else { SeriesLabelPosition::UpperLeft })
        .margin(14)
        .legend_area_size(30)
        .label_font(ink::letters(ink::LABEL, &INK))
        .background_style(WHITE.mix(0.85))
        .border_style(FAINT)
        .draw()
        .map_err(Failure::internal)
}

fn time_of(trial: &Trial, stage: &Stage) -> Option<f64> {
    Some(trial.simulation.scans.get(stage.scans.checked_sub(1)?)?.scan.time_s)
}
