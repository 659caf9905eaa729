//! Where a map lies best, and doubts about where it is said to lie.

use grid::Frame;
use score::{AlignBound, Alignment, Metric, Suspicion, align, suspicion};

use super::candidate::Candidate;
use super::options::{Align, ScoreOptions};
use super::rows::Row;
use super::truth::Truth;
use crate::failure::Failure;
use crate::worlds::map_file::{RowOrder, extension};

/// Moves the map to where it agrees best with the truth, if it is to be moved.
pub(super) fn best(candidate: &Candidate, truth: &Truth, options: &ScoreOptions) -> Result<Option<Alignment>, Failure> {
    let turn_rad = match options.align {
        Align::None => return Ok(None),
        Align::Shift => 0.0,
        Align::Rigid => options.align_turn.to_radians(),
    };
    let bound = AlignBound { shift_m: options.align_bound, turn_rad };
    let (map, truth) = ((&candidate.shares, &candidate.frame), (&truth.cells, &truth.frame));
    align(map, truth, &bound)
        .map(Some)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", candidate.path.display())))
}

/// What is doubtful about a map at a place, as warnings.
pub(super) fn doubts(
    candidate: &Candidate,
    frame: &Frame,
    alignment: Option<&Alignment>,
    truth: &Truth,
    options: &ScoreOptions,
) -> Result<Vec<String>, Failure> {
    let path = candidate.path.display();
    let mut warnings = Vec::new();
    if alignment.is_some_and(|alignment| alignment.at_bound) {
        let turn =
            if options.align == Align::Rigid { format!(" and {} degrees", options.align_turn) } else { String::new() };
        warnings.push(format!(
            "{path}: agrees best at the bound of {} m{turn}; give more with --align-bound or --align-turn, or correct its origin",
            options.align_bound
        ));
    }
    let doubt = suspicion((&candidate.shares, frame), (&truth.cells, &truth.frame))
        .map_err(|error| Failure::BadInput(format!("{path}: {error}")))?;
    match doubt {
        Some(Suspicion::Flipped { rows, columns, error, flipped }) => {
            let order = match options.row_order {
                Some(RowOrder::Top) => "with --row-order bottom",
                Some(RowOrder::Bottom) | None => "with --row-order top",
            };
            let remedy = match (rows, columns) {
                (true, false) if extension(&candidate.path) == "npy" => format!("its first row may be another one: score it {order}"),
                _ => "save it with y upwards and x to the right, or correct the truth".to_owned(),
            };
            let what = match (rows, columns) {
                (true, false) => "with its rows in the other order",
                (false, _) => "with its columns in the other order",
                (true, true) => "turned upside down",
            };
            warnings.push(format!("{path}: agrees better {what} (mean squared error {flipped:.4}, as it is {error:.4}); {remedy}"));
        }
        Some(Suspicion::HalfCell { cells: [x, y] }) => warnings.push(format!(
            "{path}: lies half a cell off: moved by ({x:+.2}, {y:+.2}) cells it agrees best; an origin is the corner of a cell, not its centre: correct it, or score it with --align shift",
        )),
        None => {}
    }
    Ok(warnings)
}

/// What an alignment is, as rows: shift, turn, and what scores were without it.
pub(super) fn rows(name: &str, alignment: &Alignment, before: &[Row]) -> Vec<Row> {
    let cells = before.iter().find(|row| row.region == "all").map_or(0, |row| row.metric.support);
    let metric = |name, value, unit| Metric { name, value: Some(value), unit, support: cells };
    let [x, y] = alignment.shift_m;
    let was = |now, of| {
        let row = before.iter().find(|row| row.region == "all" && row.metric.name == of);
        row.map(|row| Metric { name: now, ..row.metric })
    };
    let metrics = [
        Some(metric("align_x", x, "m")),
        Some(metric("align_y", y, "m")),
        Some(metric("align_turn", alignment.turn_rad.to_degrees(), "deg")),
        was("unaligned_log_loss", "log_loss"),
        was("unaligned_brier", "brier"),
        was("unaligned_iou", "iou"),
    ];
    let row = |metric| Row { map: name.to_owned(), region: "all".to_owned(), metric };
    metrics.into_iter().flatten().map(row).collect()
}

/// An alignment in words, with the origin that the map's file should have.
pub(super) fn worded(alignment: &Alignment, frame: &Frame, cell_m: f64) -> String {
    let [x, y] = alignment.shift_m;
    let (turn, pivot) = (alignment.turn_rad.to_degrees(), alignment.pivot_m);
    let home = alignment.of(frame);
    let [ox, oy] = home.spec.origin_m;
    format!(
        "moved by ({x:+.4}, {y:+.4}) m, which is ({:+.2}, {:+.2}) cells, and turned by {turn:+.3} degrees about ({:.3}, {:.3}) m: its origin would be [{ox:.4}, {oy:.4}, {:.5}]",
        x / cell_m,
        y / cell_m,
        pivot[0],
        pivot[1],
        home.yaw_rad
    )
}
