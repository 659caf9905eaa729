//! How the filter was doing from scan to scan.

use score::trajectory::{Stamped, aligned, associated};
use sensor::Pose;
use slam::Update;

use super::scores::MOST_S;
use super::source::Taken;
use crate::figures::chart::{Axis, Chart, Series, sheet};
use crate::figures::ink::{FAINT, ROUTE};
use crate::figures::style::Style;
use crate::figures::{Drawing, Paper};
use crate::worlds::track::stamped;

/// What the picture shows.
pub(super) const CAPTION: &str = "Along the way: effective number of particles before they are drawn anew (as a share of all), how far they lie \
    apart, how much better the map predicts a scan than no map would, and, where the true way is known, how far the way is from it once both \
    are aligned.";

/// Size of a chart.
const SIZE: (f64, f64) = (700.0, 420.0);

/// Draws what is known of the updates, and errors where there is a truth.
pub(super) fn draw(
    updates: &[Update],
    particles: usize,
    scans: &[Taken],
    found: &[(f64, Pose)],
    truth: Option<&[Stamped]>,
    paper: &Paper,
) -> Drawing {
    let end = scans.last().map_or(1.0, |taken| taken.time_s()).max(1.0);
    let chart = |title: &str, label: &str, low: f64, series: Vec<Series>| {
        let values = || series.iter().flat_map(|series| &series.points).map(|at| at.y);
        let high = values().fold(low, f64::max);
        let low = values().fold(low, f64::min);
        let top = if high > low { high + 0.05 * (high - low) } else { low + 1.0 };
        Chart::new(title, Axis::linear("time, s", 0.0..end), Axis::linear(label, low..top), series)
    };
    let line = |value: &dyn Fn(&Update) -> Option<f64>| {
        vec![Series::new("slam", Style::line(ROUTE), updates.iter().map(|update| (update.time_s, value(update))))]
    };
    let mut charts = vec![
        chart("Effective particles", "N_eff / N", 0.0, line(&|update| Some(update.effective / particles as f64))),
        chart("Spread of the particles", "m", 0.0, line(&|update| Some(update.spread_m))),
    ];
    if updates.iter().any(|update| update.gain.is_some()) {
        charts.push(chart("Gain of the map", "nats/reading", 0.0, line(&|update| update.gain)));
    }
    let start_s = scans.first().map_or(0.0, |taken| taken.clock_s - taken.time_s());
    let errors = |name: &str, colour, poses: Vec<Stamped>| {
        let pairs = aligned(&associated(&poses, truth?, MOST_S).ok()?).ok()?;
        let off = pairs.into_iter().map(|pair| {
            let error = pair.estimate.seen_from(pair.reference);
            (pair.time_s - start_s, Some(error.x_m.hypot(error.y_m)))
        });
        Some(Series::new(name, Style::line(colour), off))
    };
    let by = |pose: &dyn Fn(usize) -> Pose| (0..scans.len()).map(|k| stamped(scans[k].clock_s, pose(k))).collect();
    let series = [errors("odometry", FAINT, by(&|k| scans[k].odometry)), errors("slam", ROUTE, by(&|k| found[k].1))];
    let series: Vec<Series> = series.into_iter().flatten().collect();
    if !series.is_empty() {
        charts.push(chart("Distance from the true way", "m", 0.0, series));
    }
    sheet(&charts, 2, SIZE, paper)
}
