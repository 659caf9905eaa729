//! What the range of a beam says: an echo, no echo, or nothing.

use crate::options::Options;

/// The maximum range where neither options nor log name one, m.
pub(crate) const MAX_RANGE_M: f64 = 80.0;

/// Scanners that see farther than this on average are taken for a mistake of units, m.
const FAR_MEDIAN_M: f64 = 200.0;

/// The rule by which ranges are judged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Rule {
    pub(crate) min_m: f64,
    pub(crate) max_m: f64,
}

impl Rule {
    /// The maximum range is the options', else that of the log, else 80 m.
    ///
    /// The scanners of most logs, SICK's LMS, write 81.83 to 81.91 m where there is no echo, and their logs give a maximum of
    /// up to 82 m, which no reading would reach; a maximum from 81.8 to 82 m is taken as 81.8 m.
    pub(crate) fn new(options: &Options, of_the_log: Option<f64>) -> Self {
        let max_m = options.max_range_m.or(of_the_log).unwrap_or(MAX_RANGE_M);
        let max_m = if (81.8..=82.0).contains(&max_m) { 81.8 } else { max_m };
        Self { min_m: options.min_range_m, max_m }
    }

    /// `Some(INFINITY)` from the maximum range on, `None` for NaN, zero, negative and below the minimum range.
    pub(crate) fn reading(&self, range_m: f64) -> Option<f64> {
        if range_m >= self.max_m {
            Some(f64::INFINITY)
        } else {
            Some(range_m).filter(|range| *range > 0.0 && *range >= self.min_m)
        }
    }
}

/// Says so where ranges, as the log has them, can hardly be metres: by the median of those that are positive, without the
/// longest, which may be a code for no echo. Reorders `ranges`.
pub(crate) fn check_unit(ranges: &mut Vec<f64>) -> Result<(), String> {
    let longest = ranges.iter().copied().fold(0.0, f64::max);
    ranges.retain(|range| *range > 0.0 && *range < longest);
    if ranges.is_empty() {
        return Ok(());
    }
    let middle = ranges.len() / 2;
    let median = *ranges.select_nth_unstable_by(middle, f64::total_cmp).1;
    if median <= FAR_MEDIAN_M {
        return Ok(());
    }
    Err(format!(
        "the median of {} ranges is {median}, which must be at most {FAR_MEDIAN_M} m; are they in mm or cm? convert them to m",
        ranges.len()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_an_echo_no_echo_or_nothing() {
        let rule = Rule::new(&Options { min_range_m: 0.1, ..Options::default() }, None);
        for (range, expected) in [
            (0.1, Some(0.1)),
            (79.99, Some(79.99)),
            (80.0, Some(f64::INFINITY)),
            (81.91, Some(f64::INFINITY)),
            (f64::INFINITY, Some(f64::INFINITY)),
            (0.09, None),
            (0.0, None),
            (-1.0, None),
            (f64::NEG_INFINITY, None),
            (f64::NAN, None),
        ] {
            assert_eq!(rule.reading(range), expected, "{range}");
        }
        assert_eq!(Rule::new(&Options::default(), None).reading(0.0), None, "zero is no surface at the sensor");
    }

    #[test]
    fn options_come_before_the_log_and_the_log_before_the_default() {
        let options = Options { max_range_m: Some(30.0), ..Options::default() };
        let maxima = [(options.clone(), Some(50.0)), (Options::default(), Some(50.0)), (Options::default(), None)];
        let expected = [30.0, 50.0, 80.0].map(|max_m| Rule { min_m: 0.0, max_m });
        assert_eq!(maxima.map(|(options, log)| Rule::new(&options, log)), expected);
    }

    #[test]
    fn a_maximum_that_no_code_reaches_is_the_sicks() {
        for max in [81.83, 81.92, 82.0] {
            assert_eq!(Rule::new(&Options::default(), Some(max)).reading(81.83), Some(f64::INFINITY), "{max}");
        }
        assert_eq!(Rule::new(&Options::default(), Some(100.0)).reading(81.91), Some(81.91));
    }

    #[test]
    fn millimetres_and_centimetres_are_noticed_and_codes_are_not() {
        for (ranges, metres) in [
            (vec![], true),
            (vec![1.5, 2.0, 81.91], true),
            (vec![f64::NAN, -1.0, f64::INFINITY, f64::INFINITY, 2.0], true),
            (vec![65535.0, 65535.0, 65535.0, 3.0], true), // a code for no echo, and one echo
            (vec![1500.0, 2000.0, 2100.0, 8000.0], false),
            (vec![210.0, 310.0, 400.0, 8191.0, 8191.0], false),
        ] {
            assert_eq!(check_unit(&mut ranges.clone()).is_ok(), metres, "{ranges:?}");
        }
        let message = check_unit(&mut vec![1500.0, 2000.0, 2100.0, 8000.0]).expect_err("mm");
        assert!(message.contains("2000") && message.contains("mm or cm"), "{message}");
    }
}
