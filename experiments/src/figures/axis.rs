//! Axes: where values lie, and their ticks.

use std::ops::Range;

use plotters::coord::ranged1d::{KeyPointHint, NoDefaultFormatting, Ranged, ValueFormatter};

/// An axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub label: String,
    /// What is shown; of a logarithmic axis, above 0.
    pub range: Range<f64>,
    /// Whether equal ratios are equally long.
    pub logarithmic: bool,
    /// A value that is none of the scale, such as "all": it stands apart behind a gap, with its name.
    pub apart: Option<(f64, String)>,
}

/// A tick.
#[derive(Debug, Clone, PartialEq)]
pub struct Tick {
    /// Share of the axis.
    pub at: f64,
    /// What stands there; empty of a small one.
    pub label: String,
}

/// Shares of an axis with a value apart: up to here goes the scale, and there is the value.
const SCALE: f64 = 0.84;
const APART: f64 = 0.94;

impl Axis {
    /// An axis on which equal differences are equally long.
    pub fn linear(label: &str, range: Range<f64>) -> Self {
        Self { label: label.to_owned(), range, logarithmic: false, apart: None }
    }

    /// An axis on which equal ratios are equally long.
    pub fn logarithmic(label: &str, range: Range<f64>) -> Self {
        Self { logarithmic: true, ..Self::linear(label, range) }
    }

    /// The share of the axis at which a value lies: outside of 0 to 1 if it is not shown.
    pub fn share(&self, value: f64) -> f64 {
        if self.apart.as_ref().is_some_and(|(apart, _)| value >= *apart) {
            return APART;
        }
        let at = |v: f64| if self.logarithmic { libm::log10(v.max(f64::MIN_POSITIVE)) } else { v };
        let (from, to) = (at(self.range.start), at(self.range.end));
        (at(value) - from) / (to - from) * self.scale_end()
    }

    /// The value of the scale at a share of the axis.
    pub fn value(&self, share: f64) -> f64 {
        let (from, to) = (self.range.start, self.range.end);
        let share = share / self.scale_end();
        if !self.logarithmic {
            return from + share * (to - from);
        }
        libm::pow(10.0, libm::log10(from) + share * (libm::log10(to) - libm::log10(from)))
    }

    /// Where the scale ends, as a share of the axis.
    pub fn scale_end(&self) -> f64 {
        if self.apart.is_some() { SCALE } else { 1.0 }
    }

    /// The ticks of an axis on which there is room for so many labels.
    pub fn ticks(&self, room: usize) -> Vec<Tick> {
        let tick = |(value, labelled): (f64, bool)| Tick {
            at: self.share(value),
            label: if labelled { self.format_ext(&value) } else { String::new() },
        };
        self.values(room).into_iter().map(tick).collect()
    }

    /// Where ticks stand, and whether they have labels.
    fn values(&self, room: usize) -> Vec<(f64, bool)> {
        let room = room.max(3);
        let mut values = if self.logarithmic { self.by_ratio(room) } else { self.by_difference(room) };
        values.retain(|(value, _)| self.apart.as_ref().is_none_or(|(apart, _)| value < apart));
        values.extend(self.apart.iter().map(|(apart, _)| (*apart, true)));
        values
    }

    fn by_difference(&self, room: usize) -> Vec<(f64, bool)> {
        let widest = step((self.range.end - self.range.start) / room as f64);
        let ends = |step: f64| {
            let first = (self.range.start / step - 1e-9).ceil() as i64;
            (first, (self.range.end / step + 1e-9).floor() as i64)
        };
        let few = |step: &f64| {
            let (first, last) = ends(*step);
            last - first < 2
        };
        let finer = [1.0, 0.4, 0.16].map(|share| step(share * widest));
        let step = finer.into_iter().find(|step| !few(step)).unwrap_or(widest);
        let (first, last) = ends(step);
        (first..=last).map(|k| (k as f64 * step, true)).collect()
    }

    /// Powers of ten and their multiples; labels at as many of them as there is room for, but at three at least.
    fn by_ratio(&self, room: usize) -> Vec<(f64, bool)> {
        let (low, high) = (self.range.start * (1.0 - 1e-9), self.range.end * (1.0 + 1e-9));
        let powers = libm::log10(low).floor() as i32..=libm::log10(high).ceil() as i32;
        let multiples = powers.flat_map(|power| (1..10).map(move |digit| (power, digit)));
        let shown: Vec<(f64, i32, i32)> = multiples
            .map(|(power, digit)| (f64::from(digit) * libm::pow(10.0, f64::from(power)), power, digit))
            .filter(|(value, ..)| (low..=high).contains(value))
            .collect();
        let tens = shown.iter().filter(|(.., digit)| *digit == 1).count();
        let every = i32::try_from(tens.div_ceil(room).min(tens / 3).max(1)).unwrap_or(1);
        let densities: [&[i32]; 4] = [&[1, 2, 3, 4, 5, 6, 7, 8, 9], &[1, 2, 3, 5], &[1, 2, 5], &[1, 3]];
        let count = |digits: &[i32]| shown.iter().filter(|(.., digit)| digits.contains(digit)).count();
        let fits = densities.into_iter().find(|digits| (3..=room).contains(&count(digits)));
        let digits = if tens >= 4 { &[1][..] } else { fits.unwrap_or(if tens >= 3 { &[1] } else { &[1, 2, 5] }) };
        if count(digits) < 3 && tens < 3 {
            return self.by_difference(room); // less than a power of ten: steps are as good as equal
        }
        let labelled = |power: i32, digit: i32| digits.contains(&digit) && power.rem_euclid(every) == 0;
        shown.into_iter().map(|(value, power, digit)| (value, labelled(power, digit))).collect()
    }
}

