//! What the range of a beam, or a disparity, says: an echo or a match, no echo, or nothing.

use crate::options::Options;
use crate::report::NoMatchCodes;

/// The maximum range where neither options nor log name one, m.
pub(crate) const MAX_RANGE_M: f64 = 80.0;

/// The maximum range of sonars where neither options nor a CARMEN log name one, m: that of [`sensor::Sonar`].
pub(crate) const MAX_SONAR_M: f64 = 5.0;

/// Scanners that see farther than this on average are taken for a mistake of units, m: no building is so large, and SICK's codes for no
/// echo are below.
const FAR_MEDIAN_M: f64 = 82.0;

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

/// What a disparity (px) says: none is no match; NaN, 0 or less, infinite and above the largest that is searched are so too, and
/// are counted where they may be a mistake.
pub(crate) fn disparity(raw: Option<f64>, most_px: Option<f64>, codes: &mut NoMatchCodes) -> Option<f64> {
    let disparity = raw?;
    if disparity.is_infinite() {
        codes.infinite += 1;
    } else if disparity > most_px.unwrap_or(f64::INFINITY) {
        codes.large += 1;
    } else if disparity > 0.0 {
        return raw;
    } else {
        codes.zero += u64::from(disparity.total_cmp(&0.0).is_eq() || disparity.total_cmp(&-0.0).is_eq());
    }
    None
}

/// Refuses a scan most of whose disparities lie above the largest that the camera searches, px.
pub(crate) fn check_scale(disparities: &mut Vec<f64>, most_px: Option<f64>) -> Result<(), String> {
    disparities.retain(|disparity| *disparity > 0.0 && disparity.is_finite());
    let Some(most_px) = most_px.filter(|_| !disparities.is_empty()) else { return Ok(()) };
    let all = disparities.len();
    let above = disparities.iter().filter(|disparity| **disparity > most_px).count();
    if 2 * above <= all {
        return Ok(());
    }
    let median = *disparities.select_nth_unstable_by(all / 2, f64::total_cmp).1;
    Err(format!(
        "{} % of {all} disparities lie above the largest that is searched, {most_px} px (--max-disparity); their median is {median} \
         px: are they sixteenths (OpenCV) or 256ths (KITTI) of a pixel? divide them by 16 or 256, or give the camera's bound",
        100 * above / all
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sonars_hear_as_far_as_mappers_take_them_to() {
        assert_eq!(MAX_SONAR_M.to_bits(), sensor::Sonar::default().max_range_m.to_bits());
    }

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
            (vec![90.0, 120.0, 180.0, 400.0], false), // cm in a small room
            (vec![81.83, 81.83, 81.83, 81.91, 2.0], true),
            (vec![210.0, 310.0, 400.0, 8191.0, 8191.0], false),
        ] {
            assert_eq!(check_unit(&mut ranges.clone()).is_ok(), metres, "{ranges:?}");
        }
        let message = check_unit(&mut vec![1500.0, 2000.0, 2100.0, 8000.0]).expect_err("mm");
        assert!(message.contains("2000") && message.contains("mm or cm"), "{message}");
    }

    #[test]
    fn every_code_for_no_match_is_none() {
        let mut codes = NoMatchCodes::default();
        let mut read = |raw: f64| disparity(Some(raw), Some(64.0), &mut codes);
        assert_eq!([read(0.5), read(64.0)], [Some(0.5), Some(64.0)]);
        for raw in [0.0, -0.0, -1.0, -16.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 64.5] {
            assert_eq!(read(raw), None, "{raw}");
        }
        assert_eq!(codes, NoMatchCodes { zero: 2, infinite: 2, large: 1 });
        assert_eq!(disparity(None, None, &mut codes), None);
        assert_eq!(disparity(Some(1e6), None, &mut codes), Some(1e6), "no bound");
    }

    #[test]
    fn parts_of_a_pixel_are_noticed_by_the_largest_disparity() {
        let scan = |scale: f64| (1..=9).map(|k| scale * f64::from(k)).chain([-scale, f64::NAN]).collect::<Vec<_>>();
        assert_eq!(check_scale(&mut scan(1.0), Some(20.0)), Ok(()));
        assert_eq!(check_scale(&mut scan(16.0), None), Ok(()), "without a bound nothing is known");
        assert_eq!(check_scale(&mut vec![-1.0], Some(20.0)), Ok(()));
        let message = check_scale(&mut scan(16.0), Some(20.0)).expect_err("sixteenths");
        assert!(message.contains("88 % of 9 disparities") && message.contains("divide them by 16 or 256"), "{message}");
    }
}
