//! What the numbers of an array say of occupancy, and by what one sees that they say something else.

use super::number::{Kind, Number};

/// The reading of an array, and what its numbers were so far.
pub(super) struct Meaning {
    kind: Kind,
    /// Largest occupancy in percent.
    most: f64,
    /// Numbers of 255 and of -1, and of those above 0 and below 255.
    white: usize,
    negative: usize,
    between: usize,
    /// Shares that are the shades 205 and 254 of a picture from 0 to 1, and other shares between 0 and 1.
    shades: usize,
    shares: usize,
}

/// What is wrong with an array as a whole: what, its value, what it must be, what to do.
type Doubt = (&'static str, String, &'static str, &'static str);

impl Meaning {
    pub(super) fn of(number: &Number) -> Self {
        Self { kind: number.kind, most: 0.0, white: 0, negative: 0, between: 0, shades: 0, shares: 0 }
    }

    /// The occupancy of a value; `None` for one out of range.
    pub(super) fn occupancy(&mut self, value: f64) -> Option<Option<f64>> {
        let integer = matches!(self.kind, Kind::Signed | Kind::Unsigned);
        match self.kind {
            Kind::Float if value.is_nan() => Some(None),
            Kind::Float | Kind::Bool => {
                let is = |shade: f64| (255.0 * value - shade).abs() < 0.1; // half precision errs by 0.06
                if is(205.0) || is(254.0) {
                    self.shades += 1;
                } else if value > 0.0 && value < 1.0 {
                    self.shares += 1;
                }
                (0.0..=1.0).contains(&value).then_some(Some(value))
            }
            _ if integer && (0.0..=100.0).contains(&value) => {
                self.most = self.most.max(value);
                self.between += usize::from(value > 0.0);
                Some(Some(value / 100.0))
            }
            // -1, and what it is in an unsigned byte.
            _ if value < 0.0 => {
                self.negative += 1;
                (value >= -1.0).then_some(None)
            }
            _ => {
                self.white += 1;
                (value > 254.0 && value < 256.0).then_some(None)
            }
        }
    }

    /// What a value must be, and what to do about one that is not.
    pub(super) fn range(&self, value: f64) -> (&'static str, &'static str) {
        match self.kind {
            Kind::Float if (-1.0..=-1.0).contains(&value) => {
                ("from 0 to 1, or NaN", "NaN means unknown: a[a < 0] = numpy.nan")
            }
            Kind::Float if (2.0..=100.0).contains(&value) => {
                ("from 0 to 1, or NaN", "save shares of occupancy, not percent or log odds: a / 100 if it is percent")
            }
            Kind::Float => ("from 0 to 1, or NaN", "save shares of occupancy, not percent or log odds"),
            Kind::Bool => ("0 or 1", "save the array again"),
            Kind::Signed | Kind::Unsigned if (101.0..255.0).contains(&value) => (
                "from 0 to 100, or -1 or 255",
                "save percent of occupancy, as a ROS OccupancyGrid has them; save a picture as PNG and convert that",
            ),
            Kind::Signed | Kind::Unsigned => {
                ("from 0 to 100, or -1 or 255", "save percent of occupancy, as a ROS OccupancyGrid has them")
            }
        }
    }

    /// What is wrong with numbers that are each in range.
    pub(super) fn doubt(&self) -> Option<Doubt> {
        if !matches!(self.kind, Kind::Signed | Kind::Unsigned) {
            let bound = "shares of occupancy; 0, 205 / 255 and 254 / 255 are the shades of a picture";
            let remedy = "save the picture as PNG and convert that, or save states: a == 0 as bool";
            let picture = self.shades > 0 && self.shares == 0;
            return picture.then(|| ("its values", "0.804 and 0.996".to_owned(), bound, remedy));
        }
        // 1 % everywhere is no map: they are states.
        if self.most > 0.0 && self.most <= 1.0 {
            let remedy = match self.negative + self.white {
                0 => "save states as bool, or shares as float32",
                _ => "save shares: numpy.where(a == 1, 1.0, numpy.where(a == 0, 0.0, numpy.nan))",
            };
            return Some(("the largest value", "1".to_owned(), "a percent, up to 100", remedy));
        }
        // As percent, 0 and 255 alone would be a map without an obstacle.
        if self.white > 0 && self.between == 0 && self.negative == 0 {
            let bound = "percent; 0 and 255 alone are a picture or a mask";
            let remedy = "save states as bool: a == 0 where black is occupied, a == 255 where white is";
            return Some(("its values", "0 and 255".to_owned(), bound, remedy));
        }
        None
    }
}