/// As an axis of plotters: ticks with labels are its bold points, the others its light ones.
impl Ranged for Axis {
    type FormatOption = NoDefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        // What is far outside comes to lie at the end of the whole numbers.
        (f64::from(from) + self.share(*value) * (f64::from(to) - f64::from(from))).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        let light = hint.weight().allow_light_points();
        let values = self.values(hint.bold_points()).into_iter();
        values.filter(|(_, labelled)| *labelled != light).map(|(value, _)| value).collect()
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

impl ValueFormatter<f64> for Axis {
    fn format_ext(&self, value: &f64) -> String {
        let apart = self.apart.as_ref().filter(|(apart, _)| value >= apart);
        apart.map_or_else(|| short(*value), |(_, name)| name.clone())
    }
}

/// A round step of at least so much: 1, 2 or 5 times a power of ten.
pub fn step(least: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(least.max(f64::MIN_POSITIVE))));
    [1.0, 2.0, 5.0].into_iter().map(|k| k * power).find(|s| *s >= least * (1.0 - 1e-9)).unwrap_or(10.0 * power)
}

/// A number as it stands at a tick.
pub fn short(value: f64) -> String {
    if value.abs() < 1e-12 {
        return "0".to_owned();
    }
    let power = (libm::log10(value.abs()) + 1e-9).floor() as i32;
    if (-4..5).contains(&power) {
        let decimals = usize::try_from(3 - power).unwrap_or(0).min(6);
        let text = format!("{value:.decimals$}");
        let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
        return text.replace('-', "−");
    }
    let factor = (value / libm::pow(10.0, f64::from(power)) * 1e3).round() / 1e3;
    format!("{factor}e{power}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(axis: &Axis, room: usize) -> Vec<String> {
        axis.ticks(room).into_iter().map(|tick| tick.label).filter(|label| !label.is_empty()).collect()
    }

    #[test]
    fn ticks_stand_at_round_numbers() {
        assert_eq!(labels(&Axis::linear("", 0.0..1.0), 7), ["0", "0.2", "0.4", "0.6", "0.8", "1"]);
        assert_eq!(
            labels(&Axis::logarithmic("", 1e-5..10.0), 8),
            ["1e−5", "0.0001", "0.001", "0.01", "0.1", "1", "10"]
        );
        assert_eq!(labels(&Axis::logarithmic("", 1.0..7.0), 8), ["1", "2", "3", "4", "5", "6", "7"]);
        assert_eq!(labels(&Axis::logarithmic("", 0.9..30.0), 6), ["1", "2", "5", "10", "20"]);
        assert_eq!(labels(&Axis::logarithmic("", 4.1..4.9), 6), ["4.2", "4.4", "4.6", "4.8"]);
    }

    #[test]
    fn a_value_apart_has_its_name_and_no_place_on_the_scale() {
        let axis = Axis { apart: Some((1000.0, "all".to_owned())), ..Axis::logarithmic("m", 1.0..10.0) };
        assert_eq!(axis.ticks(8).last().expect("a tick").label, "all");
        assert!(axis.share(10.0) < axis.share(1000.0) && (axis.share(1000.0) - axis.share(9e9)).abs() < 1e-12);
    }

    #[test]
    fn plotters_sees_the_same_ticks() {
        use plotters::coord::ranged1d::{BoldPoints, LightPoints};
        let axis = Axis { apart: Some((1000.0, "all".to_owned())), ..Axis::logarithmic("m", 1.0..40.0) };
        let bold = axis.key_points(BoldPoints(5));
        assert_eq!(bold.iter().map(|value| axis.format_ext(value)).collect::<Vec<_>>(), labels(&axis, 5));
        let light = axis.key_points(LightPoints::new(5, 50));
        assert_eq!(bold.len() + light.len(), axis.ticks(5).len());
        assert_eq!([1.0, 40.0, 1e4].map(|value| axis.map(&value, (1000, 0))), [1000, 160, 60]);
        assert_eq!(Axis::linear("", 0.0..1e-9).map(&1.0, (0, 1000)), i32::MAX);
    }

    proptest! {
        #[test]
        fn there_are_three_labels_or_more_and_they_are_in_order(from in 1e-6..1e3f64, ratio in 1.2..1e6f64, logarithmic: bool, room in 4usize..9) {
            let axis = Axis { logarithmic, ..Axis::linear("", from..from * ratio) };
            let ticks = axis.ticks(room);
            let labelled: Vec<&Tick> = ticks.iter().filter(|tick| !tick.label.is_empty()).collect();
            prop_assert!((3..=2 * room + 4).contains(&labelled.len()), "{labelled:?}");
            prop_assert!(ticks.windows(2).all(|pair| pair[0].at < pair[1].at));
            prop_assert!(ticks.iter().all(|tick| (-1e-6..=1.0 + 1e-6).contains(&tick.at)));
            prop_assert!(labelled.windows(2).all(|pair| pair[0].label != pair[1].label), "{labelled:?}");
        }

        #[test]
        fn a_value_is_where_its_share_is(from in 1e-6..1e3f64, ratio in 1.2..1e6f64, share in 0.0..0.84f64, logarithmic: bool, gap: bool) {
            let apart = gap.then(|| (f64::INFINITY, "all".to_owned()));
            let axis = Axis { logarithmic, apart, ..Axis::linear("", from..from * ratio) };
            prop_assert!((axis.share(axis.value(share)) - share).abs() < 1e-9);
        }
    }
}
