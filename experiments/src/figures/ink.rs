//! Colours and sizes of lettering.

/// Shares of red, green and blue.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Colour(pub u8, pub u8, pub u8);

impl Colour {
    pub const WHITE: Self = Self(255, 255, 255);
    pub const BLACK: Self = Self(0, 0, 0);

    /// The colour between this and another: that one for a share of 1.
    pub fn towards(self, other: Self, share: f64) -> Self {
        let mix = |from: u8, to: u8| (f64::from(from) + share * (f64::from(to) - f64::from(from))).round() as u8;
        Self(mix(self.0, other.0), mix(self.1, other.1), mix(self.2, other.2))
    }

    /// How far it is from another: the sum of squares.
    pub fn off(self, other: Self) -> u32 {
        let square = |a: u8, b: u8| u32::from(a.abs_diff(b)).pow(2);
        square(self.0, other.0) + square(self.1, other.1) + square(self.2, other.2)
    }
}

/// Text.
pub const INK: Colour = Colour(34, 34, 34);

/// Captions and frames that should step back.
pub const FAINT: Colour = Colour(110, 110, 110);

/// Lines of a grid.
pub const GRID: Colour = Colour(226, 226, 226);

/// A named region.
pub const REGION: Colour = Colour(213, 94, 0);

/// The robot and its route.
pub const ROUTE: Colour = Colour(0, 114, 178);

/// What moves.
pub const THING: Colour = Colour(120, 60, 200);

/// Cells whose truth is not known.
pub const UNKNOWN: Colour = Colour(214, 222, 230);

/// Colours of values that have no name, from dark to light in grey too: Okabe and Ito (2008), without those that are too
/// light for a thin line.
pub const LINES: [Colour; 7] = [
    Colour(0, 0, 0),
    Colour(0, 114, 178),
    Colour(213, 94, 0),
    Colour(0, 158, 115),
    Colour(204, 121, 167),
    Colour(230, 159, 0),
    Colour(86, 180, 233),
];

/// Sizes of lettering: 7.2 and 6.5 points.
pub const LABEL: f64 = 20.0;
pub const SMALL: f64 = 18.0;

/// Colour of an occupancy: white for free, black for occupied, and light grey for the prior, so that
/// what is not known does not look free. Linear in log odds between those, since evidence is.
pub fn occupancy(p: f64, prior: f64) -> Colour {
    const CERTAIN: f64 = 4.6; // log odds of 0.99
    const AT_PRIOR: f64 = 200.0;
    /// Levels are this far apart: 64 of them are enough for the eye, and make small files.
    const STEP: f64 = 4.0;
    let odds = |p: f64| libm::log(p / (1.0 - p));
    let (at, from) = (odds(p.clamp(1e-9, 1.0 - 1e-9)), odds(prior.clamp(1e-3, 1.0 - 1e-3)));
    let level = if at <= from {
        let share = ((from - at) / (CERTAIN + from).max(1.0)).min(1.0);
        AT_PRIOR + share * (255.0 - AT_PRIOR)
    } else {
        let share = ((at - from) / (CERTAIN - from)).min(1.0);
        AT_PRIOR * (1.0 - share)
    };
    let level = if level > 253.0 { 255 } else { ((level / STEP).round() * STEP) as u8 };
    Colour(level, level, level)
}

/// Colour of the truth: as a map without doubt.
pub fn truth(cell: Option<bool>) -> Colour {
    match cell {
        Some(true) => Colour::BLACK,
        Some(false) => Colour::WHITE,
        None => UNKNOWN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_occupancy_is_darker_the_surer_it_is() {
        let level = |p: f64| occupancy(p, 0.1).0;
        assert_eq!([0.0, 0.1, 1.0].map(level), [255, 200, 0]);
        let levels: Vec<u8> = (0..=100).map(|k| level(f64::from(k) / 100.0)).collect();
        assert!(levels.is_sorted_by(|a, b| a >= b), "{levels:?}");
    }

    #[test]
    fn a_colour_towards_another() {
        assert_eq!(Colour::WHITE.towards(Colour(0, 100, 255), 0.5), Colour(128, 178, 255));
        assert_eq!(Colour(1, 2, 3).off(Colour(2, 0, 3)), 5);
    }
}
