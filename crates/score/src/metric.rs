//! One number about a map.

use serde::Serialize;

/// A metric with its unit and the number of cells, or of drives, behind it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Metric {
    /// Name, as in tables and files.
    pub name: &'static str,
    /// The value, or `None` where the metric is not defined: nothing to judge is not a zero.
    pub value: Option<f64>,
    /// Unit of the value; `1` for a share.
    pub unit: &'static str,
    /// Number of cells that the metric is computed over; of a metric of drives, their number.
    pub support: usize,
}

impl Metric {
    /// `sum / support`, or no value where there is no support.
    pub(crate) fn mean(name: &'static str, unit: &'static str, sum: f64, support: usize) -> Self {
        Self { name, value: (support > 0).then(|| sum / support as f64), unit, support }
    }

    /// The share of `support` cells that are among `part`.
    pub(crate) fn share(name: &'static str, part: usize, support: usize) -> Self {
        debug_assert!(part <= support, "{part} of {support}");
        Self::mean(name, "1", part as f64, support)
    }

    /// The area (m²) of those `part` of `support` cells that are at fault.
    pub(crate) fn area(name: &'static str, part: usize, support: usize, cell_area_m2: f64) -> Self {
        debug_assert!(part <= support, "{part} of {support}");
        Self { name, value: (support > 0).then_some(part as f64 * cell_area_m2), unit: "m²", support }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_support_there_is_no_value() {
        for metric in [Metric::mean("m", "1", 0.0, 0), Metric::share("m", 0, 0), Metric::area("m", 0, 0, 0.01)] {
            assert_eq!((metric.value, metric.support), (None, 0));
        }
    }

    #[test]
    fn shares_and_areas() {
        assert_eq!(Metric::share("m", 1, 4).value, Some(0.25));
        assert_eq!(Metric::area("m", 3, 4, 0.25).value, Some(0.75));
        assert_eq!(Metric::area("m", 0, 4, 0.25).value, Some(0.0));
    }
}
