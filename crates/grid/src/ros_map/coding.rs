//! What the shades of an image mean: the modes of `map_server`.

use super::pixel::Pixel;

/// How the shades of a map's image say what is in its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Occupied, free or unknown, by two thresholds on the darkness.
    #[default]
    Trinary,
    /// As trinary at the ends, and percent in between; only what is not opaque is unknown.
    Scale,
    /// The brightness, of 255, is the percent; above 100 is unknown.
    Raw,
}

impl Mode {
    /// All modes.
    pub const ALL: [Self; 3] = [Self::Trinary, Self::Scale, Self::Raw];

    /// The name that stands in a map's YAML file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Trinary => "trinary",
            Self::Scale => "scale",
            Self::Raw => "raw",
        }
    }
}

/// The shares from which a cell counts as occupied and up to which as free, each without the bound itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Thresholds {
    /// Above it a cell is occupied, 0 to 1.
    pub occupied: f64,
    /// Below it a cell is free, 0 to `occupied`.
    pub free: f64,
}

impl Default for Thresholds {
    /// Those that map_server writes: the grey 205 of its unknown cells lies between them.
    fn default() -> Self {
        Self { occupied: 0.65, free: 0.196 }
    }
}

impl Thresholds {
    /// Whether a cell of this occupancy is occupied, free or neither.
    ///
    /// Compares in single precision: 0.6 is not above a threshold of 0.6.
    pub fn state(&self, occupancy: Option<f32>) -> Option<bool> {
        let occupancy = occupancy?;
        if occupancy > self.occupied as f32 {
            Some(true)
        } else if occupancy < self.free as f32 {
            Some(false)
        } else {
            None
        }
    }

    /// The same for a darkness as the image gives it, from 0 to 1.
    fn of_darkness(&self, p: f64) -> Option<bool> {
        if p > self.occupied {
            Some(true)
        } else if p < self.free {
            Some(false)
        } else {
            None
        }
    }
}

/// Everything that is needed to read occupancy out of shades, and to write it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Coding {
    /// Which rule.
    pub mode: Mode,
    /// Bright means occupied. Not in [`Mode::Raw`], where nav2 does not look at it.
    pub negate: bool,
    /// The two thresholds.
    pub thresholds: Thresholds,
}

impl Coding {
    /// The occupancy of a cell by its pixel, from 0 to 1; `None` is unknown.
    ///
    /// Source: `loadMapFromFile` in nav2_map_server. In mode `scale` map_server of ROS 1 has `1 + 98 r` cut to a whole
    /// percent instead of `100 r` rounded: a percent less or more.
    pub(super) fn occupancy(&self, pixel: Pixel) -> Option<f32> {
        let Pixel { brightness, white, opacity } = pixel;
        let percent = |v: f64| Some((v / 100.0) as f32);
        let seen = if self.mode == Mode::Scale { pixel.is_opaque() } else { opacity > 0 };
        if !seen {
            return None;
        }
        if self.mode == Mode::Raw {
            // The nearest whole number of 255.
            let shade = (2 * 255 * u64::from(brightness) + u64::from(white)) / (2 * u64::from(white));
            return if shade <= 100 { percent(shade as f64) } else { None };
        }
        let dark = if self.negate { brightness } else { white - brightness };
        // Whole numbers up to here, so that a value at a threshold stays there.
        let p = f64::from(dark) / f64::from(white);
        match self.thresholds.of_darkness(p) {
            Some(occupied) => Some(f32::from(u8::from(occupied))),
            None if self.mode == Mode::Trinary => None,
            None => {
                let Thresholds { occupied, free } = self.thresholds;
                // Equal thresholds leave one darkness between them: half.
                let ratio = if occupied > free { (p - free) / (occupied - free) } else { 0.5 };
                percent((ratio * 100.0).round_ties_even())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(mode: Mode, negate: bool, brightness: u32) -> Option<f32> {
        let coding = Coding { mode, negate, thresholds: Thresholds::default() };
        coding.occupancy(Pixel { brightness, white: 255, opacity: Pixel::OPAQUE })
    }

    #[test]
    fn scale_is_what_nav2_makes_of_it() {
        // rint(100 (p - 0.196) / 0.454), by hand: p = 51/255 = 0.2, 102/255 = 0.4, 165/255 = 0.64706.
        for (dark, percent) in [(0, 0), (49, 0), (50, 0), (51, 1), (102, 45), (165, 99), (166, 100), (255, 100)] {
            let expected = Some(percent as f32 / 100.0);
            assert_eq!(read(Mode::Scale, false, 255 - dark), expected, "{dark}");
            assert_eq!(read(Mode::Scale, true, dark), expected, "{dark}");
        }
    }

    #[test]
    fn raw_is_the_brightness_whatever_negate_says() {
        for negate in [false, true] {
            for v in 0..=255 {
                let expected = (v <= 100).then_some(v as f32 / 100.0);
                assert_eq!(read(Mode::Raw, negate, v), expected, "{v}");
            }
        }
    }

    #[test]
    fn only_opaque_pixels_count_in_scale_and_only_transparent_ones_do_not_elsewhere() {
        for (opacity, seen) in [(0, [false; 3]), (1, [true, false, true]), (Pixel::OPAQUE, [true; 3])] {
            for (mode, seen) in Mode::ALL.into_iter().zip(seen) {
                let coding = Coding { mode, ..Coding::default() };
                let pixel = Pixel { brightness: 0, white: 255, opacity };
                assert_eq!(coding.occupancy(pixel).is_some(), seen, "{mode:?} {opacity}");
            }
        }
    }

    #[test]
    fn a_percent_at_a_threshold_is_neither() {
        for percent in 1..100_u8 {
            let share = f64::from(percent) / 100.0;
            let at = Thresholds { occupied: share, free: share };
            assert_eq!(at.state(Some(share as f32)), None, "{percent}");
            assert_eq!(at.state(Some((share + 0.001) as f32)), Some(true));
            assert_eq!(at.state(Some((share - 0.001) as f32)), Some(false));
        }
        assert_eq!(Thresholds::default().state(None), None);
    }
}
