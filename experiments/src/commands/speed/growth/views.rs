//! Table and picture of how time grows.

use serde_json::json;

use super::curve::{Against, Curve};
use crate::commands::speed::tables::grouped;
use crate::figures::chart::{Axis, Chart, Series, sheet};
use crate::figures::{Drawing, Paper, style};
use crate::output::table::{Table, aligned, optional, rounded};

/// One row per mapper, axis and size; the exponent is that of the whole curve.
pub fn table(curves: &[Curve]) -> Table {
    let mut rows = Vec::new();
    for curve in curves {
        rows.extend(curve.points.iter().map(|point| (curve, *point)));
    }
    Table::of(
        &rows,
        &[
            ("mapper", &|(curve, _)| json!(curve.mapper)),
            ("against", &|(curve, _)| json!(curve.against.name())),
            ("size", &|(_, (size, _))| json!(*size as u64)),
            ("seconds", &|(_, (_, seconds))| rounded(*seconds)),
            ("exponent", &|(curve, _)| optional(curve.exponent())),
        ],
    )
}

/// For reading, a row per mapper, at most 80 columns wide: exponents, and times at the largest sizes.
pub fn text(curves: &[Curve]) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    for curve in curves.iter().filter(|curve| curve.against == Against::ALL[0]) {
        let told = |against: Against| {
            let own = curves.iter().find(|other| other.mapper == curve.mapper && other.against == against);
            let exponent = own.and_then(Curve::exponent).map_or_else(|| "-".to_owned(), shown);
            let last = own.and_then(|own| own.points.last()).map(|(_, seconds)| time(*seconds));
            format!("{exponent} {:>7}", last.unwrap_or_default())
        };
        rows.push([curve.mapper.to_owned()].into_iter().chain(Against::ALL.map(told)).collect());
    }
    let spans = Against::ALL.map(|against| {
        let sizes = || curves.iter().filter(|curve| curve.against == against).flat_map(|curve| &curve.points);
        let ends = sizes().fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), (x, _)| (a.min(*x), b.max(*x)));
        let [low, high] = [ends.0, ends.1].map(|end| grouped(end as u64));
        format!("  {:14} {low:>6} to {high:10} {}\n", against.heading(), against.timed())
    });
    format!(
        "Growth: the exponent of time, fitted to times at several sizes (1: in\nproportion, 0: not at all), and the time at the \
         largest, in cells of 0.05 m\n\n{}\n{}",
        aligned(&["mapper"].into_iter().chain(Against::ALL.map(Against::heading)).collect::<Vec<_>>(), &rows),
        spans.concat()
    )
}

/// A time with three digits, in seven letters at most.
fn time(seconds: f64) -> String {
    let units = [("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9)];
    let (unit, value) = units
        .map(|(unit, size)| (unit, seconds / size))
        .into_iter()
        .find(|(_, v)| *v >= 0.9995)
        .unwrap_or(("ns", 1e9 * seconds));
    let decimals = if value < 9.995 { 2 } else { usize::from(value < 99.95) };
    format!("{value:.decimals$} {unit}")
}

/// A chart for each axis with a line for each mapper.
pub fn draw(curves: &[Curve], paper: &Paper) -> Drawing {
    let charts: Vec<Chart> = Against::ALL.iter().filter_map(|against| chart(curves, *against)).collect();
    sheet(&charts, 2, (700.0, 520.0), paper)
}

impl Against {
    fn heading(self) -> &'static str {
        match self {
            Self::CellsPerRay => "cells per ray",
            Self::RaysPerScan => "rays per scan",
            Self::MapCells => "cells of map",
            Self::Scans => "scans",
        }
    }

    /// What the time is of.
    fn timed(self) -> &'static str {
        match self {
            Self::CellsPerRay => "one ray",
            Self::RaysPerScan => "one scan",
            Self::MapCells => "the same scan",
            Self::Scans => "all of them",
        }
    }

    /// What stands upwards, and its unit in seconds.
    fn ordinate(self) -> (&'static str, f64) {
        match self {
            Self::CellsPerRay => ("time per ray, µs", 1e-6),
            Self::RaysPerScan | Self::MapCells => ("time per scan, ms", 1e-3),
            Self::Scans => ("time of all scans, s", 1.0),
        }
    }
}

/// An exponent with two decimals, and no minus zero.
fn shown(exponent: f64) -> String {
    format!("{:.2}", (100.0 * exponent).round() / 100.0 + 0.0)
}

/// None where there is nothing to draw.
fn chart(curves: &[Curve], against: Against) -> Option<Chart> {
    let own = || curves.iter().filter(|curve| curve.against == against);
    let (title, unit_s) = against.ordinate();
    let ends = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), value| (a.min(value), b.max(value)))
    };
    let (left, right) = ends(&mut own().flat_map(|curve| &curve.points).map(|(size, _)| *size));
    let (bottom, top) = ends(&mut own().flat_map(|curve| &curve.points).map(|(_, seconds)| seconds / unit_s));
    if right <= left || !(bottom > 0.0 && top.is_finite()) {
        return None;
    }
    let names: Vec<&str> = own().map(|curve| curve.mapper).collect();
    let series = own().zip(style::of_mappers(&names)).map(|(curve, style)| {
        Series::new(curve.mapper, style, curve.points.iter().map(|(size, seconds)| (*size, Some(seconds / unit_s))))
    });
    let x = Axis::logarithmic(against.heading(), 0.8 * left..1.25 * right);
    Some(Chart::new(against.heading(), x, Axis::logarithmic(title, 0.7 * bottom..1.4 * top), series.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curves() -> Vec<Curve> {
        let curve = |mapper, against, power| Curve {
            mapper,
            against,
            points: [100.0, 1000.0, 10_000.0].map(|x: f64| (x, 1e-8 * x.powf(power))).to_vec(),
        };
        let both = |against| [curve("visibility", against, 1.0), curve("log-odds-cartographer", against, 0.5)];
        Against::ALL.into_iter().flat_map(both).collect()
    }

    #[test]
    fn exponents_stand_by_mapper_and_axis() {
        let text = text(&curves());
        assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
        let row = text.lines().find(|line| line.starts_with("log-odds-cartographer")).expect("a row");
        assert_eq!(row.split_whitespace().skip(1).collect::<Vec<_>>().join(" "), ["0.50 1.00 µs"; 4].join(" "));
    }

    #[test]
    fn times_have_three_digits_and_exponents_no_minus_zero() {
        let shown_times = [1e-10, 0.9994e-6, 0.9996e-6, 12.345e-3, 99.96e-3, 11.3, 1234.0].map(time);
        assert_eq!(shown_times, ["0.10 ns", "999 ns", "1.00 µs", "12.3 ms", "100 ms", "11.3 s", "1234 s"]);
        assert_eq!([-0.004, -0.006, 0.849].map(shown), ["0.00", "-0.01", "0.85"]);
    }

    #[test]
    fn the_table_has_every_point() {
        let table = table(&curves());
        assert_eq!(table.rows().len(), 4 * 2 * 3);
        assert_eq!(table.rows()[0][1..3], [json!("cells_per_ray"), json!(100)]);
    }

    #[test]
    fn a_chart_needs_two_sizes() {
        assert!(chart(&curves(), Against::Scans).is_some());
        let mut single = curves();
        single.iter_mut().for_each(|curve| curve.points.truncate(1));
        assert!(chart(&single, Against::Scans).is_none());
        let png = Paper::default().png(&draw(&curves(), &Paper::default())).expect("drawn");
        assert!(png.starts_with(b"\x89PNG"));
    }
}
